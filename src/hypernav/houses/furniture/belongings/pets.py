"""What belongs to pets."""

import math

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish, join
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, prism
from hypernav.houses.kit.surfaces import ball, cylinder
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import (
    BLACK_METAL,
    BRASS,
    HUES,
    WHITE_METAL,
    Taste,
    fabric,
    plastic,
    wood,
)


def fish_tank(dice: Dice, taste: Taste) -> Model:
    """An aquarium on its cabinet."""
    bench = Bench()
    body = taste.furniture_wood(dice)
    bench.add(
        body, box(0.82, 0.38, 0.7, bevel=0.004), box(0.82, 0.38, 0.05, at=(0, 0, 1.12), bevel=0.004)
    )
    bench.add(Finish("", (0.35, 0.6, 0.72), 1.0, "", "glass"), box(0.8, 0.36, 0.42, at=(0, 0, 0.7)))
    bench.add(Finish("", (0.78, 0.68, 0.45)), box(0.802, 0.362, 0.06, at=(0, 0, 0.7)))
    for k in range(6):
        x, z = dice.uniform(-0.32, 0.32), dice.uniform(0.84, 1.05)
        fish = join(
            [
                ball(0.09, 0.012, 0.05, sides=10),
                prism(
                    [(0.035, -0.004), (0.07, -0.004), (0.07, 0.004), (0.035, 0.004)], 0.04, z=-0.02
                ),
            ]
        )
        bench.add(
            Finish("", dice.choice(((0.95, 0.5, 0.1), (0.95, 0.85, 0.2), (0.9, 0.2, 0.2)))),
            fish.moved(x, 0.185, z),
        )
        bench.add(
            Finish("", (0.2, 0.5, 0.25)), box(0.02, 0.006, 0.16, at=(-0.34 + 0.13 * k, 0.183, 0.76))
        )
    return bench.model("fish tank", "aquarium", main=body)


def cat_tree(dice: Dice, taste: Taste) -> Model:
    """Posts with platforms for a cat."""
    del taste
    bench = Bench()
    plush = Finish(
        "pile", dice.choice(((0.75, 0.68, 0.58), (0.5, 0.5, 0.52))), 0.3, "beige", "fabric"
    )
    sisal = Finish("wicker", (0.78, 0.66, 0.46), 0.1)
    bench.add(
        plush,
        box(0.5, 0.45, 0.05, bevel=0.01),
        box(0.32, 0.3, 0.3, at=(-0.06, -0.05, 0.05), bevel=0.02),
        box(0.36, 0.3, 0.03, at=(0.08, 0, 0.75), bevel=0.01),
        box(0.32, 0.3, 0.08, at=(-0.08, -0.03, 1.2), bevel=0.02),
    )
    bench.add(
        Finish("", (0.08, 0.07, 0.06)),
        cylinder(0.09, 0.004, sides=20).turned(-90, "x").moved(-0.06, 0.1, 0.19),
    )
    bench.add(
        sisal,
        cylinder(0.045, 0.7, at=(0.16, 0.1, 0.05)),
        cylinder(0.045, 0.42, at=(-0.06, -0.02, 0.78)),
        cylinder(0.045, 0.42, at=(-0.06, -0.05, 0.34)),
    )
    return bench.model("cat tree", "scratching post", main=plush)


def pet_bed(dice: Dice, taste: Taste) -> Model:
    """A round basket for a dog or cat."""
    bench = Bench()
    cloth = fabric(dice.choice((taste.soft, "gray", "brown")), "coarse fabric", 0.3)
    ring = [
        (0.27 * math.cos(2 * math.pi * k / 20), 0.22 * math.sin(2 * math.pi * k / 20), 0.08)
        for k in range(20)
    ]
    bench.add(cloth, tube(ring, 0.075, sides=10, closed=True))
    bench.add(
        Finish("terry", HUES["cream"], 0.25),
        cylinder(0.24, 0.07, sides=24, bevel=0.02).scaled(1, 0.82, 1),
    )
    return bench.model("pet basket", "dog basket", "cat basket", main=cloth)


def bird_cage(dice: Dice, taste: Taste) -> Model:
    """A cage on a stand."""
    bench = Bench()
    metal = dice.choice((BRASS, WHITE_METAL, BLACK_METAL))
    bench.add(
        metal,
        cylinder(0.2, 0.02, sides=24),
        rod((0, 0, 0.01), (0, 0, 0.9), 0.014),
        cylinder(0.2, 0.05, at=(0, 0, 0.9), sides=24),
    )
    for k in range(20):
        a = 2 * math.pi * k / 20
        c, s = 0.19 * math.cos(a), 0.19 * math.sin(a)
        bench.add(
            metal,
            tube(
                [(c, s, 0.94), (c, s, 1.3), (c * 0.7, s * 0.7, 1.42), (0, 0, 1.48)], 0.003, sides=4
            ),
        )
    bench.add(
        plastic(taste.accent),
        ball(0.05, 0.1, 0.07, at=(0.02, 0, 1.14), sides=10),
        ball(0.045, 0.045, 0.045, at=(0.02, 0.05, 1.19), sides=8),
    )
    bench.add(wood("oak"), rod((-0.15, 0, 1.1), (0.15, 0, 1.1), 0.006))
    return bench.model("bird cage", "birdcage", main=metal)
