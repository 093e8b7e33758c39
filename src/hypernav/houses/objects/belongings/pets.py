"""Models of equipment for pets."""

import math

from hypernav.houses.materials import (
    BLACK_METAL,
    BRASS,
    HUES,
    WHITE_METAL,
    Palette,
    fabric,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish, join
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, prism
from hypernav.houses.modelling.surfaces import ball, cylinder
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.random_stream import RandomStream


def fish_tank(rng: RandomStream, palette: Palette) -> Model:
    """An aquarium on its cabinet."""
    builder = ModelBuilder()
    body = palette.furniture_wood(rng)
    builder.add(
        body, box(0.82, 0.38, 0.7, bevel=0.004), box(0.82, 0.38, 0.05, at=(0, 0, 1.12), bevel=0.004)
    )
    builder.add(
        Finish("", (0.35, 0.6, 0.72), 1.0, "", "glass"), box(0.8, 0.36, 0.42, at=(0, 0, 0.7))
    )
    builder.add(Finish("", (0.78, 0.68, 0.45)), box(0.802, 0.362, 0.06, at=(0, 0, 0.7)))
    for k in range(6):
        x, z = rng.uniform(-0.32, 0.32), rng.uniform(0.84, 1.05)
        fish = join(
            [
                ball(0.09, 0.012, 0.05, sides=10),
                prism(
                    [(0.035, -0.004), (0.07, -0.004), (0.07, 0.004), (0.035, 0.004)], 0.04, z=-0.02
                ),
            ]
        )
        builder.add(
            Finish("", rng.choice(((0.95, 0.5, 0.1), (0.95, 0.85, 0.2), (0.9, 0.2, 0.2)))),
            fish.moved(x, 0.185, z),
        )
        builder.add(
            Finish("", (0.2, 0.5, 0.25)), box(0.02, 0.006, 0.16, at=(-0.34 + 0.13 * k, 0.183, 0.76))
        )
    return builder.model("fish tank", "aquarium", main=body)


def cat_tree(rng: RandomStream, palette: Palette) -> Model:
    """Posts with platforms for a cat."""
    del palette
    builder = ModelBuilder()
    plush = Finish(
        "pile", rng.choice(((0.75, 0.68, 0.58), (0.5, 0.5, 0.52))), 0.3, "beige", "fabric"
    )
    sisal = Finish("wicker", (0.78, 0.66, 0.46), 0.1)
    builder.add(
        plush,
        box(0.5, 0.45, 0.05, bevel=0.01),
        box(0.32, 0.3, 0.3, at=(-0.06, -0.05, 0.05), bevel=0.02),
        box(0.36, 0.3, 0.03, at=(0.08, 0, 0.75), bevel=0.01),
        box(0.32, 0.3, 0.08, at=(-0.08, -0.03, 1.2), bevel=0.02),
    )
    builder.add(
        Finish("", (0.08, 0.07, 0.06)),
        cylinder(0.09, 0.004, sides=20).turned(-90, "x").moved(-0.06, 0.1, 0.19),
    )
    builder.add(
        sisal,
        cylinder(0.045, 0.7, at=(0.16, 0.1, 0.05)),
        cylinder(0.045, 0.42, at=(-0.06, -0.02, 0.78)),
        cylinder(0.045, 0.42, at=(-0.06, -0.05, 0.34)),
    )
    return builder.model("cat tree", "scratching post", main=plush)


def pet_bed(rng: RandomStream, palette: Palette) -> Model:
    """A round basket for a dog or cat."""
    builder = ModelBuilder()
    cloth = fabric(rng.choice((palette.upholstery_hue, "gray", "brown")), "coarse fabric", 0.3)
    ring = [
        (0.27 * math.cos(2 * math.pi * k / 20), 0.22 * math.sin(2 * math.pi * k / 20), 0.08)
        for k in range(20)
    ]
    builder.add(cloth, tube(ring, 0.075, sides=10, closed=True))
    builder.add(
        Finish("terry", HUES["cream"], 0.25),
        cylinder(0.24, 0.07, sides=24, bevel=0.02).scaled(1, 0.82, 1),
    )
    return builder.model("pet basket", "dog basket", "cat basket", main=cloth)


def bird_cage(rng: RandomStream, palette: Palette) -> Model:
    """A cage on a stand."""
    builder = ModelBuilder()
    metal = rng.choice((BRASS, WHITE_METAL, BLACK_METAL))
    builder.add(
        metal,
        cylinder(0.2, 0.02, sides=24),
        rod((0, 0, 0.01), (0, 0, 0.9), 0.014),
        cylinder(0.2, 0.05, at=(0, 0, 0.9), sides=24),
    )
    for k in range(20):
        a = 2 * math.pi * k / 20
        c, s = 0.19 * math.cos(a), 0.19 * math.sin(a)
        builder.add(
            metal,
            tube(
                [(c, s, 0.94), (c, s, 1.3), (c * 0.7, s * 0.7, 1.42), (0, 0, 1.48)], 0.003, sides=4
            ),
        )
    builder.add(
        plastic(palette.accent_hue),
        ball(0.05, 0.1, 0.07, at=(0.02, 0, 1.14), sides=10),
        ball(0.045, 0.045, 0.045, at=(0.02, 0.05, 1.19), sides=8),
    )
    builder.add(wood("oak"), rod((-0.15, 0, 1.1), (0.15, 0, 1.1), 0.006))
    return builder.model("bird cage", "birdcage", main=metal)
