"""Small things for surfaces and shelves."""

from hypernav.worlds.houses.dice import Dice
from hypernav.worlds.houses.kit.mesh import Finish, Mesh
from hypernav.worlds.houses.kit.model import Bench, Model
from hypernav.worlds.houses.kit.solids import box, cushion, panel, tile
from hypernav.worlds.houses.kit.surfaces import ball, cylinder, lathe, rod, tube
from hypernav.worlds.houses.palette import (
    BLACK_METAL,
    BRASS,
    CERAMIC,
    CHROME,
    GLASS,
    HUES,
    STEEL,
    Taste,
    lacquer,
    picture,
    plastic,
    wood,
)


def glazed(hue: str) -> Finish:
    """Coloured ceramic."""
    return Finish("", HUES[hue], 1.0, hue, "ceramic")


def books(dice: Dice, taste: Taste) -> Model:
    """A few books, lying on each other."""
    del taste
    bench = Bench()
    z = 0.0
    for _ in range(dice.integer(2, 4)):
        x, y, h = dice.uniform(0.2, 0.26), dice.uniform(0.15, 0.19), dice.uniform(0.02, 0.04)
        cover = plastic(
            dice.choice(("red", "navy", "green", "yellow", "white", "teal", "brown", "orange"))
        )
        turn = dice.uniform(-12, 12)
        bench.add(
            cover,
            box(x, y, 0.004).turned(turn).moved(0, 0, z),
            box(x, y, 0.004).turned(turn).moved(0, 0, z + h - 0.004),
            box(x, 0.004, h).moved(0, -y / 2 + 0.002, 0).turned(turn).moved(0, 0, z),
        )
        bench.add(
            plastic("cream"),
            box(x - 0.012, y - 0.014, h - 0.008, at=(0, 0.002, 0.004)).turned(turn).moved(0, 0, z),
        )
        z += h + 0.001
    return bench.model("book", "books", "stack of books")


def magazine(dice: Dice, taste: Taste) -> Model:
    """An open or closed magazine."""
    del taste
    bench = Bench()
    bench.add(plastic("white"), box(0.22, 0.29, 0.006))
    bench.add(picture(f"painting {dice.integer(0, 15)}"), tile(0.215, 0.285, at=(0, 0, 0.0065)))
    return bench.model("magazine", main=plastic("white"))


def cup(dice: Dice, taste: Taste) -> Model:
    """A mug."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", taste.accent, "blue", "yellow", "red")))
    bench.add(
        glaze,
        lathe(
            [
                (0, 0),
                (0.036, 0),
                (0.041, 0.01),
                (0.041, 0.095),
                (0.037, 0.095),
                (0.036, 0.02),
                (0, 0.018),
            ],
            sides=18,
        ),
    )
    bench.add(
        glaze,
        tube(
            [(0.04, 0, 0.075), (0.068, 0, 0.072), (0.07, 0, 0.035), (0.04, 0, 0.022)],
            0.006,
            sides=6,
        ),
    )
    bench.add(plastic("brown"), cylinder(0.036, 0.002, at=(0, 0, 0.08)))
    return bench.model("cup", "mug", "coffee cup", main=glaze)


def bowl(dice: Dice, taste: Taste) -> Model:
    """An empty bowl."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", taste.accent, "teal", "cream")))
    bench.add(glaze, _bowl(0.12, 0.075))
    return bench.model("bowl", main=glaze)


def _bowl(radius: float, high: float) -> Mesh:
    return lathe(
        [
            (0, 0),
            (radius * 0.45, 0),
            (radius * 0.5, 0.008),
            (radius * 0.85, high * 0.55),
            (radius, high),
            (radius * 0.96, high),
            (radius * 0.8, high * 0.55),
            (radius * 0.4, 0.016),
            (0, 0.014),
        ],
        sides=28,
        crease_deg=60,
    )


def fruit_bowl(dice: Dice, taste: Taste) -> Model:
    """A bowl with oranges, apples and bananas."""
    bench = Bench()
    glaze = (
        glazed(dice.choice(("white", "teal", taste.accent))) if dice.chance(0.6) else wood("oak")
    )
    bench.add(glaze, _bowl(0.16, 0.08))
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
        bench.add(
            Finish("", inks[(k + dice.integer(0, 3)) % 4]),
            ball(0.078, 0.078, 0.074, at=(x, y, z), sides=14),
        )
    banana = [(-0.09, 0.03, 0.1), (-0.03, 0.06, 0.135), (0.04, 0.06, 0.135), (0.09, 0.03, 0.11)]
    bench.add(Finish("", (0.95, 0.8, 0.2)), tube(banana, [0.008, 0.018, 0.018, 0.007]))
    return bench.model("fruit bowl", "bowl", main=glaze)


def plate(dice: Dice, taste: Taste) -> Model:
    """A plate with knife and fork."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", "white", "light blue", taste.accent)))
    bench.add(
        glaze,
        lathe(
            [(0, 0), (0.08, 0), (0.13, 0.018), (0.128, 0.021), (0.085, 0.008), (0, 0.006)],
            sides=28,
            crease_deg=60,
        ),
    )
    for x in (-0.165, 0.165):
        bench.add(CHROME, box(0.014, 0.19, 0.004, at=(x, 0, 0)))
    return bench.model("plate", "dish", main=glaze)


def bottle(dice: Dice, taste: Taste) -> Model:
    """A bottle of wine or water."""
    del taste
    bench = Bench()
    glass = Finish(
        "",
        dice.choice(((0.1, 0.22, 0.12), (0.15, 0.05, 0.06), (0.6, 0.75, 0.8), (0.3, 0.2, 0.1))),
        1.0,
        "",
        "glass",
    )
    bench.add(
        glass,
        lathe(
            [(0, 0), (0.037, 0), (0.038, 0.19), (0.014, 0.24), (0.014, 0.31), (0, 0.31)],
            sides=18,
            crease_deg=50,
        ),
    )
    bench.add(
        picture(f"label {dice.integer(0, 7)}"),
        lathe([(0.0385, 0.06), (0.0385, 0.15)], sides=18).textured(8.0, 11.0),
    )
    return bench.model("bottle", main=glass)


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


def candle(dice: Dice, taste: Taste) -> Model:
    """A thick candle on a dish."""
    bench = Bench()
    wax = plastic(dice.choice(("white", "cream", taste.accent)))
    high = dice.uniform(0.08, 0.16)
    bench.add(BLACK_METAL, cylinder(0.055, 0.01, sides=20))
    bench.add(wax, cylinder(0.036, high, at=(0, 0, 0.01), sides=18, bevel=0.006))
    bench.add(BLACK_METAL, rod((0, 0, high + 0.008), (0, 0, high + 0.022), 0.0015, sides=4))
    return bench.model("candle", main=wax)


def photo_frame(dice: Dice, taste: Taste) -> Model:
    """A small standing picture."""
    bench = Bench()
    frame = dice.choice((lacquer("black"), lacquer("white"), BRASS, wood("oak")))
    inner = Bench()
    inner.add(frame, box(0.16, 0.015, 0.21, bevel=0.003))
    inner.add(picture(f"painting {dice.integer(0, 15)}"), panel(0.12, 0.17, at=(0, 0.0085, 0.02)))
    for part in inner.parts:
        bench.add(part.finish, part.mesh.turned(12, "x").moved(0, 0.02, 0.001))
    bench.add(frame, rod((0, -0.015, 0.13), (0, -0.07, 0.0), 0.006, sides=5))
    del taste
    return bench.model("photo frame", "picture frame", main=frame)


def globe(dice: Dice, taste: Taste) -> Model:
    """A globe on its stand."""
    bench = Bench()
    bench.add(
        Finish("marble", (0.3, 0.5, 0.72), 0.3, "blue", "plastic"),
        ball(0.24, 0.24, 0.24, at=(0, 0, 0.2), sides=20),
    )
    land = Finish("", (0.45, 0.6, 0.3))
    for _ in range(6):
        turn, tilt = dice.uniform(0, 360), dice.uniform(-40, 60)
        patch = cushion(0.11, 0.03, 0.09, radius=0.014, at=(0, 0.108, -0.045))
        bench.add(land, patch.turned(tilt, "x").turned(turn).moved(0, 0, 0.2))
    metal = BRASS
    ring = [
        (0.13 * s, 0, 0.2 + 0.13 * c) for s, c in ((0, 1), (0.7, 0.7), (1, 0), (0.7, -0.7), (0, -1))
    ]
    bench.add(
        metal,
        tube(ring, 0.006, sides=6),
        cylinder(0.08, 0.02, sides=20),
        rod((0, 0, 0.02), (0, 0, 0.08), 0.01),
    )
    del taste
    return bench.model("globe", main=metal)


def clock(dice: Dice, taste: Taste) -> Model:
    """A small standing clock."""
    bench = Bench()
    body = taste.furniture_wood(dice)
    bench.add(body, box(0.17, 0.06, 0.17, bevel=0.02))
    bench.add(
        picture(f"clock face {dice.integer(0, 4)}"), panel(0.125, 0.125, at=(0, 0.031, 0.0225))
    )
    return bench.model("clock", "table clock", main=body)


def remote(dice: Dice, taste: Taste) -> Model:
    """A remote control."""
    del taste, dice
    bench = Bench()
    bench.add(plastic("black"), box(0.045, 0.17, 0.018, bevel=0.005))
    bench.add(
        plastic("gray"),
        *[
            box(0.008, 0.008, 0.003, at=((k % 3 - 1) * 0.012, 0.05 - (k // 3) * 0.018, 0.018))
            for k in range(15)
        ],
    )
    return bench.model("remote control", "remote", "tv remote", main=plastic("black"))


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


def knife_block(dice: Dice, taste: Taste) -> Model:
    """Knives in a wooden block."""
    del dice
    bench = Bench()
    body = wood(taste.wood)
    bench.add(body, box(0.1, 0.14, 0.2, bevel=0.008))
    for k in range(4):
        bench.add(
            plastic("black"),
            box(0.016, 0.024, 0.09, at=(-0.03 + 0.02 * k, 0.01 * (k % 2), 0.2), bevel=0.005),
        )
    return bench.model("knife block", "knives", main=body)


def pot(dice: Dice, taste: Taste) -> Model:
    """A cooking pot with its lid."""
    bench = Bench()
    body = dice.choice((STEEL, glazed(taste.accent), plastic("red")))
    radius = dice.uniform(0.095, 0.11)
    bench.add(
        body,
        lathe([(0, 0), (radius, 0), (radius, 0.11), (radius * 1.03, 0.115)], sides=24),
        lathe([(radius * 1.03, 0.115), (radius * 0.8, 0.13), (0, 0.14)], sides=24, crease_deg=60),
    )
    bench.add(BLACK_METAL, ball(0.03, 0.03, 0.025, at=(0, 0, 0.15), sides=10))
    for s in (-1.0, 1.0):
        bench.add(
            BLACK_METAL, box(0.03, 0.05, 0.015, at=(s * (radius + 0.012), 0, 0.08), bevel=0.005)
        )
    return bench.model("pot", "cooking pot", "saucepan", main=body)


def paper_towels(dice: Dice, taste: Taste) -> Model:
    """A roll of kitchen paper on its stand."""
    del dice, taste
    bench = Bench()
    bench.add(
        CHROME, cylinder(0.075, 0.012, sides=24), rod((0, 0, 0.01), (0, 0, 0.3), 0.006, sides=6)
    )
    bench.add(
        Finish("terry", (0.97, 0.97, 0.96), 0.2, "white", "paper"),
        cylinder(0.06, 0.24, at=(0, 0, 0.014), sides=24),
    )
    return bench.model("paper towels", "kitchen roll", main=CHROME)


def cutting_board(dice: Dice, taste: Taste) -> Model:
    """A board with bread."""
    bench = Bench()
    board = wood(taste.second_wood)
    bench.add(board, box(0.38, 0.24, 0.02, bevel=0.006))
    if dice.chance(0.7):
        bench.add(
            Finish("terry", (0.72, 0.48, 0.25), 0.3),
            ball(0.24, 0.12, 0.11, at=(-0.02, 0, 0.07), sides=14),
        )
    return bench.model("cutting board", "chopping board", main=board)


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


def pen_cup(dice: Dice, taste: Taste) -> Model:
    """Pens in a cup."""
    bench = Bench()
    body = glazed(taste.accent)
    bench.add(body, lathe([(0, 0), (0.04, 0), (0.042, 0.1), (0.038, 0.1), (0.036, 0.01)], sides=16))
    for k, hue in enumerate(("blue", "red", "yellow", "black")):
        bench.add(
            plastic(hue),
            rod(
                (0.008 * (k - 1.5), 0.006 * (k % 2), 0.01),
                (0.02 * (k - 1.5), 0.015 * (k % 2), 0.17),
                0.004,
                sides=6,
            ),
        )
    return bench.model("pen holder", "pencil cup", main=body)


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
