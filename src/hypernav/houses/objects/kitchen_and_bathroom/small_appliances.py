"""Models of small kitchen appliances."""

from hypernav.houses.materials import (
    BLACK_METAL,
    CHROME,
    GLASS,
    STEEL,
    WHITE_METAL,
    Palette,
    plastic,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.random_stream import RandomStream


def microwave(rng: RandomStream, palette: Palette) -> Model:
    """A microwave oven for the worktop."""
    del palette
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
    del palette
    builder = ModelBuilder()
    body = rng.choice((plastic("black"), STEEL, plastic("red")))
    builder.add(
        body,
        box(0.2, 0.24, 0.04, bevel=0.008),
        box(0.2, 0.09, 0.33, at=(0, -0.075, 0), bevel=0.008),
        cushion(0.2, 0.22, 0.1, radius=0.02, at=(0, 0, 0.24)),
    )
    builder.add(
        GLASS.tinted(0.4),
        lathe([(0, 0.045), (0.06, 0.045), (0.07, 0.1), (0.05, 0.17), (0.05, 0.19)], sides=20).moved(
            0, 0.045, 0
        ),
    )
    builder.add(
        BLACK_METAL,
        tube([(0, 0.1, 0.17), (0, 0.145, 0.16), (0, 0.14, 0.09), (0, 0.11, 0.08)], 0.008),
    )
    return builder.model("coffee machine", "coffee maker", main=body)


def blender(rng: RandomStream, palette: Palette) -> Model:
    """A jug blender."""
    del palette
    builder = ModelBuilder()
    body = rng.choice((plastic("black"), plastic("red"), STEEL))
    builder.add(body, lathe([(0, 0), (0.085, 0), (0.07, 0.12), (0.055, 0.14), (0, 0.14)], sides=20))
    builder.add(GLASS, lathe([(0.05, 0.14), (0.075, 0.34), (0.073, 0.35)], sides=20))
    builder.add(BLACK_METAL, cylinder(0.075, 0.03, at=(0, 0, 0.345), sides=20, bevel=0.006))
    return builder.model("blender", "mixer", main=body)
