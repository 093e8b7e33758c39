"""Small kitchen appliances."""

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion
from hypernav.houses.kit.surfaces import ball, cylinder, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import BLACK_METAL, CHROME, GLASS, STEEL, WHITE_METAL, Taste, plastic


def microwave(dice: Dice, taste: Taste) -> Model:
    """A microwave oven for the worktop."""
    del taste
    bench = Bench()
    body = dice.choice((STEEL, WHITE_METAL, BLACK_METAL))
    bench.add(body, box(0.49, 0.36, 0.28, bevel=0.008))
    bench.add(
        Finish("", (0.05, 0.05, 0.06)), box(0.33, 0.006, 0.2, at=(-0.06, 0.18, 0.04), bevel=0.003)
    )
    bench.add(body.tinted(0.7), box(0.1, 0.006, 0.24, at=(0.18, 0.18, 0.02), bevel=0.003))
    bench.add(Finish("", (0.1, 0.35, 0.3)), box(0.075, 0.004, 0.03, at=(0.18, 0.184, 0.205)))
    for row in range(4):
        for column in range(3):
            bench.add(
                plastic("light gray"),
                box(0.016, 0.004, 0.012, at=(0.157 + 0.023 * column, 0.184, 0.06 + 0.03 * row)),
            )
    bench.add(
        CHROME,
        rod((0.118, 0.205, 0.05), (0.118, 0.205, 0.23), 0.008),
        rod((0.118, 0.18, 0.06), (0.118, 0.205, 0.06), 0.005, sides=5),
        rod((0.118, 0.18, 0.22), (0.118, 0.205, 0.22), 0.005, sides=5),
    )
    return bench.model("microwave", "microwave oven", main=body)


def toaster(dice: Dice, taste: Taste) -> Model:
    """A toaster for two slices."""
    bench = Bench()
    body = dice.choice((STEEL, plastic(taste.accent), WHITE_METAL))
    bench.add(body, cushion(0.28, 0.17, 0.18, radius=0.04, at=(0, 0, 0.01)))
    for y in (-0.03, 0.03):
        bench.add(Finish("", (0.06, 0.05, 0.05)), box(0.19, 0.025, 0.004, at=(0, y, 0.189)))
    bench.add(
        BLACK_METAL,
        box(0.26, 0.15, 0.012),
        box(0.02, 0.03, 0.015, at=(0.148, 0, 0.12), bevel=0.004),
    )
    return bench.model("toaster", main=body)


def kettle(dice: Dice, taste: Taste) -> Model:
    """An electric kettle."""
    bench = Bench()
    body = dice.choice((STEEL, plastic(taste.accent), WHITE_METAL))
    bench.add(BLACK_METAL, cylinder(0.08, 0.02, sides=24))
    bench.add(
        body,
        lathe([(0.0, 0.02), (0.078, 0.02), (0.074, 0.12), (0.055, 0.2), (0.0, 0.215)], sides=24),
    )
    bench.add(
        BLACK_METAL,
        ball(0.02, 0.02, 0.02, at=(0, 0, 0.22), sides=8),
        tube([(0, -0.055, 0.19), (0, -0.11, 0.18), (0, -0.115, 0.09), (0, -0.078, 0.05)], 0.01),
    )
    bench.add(body, rod((0, 0.055, 0.15), (0, 0.1, 0.19), 0.02, end_radius=0.01))
    return bench.model("kettle", "electric kettle", main=body)


def coffee_machine(dice: Dice, taste: Taste) -> Model:
    """A filter coffee maker with its jug."""
    del taste
    bench = Bench()
    body = dice.choice((plastic("black"), STEEL, plastic("red")))
    bench.add(
        body,
        box(0.2, 0.24, 0.04, bevel=0.008),
        box(0.2, 0.09, 0.33, at=(0, -0.075, 0), bevel=0.008),
        cushion(0.2, 0.22, 0.1, radius=0.02, at=(0, 0, 0.24)),
    )
    bench.add(
        GLASS.tinted(0.4),
        lathe([(0, 0.045), (0.06, 0.045), (0.07, 0.1), (0.05, 0.17), (0.05, 0.19)], sides=20).moved(
            0, 0.045, 0
        ),
    )
    bench.add(
        BLACK_METAL,
        tube([(0, 0.1, 0.17), (0, 0.145, 0.16), (0, 0.14, 0.09), (0, 0.11, 0.08)], 0.008),
    )
    return bench.model("coffee machine", "coffee maker", main=body)


def blender(dice: Dice, taste: Taste) -> Model:
    """A jug blender."""
    del taste
    bench = Bench()
    body = dice.choice((plastic("black"), plastic("red"), STEEL))
    bench.add(body, lathe([(0, 0), (0.085, 0), (0.07, 0.12), (0.055, 0.14), (0, 0.14)], sides=20))
    bench.add(GLASS, lathe([(0.05, 0.14), (0.075, 0.34), (0.073, 0.35)], sides=20))
    bench.add(BLACK_METAL, cylinder(0.075, 0.03, at=(0, 0, 0.345), sides=20, bevel=0.006))
    return bench.model("blender", "mixer", main=body)
