"""Models of small ornaments for shelves, desks and sideboards."""

from hypernav.houses.materials import (
    BLACK_METAL,
    BRASS,
    Palette,
    image_finish,
    lacquer,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, panel, tile
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.objects.kitchen_and_bathroom.tableware import glazed
from hypernav.houses.random_stream import RandomStream


def books(rng: RandomStream, palette: Palette) -> Model:
    """A stack of books."""
    del palette
    builder = ModelBuilder()
    z = 0.0
    for _ in range(rng.integer(2, 4)):
        x, y, h = rng.uniform(0.2, 0.26), rng.uniform(0.15, 0.19), rng.uniform(0.02, 0.04)
        cover = plastic(
            rng.choice(("red", "navy", "green", "yellow", "white", "teal", "brown", "orange"))
        )
        turn = rng.uniform(-12, 12)
        builder.add(
            cover,
            box(x, y, 0.004).turned(turn).moved(0, 0, z),
            box(x, y, 0.004).turned(turn).moved(0, 0, z + h - 0.004),
            box(x, 0.004, h).moved(0, -y / 2 + 0.002, 0).turned(turn).moved(0, 0, z),
        )
        builder.add(
            plastic("cream"),
            box(x - 0.012, y - 0.014, h - 0.008, at=(0, 0.002, 0.004)).turned(turn).moved(0, 0, z),
        )
        z += h + 0.001
    return builder.model("book", "books", "stack of books")


def magazine(rng: RandomStream, palette: Palette) -> Model:
    """An open or closed magazine."""
    del palette
    builder = ModelBuilder()
    builder.add(plastic("white"), box(0.22, 0.29, 0.006))
    builder.add(
        image_finish(f"painting {rng.integer(0, 15)}"), tile(0.215, 0.285, at=(0, 0, 0.0065))
    )
    return builder.model("magazine", main=plastic("white"))


def candle(rng: RandomStream, palette: Palette) -> Model:
    """A thick candle on a dish."""
    builder = ModelBuilder()
    wax = plastic(rng.choice(("white", "cream", palette.accent_hue)))
    high = rng.uniform(0.08, 0.16)
    builder.add(BLACK_METAL, cylinder(0.055, 0.01, sides=20))
    builder.add(wax, cylinder(0.036, high, at=(0, 0, 0.01), sides=18, bevel=0.006))
    builder.add(BLACK_METAL, rod((0, 0, high + 0.008), (0, 0, high + 0.022), 0.0015, sides=4))
    return builder.model("candle", main=wax)


def photo_frame(rng: RandomStream, palette: Palette) -> Model:
    """A standing photo frame."""
    builder = ModelBuilder()
    frame = rng.choice((lacquer("black"), lacquer("white"), BRASS, wood("oak")))
    inner = ModelBuilder()
    inner.add(frame, box(0.16, 0.015, 0.21, bevel=0.003))
    inner.add(
        image_finish(f"painting {rng.integer(0, 15)}"), panel(0.12, 0.17, at=(0, 0.0085, 0.02))
    )
    for part in inner.parts:
        builder.add(part.finish, part.mesh.turned(12, "x").moved(0, 0.02, 0.001))
    builder.add(frame, rod((0, -0.015, 0.13), (0, -0.07, 0.0), 0.006, sides=5))
    del palette
    return builder.model("photo frame", "picture frame", main=frame)


def globe(rng: RandomStream, palette: Palette) -> Model:
    """A globe on its stand."""
    builder = ModelBuilder()
    builder.add(
        Finish("marble", (0.3, 0.5, 0.72), 0.3, "blue", "plastic"),
        ball(0.24, 0.24, 0.24, at=(0, 0, 0.2), sides=20),
    )
    land = Finish("", (0.45, 0.6, 0.3))
    for _ in range(6):
        turn, tilt = rng.uniform(0, 360), rng.uniform(-40, 60)
        patch = cushion(0.11, 0.03, 0.09, radius=0.014, at=(0, 0.108, -0.045))
        builder.add(land, patch.turned(tilt, "x").turned(turn).moved(0, 0, 0.2))
    metal = BRASS
    ring = [
        (0.13 * s, 0, 0.2 + 0.13 * c) for s, c in ((0, 1), (0.7, 0.7), (1, 0), (0.7, -0.7), (0, -1))
    ]
    builder.add(
        metal,
        tube(ring, 0.006, sides=6),
        cylinder(0.08, 0.02, sides=20),
        rod((0, 0, 0.02), (0, 0, 0.08), 0.01),
    )
    del palette
    return builder.model("globe", main=metal)


def clock(rng: RandomStream, palette: Palette) -> Model:
    """A small standing clock."""
    builder = ModelBuilder()
    body = palette.furniture_wood(rng)
    builder.add(body, box(0.17, 0.06, 0.17, bevel=0.02))
    builder.add(
        image_finish(f"clock face {rng.integer(0, 4)}"), panel(0.125, 0.125, at=(0, 0.031, 0.0225))
    )
    return builder.model("clock", "table clock", main=body)


def remote(rng: RandomStream, palette: Palette) -> Model:
    """A remote control."""
    del palette, rng
    builder = ModelBuilder()
    builder.add(plastic("black"), box(0.045, 0.17, 0.018, bevel=0.005))
    builder.add(
        plastic("gray"),
        *[
            box(0.008, 0.008, 0.003, at=((k % 3 - 1) * 0.012, 0.05 - (k // 3) * 0.018, 0.018))
            for k in range(15)
        ],
    )
    return builder.model("remote control", "remote", "tv remote", main=plastic("black"))


def pen_cup(rng: RandomStream, palette: Palette) -> Model:
    """Pens in a cup."""
    builder = ModelBuilder()
    body = glazed(palette.accent_hue)
    builder.add(
        body, lathe([(0, 0), (0.04, 0), (0.042, 0.1), (0.038, 0.1), (0.036, 0.01)], sides=16)
    )
    for k, hue in enumerate(("blue", "red", "yellow", "black")):
        builder.add(
            plastic(hue),
            rod(
                (0.008 * (k - 1.5), 0.006 * (k % 2), 0.01),
                (0.02 * (k - 1.5), 0.015 * (k % 2), 0.17),
                0.004,
                sides=6,
            ),
        )
    return builder.model("pen holder", "pencil cup", main=body)
