"""Models of lamps."""

from hypernav.houses.materials import BLACK_METAL, BRASS, GLOW, SHADE, WHITE_METAL, Palette, plastic
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.random_stream import RandomStream

_LIT = Finish("fabric", (1.0, 0.96, 0.85), 0.3, "cream", "fabric", unlit=True)


def _shade(builder: ModelBuilder, radius: float, high: float, z: float, slope: float = 0.8) -> None:
    """A cloth shade, glowing, open below and above."""
    wall = [(radius, z), (radius * slope, z + high)]
    builder.add(_LIT, lathe(wall, sides=24))
    builder.add(
        SHADE, lathe([(radius * 0.99, z), (radius * slope * 0.99, z + high)][::-1], sides=24)
    )
    builder.add(GLOW, ball(0.07, 0.07, 0.09, at=(0, 0, z + high * 0.5), sides=10))
    builder.add(
        BLACK_METAL,
        rod(
            (-radius * slope, 0, z + high - 0.01),
            (radius * slope, 0, z + high - 0.01),
            0.003,
            sides=5,
        ),
    )


def floor_lamp(rng: RandomStream, palette: Palette) -> Model:
    """A tall lamp: straight, tripod or arched."""
    builder = ModelBuilder()
    metal = rng.choice((palette.metal, BLACK_METAL, BRASS))
    style = rng.choice(("straight", "tripod", "arc"))
    if style == "tripod":
        wood = palette.furniture_wood(rng)
        for k in range(3):
            builder.add(
                wood,
                rod((0.27, 0, 0), (0.02, 0, 1.15), 0.013, end_radius=0.016).turned(120 * k + 90),
            )
        _shade(builder, 0.23, 0.3, 1.15)
        return builder.model("floor lamp", "standing lamp", "lamp", main=wood, attributes=("tall",))
    if style == "straight":
        builder.add(
            metal,
            cylinder(0.15, 0.025, sides=28, bevel=0.008),
            rod((0, 0, 0.02), (0, 0, 1.3), 0.011),
        )
        _shade(builder, 0.2, 0.28, 1.28)
    else:
        builder.add(metal, cylinder(0.16, 0.03, sides=28, bevel=0.008))
        builder.add(
            metal,
            tube(
                [
                    (0, 0, 0.02),
                    (0, 0, 1.3),
                    (0.05, 0, 1.5),
                    (0.17, 0, 1.6),
                    (0.33, 0, 1.56),
                    (0.4, 0, 1.45),
                ],
                0.011,
            ),
        )
        builder.add(
            metal,
            lathe([(0.15, 1.28), (0.13, 1.37), (0.05, 1.44), (0, 1.45)], crease_deg=80).moved(
                0.4, 0, 0
            ),
        )
        builder.add(GLOW, ball(0.1, 0.1, 0.1, at=(0.4, 0, 1.33), sides=12))
    return builder.model("floor lamp", "standing lamp", "lamp", main=metal, attributes=("tall",))


def table_lamp(rng: RandomStream, palette: Palette) -> Model:
    """A lamp with a cloth shade for a nightstand or sideboard."""
    builder = ModelBuilder()
    glaze = rng.choice(
        (
            Finish("", plastic(palette.accent_hue).color, 1.0, palette.accent_hue, "ceramic"),
            WHITE_METAL,
            BRASS,
            palette.furniture_wood(rng),
        )
    )
    body = rng.choice(
        (
            [(0.0, 0.0), (0.06, 0.0), (0.085, 0.07), (0.06, 0.15), (0.02, 0.2), (0.012, 0.24)],
            [(0.0, 0.0), (0.075, 0.0), (0.07, 0.015), (0.015, 0.03), (0.015, 0.24)],
            [(0.0, 0.0), (0.05, 0.0), (0.05, 0.18), (0.015, 0.2), (0.012, 0.24)],
        )
    )
    builder.add(glaze, lathe(body, sides=20))
    _shade(builder, 0.13, 0.17, 0.22, 0.7)
    return builder.model("table lamp", "bedside lamp", "lamp", main=glaze)


def desk_lamp(rng: RandomStream, palette: Palette) -> Model:
    """A jointed lamp that bends over a desk."""
    builder = ModelBuilder()
    paint = rng.choice((BLACK_METAL, WHITE_METAL, plastic(palette.accent_hue), palette.metal))
    builder.add(
        paint,
        cylinder(0.085, 0.02, sides=24, bevel=0.006),
        rod((0, 0, 0.02), (-0.1, 0, 0.24), 0.008),
        rod((-0.1, 0, 0.24), (0.08, 0, 0.43), 0.008),
        ball(0.028, 0.028, 0.028, at=(-0.1, 0, 0.24), sides=8),
    )
    head = lathe([(0.075, -0.1), (0.065, -0.05), (0.03, 0.0), (0.0, 0.01)], sides=20, crease_deg=70)
    builder.add(paint, head.turned(-35, "y").moved(0.09, 0, 0.43))
    builder.add(GLOW, ball(0.05, 0.05, 0.05, at=(0.125, 0, 0.365), sides=10))
    return builder.model("desk lamp", "reading lamp", "lamp", main=paint)


def ceiling_lamp(rng: RandomStream, palette: Palette) -> Model:
    """A flat round lamp, hanging from z = 0."""
    builder = ModelBuilder()
    radius = rng.uniform(0.17, 0.26)
    builder.add(palette.metal, cylinder(radius, 0.03, at=(0, 0, -0.03), sides=28))
    builder.add(
        GLOW,
        lathe(
            [(0.0, -0.11), (radius * 0.6, -0.095), (radius * 0.92, -0.05), (radius * 0.95, -0.03)],
            sides=28,
            crease_deg=80,
        ),
    )
    return builder.model("ceiling lamp", "ceiling light", "lamp", main=palette.metal)


def chandelier(rng: RandomStream, palette: Palette) -> Model:
    """Five or six arms with bulbs, hanging from z = 0."""
    builder = ModelBuilder()
    metal = rng.choice((BRASS, BLACK_METAL, palette.metal))
    arms = rng.choice((5, 6))
    drop = 0.55
    builder.add(
        metal,
        rod((0, 0, -drop), (0, 0, 0), 0.008),
        cylinder(0.06, 0.03, at=(0, 0, -0.03)),
        ball(0.09, 0.09, 0.12, at=(0, 0, -drop)),
    )
    for k in range(arms):
        turn = 360 / arms * k
        arm = tube(
            [
                (0.03, 0, -drop),
                (0.12, 0, -drop - 0.07),
                (0.24, 0, -drop - 0.05),
                (0.28, 0, -drop + 0.02),
            ],
            0.008,
        )
        builder.add(
            metal,
            arm.turned(turn),
            cylinder(0.03, 0.02, at=(0.28, 0, -drop + 0.02), sides=12).turned(turn),
        )
        builder.add(
            GLOW, ball(0.05, 0.05, 0.07, at=(0.28, 0, -drop + 0.075), sides=10).turned(turn)
        )
    return builder.model("chandelier", "ceiling lamp", "lamp", main=metal)


def pendant(rng: RandomStream, palette: Palette) -> Model:
    """A lamp on a cord, hanging from z = 0."""
    builder = ModelBuilder()
    shade = rng.choice((BLACK_METAL, WHITE_METAL, palette.metal, plastic(palette.accent_hue)))
    drop = 0.62
    builder.add(
        BLACK_METAL,
        rod((0, 0, -drop), (0, 0, 0), 0.004, sides=6),
        cylinder(0.05, 0.025, at=(0, 0, -0.025)),
    )
    builder.add(
        shade,
        lathe(
            [
                (0.2, -drop - 0.16),
                (0.19, -drop - 0.12),
                (0.12, -drop - 0.03),
                (0.04, -drop),
                (0.0, -drop),
            ],
            crease_deg=80,
        ),
    )
    builder.add(
        GLOW,
        lathe(
            [(0.0, -drop - 0.15), (0.06, -drop - 0.13), (0.06, -drop - 0.08), (0.0, -drop - 0.04)]
        ),
    )
    return builder.model("ceiling lamp", "pendant lamp", "pendant light", "lamp", main=shade)
