"""What hangs on walls and at windows. The wall is at the back (-y); z = 0 is the lower edge."""

import math

import numpy as np

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Mesh
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, panel, prism
from hypernav.houses.kit.surfaces import ball, cylinder, lathe, rounded_outline, sheet
from hypernav.houses.kit.tubes import rod
from hypernav.houses.palette import (
    BLACK_METAL,
    BRASS,
    CHROME,
    MIRROR,
    STEEL,
    WHITE_METAL,
    Taste,
    fabric,
    lacquer,
    picture,
    terry,
)


def framed_picture(dice: Dice, taste: Taste) -> Model:
    """A painting or print in a frame."""
    bench = Bench()
    wide = dice.choice((0.4, 0.55, 0.7, 0.9))
    high = wide * dice.choice((0.75, 0.75, 1.3, 1.0))
    frame = dice.choice((taste.furniture_wood(dice), lacquer("black"), lacquer("white"), BRASS))
    rim = dice.uniform(0.025, 0.05)
    for s in (-1.0, 1.0):
        bench.add(
            frame,
            box(rim, 0.025, high, at=(s * (wide - rim) / 2, 0, 0), bevel=0.005).swapped_uv(),
            box(wide, 0.025, rim, at=(0, 0, (high - rim) * (s + 1) / 2), bevel=0.005),
        )
    mount = 0.05 if dice.chance(0.5) else 0.0
    if mount:
        bench.add(lacquer("white"), panel(wide - rim, high - rim, at=(0, 0.002, rim / 2)))
    edge = 2 * (rim + mount)
    bench.add(
        picture(f"painting {dice.integer(0, 15)}"),
        panel(wide - edge, high - edge, at=(0, 0.004, rim + mount)),
    )
    bench.add(frame, box(wide - 0.02, 0.01, high - 0.02, at=(0, -0.007, 0.01)))
    return bench.model("picture", "painting", "framed picture", main=frame)


def mirror(dice: Dice, taste: Taste) -> Model:
    """A looking-glass, square, round or tall."""
    bench = Bench()
    frame = dice.choice((taste.furniture_wood(dice), taste.metal, lacquer("black")))
    kind = dice.choice(("square", "round", "oval"))
    if kind == "square":
        wide, high = dice.uniform(0.5, 0.8), dice.uniform(0.6, 0.85)
        outline = rounded_outline(wide, high, 0.02, 2)
    else:
        wide = dice.uniform(0.5, 0.65)
        high = wide if kind == "round" else wide * 1.35
        outline = [
            (wide / 2 * math.cos(a), high / 2 * math.sin(a))
            for a in np.linspace(0, 2 * math.pi, 32, endpoint=False)
        ]
    plate = prism(outline, 0.02).turned(90, "x")
    bench.add(frame, plate.moved(0, 0.01, high / 2))
    glass = prism([(x * 0.93, y * 0.93) for x, y in outline], 0.004).turned(90, "x")
    bench.add(MIRROR, glass.moved(0, 0.0145, high / 2))
    return bench.model("mirror", f"{kind} mirror", main=frame)


def clock(dice: Dice, taste: Taste) -> Model:
    """A round wall clock."""
    bench = Bench()
    radius = dice.uniform(0.14, 0.19)
    frame = dice.choice((BLACK_METAL, taste.furniture_wood(dice), taste.metal, WHITE_METAL))
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
    bench.add(frame, ring.turned(-90, "x").moved(0, 0, radius))
    r = radius * 0.89
    ring_points = [
        (r * math.cos(a), r * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 32, endpoint=False)
    ]
    dial = prism(ring_points, 0.001)
    uv = dial.positions[:, :2] / (2 * r) + 0.5
    dial = Mesh(dial.positions, dial.normals, uv, dial.faces).turned(90, "x")
    flipped = Mesh(dial.positions, dial.normals, dial.uv * (-1, 1) + (1, 0), dial.faces)
    bench.add(picture(f"clock face {dice.integer(0, 4)}"), flipped.moved(0, 0.0245, radius))
    return bench.model("clock", "wall clock", main=frame, attributes=("round",))


def curtain(dice: Dice, taste: Taste, wide: float = 1.4, high: float = 2.1) -> Model:
    """Two window curtains on a rod, drawn apart; the rod is at the top."""
    bench = Bench()
    cloth = fabric(
        taste.linen if taste.linen != "white" else dice.choice(("white", taste.accent)),
        dice.choice(("fabric", "fabric", "stripes")),
        0.4,
    )
    full = wide + 0.5
    metal = taste.metal
    bench.add(metal, rod((-full / 2, 0, high - 0.03), (full / 2, 0, high - 0.03), 0.012))
    for s in (-1.0, 1.0):
        bench.add(metal, ball(0.045, 0.045, 0.045, at=(s * full / 2, 0, high - 0.03), sides=10))
        bench.add(
            metal,
            rod(
                (s * (full / 2 - 0.1), 0, high - 0.03),
                (s * (full / 2 - 0.1), -0.055, high - 0.03),
                0.008,
            ),
        )
        bench.add(cloth, _drape(dice, 0.46, high - 0.06).moved(s * (full / 2 - 0.25), 0, 0.02))
    return bench.model("curtain", "window curtain", "drape", main=cloth)


def _drape(dice: Dice, wide: float, high: float, depth: float = 0.035) -> Mesh:
    """Cloth that hangs in folds, facing +y."""
    folds = dice.integer(4, 6)
    n, rows = folds * 6 + 1, 6
    u = np.linspace(0.0, 1.0, n)[:, None]
    v = np.linspace(0.0, 1.0, rows)[None, :]
    phase = dice.uniform(0, 6.28)
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


def shower_curtain(dice: Dice, taste: Taste, wide: float = 1.5) -> Model:
    """A curtain along a bathtub, pushed together at one end, on a rod at 2 m."""
    bench = Bench()
    cloth = fabric(
        dice.choice((taste.accent, "white", "light blue", "teal")),
        dice.choice(("stripes", "floral", "fabric")),
        0.6,
    )
    bench.add(CHROME, rod((-wide / 2, 0, 1.75), (wide / 2, 0, 1.75), 0.011))
    share = dice.uniform(0.4, 0.55)
    side = dice.choice((-1.0, 1.0))
    bench.add(cloth, _drape(dice, wide * share, 1.7).moved(side * wide * (1 - share) / 2, 0, 0.03))
    return bench.model("shower curtain", main=cloth)


def towel_rack(dice: Dice, taste: Taste) -> Model:
    """A rail with a towel or two."""
    bench = Bench()
    metal = dice.choice((CHROME, BLACK_METAL, BRASS))
    for z in (0.53, 0.28):
        bench.add(metal, rod((-0.3, 0.05, z), (0.3, 0.05, z), 0.009))
    for s in (-1.0, 1.0):
        bench.add(
            metal,
            rod((s * 0.3, -0.03, 0.53), (s * 0.3, 0.05, 0.53), 0.008),
            rod((s * 0.3, -0.03, 0.28), (s * 0.3, 0.05, 0.28), 0.008),
        )
    hue = dice.choice((taste.accent, "white", "light blue", taste.linen))
    for x, wide, high in ((-0.11, 0.32, 0.55), (0.17, 0.18, 0.35)):
        front = cushion(wide, 0.02, high, radius=0.009, at=(x, 0.066, 0.55 - high))
        back = cushion(wide, 0.018, high * 0.8, radius=0.008, at=(x, 0.034, 0.55 - high * 0.8))
        bench.add(terry(hue), front, back)
    return bench.model("towel rack", "towel rail", "towel holder", main=metal)


def radiator(dice: Dice, taste: Taste) -> Model:
    """A ribbed heater under a window."""
    del taste
    bench = Bench()
    wide = dice.choice((0.7, 0.9, 1.1))
    count = round(wide / 0.09)
    for k in range(count):
        x = (k + 0.5 - count / 2) * 0.09
        bench.add(WHITE_METAL, cushion(0.07, 0.08, 0.52, radius=0.02, rounds=1, at=(x, 0.0, 0.1)))
    for z in (0.16, 0.54):
        bench.add(WHITE_METAL, rod((-wide / 2, 0, z), (wide / 2, 0, z), 0.02))
    bench.add(
        WHITE_METAL,
        rod((-wide / 2 + 0.03, 0, 0), (-wide / 2 + 0.03, 0, 0.2), 0.01),
        cylinder(0.02, 0.06, sides=10).turned(90, "y").moved(wide / 2, 0, 0.16),
    )
    return bench.model("radiator", "heater", main=WHITE_METAL)


def air_conditioner(dice: Dice, taste: Taste) -> Model:
    """A wall unit high up."""
    del dice, taste
    bench = Bench()
    bench.add(WHITE_METAL, cushion(0.85, 0.2, 0.29, radius=0.04))
    bench.add(lacquer("gray"), box(0.78, 0.01, 0.05, at=(0, 0.092, 0.03)))
    for k in range(3):
        bench.add(lacquer("dark gray"), box(0.74, 0.006, 0.006, at=(0, 0.1, 0.035 + 0.015 * k)))
    bench.add(STEEL, box(0.06, 0.004, 0.012, at=(0.3, 0.101, 0.2)))
    return bench.model("air conditioner", "ac unit", main=WHITE_METAL)


def wall_hooks(dice: Dice, taste: Taste) -> Model:
    """A board with hooks, a bag and a hat."""
    bench = Bench()
    wood = taste.furniture_wood(dice)
    bench.add(wood, box(0.7, 0.02, 0.1, at=(0, -0.04, 0.35), bevel=0.005))
    for k in range(4):
        x = (k - 1.5) * 0.17
        bench.add(taste.metal, rod((x, -0.03, 0.39), (x, 0.03, 0.42), 0.007))
    bench.add(fabric(taste.accent), cushion(0.2, 0.06, 0.32, radius=0.025, at=(-0.25, 0.01, 0.02)))
    return bench.model("coat hooks", "wall hooks", "coat hanger", main=wood)


def toilet_paper(dice: Dice, taste: Taste) -> Model:
    """A roll on its holder."""
    del dice, taste
    bench = Bench()
    bench.add(
        CHROME,
        box(0.05, 0.015, 0.05, at=(0, -0.06, 0.06)),
        rod((0, -0.06, 0.085), (0, 0.01, 0.085), 0.006),
        rod((-0.06, 0.01, 0.085), (0.06, 0.01, 0.085), 0.006),
    )
    bench.add(
        lacquer("white"),
        cylinder(0.055, 0.1, sides=20).turned(90, "y").moved(-0.05, 0.01, 0.06),
        box(0.1, 0.004, 0.1, at=(0, 0.063, -0.03)),
    )
    return bench.model("toilet paper", "toilet paper holder", main=CHROME)
