"""Music, play, sport and pets."""

import math

from hypernav.worlds.houses.dice import Dice
from hypernav.worlds.houses.kit.mesh import Finish, join
from hypernav.worlds.houses.kit.model import Bench, Model, Top
from hypernav.worlds.houses.kit.solids import box, cushion, panel, prism, tile
from hypernav.worlds.houses.kit.surfaces import ball, cylinder, lathe, rod, tube
from hypernav.worlds.houses.palette import (
    BLACK_METAL,
    BRASS,
    CHROME,
    GLASS,
    HUES,
    RUBBER,
    STEEL,
    WHITE_METAL,
    Taste,
    fabric,
    lacquer,
    picture,
    plastic,
    wood,
)


def piano(dice: Dice, taste: Taste) -> Model:
    """An upright piano; the player sits in front (+y)."""
    bench = Bench()
    body = dice.choice((lacquer("black"), wood("walnut"), wood("cherry"), lacquer("white")))
    wide = 1.46
    bench.add(
        body,
        box(wide, 0.3, 1.15, at=(0, -0.14, 0), bevel=0.008),
        box(wide + 0.03, 0.36, 0.03, at=(0, -0.13, 1.15), bevel=0.006),
        box(wide, 0.3, 0.09, at=(0, 0.12, 0.6), bevel=0.008),
        box(wide - 0.16, 0.02, 0.45, at=(0, 0.02, 0.1)),
    )
    for s in (-1.0, 1.0):
        bench.add(
            body,
            box(0.06, 0.3, 0.18, at=(s * (wide / 2 - 0.03), 0.12, 0.6), bevel=0.01),
            box(0.06, 0.07, 0.6, at=(s * (wide / 2 - 0.05), 0.22, 0), bevel=0.008),
        )
    keys = wide - 0.16
    bench.add(plastic("white"), box(keys, 0.14, 0.02, at=(0, 0.19, 0.69)))
    white = 52
    each = keys / white
    bench.add(
        plastic("gray"),
        *[
            box(0.0015, 0.141, 0.0205, at=((k + 1 - white / 2) * each, 0.19, 0.69))
            for k in range(white - 1)
        ],
    )
    black = [k for k in range(white - 1) if k % 7 in (0, 1, 3, 4, 5)]
    bench.add(
        plastic("black"),
        *[
            box(each * 0.55, 0.09, 0.016, at=((k + 1 - white / 2) * each, 0.165, 0.71))
            for k in black
        ],
    )
    bench.add(body, box(0.6, 0.015, 0.24, at=(0, 0.025, 0.82)).turned(0))
    bench.add(picture("label 0"), panel(0.3, 0.2, at=(0, 0.035, 0.84)))
    bench.add(BRASS, *[box(0.05, 0.1, 0.02, at=((k - 1) * 0.12, 0.1, 0.03)) for k in range(3)])
    del taste
    return bench.model(
        "piano", "upright piano", main=body, tops=(Top(-0.65, -0.26, 0.65, 0.0, 1.18),)
    )


def guitar(dice: Dice, taste: Taste) -> Model:
    """An acoustic guitar on its stand."""
    bench = Bench()
    body = wood(dice.choice(("pine", "cherry", "oak")))
    outline = []
    for k in range(36):
        a = 2 * math.pi * k / 36
        waist = 0.165 + 0.035 * math.cos(2 * a + math.pi) - 0.02 * math.sin(a)
        outline.append((waist * math.cos(a) * 1.05, 0.24 * math.sin(a)))
    shell = prism(outline, 0.1).turned(90, "x").moved(0, 0.05, 0.34)
    dark = wood("wenge")
    parts = [
        (body, shell),
        (dark, cylinder(0.045, 0.004, sides=20).turned(-90, "x").moved(0, 0.05, 0.42)),
        (dark, box(0.05, 0.025, 0.46, at=(0, 0.045, 0.56))),
        (dark, box(0.075, 0.02, 0.15, at=(0, 0.04, 1.0))),
        (dark, box(0.14, 0.015, 0.025, at=(0, 0.055, 0.24))),
    ]
    for finish, mesh in parts:
        bench.add(finish, mesh.turned(9, "x").moved(0, 0.02, 0))
    bench.add(
        CHROME,
        *[
            rod((x * 0.006, 0.065, 0.25), (x * 0.006, 0.062, 1.1), 0.0012, sides=4)
            .turned(9, "x")
            .moved(0, 0.02, 0)
            for x in (-2.5, -1.5, -0.5, 0.5, 1.5, 2.5)
        ],
    )
    for s in (-1.0, 1.0):
        bench.add(
            BLACK_METAL,
            rod((s * 0.17, 0.16, 0), (s * 0.06, -0.06, 0.35), 0.008),
            rod((s * 0.1, -0.02, 0.1), (s * 0.1, 0.14, 0.09), 0.008),
        )
    bench.add(
        BLACK_METAL,
        rod((0, -0.24, 0), (0, -0.06, 0.36), 0.008),
        rod((0, -0.06, 0.34), (0, -0.11, 0.85), 0.008),
    )
    del taste
    return bench.model("guitar", "acoustic guitar", main=body)


def fireplace(dice: Dice, taste: Taste) -> Model:
    """A fireplace with mantelpiece and a fire."""
    bench = Bench()
    stone = dice.choice(
        (
            Finish("bricks", (0.66, 0.33, 0.26), 0.8, "red", "brick"),
            Finish("marble", (0.93, 0.92, 0.9), 1.0, "white", "marble"),
            Finish("concrete", (0.6, 0.58, 0.55), 1.0, "gray", "stone"),
        )
    )
    wide, deep, high = 1.3, 0.35, 1.05
    for s in (-1.0, 1.0):
        bench.add(stone, box(0.27, deep, high, at=(s * (wide - 0.27) / 2, 0, 0)))
    bench.add(stone, box(wide - 0.54, deep, 0.32, at=(0, 0, high - 0.32)))
    bench.add(
        Finish("bricks", (0.16, 0.14, 0.13), 0.6),
        box(wide - 0.54, 0.03, high - 0.3, at=(0, -deep / 2 + 0.02, 0)),
    )
    bench.add(Finish("", (0.1, 0.09, 0.09)), box(wide - 0.5, deep + 0.0, 0.03, at=(0, 0, 0)))
    mantel = taste.furniture_wood(dice)
    bench.add(mantel, box(wide + 0.14, deep + 0.08, 0.06, at=(0, 0.02, high), bevel=0.012))
    for k in range(4):
        log = (
            cylinder(0.05, 0.42, sides=10)
            .turned(90, "y")
            .moved(-0.21, -0.02 + 0.05 * (k % 2), 0.09 + 0.07 * (k // 2))
        )
        bench.add(Finish("wood", (0.3, 0.2, 0.14), 0.3), log.turned(8 * (k - 1.5)))
    for k in range(7):
        flame = lathe([(0, 0.0), (0.045, 0.05), (0.03, 0.14), (0, 0.24)], sides=8, crease_deg=80)
        ink = ((1.0, 0.55, 0.1), (1.0, 0.78, 0.25))[k % 2]
        bench.add(
            Finish("", ink, unlit=True), flame.moved((k - 3) * 0.06, 0.02 * (k % 3 - 1), 0.15)
        )
    return bench.model(
        "fireplace", "hearth", main=stone, tops=(Top(-0.6, -0.12, 0.6, 0.16, high + 0.06),)
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


def teddy_bear(dice: Dice, taste: Taste) -> Model:
    """A stuffed bear, sitting."""
    del taste
    bench = Bench()
    fur = Finish(
        "pile",
        dice.choice(((0.62, 0.42, 0.24), (0.85, 0.7, 0.5), (0.5, 0.36, 0.25))),
        0.25,
        "brown",
        "plush",
    )
    bench.add(
        fur, ball(0.26, 0.22, 0.28, at=(0, 0, 0.14)), ball(0.21, 0.19, 0.19, at=(0, 0.01, 0.33))
    )
    bench.add(
        fur.tinted(1.3),
        ball(0.1, 0.07, 0.08, at=(0, 0.1, 0.31)),
        ball(0.16, 0.06, 0.18, at=(0, 0.09, 0.14)),
    )
    for s in (-1.0, 1.0):
        bench.add(
            fur,
            ball(0.08, 0.05, 0.08, at=(s * 0.085, 0, 0.42)),
            ball(0.09, 0.2, 0.1, at=(s * 0.1, 0.14, 0.06)),
            ball(0.08, 0.14, 0.18, at=(s * 0.15, 0.05, 0.19)),
        )
        bench.add(plastic("black"), ball(0.022, 0.014, 0.022, at=(s * 0.04, 0.098, 0.365), sides=8))
    bench.add(plastic("black"), ball(0.03, 0.02, 0.02, at=(0, 0.136, 0.325), sides=8))
    return bench.model("toy", "teddy bear", "stuffed animal", main=fur)


def toy_car(dice: Dice, taste: Taste) -> Model:
    """A toy car."""
    bench = Bench()
    paint = plastic(dice.choice(("red", "blue", "yellow", taste.accent)))
    bench.add(
        paint,
        cushion(0.26, 0.12, 0.06, radius=0.02, at=(0, 0, 0.025)),
        cushion(0.14, 0.11, 0.06, radius=0.02, at=(-0.01, 0, 0.075)),
    )
    bench.add(GLASS.tinted(0.5), box(0.142, 0.09, 0.03, at=(-0.01, 0, 0.092)))
    for x in (-0.08, 0.08):
        bench.add(RUBBER, cylinder(0.03, 0.125, sides=14).turned(90, "x").moved(x, 0.0625, 0.03))
    return bench.model("toy", "toy car", main=paint)


def toy_blocks(dice: Dice, taste: Taste) -> Model:
    """A tower of building blocks."""
    del taste
    bench = Bench()
    hues = dice.shuffled(("red", "blue", "yellow", "green", "orange", "purple"))
    for k, (x, z) in enumerate(
        ((-0.07, 0), (0.0, 0), (0.07, 0), (-0.035, 0.06), (0.035, 0.06), (0, 0.12))
    ):
        bench.add(plastic(hues[k]), box(0.06, 0.06, 0.06, at=(x, 0, z), bevel=0.005).turned(0))
    return bench.model("toy", "toy blocks", "building blocks", attributes=("colorful",))


def toy_box(dice: Dice, taste: Taste) -> Model:
    """An open chest with toys."""
    bench = Bench()
    body = lacquer(dice.choice(("white", taste.accent, "light blue", "yellow")))
    for s in (-1.0, 1.0):
        bench.add(
            body,
            box(0.02, 0.4, 0.38, at=(s * 0.34, 0, 0)),
            box(0.7, 0.02, 0.38, at=(0, s * 0.19, 0)),
        )
    bench.add(body, box(0.68, 0.38, 0.02))
    for k in range(9):
        hue = dice.choice(("red", "blue", "yellow", "green", "orange", "pink"))
        x, y = (k % 3 - 1) * 0.2, (k // 3 - 1) * 0.11
        toy = (
            ball(0.16, 0.14, 0.14, at=(x, y, 0.34), sides=12)
            if dice.chance(0.5)
            else box(0.15, 0.11, 0.16, at=(x, y, 0.26), bevel=0.01)
        )
        bench.add(plastic(hue), toy)
    return bench.model("toy box", "toy chest", main=body)


def dollhouse(dice: Dice, taste: Taste) -> Model:
    """A doll's house with a pitched roof."""
    bench = Bench()
    wall, roof = (
        lacquer(dice.choice(("pink", "white", "light blue"))),
        lacquer(dice.choice(("red", "brown", taste.accent))),
    )
    bench.add(wall, box(0.6, 0.02, 0.6, at=(0, -0.14, 0)))
    for x in (-0.29, 0.0, 0.29):
        bench.add(wall, box(0.02, 0.3, 0.6, at=(x, 0, 0)))
    for z in (0, 0.3, 0.58):
        bench.add(wall, box(0.6, 0.3, 0.02, at=(0, 0, z)))
    slope = box(0.44, 0.34, 0.02)
    for s in (-1.0, 1.0):
        bench.add(roof, slope.moved(s * -0.22, 0, 0).turned(s * 38, "y").moved(0, 0, 0.86))
    for k in range(4):
        bench.add(
            plastic(dice.choice(("red", "yellow", "blue", "green"))),
            box(0.1, 0.1, 0.09, at=((k % 2 - 0.5) * 0.28, 0.02, 0.02 + 0.3 * (k // 2)), bevel=0.01),
        )
    return bench.model("toy", "dollhouse", "doll house", main=wall)


def easel(dice: Dice, taste: Taste) -> Model:
    """An easel with a painting."""
    bench = Bench()
    frame = wood(taste.second_wood)
    for s in (-1.0, 1.0):
        bench.add(frame, rod((s * 0.32, 0.2, 0), (s * 0.04, -0.08, 1.6), 0.014))
    bench.add(
        frame,
        rod((0, -0.42, 0), (0, -0.08, 1.55), 0.014),
        box(0.6, 0.06, 0.025, at=(0, 0.09, 0.72)),
    )
    canvas = panel(0.62, 0.5).turned(10, "x").moved(0, 0.09, 0.75)
    bench.add(
        lacquer("white"),
        box(0.64, 0.02, 0.52, at=(0, -0.011, 0)).turned(10, "x").moved(0, 0.09, 0.745),
    )
    bench.add(picture(f"painting {dice.integer(0, 15)}"), canvas)
    return bench.model("easel", "painting easel", main=frame)


def chess(dice: Dice, taste: Taste) -> Model:
    """A chess board with pieces."""
    del taste
    bench = Bench()
    bench.add(wood("walnut"), box(0.4, 0.4, 0.02, bevel=0.004))
    light = [
        tile(0.044, 0.044, at=((i - 3.5) * 0.045, (j - 3.5) * 0.045, 0.0205))
        for i in range(8)
        for j in range(8)
        if (i + j) % 2
    ]
    bench.add(lacquer("cream"), *light)
    piece = lathe([(0, 0), (0.014, 0), (0.007, 0.02), (0.009, 0.035), (0, 0.045)], sides=8)
    for hue, rows in (("white", (0, 1)), ("black", (6, 7))):
        men = [
            piece.moved((i - 3.5) * 0.045, (j - 3.5) * 0.045, 0.021)
            for i in range(8)
            for j in rows
            if dice.chance(0.9)
        ]
        bench.add(plastic(hue), *men)
    return bench.model("chess set", "chess board", "board game", main=wood("walnut"))


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
