"""Small things for shelves, desks and sideboards."""

from hypernav.houses.dice import Dice
from hypernav.houses.furniture.kitchen_and_bath.tableware import glazed
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, panel, tile
from hypernav.houses.kit.surfaces import ball, cylinder, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import BLACK_METAL, BRASS, Taste, lacquer, picture, plastic, wood


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
