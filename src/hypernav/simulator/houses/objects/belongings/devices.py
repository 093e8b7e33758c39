"""Models of screens, computers, lamps and other electrical devices."""

import math

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    BRASS,
    CHROME,
    GLOW,
    SHADE,
    STEEL,
    WHITE_METAL,
    Palette,
    image_finish,
    lacquer,
    plastic,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion, panel, tile
from hypernav.simulator.houses.random_stream import RandomStream

_FRAME = Finish("", (0.045, 0.045, 0.05), 1.0, "black", "plastic")

_LIT = Finish("fabric", (1.0, 0.96, 0.85), 0.3, "cream", "fabric", unlit=True)

_GRILLE = Finish("fabric", (0.14, 0.14, 0.15), 0.2, "black", "fabric")


def _screen(builder: ModelBuilder, wide: float, high: float, z: float, key: str) -> None:
    rim = 0.014
    builder.add(_FRAME, box(wide, 0.035, high, at=(0, -0.0175, z), bevel=0.004))
    builder.add(
        image_finish(key), panel(wide - 2 * rim, high - 2.4 * rim, at=(0, 0.0012, z + 1.4 * rim))
    )


def _programme(rng: RandomStream) -> str:
    return f"screen show {rng.integer(0, 11)}" if rng.chance(0.45) else "screen off"


def tv(rng: RandomStream, palette: Palette) -> Model:
    """A flat television on feet."""
    builder = ModelBuilder()
    wide = rng.choice((0.97, 1.1, 1.1, 1.23, 1.3))
    high = wide * 0.58
    _screen(builder, wide, high, 0.06, _programme(rng))
    builder.add(_FRAME, box(wide * 0.6, 0.05, high * 0.5, at=(0, -0.045, 0.12), bevel=0.02))
    if rng.chance(0.5):
        builder.add(
            BLACK_METAL,
            box(wide * 0.4, 0.22, 0.014, at=(0, -0.02, 0), bevel=0.004),
            box(0.1, 0.03, 0.1, at=(0, -0.03, 0)),
        )
    else:
        for s in (-1.0, 1.0):
            x = s * wide * 0.36
            for y in (0.09, -0.13):
                builder.add(BLACK_METAL, rod((x, y, 0.006), (x, -0.02, 0.07), 0.007, sides=6))
    return builder.model("tv", "television", "flat screen tv", main=_FRAME)


def wall_tv(rng: RandomStream, palette: Palette) -> Model:
    """A flat television on a wall mount; its back is the wall."""
    builder = ModelBuilder()
    wide = rng.choice((1.1, 1.23, 1.36, 1.45))
    high = wide * 0.575
    _screen(builder, wide, high, 0.0, _programme(rng))
    builder.add(BLACK_METAL, box(0.4, 0.04, 0.3, at=(0, -0.05, high / 2 - 0.15)))
    return builder.model("tv", "television", "flat screen tv", "wall tv", main=_FRAME)


def monitor(rng: RandomStream, palette: Palette) -> Model:
    """A computer monitor on its foot."""
    builder = ModelBuilder()
    wide = rng.choice((0.5, 0.56, 0.62))
    key = "screen desktop" if rng.chance(0.6) else "screen off"
    _screen(builder, wide, wide * 0.6, 0.12, key)
    builder.add(
        _FRAME,
        box(0.05, 0.03, 0.2, at=(0, -0.05, 0)),
        box(0.22, 0.18, 0.012, at=(0, -0.02, 0), bevel=0.004),
    )
    return builder.model("computer monitor", "monitor", "computer screen", main=_FRAME)


def laptop(rng: RandomStream, palette: Palette) -> Model:
    """An open laptop; its user sits in front (+y)."""
    builder = ModelBuilder()
    body = STEEL if rng.chance(0.6) else plastic("dark gray")
    builder.add(body, box(0.34, 0.235, 0.016, at=(0, 0, 0), bevel=0.004))
    builder.add(image_finish("keyboard"), tile(0.3, 0.11, at=(0, -0.045, 0.0165)))
    builder.add(body.tinted(0.8), tile(0.1, 0.065, at=(0, 0.07, 0.0165)))
    lid = ModelBuilder()
    lid.add(body, box(0.34, 0.008, 0.225, bevel=0.003))
    lid.add(image_finish("screen desktop"), panel(0.325, 0.205, at=(0, 0.0045, 0.012)))
    for part in lid.parts:
        builder.add(part.finish, part.mesh.turned(16, "x").moved(0, -0.115, 0.012))
    return builder.model("laptop", "laptop computer", "notebook computer", main=body)


def keyboard(rng: RandomStream, palette: Palette) -> Model:
    """A computer keyboard."""
    builder = ModelBuilder()
    body = plastic("black") if rng.chance(0.6) else plastic("white")
    builder.add(body, box(0.44, 0.145, 0.02, bevel=0.005))
    builder.add(image_finish("keyboard"), tile(0.42, 0.125, at=(0, 0, 0.0205)).turned(180))
    return builder.model("keyboard", "computer keyboard", main=body)


def _shade(builder: ModelBuilder, radius: float, high: float, z: float, slope: float = 0.8) -> None:
    """A cloth shade, glowing, open below and above."""
    wall = [(radius, z), (radius * slope, z + high)]
    builder.add(_LIT, lathe(wall, sides=24))
    builder.add(
        SHADE, lathe([(radius * 0.99, z), (radius * slope * 0.99, z + high)][::-1], sides=24)
    )
    builder.add(GLOW, ball(0.07, 0.07, 0.09, at=(0, 0, z + high * 0.5), sides=10))
    part = rod(
        (-radius * slope, 0, z + high - 0.01), (radius * slope, 0, z + high - 0.01), 0.003, sides=5
    )
    builder.add(BLACK_METAL, part)


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
        part = tube(
            [
                (0, 0, 0.02),
                (0, 0, 1.3),
                (0.05, 0, 1.5),
                (0.17, 0, 1.6),
                (0.33, 0, 1.56),
                (0.4, 0, 1.45),
            ],
            0.011,
        )
        builder.add(metal, part)
        part = lathe([(0.15, 1.28), (0.13, 1.37), (0.05, 1.44), (0, 1.45)], crease_deg=80).moved(
            0.4, 0, 0
        )
        builder.add(metal, part)
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
    profile = [(0.0, -0.11), (radius * 0.6, -0.095), (radius * 0.92, -0.05), (radius * 0.95, -0.03)]
    part = lathe(profile, sides=28, crease_deg=80)
    builder.add(GLOW, part)
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
    profile = [
        (0.2, -drop - 0.16),
        (0.19, -drop - 0.12),
        (0.12, -drop - 0.03),
        (0.04, -drop),
        (0.0, -drop),
    ]
    part = lathe(profile, crease_deg=80)
    builder.add(shade, part)
    part = lathe(
        [(0.0, -drop - 0.15), (0.06, -drop - 0.13), (0.06, -drop - 0.08), (0.0, -drop - 0.04)]
    )
    builder.add(GLOW, part)
    return builder.model("ceiling lamp", "pendant lamp", "pendant light", "lamp", main=shade)


def fan(rng: RandomStream, palette: Palette) -> Model:
    """A standing fan."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "black")))
    z = rng.uniform(1.0, 1.15)
    builder.add(
        body, cylinder(0.19, 0.03, sides=28, bevel=0.01), rod((0, 0, 0.02), (0, 0, z), 0.014)
    )
    builder.add(body, cylinder(0.06, 0.13).turned(90, "x").moved(0, 0.02, z))
    for k in range(3):
        blade = (
            cushion(0.1, 0.16, 0.01, radius=0.004, at=(0, 0.11, 0)).turned(20, "y").turned(90, "x")
        )
        builder.add(body, blade.turned(120 * k, "y").moved(0, 0.06, z))
    for r in (0.21, 0.14, 0.07):
        ring = [
            (r * math.cos(a), 0.09 + 0.02 * (1 - r / 0.21), z + r * math.sin(a)) for a in _turn(24)
        ]
        builder.add(CHROME, tube(ring, 0.004 if r > 0.2 else 0.0025, sides=5, closed=True))
    for a in _turn(16):
        builder.add(
            CHROME,
            rod((0, 0.11, z), (0.21 * math.cos(a), 0.09, z + 0.21 * math.sin(a)), 0.0018, sides=4),
        )
    return builder.model("fan", "standing fan", "electric fan", main=body)


def _turn(count: int) -> list[float]:
    return [2.0 * math.pi * k / count for k in range(count)]


def speaker(rng: RandomStream, palette: Palette) -> Model:
    """A tall loudspeaker."""
    body = palette.furniture_wood(rng) if rng.chance(0.4) else plastic("black")
    return _speaker(body, 0.22, 0.28, rng.uniform(0.85, 1.0))


def speaker_small(rng: RandomStream, palette: Palette) -> Model:
    """A loudspeaker for a shelf."""
    return _speaker(plastic(rng.choice(("black", "white"))), 0.15, 0.17, 0.24)


def _speaker(body: Finish, wide: float, deep: float, high: float) -> Model:
    builder = ModelBuilder()
    builder.add(body, box(wide, deep, high, bevel=0.006).swapped_uv())
    builder.add(_GRILLE, panel(wide * 0.86, high * 0.94, at=(0, deep / 2 + 0.001, high * 0.03)))
    for z, r in ((0.3, 0.36), (0.62, 0.3), (0.84, 0.16)):
        cone = cylinder(wide * r, 0.006, sides=20, top_radius=wide * r * 0.8).turned(-90, "x")
        builder.add(plastic("dark gray"), cone.moved(0, deep / 2 + 0.001, high * z))
    return builder.model("speaker", "loudspeaker", main=body)


def game_console(rng: RandomStream, palette: Palette) -> Model:
    """A game console: a flat black or white box."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "white")))
    builder.add(body, box(0.3, 0.22, 0.06, bevel=0.01))
    builder.add(plastic("blue"), box(0.08, 0.004, 0.006, at=(0.08, 0.11, 0.028)))
    return builder.model("game console", "video game console", main=body)


def phone(rng: RandomStream, palette: Palette) -> Model:
    """A smartphone, lying."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "white", "blue")))
    builder.add(body, box(0.075, 0.155, 0.009, bevel=0.004))
    builder.add(Finish("", (0.05, 0.05, 0.07)), tile(0.067, 0.14, at=(0, 0, 0.0095)))
    return builder.model("cell phone", "mobile phone", "smartphone", main=body)


def printer(rng: RandomStream, palette: Palette) -> Model:
    """A desk printer with paper."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "light gray", "dark gray")))
    builder.add(
        body,
        cushion(0.4, 0.36, 0.18, radius=0.025),
        box(0.36, 0.3, 0.02, at=(0, -0.01, 0.18), bevel=0.006),
    )
    builder.add(
        plastic("black"),
        box(0.34, 0.02, 0.05, at=(0, 0.172, 0.05)),
        box(0.12, 0.004, 0.03, at=(-0.1, 0.18, 0.14)),
    )
    builder.add(plastic("gray"), box(0.3, 0.13, 0.008, at=(0, 0.235, 0.045)))
    builder.add(
        plastic("white"),
        box(0.21, 0.12, 0.006, at=(0, 0.235, 0.053)),
        box(0.21, 0.012, 0.16, at=(0, -0.17, 0.17)),
    )
    return builder.model("printer", "inkjet printer", main=body)


def vacuum_cleaner(rng: RandomStream, palette: Palette) -> Model:
    """A canister vacuum cleaner with its hose upright."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("red", "blue", palette.accent_hue, "dark gray")))
    builder.add(body, cushion(0.28, 0.42, 0.22, radius=0.09, rounds=3, at=(0, 0, 0.05)))
    builder.add(
        plastic("black"),
        *[
            cylinder(0.09, 0.04).turned(90, "y").moved(s * 0.14 - 0.02, -0.1, 0.09)
            for s in (-1.0, 1.0)
        ],
    )
    builder.add(
        plastic("dark gray"),
        tube([(0, 0.18, 0.2), (0, 0.3, 0.4), (0.1, 0.3, 0.75), (0.16, 0.18, 0.95)], 0.02),
    )
    builder.add(CHROME, rod((0.16, 0.18, 0.95), (0.2, 0.3, 0.06), 0.014))
    builder.add(plastic("black"), box(0.26, 0.1, 0.05, at=(0.2, 0.32, 0), bevel=0.01))
    return builder.model("vacuum cleaner", "hoover", main=body)


def air_purifier(rng: RandomStream, palette: Palette) -> Model:
    """A white tower with slots."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "light gray")))
    builder.add(body, cushion(0.3, 0.22, 0.55, radius=0.05))
    for k in range(12):
        builder.add(plastic("gray"), box(0.2, 0.006, 0.008, at=(0, 0.109, 0.08 + 0.022 * k)))
    builder.add(lacquer("black"), box(0.1, 0.004, 0.03, at=(0, 0.109, 0.44)))
    return builder.model("air purifier", "air cleaner", main=body)


def hair_dryer(rng: RandomStream, palette: Palette) -> Model:
    """A hair dryer, lying."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "pink", "white", palette.accent_hue)))
    builder.add(
        body,
        cylinder(0.04, 0.18, sides=16, top_radius=0.03).turned(90, "y").moved(-0.09, 0, 0.04),
        rod((-0.04, 0, 0.03), (-0.06, 0.13, 0.02), 0.02),
    )
    return builder.model("hair dryer", "hair drier", "blow dryer", main=body)


def radio(rng: RandomStream, palette: Palette) -> Model:
    """A small radio with a handle."""
    builder = ModelBuilder()
    body = palette.furniture_wood(rng) if rng.chance(0.5) else plastic(palette.accent_hue)
    builder.add(body, box(0.26, 0.1, 0.16, bevel=0.012))
    builder.add(_GRILLE, panel(0.14, 0.11, at=(-0.045, 0.051, 0.025)))
    builder.add(
        CHROME,
        cylinder(0.02, 0.015, sides=14).turned(-90, "x").moved(0.085, 0.05, 0.06),
        rod((0.1, -0.03, 0.16), (0.14, -0.03, 0.33), 0.003, sides=5),
    )
    builder.add(image_finish("label 2"), panel(0.06, 0.03, at=(0.085, 0.051, 0.1)))
    return builder.model("radio", main=body)
