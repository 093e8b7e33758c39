"""Models of tableware, kitchen utensils and small kitchen appliances."""

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CHROME,
    GLASS,
    HUES,
    STEEL,
    WHITE_METAL,
    Palette,
    image_finish,
    plastic,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Mesh, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion
from hypernav.simulator.houses.random_stream import RandomStream


def glazed(hue: str) -> Finish:
    """Finish of coloured ceramic."""
    return Finish("", HUES[hue], 1.0, hue, "ceramic")


def cup(rng: RandomStream, palette: Palette) -> Model:
    """A mug."""
    builder = ModelBuilder()
    glaze = glazed(rng.choice(("white", palette.accent_hue, "blue", "yellow", "red")))
    profile = [
        (0, 0),
        (0.036, 0),
        (0.041, 0.01),
        (0.041, 0.095),
        (0.037, 0.095),
        (0.036, 0.02),
        (0, 0.018),
    ]
    part = lathe(profile, sides=18)
    builder.add(glaze, part)
    part = tube(
        [(0.04, 0, 0.075), (0.068, 0, 0.072), (0.07, 0, 0.035), (0.04, 0, 0.022)], 0.006, sides=6
    )
    builder.add(glaze, part)
    builder.add(plastic("brown"), cylinder(0.036, 0.002, at=(0, 0, 0.08)))
    return builder.model("cup", "mug", "coffee cup", main=glaze)


def bowl(rng: RandomStream, palette: Palette) -> Model:
    """An empty bowl."""
    builder = ModelBuilder()
    glaze = glazed(rng.choice(("white", palette.accent_hue, "teal", "cream")))
    builder.add(glaze, _bowl(0.12, 0.075))
    return builder.model("bowl", main=glaze)


def _bowl(radius: float, high: float) -> Mesh:
    profile = [
        (0, 0),
        (radius * 0.45, 0),
        (radius * 0.5, 0.008),
        (radius * 0.85, high * 0.55),
        (radius, high),
        (radius * 0.96, high),
        (radius * 0.8, high * 0.55),
        (radius * 0.4, 0.016),
        (0, 0.014),
    ]
    return lathe(profile, sides=28, crease_deg=60)


def fruit_bowl(rng: RandomStream, palette: Palette) -> Model:
    """A bowl with oranges, apples and bananas."""
    builder = ModelBuilder()
    glaze = (
        glazed(rng.choice(("white", "teal", palette.accent_hue)))
        if rng.chance(0.6)
        else wood("oak")
    )
    builder.add(glaze, _bowl(0.16, 0.08))
    inks = ((0.95, 0.55, 0.12), (0.78, 0.12, 0.1), (0.5, 0.68, 0.2), (0.95, 0.6, 0.15))
    for k, (x, y, z) in enumerate(
        (
            (0.06, 0.02, 0.075),
            (-0.05, 0.055, 0.075),
            (-0.03, -0.06, 0.075),
            (0.04, -0.06, 0.08),
            (0.0, 0.0, 0.115),
        )
    ):
        builder.add(
            Finish("", inks[(k + rng.integer(0, 3)) % 4]),
            ball(0.078, 0.078, 0.074, at=(x, y, z), sides=14),
        )
    banana = [(-0.09, 0.03, 0.1), (-0.03, 0.06, 0.135), (0.04, 0.06, 0.135), (0.09, 0.03, 0.11)]
    builder.add(Finish("", (0.95, 0.8, 0.2)), tube(banana, [0.008, 0.018, 0.018, 0.007]))
    return builder.model("fruit bowl", "bowl", main=glaze)


def plate(rng: RandomStream, palette: Palette) -> Model:
    """A plate with knife and fork."""
    builder = ModelBuilder()
    glaze = glazed(rng.choice(("white", "white", "light blue", palette.accent_hue)))
    profile = [(0, 0), (0.08, 0), (0.13, 0.018), (0.128, 0.021), (0.085, 0.008), (0, 0.006)]
    part = lathe(profile, sides=28, crease_deg=60)
    builder.add(glaze, part)
    for x in (-0.165, 0.165):
        builder.add(CHROME, box(0.014, 0.19, 0.004, at=(x, 0, 0)))
    return builder.model("plate", "dish", main=glaze)


def bottle(rng: RandomStream, palette: Palette) -> Model:
    """A bottle of wine or water."""
    builder = ModelBuilder()
    glass = Finish(
        "",
        rng.choice(((0.1, 0.22, 0.12), (0.15, 0.05, 0.06), (0.6, 0.75, 0.8), (0.3, 0.2, 0.1))),
        1.0,
        "",
        "glass",
    )
    profile = [(0, 0), (0.037, 0), (0.038, 0.19), (0.014, 0.24), (0.014, 0.31), (0, 0.31)]
    part = lathe(profile, sides=18, crease_deg=50)
    builder.add(glass, part)
    builder.add(
        image_finish(f"label {rng.integer(0, 7)}"),
        lathe([(0.0385, 0.06), (0.0385, 0.15)], sides=18).textured(8.0, 11.0),
    )
    return builder.model("bottle", main=glass)


def pot(rng: RandomStream, palette: Palette) -> Model:
    """A cooking pot with its lid."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, glazed(palette.accent_hue), plastic("red")))
    radius = rng.uniform(0.095, 0.11)
    builder.add(
        body,
        lathe([(0, 0), (radius, 0), (radius, 0.11), (radius * 1.03, 0.115)], sides=24),
        lathe([(radius * 1.03, 0.115), (radius * 0.8, 0.13), (0, 0.14)], sides=24, crease_deg=60),
    )
    builder.add(BLACK_METAL, ball(0.03, 0.03, 0.025, at=(0, 0, 0.15), sides=10))
    for s in (-1.0, 1.0):
        builder.add(
            BLACK_METAL, box(0.03, 0.05, 0.015, at=(s * (radius + 0.012), 0, 0.08), bevel=0.005)
        )
    return builder.model("pot", "cooking pot", "saucepan", main=body)


def knife_block(rng: RandomStream, palette: Palette) -> Model:
    """Knives in a wooden block."""
    builder = ModelBuilder()
    body = wood(palette.wood)
    builder.add(body, box(0.1, 0.14, 0.2, bevel=0.008))
    for k in range(4):
        builder.add(
            plastic("black"),
            box(0.016, 0.024, 0.09, at=(-0.03 + 0.02 * k, 0.01 * (k % 2), 0.2), bevel=0.005),
        )
    return builder.model("knife block", "knives", main=body)


def paper_towels(rng: RandomStream, palette: Palette) -> Model:
    """A roll of kitchen paper on its stand."""
    builder = ModelBuilder()
    builder.add(
        CHROME, cylinder(0.075, 0.012, sides=24), rod((0, 0, 0.01), (0, 0, 0.3), 0.006, sides=6)
    )
    builder.add(
        Finish("terry", (0.97, 0.97, 0.96), 0.2, "white", "paper"),
        cylinder(0.06, 0.24, at=(0, 0, 0.014), sides=24),
    )
    return builder.model("paper towels", "kitchen roll", main=CHROME)


def cutting_board(rng: RandomStream, palette: Palette) -> Model:
    """A board with bread."""
    builder = ModelBuilder()
    board = wood(palette.secondary_wood)
    builder.add(board, box(0.38, 0.24, 0.02, bevel=0.006))
    if rng.chance(0.7):
        builder.add(
            Finish("terry", (0.72, 0.48, 0.25), 0.3),
            ball(0.24, 0.12, 0.11, at=(-0.02, 0, 0.07), sides=14),
        )
    return builder.model("cutting board", "chopping board", main=board)


def microwave(rng: RandomStream, palette: Palette) -> Model:
    """A microwave oven for the worktop."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, WHITE_METAL, BLACK_METAL))
    builder.add(body, box(0.49, 0.36, 0.28, bevel=0.008))
    builder.add(
        Finish("", (0.05, 0.05, 0.06)), box(0.33, 0.006, 0.2, at=(-0.06, 0.18, 0.04), bevel=0.003)
    )
    builder.add(body.tinted(0.7), box(0.1, 0.006, 0.24, at=(0.18, 0.18, 0.02), bevel=0.003))
    builder.add(Finish("", (0.1, 0.35, 0.3)), box(0.075, 0.004, 0.03, at=(0.18, 0.184, 0.205)))
    for row in range(4):
        for column in range(3):
            builder.add(
                plastic("light gray"),
                box(0.016, 0.004, 0.012, at=(0.157 + 0.023 * column, 0.184, 0.06 + 0.03 * row)),
            )
    builder.add(
        CHROME,
        rod((0.118, 0.205, 0.05), (0.118, 0.205, 0.23), 0.008),
        rod((0.118, 0.18, 0.06), (0.118, 0.205, 0.06), 0.005, sides=5),
        rod((0.118, 0.18, 0.22), (0.118, 0.205, 0.22), 0.005, sides=5),
    )
    return builder.model("microwave", "microwave oven", main=body)


def toaster(rng: RandomStream, palette: Palette) -> Model:
    """A toaster for two slices."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, plastic(palette.accent_hue), WHITE_METAL))
    builder.add(body, cushion(0.28, 0.17, 0.18, radius=0.04, at=(0, 0, 0.01)))
    for y in (-0.03, 0.03):
        builder.add(Finish("", (0.06, 0.05, 0.05)), box(0.19, 0.025, 0.004, at=(0, y, 0.189)))
    builder.add(
        BLACK_METAL,
        box(0.26, 0.15, 0.012),
        box(0.02, 0.03, 0.015, at=(0.148, 0, 0.12), bevel=0.004),
    )
    return builder.model("toaster", main=body)


def kettle(rng: RandomStream, palette: Palette) -> Model:
    """An electric kettle."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, plastic(palette.accent_hue), WHITE_METAL))
    builder.add(BLACK_METAL, cylinder(0.08, 0.02, sides=24))
    builder.add(
        body,
        lathe([(0.0, 0.02), (0.078, 0.02), (0.074, 0.12), (0.055, 0.2), (0.0, 0.215)], sides=24),
    )
    builder.add(
        BLACK_METAL,
        ball(0.02, 0.02, 0.02, at=(0, 0, 0.22), sides=8),
        tube([(0, -0.055, 0.19), (0, -0.11, 0.18), (0, -0.115, 0.09), (0, -0.078, 0.05)], 0.01),
    )
    builder.add(body, rod((0, 0.055, 0.15), (0, 0.1, 0.19), 0.02, end_radius=0.01))
    return builder.model("kettle", "electric kettle", main=body)


def coffee_machine(rng: RandomStream, palette: Palette) -> Model:
    """A filter coffee maker with its jug."""
    builder = ModelBuilder()
    body = rng.choice((plastic("black"), STEEL, plastic("red")))
    builder.add(
        body,
        box(0.2, 0.24, 0.04, bevel=0.008),
        box(0.2, 0.09, 0.33, at=(0, -0.075, 0), bevel=0.008),
        cushion(0.2, 0.22, 0.1, radius=0.02, at=(0, 0, 0.24)),
    )
    part = lathe(
        [(0, 0.045), (0.06, 0.045), (0.07, 0.1), (0.05, 0.17), (0.05, 0.19)], sides=20
    ).moved(0, 0.045, 0)
    builder.add(GLASS.tinted(0.4), part)
    builder.add(
        BLACK_METAL,
        tube([(0, 0.1, 0.17), (0, 0.145, 0.16), (0, 0.14, 0.09), (0, 0.11, 0.08)], 0.008),
    )
    return builder.model("coffee machine", "coffee maker", main=body)


def blender(rng: RandomStream, palette: Palette) -> Model:
    """A jug blender."""
    builder = ModelBuilder()
    body = rng.choice((plastic("black"), plastic("red"), STEEL))
    builder.add(body, lathe([(0, 0), (0.085, 0), (0.07, 0.12), (0.055, 0.14), (0, 0.14)], sides=20))
    builder.add(GLASS, lathe([(0.05, 0.14), (0.075, 0.34), (0.073, 0.35)], sides=20))
    builder.add(BLACK_METAL, cylinder(0.075, 0.03, at=(0, 0, 0.345), sides=20, bevel=0.006))
    return builder.model("blender", "mixer", main=body)
