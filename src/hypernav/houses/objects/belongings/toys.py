"""Models of toys and games."""

from hypernav.houses.materials import GLASS, RUBBER, Palette, lacquer, plastic, wood
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, tile
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.random_stream import RandomStream


def teddy_bear(rng: RandomStream, palette: Palette) -> Model:
    """A stuffed bear, sitting."""
    del palette
    builder = ModelBuilder()
    fur = Finish(
        "pile",
        rng.choice(((0.62, 0.42, 0.24), (0.85, 0.7, 0.5), (0.5, 0.36, 0.25))),
        0.25,
        "brown",
        "plush",
    )
    builder.add(
        fur, ball(0.26, 0.22, 0.28, at=(0, 0, 0.14)), ball(0.21, 0.19, 0.19, at=(0, 0.01, 0.33))
    )
    builder.add(
        fur.tinted(1.3),
        ball(0.1, 0.07, 0.08, at=(0, 0.1, 0.31)),
        ball(0.16, 0.06, 0.18, at=(0, 0.09, 0.14)),
    )
    for s in (-1.0, 1.0):
        builder.add(
            fur,
            ball(0.08, 0.05, 0.08, at=(s * 0.085, 0, 0.42)),
            ball(0.09, 0.2, 0.1, at=(s * 0.1, 0.14, 0.06)),
            ball(0.08, 0.14, 0.18, at=(s * 0.15, 0.05, 0.19)),
        )
        builder.add(
            plastic("black"), ball(0.022, 0.014, 0.022, at=(s * 0.04, 0.098, 0.365), sides=8)
        )
    builder.add(plastic("black"), ball(0.03, 0.02, 0.02, at=(0, 0.136, 0.325), sides=8))
    return builder.model("toy", "teddy bear", "stuffed animal", main=fur)


def toy_car(rng: RandomStream, palette: Palette) -> Model:
    """A toy car."""
    builder = ModelBuilder()
    paint = plastic(rng.choice(("red", "blue", "yellow", palette.accent_hue)))
    builder.add(
        paint,
        cushion(0.26, 0.12, 0.06, radius=0.02, at=(0, 0, 0.025)),
        cushion(0.14, 0.11, 0.06, radius=0.02, at=(-0.01, 0, 0.075)),
    )
    builder.add(GLASS.tinted(0.5), box(0.142, 0.09, 0.03, at=(-0.01, 0, 0.092)))
    for x in (-0.08, 0.08):
        builder.add(RUBBER, cylinder(0.03, 0.125, sides=14).turned(90, "x").moved(x, 0.0625, 0.03))
    return builder.model("toy", "toy car", main=paint)


def toy_blocks(rng: RandomStream, palette: Palette) -> Model:
    """A tower of building blocks."""
    del palette
    builder = ModelBuilder()
    hues = rng.shuffled(("red", "blue", "yellow", "green", "orange", "purple"))
    for k, (x, z) in enumerate(
        ((-0.07, 0), (0.0, 0), (0.07, 0), (-0.035, 0.06), (0.035, 0.06), (0, 0.12))
    ):
        builder.add(plastic(hues[k]), box(0.06, 0.06, 0.06, at=(x, 0, z), bevel=0.005).turned(0))
    return builder.model("toy", "toy blocks", "building blocks", attributes=("colorful",))


def toy_box(rng: RandomStream, palette: Palette) -> Model:
    """An open chest with toys."""
    builder = ModelBuilder()
    body = lacquer(rng.choice(("white", palette.accent_hue, "light blue", "yellow")))
    for s in (-1.0, 1.0):
        builder.add(
            body,
            box(0.02, 0.4, 0.38, at=(s * 0.34, 0, 0)),
            box(0.7, 0.02, 0.38, at=(0, s * 0.19, 0)),
        )
    builder.add(body, box(0.68, 0.38, 0.02))
    for k in range(9):
        hue = rng.choice(("red", "blue", "yellow", "green", "orange", "pink"))
        x, y = (k % 3 - 1) * 0.2, (k // 3 - 1) * 0.11
        toy = (
            ball(0.16, 0.14, 0.14, at=(x, y, 0.34), sides=12)
            if rng.chance(0.5)
            else box(0.15, 0.11, 0.16, at=(x, y, 0.26), bevel=0.01)
        )
        builder.add(plastic(hue), toy)
    return builder.model("toy box", "toy chest", main=body)


def dollhouse(rng: RandomStream, palette: Palette) -> Model:
    """A doll's house with a pitched roof."""
    builder = ModelBuilder()
    wall, roof = (
        lacquer(rng.choice(("pink", "white", "light blue"))),
        lacquer(rng.choice(("red", "brown", palette.accent_hue))),
    )
    builder.add(wall, box(0.6, 0.02, 0.6, at=(0, -0.14, 0)))
    for x in (-0.29, 0.0, 0.29):
        builder.add(wall, box(0.02, 0.3, 0.6, at=(x, 0, 0)))
    for z in (0, 0.3, 0.58):
        builder.add(wall, box(0.6, 0.3, 0.02, at=(0, 0, z)))
    slope = box(0.44, 0.34, 0.02)
    for s in (-1.0, 1.0):
        builder.add(roof, slope.moved(s * -0.22, 0, 0).turned(-s * 38, "y").moved(0, 0, 0.86))
    for k in range(4):
        builder.add(
            plastic(rng.choice(("red", "yellow", "blue", "green"))),
            box(0.1, 0.1, 0.09, at=((k % 2 - 0.5) * 0.28, 0.02, 0.02 + 0.3 * (k // 2)), bevel=0.01),
        )
    return builder.model("toy", "dollhouse", "doll house", main=wall)


def chess(rng: RandomStream, palette: Palette) -> Model:
    """A chess board with pieces."""
    del palette
    builder = ModelBuilder()
    builder.add(wood("walnut"), box(0.4, 0.4, 0.02, bevel=0.004))
    light = [
        tile(0.044, 0.044, at=((i - 3.5) * 0.045, (j - 3.5) * 0.045, 0.0205))
        for i in range(8)
        for j in range(8)
        if (i + j) % 2
    ]
    builder.add(lacquer("cream"), *light)
    piece = lathe([(0, 0), (0.014, 0), (0.007, 0.02), (0.009, 0.035), (0, 0.045)], sides=8)
    for hue, rows in (("white", (0, 1)), ("black", (6, 7))):
        men = [
            piece.moved((i - 3.5) * 0.045, (j - 3.5) * 0.045, 0.021)
            for i in range(8)
            for j in rows
            if rng.chance(0.9)
        ]
        builder.add(plastic(hue), *men)
    return builder.model("chess set", "chess board", "board game", main=wood("walnut"))
