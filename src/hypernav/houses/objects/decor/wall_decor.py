"""Models that hang on walls and at windows; the wall is at -y, the lower edge at z = 0."""

import math

import numpy as np

from hypernav.houses.materials import (
    BLACK_METAL,
    BRASS,
    CHROME,
    MIRROR,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    lacquer,
    terry,
)
from hypernav.houses.modelling.mesh import Mesh
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, panel, prism
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe, rounded_outline, sheet
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream


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


def clock(rng: RandomStream, palette: Palette) -> Model:
    """A round wall clock."""
    builder = ModelBuilder()
    radius = rng.uniform(0.14, 0.19)
    frame = rng.choice((BLACK_METAL, palette.furniture_wood(rng), palette.metal, WHITE_METAL))
    ring = lathe(
        [
            (0.0, 0.0),
            (radius, 0.0),
            (radius, 0.035),
            (radius * 0.9, 0.04),
            (radius * 0.88, 0.022),
            (0.0, 0.022),
        ],
        sides=32,
    )
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
        builder.add(
            metal,
            rod(
                (s * (full / 2 - 0.1), 0, high - 0.03),
                (s * (full / 2 - 0.1), -0.055, high - 0.03),
                0.008,
            ),
        )
        builder.add(cloth, _drape(rng, 0.46, high - 0.06).moved(s * (full / 2 - 0.25), 0, 0.02))
    return builder.model("curtain", "window curtain", "drape", main=cloth)


def _drape(rng: RandomStream, wide: float, high: float, depth: float = 0.035) -> Mesh:
    """Cloth that hangs in folds, facing +y."""
    folds = rng.integer(4, 6)
    n, rows = folds * 6 + 1, 6
    u = np.linspace(0.0, 1.0, n)[:, None]
    v = np.linspace(0.0, 1.0, rows)[None, :]
    phase = rng.uniform(0, 6.28)
    ripple = (
        depth
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
    del palette
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
    del rng, palette
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
