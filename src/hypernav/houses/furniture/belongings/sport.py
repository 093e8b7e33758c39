"""Bicycles, machines and balls."""

import math

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, panel
from hypernav.houses.kit.surfaces import ball, cylinder
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import (
    BLACK_METAL,
    CHROME,
    HUES,
    RUBBER,
    STEEL,
    Taste,
    picture,
    plastic,
)


def bicycle(dice: Dice, taste: Taste) -> Model:
    """A bicycle on its stand, standing along x."""
    bench = Bench()
    paint = Finish(
        "",
        HUES[dice.choice(("red", "blue", "black", "teal", "green", taste.accent))],
        1.0,
        "",
        "metal",
    )
    radius, base = 0.33, 0.52
    for x in (-base, base):
        ring = [
            (x + radius * math.cos(a), 0, radius + 0.012 + radius * math.sin(a))
            for a in (2 * math.pi * k / 28 for k in range(28))
        ]
        bench.add(RUBBER, tube(ring, 0.016, sides=7, closed=True))
        bench.add(
            CHROME,
            *[
                rod(
                    (x, 0, radius + 0.012),
                    (x + 0.31 * math.cos(a), 0, radius + 0.012 + 0.31 * math.sin(a)),
                    0.0018,
                    sides=4,
                )
                for a in (2 * math.pi * k / 14 for k in range(14))
            ],
            cylinder(0.022, 0.08).turned(90, "x").moved(x, 0.04, radius + 0.012),
        )
    rear, front = (-base, 0, 0.342), (base, 0, 0.342)
    crank, seat, head = (-0.06, 0, 0.31), (-0.2, 0, 0.78), (0.36, 0, 0.8)
    for a, b, r in (
        (crank, seat, 0.017),
        (crank, head, 0.019),
        (seat, head, 0.017),
        (rear, crank, 0.011),
        (rear, seat, 0.01),
        (head, (0.33, 0, 0.9), 0.017),
    ):
        bench.add(paint, rod(a, b, r))
    for y in (-0.045, 0.045):
        bench.add(
            paint, tube([(0.37, y * 0.4, 0.76), (0.4, y, 0.68), (front[0], y, front[2])], 0.011)
        )
    bench.add(
        CHROME,
        rod(seat, (-0.235, 0, 0.9), 0.013),
        rod((0.33, 0, 0.9), (0.31, 0, 1.0), 0.014),
        rod((-0.06, -0.08, 0.31), (-0.06, 0.08, 0.31), 0.012),
    )
    bench.add(
        BLACK_METAL,
        cushion(0.27, 0.15, 0.06, radius=0.028, at=(-0.25, 0, 0.9)),
        cylinder(0.09, 0.006, sides=24).turned(90, "x").moved(-0.06, 0.05, 0.31),
    )
    bench.add(
        BLACK_METAL,
        tube(
            [(0.22, -0.28, 1.0), (0.32, -0.12, 1.02), (0.32, 0.12, 1.02), (0.22, 0.28, 1.0)], 0.013
        ),
    )
    for s in (-1.0, 1.0):
        bench.add(
            CHROME,
            rod((-0.06, s * 0.09, 0.31), (-0.06 + s * 0.12, s * 0.09, 0.31 - s * 0.1), 0.009),
        )
        bench.add(
            BLACK_METAL, box(0.09, 0.07, 0.02, at=(-0.06 + s * 0.13, s * 0.12, 0.3 - s * 0.1))
        )
    bench.add(BLACK_METAL, rod((-0.2, -0.02, 0.3), (-0.18, -0.17, 0.0), 0.008))
    return bench.model("bicycle", "bike", main=paint)


def treadmill(dice: Dice, taste: Taste) -> Model:
    """A running machine; its user faces -y."""
    del dice, taste
    bench = Bench()
    bench.add(plastic("dark gray"), box(0.74, 1.5, 0.14, bevel=0.02))
    bench.add(RUBBER, box(0.48, 1.36, 0.012, at=(0, 0.06, 0.14)))
    for s in (-1.0, 1.0):
        bench.add(STEEL, box(0.07, 1.4, 0.03, at=(s * 0.31, 0.04, 0.14), bevel=0.008))
        bench.add(
            BLACK_METAL,
            tube([(s * 0.34, -0.6, 0.1), (s * 0.33, -0.62, 1.1), (s * 0.33, -0.55, 1.2)], 0.03),
            tube([(s * 0.33, -0.58, 1.0), (s * 0.33, -0.1, 0.95)], 0.022),
        )
    bench.add(
        BLACK_METAL, cushion(0.72, 0.12, 0.32, radius=0.04).turned(20, "x").moved(0, -0.6, 1.08)
    )
    bench.add(
        picture("screen desktop", unlit=True),
        panel(0.34, 0.16, at=(0, 0.061, 0.1)).turned(20, "x").moved(0, -0.6, 1.08),
    )
    return bench.model(
        "exercise equipment", "treadmill", "running machine", main=plastic("dark gray")
    )


def exercise_bike(dice: Dice, taste: Taste) -> Model:
    """A stationary bicycle."""
    bench = Bench()
    paint = Finish("", HUES[dice.choice(("red", "black", "white", taste.accent))], 1.0, "", "metal")
    for y in (-0.42, 0.42):
        bench.add(BLACK_METAL, rod((-0.25, y, 0.03), (0.25, y, 0.03), 0.03))
    bench.add(
        paint,
        rod((0, -0.42, 0.05), (0, 0.42, 0.05), 0.03),
        rod((0, 0.1, 0.05), (0, 0.3, 0.85), 0.035),
        rod((0, -0.3, 0.06), (0, -0.42, 0.95), 0.03),
    )
    bench.add(STEEL, cylinder(0.23, 0.05, sides=32).turned(90, "y").moved(-0.025, -0.25, 0.36))
    bench.add(
        BLACK_METAL,
        cushion(0.24, 0.27, 0.08, radius=0.035, at=(0, 0.3, 0.85)),
        tube(
            [(-0.22, -0.25, 1.12), (-0.2, -0.42, 1.05), (0.2, -0.42, 1.05), (0.22, -0.25, 1.12)],
            0.016,
        ),
        box(0.16, 0.03, 0.11, at=(0, -0.47, 1.06)),
    )
    for s in (-1.0, 1.0):
        bench.add(
            BLACK_METAL,
            box(0.1, 0.09, 0.025, at=(s * 0.16, -0.02 + s * 0.1, 0.3 - s * 0.08)),
            rod((s * 0.05, -0.02, 0.3), (s * 0.14, -0.02 + s * 0.1, 0.31 - s * 0.08), 0.012),
        )
    return bench.model("exercise equipment", "exercise bike", "stationary bike", main=paint)


def dumbbells(dice: Dice, taste: Taste) -> Model:
    """A pair of dumbbells."""
    bench = Bench()
    ink = plastic(dice.choice(("black", "blue", taste.accent)))
    for y in (-0.09, 0.09):
        bench.add(CHROME, rod((-0.1, y, 0.06), (0.1, y, 0.06), 0.014))
        for s in (-1.0, 1.0):
            bench.add(
                ink,
                cylinder(0.06, 0.07, sides=8, bevel=0.008)
                .turned(90, "y")
                .moved(s * 0.11 - 0.035, y, 0.06),
            )
    return bench.model("dumbbell", "dumbbells", "weights", main=ink)


def exercise_ball(dice: Dice, taste: Taste) -> Model:
    """A large gymnastics ball."""
    bench = Bench()
    ink = plastic(dice.choice(("blue", "pink", "gray", taste.accent)))
    bench.add(ink, ball(0.6, 0.6, 0.58, at=(0, 0, 0.29), sides=28))
    return bench.model("exercise ball", "gym ball", "ball", main=ink)


def football(dice: Dice, taste: Taste) -> Model:
    """A ball to play with."""
    del taste
    bench = Bench()
    ink = dice.choice(
        (Finish("", (0.85, 0.45, 0.15), 1.0, "orange", "rubber"), plastic("white"), plastic("red"))
    )
    bench.add(ink, ball(0.23, 0.23, 0.23, at=(0, 0, 0.115), sides=20))
    return bench.model(
        "ball", "basketball" if ink.hue == "orange" else "football", "sports ball", main=ink
    )


def skateboard(dice: Dice, taste: Taste) -> Model:
    """A skateboard."""
    bench = Bench()
    bench.add(
        plastic(dice.choice(("red", "black", taste.accent))),
        cushion(0.78, 0.2, 0.02, radius=0.009, at=(0, 0, 0.09)),
    )
    for x in (-0.24, 0.24):
        bench.add(STEEL, box(0.05, 0.14, 0.03, at=(x, 0, 0.06)))
        for y in (-0.08, 0.08):
            bench.add(
                plastic("white"),
                cylinder(0.027, 0.035, sides=14).turned(90, "x").moved(x, y + 0.0175, 0.03),
            )
    return bench.model("skateboard", main=plastic("red"))
