"""Models of toilets, basins, bathtubs and showers."""

import math
from functools import partial

import numpy as np

from hypernav.simulator.houses.modelling.curves import (
    cylinder,
    lathe,
    rod,
    rounded_outline,
    sheet,
    tube,
)
from hypernav.simulator.houses.modelling.joinery import front
from hypernav.simulator.houses.modelling.materials import CERAMIC, CHROME, GLASS, Palette, lacquer
from hypernav.simulator.houses.modelling.model import (
    Finish,
    Mesh,
    Model,
    ModelBuilder,
    SupportSurface,
    join,
)
from hypernav.simulator.houses.modelling.solids import box, cushion, prism
from hypernav.simulator.houses.random_stream import RandomStream

_WATER = Finish("", (0.55, 0.62, 0.66))
_INSIDE = Finish("", (0.86, 0.87, 0.87))


def _ring(
    scale_x: float, front_y: float, back_y: float, z: float, sides: int = 28
) -> list[list[float]]:
    """An egg-shaped outline: round at the front, nearly straight at the back."""
    middle = back_y + (front_y - back_y) * 0.42
    points = []
    for k in range(sides + 1):
        a = 2.0 * math.pi * k / sides
        c, s = math.cos(a), math.sin(a)
        reach = (front_y - middle) if s > 0 else (middle - back_y)
        square = 1.0 if s > 0 else 0.72
        points.append(
            [
                math.copysign(abs(c) ** (1.0 if s > 0 else square), c) * scale_x,
                middle + math.copysign(abs(s) ** (0.96 if s > 0 else square), s) * reach,
                z,
            ]
        )
    points[-1] = list(points[0])
    return points


def _loft(rings: list[list[list[float]]]) -> Mesh:
    return sheet(np.array(rings).transpose(1, 0, 2), closed_u=True)


def toilet(rng: RandomStream, palette: Palette) -> Model:
    """A water closet with its cistern; the lid is up or down."""
    builder = ModelBuilder()
    back = -0.16
    rim = 0.4
    # Pedestal and bowl, lofted from the floor to the rim.
    bowl = [
        _ring(0.115, 0.22, back - 0.06, 0.0),
        _ring(0.11, 0.2, back - 0.06, 0.06),
        _ring(0.1, 0.17, back - 0.05, 0.14),
        _ring(0.115, 0.2, back - 0.04, 0.22),
        _ring(0.155, 0.3, back - 0.03, 0.3),
        _ring(0.182, 0.355, back - 0.01, 0.36),
        _ring(0.188, 0.365, back, 0.385),
        _ring(0.186, 0.362, back, rim),
    ]
    builder.add(CERAMIC, _loft(bowl))
    part = _loft(
        [
            _ring(0.186, 0.362, back, rim),
            _ring(0.13, 0.29, back + 0.07, rim - 0.005),
            _ring(0.12, 0.27, back + 0.08, rim - 0.06),
            _ring(0.07, 0.18, back + 0.12, rim - 0.17),
        ]
    )
    builder.add(_INSIDE, part)
    builder.add(_WATER, _fan(_ring(0.085, 0.2, back + 0.11, rim - 0.14)))
    open_ = rng.chance(0.45)
    seat_inner, seat_outer = (0.12, 0.28, back + 0.085), (0.192, 0.372, back + 0.005)
    seat = [
        _ring(*seat_outer, rim + 0.004),
        _ring(*seat_outer, rim + 0.02),
        _ring(0.182, 0.36, back + 0.015, rim + 0.028),
        _ring(0.132, 0.295, back + 0.075, rim + 0.028),
        _ring(*seat_inner, rim + 0.016),
        _ring(*seat_inner, rim + 0.002),
    ]
    builder.add(CERAMIC, _loft(seat))
    lid_high = [
        _ring(0.19, 0.37, back + 0.0, 0.0),
        _ring(0.192, 0.372, back, 0.012),
        _ring(0.18, 0.355, back + 0.01, 0.02),
        _ring(0.06, 0.12, back + 0.1, 0.024),
    ]
    lid = join(
        [
            _loft(lid_high),
            _fan(_ring(0.06, 0.12, back + 0.1, 0.024)),
            Mesh(*_flipped(_fan(_ring(0.19, 0.37, back, 0.0)))),
        ]
    )
    if open_:
        lid = lid.moved(0, -back, 0).turned(97, "x").moved(0, back + 0.005, rim + 0.035)
    else:
        lid = lid.moved(0, 0, rim + 0.03)
    builder.add(CERAMIC, lid)
    tank_wide, tank_high = rng.uniform(0.36, 0.42), rng.uniform(0.34, 0.4)
    tank_y = back - 0.11
    builder.add(
        CERAMIC,
        cushion(tank_wide, 0.17, tank_high, radius=0.025, at=(0, tank_y, rim - 0.02)),
        cushion(
            tank_wide + 0.02, 0.19, 0.035, radius=0.014, at=(0, tank_y, rim + tank_high - 0.02)
        ),
        box(0.22, 0.2, 0.06, at=(0, back - 0.06, rim - 0.07), bevel=0.02),
    )
    if rng.chance(0.5):
        builder.add(
            CHROME, cylinder(0.022, 0.008, at=(0, tank_y, rim + tank_high + 0.014), bevel=0.003)
        )
    else:
        part = rod(
            (-tank_wide / 2 + 0.06, tank_y + 0.1, rim + tank_high - 0.07),
            (-tank_wide / 2 + 0.14, tank_y + 0.105, rim + tank_high - 0.085),
            0.008,
        )
        builder.add(CHROME, part)
    surface = SupportSurface(-0.15, -0.33, 0.15, -0.22, rim + tank_high + 0.015, 0.4)
    return builder.model("toilet", "lavatory", "wc", main=CERAMIC, supports=(surface,))


def _fan(ring: list[list[float]]) -> Mesh:
    points = np.array(ring[:-1])
    middle = points.mean(axis=0)
    n = len(points)
    k = np.arange(n, dtype=np.int64)
    return Mesh(
        np.concatenate([points, middle[None]]),
        np.tile([0.0, 0.0, 1.0], (n + 1, 1)),
        np.zeros((n + 1, 2)),
        np.stack([k, (k + 1) % n, np.full(n, n, dtype=np.int64)], axis=1),
    )


def _flipped(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return mesh.positions, -mesh.normals, mesh.uv, mesh.faces[:, ::-1]


def tap(high: float = 0.16, reach: float = 0.12) -> Mesh:
    """A mixer tap that reaches to +y."""
    neck = [
        (0, 0, 0),
        (0, 0, high * 0.7),
        (0, reach * 0.25, high * 0.95),
        (0, reach * 0.7, high),
        (0, reach, high * 0.85),
    ]
    return join(
        [
            cylinder(0.024, 0.02, bevel=0.004),
            tube(neck, 0.011),
            rod((0.0, 0.0, high * 0.55), (0.05, 0.0, high * 0.62), 0.007),
        ]
    )


def bowl_mesh(x: float, y: float, deep: float, sides: int = 28) -> Mesh:
    """A round basin seen from above: rim at z = 0, sinking to -deep."""
    profile = [
        (1.0, 0.0),
        (0.93, 0.006),
        (0.88, -0.02),
        (0.8, -deep * 0.6),
        (0.5, -deep * 0.95),
        (0.0, -deep),
    ]
    inside = lathe(profile[::-1], sides=sides, crease_deg=90)
    inside = Mesh(*_flipped(inside))
    return inside.scaled(x / 2, y / 2, 1.0)


def bathroom_sink(rng: RandomStream, palette: Palette) -> Model:
    """A wash-basin on a cabinet, or on a pedestal."""
    builder = ModelBuilder()
    high = 0.84
    if rng.chance(0.3):
        builder.add(
            CERAMIC,
            lathe([(0.0, 0.0), (0.11, 0.0), (0.085, 0.1), (0.075, 0.4), (0.1, 0.66), (0.0, 0.66)]),
        )
        part = _loft(
            [
                _ring(0.1, 0.08, -0.16, 0.62),
                _ring(0.2, 0.18, -0.21, 0.7),
                _ring(0.27, 0.24, -0.23, 0.8),
                _ring(0.28, 0.25, -0.24, high),
                _ring(0.25, 0.22, -0.16, high + 0.004),
                _ring(0.23, 0.2, -0.13, high - 0.03),
                _ring(0.15, 0.12, -0.08, high - 0.12),
            ]
        )
        builder.add(CERAMIC, part)
        builder.add(_INSIDE, _fan(_ring(0.16, 0.13, -0.08, high - 0.11)))
        builder.add(CHROME, tap().moved(0, -0.19, high))
        return builder.model("sink", "bathroom sink", "washbasin", "basin", main=CERAMIC)
    body = lacquer(palette.paint_hue) if rng.chance(0.6) else palette.furniture_wood(rng)
    fit = partial(front, builder, body, CHROME)
    wide, deep = rng.choice((0.6, 0.8, 1.0)), 0.46
    builder.add(body, box(wide - 0.01, deep - 0.02, high - 0.3, at=(0, -0.01, 0.24), bevel=0.003))
    builder.add(body, box(wide - 0.08, deep - 0.1, 0.24, at=(0, -0.03, 0)))
    count = 2
    for k in range(count):
        at = ((k - 0.5) * wide / count, deep / 2 - 0.02, 0.25)
        fit(wide / count - 0.01, high - 0.33, at=at, upright=True, side=1.0 - 2.0 * k)
    rim, oval = 0.05, (min(wide - 0.14, 0.5), 0.34)
    outline = rounded_outline(wide, deep, 0.015, 2)
    builder.add(CERAMIC, prism(outline, rim, z=high - rim - 0.004))
    builder.add(_INSIDE, bowl_mesh(*oval, 0.002).moved(0, 0.02, high + 0.006))
    builder.add(
        CERAMIC,
        lathe([(1.0, 0.0), (1.02, 0.012), (0.96, 0.02), (0.92, 0.008)], sides=28)
        .scaled(oval[0] / 2, oval[1] / 2, 1.0)
        .moved(0, 0.02, high - 0.004),
    )
    builder.add(
        _INSIDE.tinted(0.86),
        lathe([(0.0, 0.0), (0.7, 0.001), (0.94, 0.004)], sides=28)
        .scaled(oval[0] / 2, oval[1] / 2, 1.0)
        .moved(0, 0.02, high - 0.002),
    )
    builder.add(
        CHROME,
        tap().moved(0, -deep / 2 + 0.06, high),
        cylinder(0.02, 0.004, at=(0, 0.02, high + 0.001)),
    )
    supports = (
        (
            SupportSurface(
                -wide / 2 + 0.02, -deep / 2 + 0.02, -oval[0] / 2 - 0.02, deep / 2 - 0.02, high, 0.3
            ),
        )
        if wide > 0.7
        else ()
    )
    return builder.model(
        "sink", "bathroom sink", "washbasin", "vanity sink", main=body, supports=supports
    )


def bathtub(rng: RandomStream, palette: Palette) -> Model:
    """A tub along a wall, 1.5 to 1.7 m."""
    builder = ModelBuilder()
    long, deep, high = rng.choice((1.5, 1.6, 1.7)), 0.72, 0.56

    def ring(x: float, y: float, r: float, z: float) -> list[list[float]]:
        points = [[px, py, z] for px, py in rounded_outline(x, y, r, 5)]
        return [*points, list(points[0])]

    inside = [
        ring(long - 0.14, deep - 0.14, 0.2, high + 0.002),
        ring(long - 0.18, deep - 0.18, 0.2, high - 0.03),
        ring(long - 0.34, deep - 0.26, 0.18, 0.2),
        ring(long - 0.5, deep - 0.36, 0.14, 0.14),
    ]
    outside = [
        ring(long, deep, 0.03, 0.0),
        ring(long, deep, 0.03, high - 0.05),
        ring(long, deep, 0.03, high - 0.01),
        ring(long - 0.02, deep - 0.02, 0.03, high),
        ring(long - 0.14, deep - 0.14, 0.2, high + 0.002),
    ]
    builder.add(CERAMIC, _loft(outside))
    builder.add(_INSIDE, _loft(inside), _fan(ring(long - 0.5, deep - 0.36, 0.14, 0.14)))
    end = -long / 2 + 0.05
    builder.add(
        CHROME,
        tap(0.15, 0.13).turned(-90).moved(end, 0, high),
        cylinder(0.022, 0.003, at=(-long / 2 + 0.4, 0, 0.141)),
    )
    return builder.model("bathtub", "tub", "bath", main=CERAMIC)


def shower(rng: RandomStream, palette: Palette) -> Model:
    """A glass cabin on a tray, for a corner: its back is -y, its closed side -x."""
    builder = ModelBuilder()
    side, high = 0.9, 2.0
    builder.add(CERAMIC, prism(rounded_outline(side, side, 0.03), 0.06))
    builder.add(_INSIDE, prism(rounded_outline(side - 0.12, side - 0.12, 0.05), 0.004, z=0.058))
    builder.add(CHROME, cylinder(0.05, 0.004, at=(0, 0, 0.062)))
    h = side / 2 - 0.02
    for x, y in ((h, h), (-h, h), (h, -h), (0.0, h)):
        builder.add(CHROME, box(0.025, 0.025, high - 0.06, at=(x, y, 0.06)))
    for z in (0.06, high - 0.03):
        builder.add(
            CHROME,
            box(side - 0.02, 0.025, 0.03, at=(0, h, z)),
            box(0.025, side - 0.02, 0.03, at=(h, 0, z)),
        )
    for z in (0.45, 0.9, 1.35):
        builder.add(GLASS, box(side / 2 - 0.06, 0.006, 0.22, at=(-side / 4, h, z)))
    builder.add(
        CHROME,
        rod((-0.0, -h + 0.02, 1.0), (0.0, -h + 0.02, 1.95), 0.011),
        cylinder(0.09, 0.012, at=(0, -h + 0.24, 1.93), sides=24),
        rod((0, -h + 0.02, 1.95), (0, -h + 0.24, 1.95), 0.009),
        box(0.18, 0.05, 0.04, at=(0, -h + 0.02, 1.0), bevel=0.01),
        tube(
            [
                (0.02, -h + 0.06, 1.0),
                (0.08, -h + 0.05, 0.7),
                (0.1, -h + 0.04, 1.2),
                (0.03, -h + 0.03, 1.5),
            ],
            0.007,
            sides=6,
        ),
    )
    return builder.model("shower", "shower cabin", "shower stall", main=GLASS)
