"""Models of ornaments and textiles, and of what hangs on walls and at windows.

The wall of what hangs on one is at -y, its lower edge at z = 0.
"""

import math

import numpy as np

from hypernav.simulator.houses.modelling.curves import (
    ball,
    cylinder,
    lathe,
    rod,
    rounded_outline,
    sheet,
    tube,
)
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    BRASS,
    CHROME,
    HUES,
    MIRROR,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    lacquer,
    plastic,
    terry,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Mesh, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion, panel, prism, tile
from hypernav.simulator.houses.objects.belongings.kitchenware import glazed
from hypernav.simulator.houses.objects.furniture.seating import throw_pillow
from hypernav.simulator.houses.random_stream import RandomStream


def books(rng: RandomStream, palette: Palette) -> Model:
    """A stack of books."""
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
        part = rod(
            (0.008 * (k - 1.5), 0.006 * (k % 2), 0.01),
            (0.02 * (k - 1.5), 0.015 * (k % 2), 0.17),
            0.004,
            sides=6,
        )
        builder.add(plastic(hue), part)
    return builder.model("pen holder", "pencil cup", main=body)


def rug(rng: RandomStream, palette: Palette) -> Model:
    """A carpet with a pattern, about 2.3 m × 1.6 m."""
    wide, deep = rng.uniform(1.9, 2.6, 0.1), rng.uniform(1.3, 1.7, 0.1)
    return _rug(wide, deep, rng.integer(0, 11))


def small_rug(rng: RandomStream, palette: Palette) -> Model:
    """A carpet for beside the bed or the hall."""
    return _rug(rng.uniform(0.9, 1.2, 0.1), rng.uniform(0.55, 0.7, 0.05), rng.integer(0, 11))


def runner(rng: RandomStream, palette: Palette) -> Model:
    """A long narrow carpet."""
    return _rug(rng.uniform(1.8, 2.4, 0.1), 0.65, rng.integer(0, 11))


def _rug(wide: float, deep: float, pattern: int) -> Model:
    builder = ModelBuilder()
    key = f"rug {pattern}"
    builder.add(Finish(key, (1.0, 1.0, 1.0), 1.0, "", "wool"), tile(wide, deep, at=(0, 0, 0.0082)))
    edge = Finish("terry", (0.5, 0.46, 0.4), 0.25)
    builder.add(edge, box(wide, deep, 0.008))
    return builder.model("rug", "carpet", attributes=("patterned",))


def bath_mat(rng: RandomStream, palette: Palette) -> Model:
    """A small mat of terry cloth."""
    builder = ModelBuilder()
    cloth = terry(rng.choice((palette.accent_hue, "white", "gray", "light blue")))
    builder.add(cloth, cushion(0.75, 0.5, 0.018, radius=0.008))
    return builder.model("bath mat", "bathroom rug", main=cloth)


def doormat(rng: RandomStream, palette: Palette) -> Model:
    """A coarse mat at the front door."""
    builder = ModelBuilder()
    cloth = Finish("pile", rng.choice(((0.45, 0.33, 0.2), (0.3, 0.3, 0.3))), 0.3, "brown", "fibre")
    builder.add(cloth, box(0.7, 0.42, 0.009))
    return builder.model("doormat", "door mat", main=cloth)


def sofa_cushion(rng: RandomStream, palette: Palette) -> Model:
    """A square cushion that leans against a sofa's back; its back is at -y."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.accent_hue, palette.accent_hue, palette.linen_hue, "white")),
        rng.choice(("fabric", "coarse fabric", "stripes", "plaid")),
        0.4,
    )
    builder.add(cloth, throw_pillow(rng.choice((0.4, 0.45))).turned(66, "x").moved(0, 0, 0.2))
    return builder.model("cushion", "throw pillow", "pillow", main=cloth)


def folded_blanket(rng: RandomStream, palette: Palette) -> Model:
    """A blanket, folded twice."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.accent_hue, palette.upholstery_hue)),
        rng.choice(("coarse fabric", "plaid")),
        0.4,
    )
    for k in range(4):
        builder.add(
            cloth, cushion(0.42 - 0.004 * k, 0.34, 0.03, radius=0.014, at=(0, 0, 0.028 * k))
        )
    return builder.model("blanket", "folded blanket", main=cloth)


def folded_towels(rng: RandomStream, palette: Palette) -> Model:
    """A stack of towels."""
    builder = ModelBuilder()
    cloth = terry("white")
    for k in range(3):
        cloth = terry(rng.choice((palette.accent_hue, "white", palette.linen_hue)))
        builder.add(cloth, cushion(0.32, 0.22, 0.055, radius=0.024, at=(0, 0, 0.054 * k)))
    return builder.model("towel", "folded towels", "bath towel", main=cloth)


def rolled_mat(rng: RandomStream, palette: Palette) -> Model:
    """A rolled yoga mat, standing."""
    builder = ModelBuilder()
    foam = Finish(
        "terry", HUES[rng.choice(("purple", "teal", "blue", palette.accent_hue))], 0.3, "", "foam"
    )
    builder.add(
        foam, cylinder(0.07, 0.61, sides=20), rod((0.0, 0.0, 0.605), (0.0, 0.0, 0.612), 0.02)
    )
    return builder.model("yoga mat", "exercise mat", main=foam)


def framed_picture(rng: RandomStream, palette: Palette) -> Model:
    """A painting or print in a frame."""
    builder = ModelBuilder()
    wide = rng.choice((0.4, 0.55, 0.7, 0.9))
    high = wide * rng.choice((0.75, 0.75, 1.3, 1.0))
    frame = rng.choice((palette.furniture_wood(rng), lacquer("black"), lacquer("white"), BRASS))
    rim = rng.uniform(0.025, 0.05)
    for s in (-1.0, 1.0):
        builder.add(
            frame,
            box(rim, 0.025, high, at=(s * (wide - rim) / 2, 0, 0), bevel=0.005).swapped_uv(),
            box(wide, 0.025, rim, at=(0, 0, (high - rim) * (s + 1) / 2), bevel=0.005),
        )
    mount = 0.05 if rng.chance(0.5) else 0.0
    if mount:
        builder.add(lacquer("white"), panel(wide - rim, high - rim, at=(0, 0.002, rim / 2)))
    edge = 2 * (rim + mount)
    builder.add(
        image_finish(f"painting {rng.integer(0, 15)}"),
        panel(wide - edge, high - edge, at=(0, 0.004, rim + mount)),
    )
    builder.add(frame, box(wide - 0.02, 0.01, high - 0.02, at=(0, -0.007, 0.01)))
    return builder.model("picture", "painting", "framed picture", main=frame)


def mirror(rng: RandomStream, palette: Palette) -> Model:
    """A mirror: square, round or tall."""
    builder = ModelBuilder()
    frame = rng.choice((palette.furniture_wood(rng), palette.metal, lacquer("black")))
    kind = rng.choice(("square", "round", "oval"))
    if kind == "square":
        wide, high = rng.uniform(0.5, 0.8), rng.uniform(0.6, 0.85)
        outline = rounded_outline(wide, high, 0.02, 2)
    else:
        wide = rng.uniform(0.5, 0.65)
        high = wide if kind == "round" else wide * 1.35
        outline = [
            (wide / 2 * math.cos(a), high / 2 * math.sin(a))
            for a in np.linspace(0, 2 * math.pi, 32, endpoint=False)
        ]
    plate = prism(outline, 0.02).turned(90, "x")
    builder.add(frame, plate.moved(0, 0.01, high / 2))
    glass = prism([(x * 0.93, y * 0.93) for x, y in outline], 0.004).turned(90, "x")
    builder.add(MIRROR, glass.moved(0, 0.0145, high / 2))
    return builder.model("mirror", f"{kind} mirror", main=frame)


def wall_clock(rng: RandomStream, palette: Palette) -> Model:
    """A round wall clock."""
    builder = ModelBuilder()
    radius = rng.uniform(0.14, 0.19)
    frame = rng.choice((BLACK_METAL, palette.furniture_wood(rng), palette.metal, WHITE_METAL))
    profile = [
        (0.0, 0.0),
        (radius, 0.0),
        (radius, 0.035),
        (radius * 0.9, 0.04),
        (radius * 0.88, 0.022),
        (0.0, 0.022),
    ]
    ring = lathe(profile, sides=32)
    builder.add(frame, ring.turned(-90, "x").moved(0, 0, radius))
    r = radius * 0.89
    ring_points = [
        (r * math.cos(a), r * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 32, endpoint=False)
    ]
    dial = prism(ring_points, 0.001)
    uv = dial.positions[:, :2] / (2 * r) + 0.5
    dial = Mesh(dial.positions, dial.normals, uv, dial.faces).turned(90, "x")
    flipped = Mesh(dial.positions, dial.normals, dial.uv * (-1, 1) + (1, 0), dial.faces)
    builder.add(image_finish(f"clock face {rng.integer(0, 4)}"), flipped.moved(0, 0.0245, radius))
    return builder.model("clock", "wall clock", main=frame, attributes=("round",))


def curtain(rng: RandomStream, palette: Palette, wide: float = 1.4, high: float = 2.1) -> Model:
    """Two window curtains on a rod, drawn apart; the rod is at the top."""
    builder = ModelBuilder()
    cloth = fabric(
        palette.linen_hue
        if palette.linen_hue != "white"
        else rng.choice(("white", palette.accent_hue)),
        rng.choice(("fabric", "fabric", "stripes")),
        0.4,
    )
    full = wide + 0.5
    metal = palette.metal
    builder.add(metal, rod((-full / 2, 0, high - 0.03), (full / 2, 0, high - 0.03), 0.012))
    for s in (-1.0, 1.0):
        builder.add(metal, ball(0.045, 0.045, 0.045, at=(s * full / 2, 0, high - 0.03), sides=10))
        part = rod(
            (s * (full / 2 - 0.1), 0, high - 0.03),
            (s * (full / 2 - 0.1), -0.055, high - 0.03),
            0.008,
        )
        builder.add(metal, part)
        builder.add(cloth, _drape(rng, 0.46, high - 0.06).moved(s * (full / 2 - 0.25), 0, 0.02))
    return builder.model("curtain", "window curtain", "drape", main=cloth)


def _drape(rng: RandomStream, wide: float, high: float) -> Mesh:
    """Cloth that hangs in folds, facing +y."""
    folds = rng.integer(4, 6)
    n, rows = folds * 6 + 1, 6
    u = np.linspace(0.0, 1.0, n)[:, None]
    v = np.linspace(0.0, 1.0, rows)[None, :]
    phase = rng.uniform(0, 6.28)
    ripple = (
        0.035
        * np.sin(2 * np.pi * folds * u + 0.6 * np.sin(3.0 * v + phase))
        * (0.55 + 0.45 * (1.0 - v))
    )
    narrow = 1.0 - 0.12 * np.sin(np.pi * np.clip(v, 0, 1)) * 0.6
    points = np.stack([(0.5 - u) * wide * narrow, ripple + 0 * v, v * high + 0 * u], axis=-1)
    return _facing(sheet(points))


def _facing(mesh: Mesh) -> Mesh:
    """The same sheet, turned so that its shading faces +y."""
    if float(mesh.normals[:, 1].sum()) < 0:
        return Mesh(mesh.positions, -mesh.normals, mesh.uv, mesh.faces[:, ::-1])
    return mesh


def shower_curtain(rng: RandomStream, palette: Palette, wide: float = 1.5) -> Model:
    """A curtain along a bathtub, pushed together at one end, on a rod at 2 m."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.accent_hue, "white", "light blue", "teal")),
        rng.choice(("stripes", "floral", "fabric")),
        0.6,
    )
    builder.add(CHROME, rod((-wide / 2, 0, 1.75), (wide / 2, 0, 1.75), 0.011))
    share = rng.uniform(0.4, 0.55)
    side = rng.choice((-1.0, 1.0))
    builder.add(cloth, _drape(rng, wide * share, 1.7).moved(side * wide * (1 - share) / 2, 0, 0.03))
    return builder.model("shower curtain", main=cloth)


def towel_rack(rng: RandomStream, palette: Palette) -> Model:
    """A rail with a towel or two."""
    builder = ModelBuilder()
    metal = rng.choice((CHROME, BLACK_METAL, BRASS))
    for z in (0.53, 0.28):
        builder.add(metal, rod((-0.3, 0.05, z), (0.3, 0.05, z), 0.009))
    for s in (-1.0, 1.0):
        builder.add(
            metal,
            rod((s * 0.3, -0.03, 0.53), (s * 0.3, 0.05, 0.53), 0.008),
            rod((s * 0.3, -0.03, 0.28), (s * 0.3, 0.05, 0.28), 0.008),
        )
    hue = rng.choice((palette.accent_hue, "white", "light blue", palette.linen_hue))
    for x, wide, high in ((-0.11, 0.32, 0.55), (0.17, 0.18, 0.35)):
        front = cushion(wide, 0.02, high, radius=0.009, at=(x, 0.066, 0.55 - high))
        back = cushion(wide, 0.018, high * 0.8, radius=0.008, at=(x, 0.034, 0.55 - high * 0.8))
        builder.add(terry(hue), front, back)
    return builder.model("towel rack", "towel rail", "towel holder", main=metal)


def radiator(rng: RandomStream, palette: Palette) -> Model:
    """A ribbed heater under a window."""
    builder = ModelBuilder()
    wide = rng.choice((0.7, 0.9, 1.1))
    count = round(wide / 0.09)
    for k in range(count):
        x = (k + 0.5 - count / 2) * 0.09
        builder.add(WHITE_METAL, cushion(0.07, 0.08, 0.52, radius=0.02, rounds=1, at=(x, 0.0, 0.1)))
    for z in (0.16, 0.54):
        builder.add(WHITE_METAL, rod((-wide / 2, 0, z), (wide / 2, 0, z), 0.02))
    builder.add(
        WHITE_METAL,
        rod((-wide / 2 + 0.03, 0, 0), (-wide / 2 + 0.03, 0, 0.2), 0.01),
        cylinder(0.02, 0.06, sides=10).turned(90, "y").moved(wide / 2, 0, 0.16),
    )
    return builder.model("radiator", "heater", main=WHITE_METAL)


def wall_hooks(rng: RandomStream, palette: Palette) -> Model:
    """A board with hooks, a bag and a hat."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    builder.add(wood, box(0.7, 0.02, 0.1, at=(0, -0.04, 0.35), bevel=0.005))
    for k in range(4):
        x = (k - 1.5) * 0.17
        builder.add(palette.metal, rod((x, -0.03, 0.39), (x, 0.03, 0.42), 0.007))
    builder.add(
        fabric(palette.accent_hue), cushion(0.2, 0.06, 0.32, radius=0.025, at=(-0.25, 0.01, 0.02))
    )
    return builder.model("coat hooks", "wall hooks", "coat hanger", main=wood)


def toilet_paper(rng: RandomStream, palette: Palette) -> Model:
    """A roll on its holder."""
    builder = ModelBuilder()
    builder.add(
        CHROME,
        box(0.05, 0.015, 0.05, at=(0, -0.06, 0.06)),
        rod((0, -0.06, 0.085), (0, 0.01, 0.085), 0.006),
        rod((-0.06, 0.01, 0.085), (0.06, 0.01, 0.085), 0.006),
    )
    builder.add(
        lacquer("white"),
        cylinder(0.055, 0.1, sides=20).turned(90, "y").moved(-0.05, 0.01, 0.06),
        box(0.1, 0.004, 0.1, at=(0, 0.063, -0.03)),
    )
    return builder.model("toilet paper", "toilet paper holder", main=CHROME)
