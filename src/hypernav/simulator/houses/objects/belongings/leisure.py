"""Models of toys, musical instruments, pets' furniture and other things for free time."""

import math

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    BRASS,
    CHROME,
    GLASS,
    HUES,
    RUBBER,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    lacquer,
    plastic,
    wood,
)
from hypernav.simulator.houses.modelling.model import (
    Finish,
    Model,
    ModelBuilder,
    SupportSurface,
    join,
)
from hypernav.simulator.houses.modelling.solids import box, cushion, panel, prism, tile
from hypernav.simulator.houses.random_stream import RandomStream


def piano(rng: RandomStream, palette: Palette) -> Model:
    """An upright piano; the player sits in front (+y)."""
    builder = ModelBuilder()
    body = rng.choice((lacquer("black"), wood("walnut"), wood("cherry"), lacquer("white")))
    wide = 1.46
    builder.add(
        body,
        box(wide, 0.3, 1.15, at=(0, -0.14, 0), bevel=0.008),
        box(wide + 0.03, 0.36, 0.03, at=(0, -0.13, 1.15), bevel=0.006),
        box(wide, 0.3, 0.09, at=(0, 0.12, 0.6), bevel=0.008),
        box(wide - 0.16, 0.02, 0.45, at=(0, 0.02, 0.1)),
    )
    for s in (-1.0, 1.0):
        builder.add(
            body,
            box(0.06, 0.3, 0.18, at=(s * (wide / 2 - 0.03), 0.12, 0.6), bevel=0.01),
            box(0.06, 0.07, 0.6, at=(s * (wide / 2 - 0.05), 0.22, 0), bevel=0.008),
        )
    keys = wide - 0.16
    builder.add(plastic("white"), box(keys, 0.14, 0.02, at=(0, 0.19, 0.69)))
    white = 52
    each = keys / white
    builder.add(
        plastic("gray"),
        *[
            box(0.0015, 0.141, 0.0205, at=((k + 1 - white / 2) * each, 0.19, 0.69))
            for k in range(white - 1)
        ],
    )
    black = [k for k in range(white - 1) if k % 7 in (0, 1, 3, 4, 5)]
    builder.add(
        plastic("black"),
        *[
            box(each * 0.55, 0.09, 0.016, at=((k + 1 - white / 2) * each, 0.165, 0.71))
            for k in black
        ],
    )
    builder.add(body, box(0.6, 0.015, 0.24, at=(0, 0.025, 0.82)).turned(0))
    builder.add(image_finish("label 0"), panel(0.3, 0.2, at=(0, 0.035, 0.84)))
    builder.add(BRASS, *[box(0.05, 0.1, 0.02, at=((k - 1) * 0.12, 0.1, 0.03)) for k in range(3)])
    surface = SupportSurface(-0.65, -0.26, 0.65, 0.0, 1.18)
    return builder.model("piano", "upright piano", main=body, supports=(surface,))


def guitar(rng: RandomStream, palette: Palette) -> Model:
    """An acoustic guitar on its stand."""
    builder = ModelBuilder()
    body = wood(rng.choice(("pine", "cherry", "oak")))
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
        builder.add(finish, mesh.turned(9, "x").moved(0, 0.02, 0))
    builder.add(
        CHROME,
        *[
            rod((x * 0.006, 0.065, 0.25), (x * 0.006, 0.062, 1.1), 0.0012, sides=4)
            .turned(9, "x")
            .moved(0, 0.02, 0)
            for x in (-2.5, -1.5, -0.5, 0.5, 1.5, 2.5)
        ],
    )
    for s in (-1.0, 1.0):
        builder.add(
            BLACK_METAL,
            rod((s * 0.17, 0.16, 0), (s * 0.06, -0.06, 0.35), 0.008),
            rod((s * 0.1, -0.02, 0.1), (s * 0.1, 0.14, 0.09), 0.008),
        )
    builder.add(
        BLACK_METAL,
        rod((0, -0.24, 0), (0, -0.06, 0.36), 0.008),
        rod((0, -0.06, 0.34), (0, -0.11, 0.85), 0.008),
    )
    return builder.model("guitar", "acoustic guitar", main=body)


def fireplace(rng: RandomStream, palette: Palette) -> Model:
    """A fireplace with mantelpiece and a fire."""
    builder = ModelBuilder()
    stone = rng.choice(
        (
            Finish("bricks", (0.66, 0.33, 0.26), 0.8, "red", "brick"),
            Finish("marble", (0.93, 0.92, 0.9), 1.0, "white", "marble"),
            Finish("concrete", (0.6, 0.58, 0.55), 1.0, "gray", "stone"),
        )
    )
    wide, deep, high = 1.3, 0.35, 1.05
    for s in (-1.0, 1.0):
        builder.add(stone, box(0.27, deep, high, at=(s * (wide - 0.27) / 2, 0, 0)))
    builder.add(stone, box(wide - 0.54, deep, 0.32, at=(0, 0, high - 0.32)))
    builder.add(
        Finish("bricks", (0.16, 0.14, 0.13), 0.6),
        box(wide - 0.54, 0.03, high - 0.3, at=(0, -deep / 2 + 0.02, 0)),
    )
    builder.add(Finish("", (0.1, 0.09, 0.09)), box(wide - 0.5, deep + 0.0, 0.03, at=(0, 0, 0)))
    mantel = palette.furniture_wood(rng)
    builder.add(mantel, box(wide + 0.14, deep + 0.08, 0.06, at=(0, 0.02, high), bevel=0.012))
    for k in range(4):
        log = (
            cylinder(0.05, 0.42, sides=10)
            .turned(90, "y")
            .moved(-0.21, -0.02 + 0.05 * (k % 2), 0.09 + 0.07 * (k // 2))
        )
        builder.add(Finish("wood", (0.3, 0.2, 0.14), 0.3), log.turned(8 * (k - 1.5)))
    for k in range(7):
        flame = lathe([(0, 0.0), (0.045, 0.05), (0.03, 0.14), (0, 0.24)], sides=8, crease_deg=80)
        ink = ((1.0, 0.55, 0.1), (1.0, 0.78, 0.25))[k % 2]
        builder.add(
            Finish("", ink, unlit=True), flame.moved((k - 3) * 0.06, 0.02 * (k % 3 - 1), 0.15)
        )
    surface = SupportSurface(-0.6, -0.12, 0.6, 0.16, high + 0.06)
    return builder.model("fireplace", "hearth", main=stone, supports=(surface,))


def easel(rng: RandomStream, palette: Palette) -> Model:
    """An easel with a painting."""
    builder = ModelBuilder()
    frame = wood(palette.secondary_wood)
    for s in (-1.0, 1.0):
        builder.add(frame, rod((s * 0.32, 0.2, 0), (s * 0.04, -0.08, 1.6), 0.014))
    builder.add(
        frame,
        rod((0, -0.42, 0), (0, -0.08, 1.55), 0.014),
        box(0.6, 0.06, 0.025, at=(0, 0.09, 0.72)),
    )
    canvas = panel(0.62, 0.5).turned(10, "x").moved(0, 0.09, 0.75)
    builder.add(
        lacquer("white"),
        box(0.64, 0.02, 0.52, at=(0, -0.011, 0)).turned(10, "x").moved(0, 0.09, 0.745),
    )
    builder.add(image_finish(f"painting {rng.integer(0, 15)}"), canvas)
    return builder.model("easel", "painting easel", main=frame)


def teddy_bear(rng: RandomStream, palette: Palette) -> Model:
    """A stuffed bear, sitting."""
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
        part = tube(
            [(c, s, 0.94), (c, s, 1.3), (c * 0.7, s * 0.7, 1.42), (0, 0, 1.48)], 0.003, sides=4
        )
        builder.add(metal, part)
    builder.add(
        plastic(palette.accent_hue),
        ball(0.05, 0.1, 0.07, at=(0.02, 0, 1.14), sides=10),
        ball(0.045, 0.045, 0.045, at=(0.02, 0.05, 1.19), sides=8),
    )
    builder.add(wood("oak"), rod((-0.15, 0, 1.1), (0.15, 0, 1.1), 0.006))
    return builder.model("bird cage", "birdcage", main=metal)
