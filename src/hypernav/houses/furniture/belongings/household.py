"""Bins, brushes, bottles and baskets."""

from hypernav.houses.dice import Dice
from hypernav.houses.furniture.kitchen_and_bath.tableware import glazed
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, panel, tile
from hypernav.houses.kit.surfaces import ball, cylinder, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import (
    BLACK_METAL,
    CERAMIC,
    CHROME,
    GLASS,
    HUES,
    STEEL,
    Taste,
    picture,
    plastic,
    wood,
)


def basket(dice: Dice, taste: Taste) -> Model:
    """A wicker basket with a blanket."""
    bench = Bench()
    cane = Finish("wicker", (0.76, 0.6, 0.4), 0.2, "light brown", "wicker")
    radius = dice.uniform(0.18, 0.24)
    bench.add(
        cane,
        lathe(
            [
                (0, 0),
                (radius * 0.85, 0),
                (radius, 0.2),
                (radius * 0.97, 0.34),
                (radius * 0.92, 0.34),
                (radius * 0.9, 0.1),
            ],
            sides=24,
            crease_deg=60,
        ),
    )
    bench.add(
        Finish("terry", HUES[taste.accent], 0.25, taste.accent, "fabric"),
        ball(radius * 1.7, radius * 1.7, 0.2, at=(0, 0, 0.28), sides=14),
    )
    return bench.model("basket", "storage basket", main=cane)


def trash_can(dice: Dice, taste: Taste) -> Model:
    """A waste bin with a lid or a swing top."""
    bench = Bench()
    body = dice.choice((STEEL, plastic("white"), plastic("black"), plastic(taste.accent)))
    high = dice.uniform(0.35, 0.62)
    radius = 0.13 + high * 0.06
    bench.add(body, lathe([(0, 0), (radius * 0.9, 0), (radius, high)], sides=24))
    if dice.chance(0.6):
        bench.add(
            body.tinted(0.8),
            lathe(
                [
                    (radius * 1.03, high - 0.02),
                    (radius * 1.03, high + 0.02),
                    (radius * 0.7, high + 0.06),
                    (0, high + 0.07),
                ],
                sides=24,
                crease_deg=60,
            ),
        )
        bench.add(BLACK_METAL, box(0.1, 0.05, 0.02, at=(0, radius + 0.02, 0.01)))
    else:
        bench.add(
            plastic("white"),
            lathe(
                [
                    (radius * 1.01, high - 0.06),
                    (radius * 1.05, high + 0.006),
                    (radius * 0.9, high - 0.05),
                ],
                sides=20,
            ),
        )
        bench.add(plastic("dark gray"), cylinder(radius * 0.9, 0.01, at=(0, 0, high * 0.7)))
    return bench.model("trash can", "waste bin", "garbage can", main=body)


def soap_dispenser(dice: Dice, taste: Taste) -> Model:
    """A pump bottle."""
    bench = Bench()
    body = glazed(dice.choice(("white", taste.accent, "teal")))
    bench.add(
        body,
        lathe(
            [(0, 0), (0.035, 0), (0.036, 0.11), (0.014, 0.13), (0, 0.13)], sides=18, crease_deg=50
        ),
    )
    bench.add(
        CHROME,
        rod((0, 0, 0.13), (0, 0, 0.165), 0.006, sides=6),
        rod((0, 0, 0.163), (0, 0.045, 0.158), 0.006, sides=6),
    )
    return bench.model("soap dispenser", "soap bottle", main=body)


def toothbrush_cup(dice: Dice, taste: Taste) -> Model:
    """A tumbler with toothbrushes."""
    bench = Bench()
    body = glazed(dice.choice(("white", taste.accent)))
    bench.add(body, lathe([(0, 0), (0.032, 0), (0.038, 0.1), (0.034, 0.1), (0.03, 0.01)], sides=16))
    for k, hue in enumerate(("blue", "red")):
        bench.add(
            plastic(hue),
            rod((0.01 - 0.02 * k, 0, 0.01), (0.025 - 0.05 * k, 0.01, 0.19), 0.005, sides=6),
        )
    return bench.model("toothbrush", "toothbrush cup", main=body)


def detergent(dice: Dice, taste: Taste) -> Model:
    """A bottle of washing liquid."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("blue", "orange", "white", "green", "purple")))
    bench.add(body, cushion(0.17, 0.09, 0.24, radius=0.03))
    bench.add(picture(f"label {dice.integer(0, 7)}"), panel(0.12, 0.13, at=(0, 0.0455, 0.05)))
    bench.add(plastic("white"), cylinder(0.03, 0.05, at=(0.03, 0, 0.235), sides=14))
    return bench.model("detergent", "laundry detergent", main=body)


def toilet_brush(dice: Dice, taste: Taste) -> Model:
    """A brush in its holder."""
    del taste
    bench = Bench()
    body = dice.choice((CERAMIC, STEEL, plastic("white")))
    bench.add(body, lathe([(0, 0), (0.05, 0), (0.055, 0.14), (0.04, 0.15)], sides=18))
    bench.add(
        CHROME,
        rod((0, 0, 0.1), (0, 0, 0.4), 0.007, sides=6),
        ball(0.022, 0.022, 0.03, at=(0, 0, 0.41), sides=8),
    )
    return bench.model("toilet brush", main=body)


def scale(dice: Dice, taste: Taste) -> Model:
    """Bathroom scales."""
    del taste
    bench = Bench()
    body = dice.choice((GLASS, plastic("black"), plastic("white")))
    bench.add(body, cushion(0.3, 0.3, 0.035, radius=0.014))
    bench.add(plastic("dark gray"), tile(0.09, 0.04, at=(0, 0.1, 0.0355)))
    return bench.model("bathroom scale", "scale", main=body)


def bucket(dice: Dice, taste: Taste) -> Model:
    """A bucket with a handle."""
    bench = Bench()
    body = plastic(dice.choice(("blue", "red", "green", taste.accent)))
    bench.add(
        body,
        lathe(
            [(0, 0), (0.11, 0), (0.145, 0.27), (0.152, 0.28), (0.14, 0.27), (0.1, 0.01)], sides=24
        ),
    )
    bench.add(
        CHROME,
        tube(
            [
                (-0.145, 0, 0.26),
                (-0.12, 0.09, 0.34),
                (0, 0.13, 0.37),
                (0.12, 0.09, 0.34),
                (0.145, 0, 0.26),
            ],
            0.004,
            sides=5,
        ),
    )
    return bench.model("bucket", main=body)


def broom(dice: Dice, taste: Taste) -> Model:
    """A broom, upright."""
    bench = Bench()
    bench.add(wood("beech"), rod((0, 0, 0.14), (0, 0, 1.3), 0.012))
    bench.add(
        plastic(dice.choice(("red", "blue", taste.accent))),
        box(0.3, 0.06, 0.05, at=(0, 0, 0.11), bevel=0.01),
    )
    bench.add(Finish("pile", (0.8, 0.7, 0.45), 0.2), box(0.3, 0.07, 0.11))
    return bench.model("broom", main=wood("beech"))
