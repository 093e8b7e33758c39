"""Models of plants in pots."""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.simulator.houses.modelling.curves import ball, cross, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import CERAMIC, TERRACOTTA, Palette, plastic
from hypernav.simulator.houses.modelling.model import (
    Finish,
    Mesh,
    Model,
    ModelBuilder,
    Vector,
    join,
    unit_vectors,
)
from hypernav.simulator.houses.modelling.solids import cushion, grid_faces
from hypernav.simulator.houses.random_stream import RandomStream

_GREENS = ((0.2, 0.43, 0.16), (0.27, 0.5, 0.2), (0.16, 0.36, 0.17), (0.38, 0.56, 0.25))

_SOIL = Finish("soil", (1.0, 1.0, 1.0), 0.2)
_BARK = Finish("wood", (0.45, 0.34, 0.24), 0.3)


def leaves(
    length: Sequence[float],
    wide: Sequence[float],
    droop: Sequence[float],
    lift_deg: Sequence[float],
    turn_deg: Sequence[float],
    at: Sequence[Vector],
    *,
    fold: float = 0.25,
    steps: int = 7,
    shape: str = "oval",
) -> Mesh:
    """Mesh of leaves that rise at an angle and bend down under their weight.

    Args:
        length: Length along the rib, metres.
        wide: Greatest width, metres.
        droop: Bend over the length, degrees.
        lift_deg: Angle of the base above the horizon, degrees.
        turn_deg: Direction in plan, degrees.
        at: Position of the base.
        fold: Depth of the valley along the rib, as a share of the half width.
        steps: Number of segments along the rib.
        shape: Outline of the blade: "oval", "sword" or "heart".
    """
    n = len(length)
    t = np.linspace(0.0, 1.0, steps + 1)
    angle = np.radians(np.array(lift_deg)[:, None] - np.array(droop)[:, None] * t)
    step = np.array(length)[:, None] / steps
    c, s = np.cos(angle), np.sin(angle)
    start = np.zeros((n, 1))
    out = np.concatenate([start, np.cumsum(c[:, :-1] * step, axis=1)], axis=1)
    up = np.concatenate([start, np.cumsum(s[:, :-1] * step, axis=1)], axis=1)
    half = np.array(wide)[:, None] / 2.0 * _outline(shape, t)
    turn = np.radians(np.array(turn_deg))[:, None]
    ct, st = np.cos(turn), np.sin(turn)
    positions = np.array(at)
    points = np.empty((n, steps + 1, 3, 3))
    for k, across in enumerate((1.0, 0.0, -1.0)):
        dip = abs(across) * half * fold
        x, y = out - dip * s, across * half
        points[:, :, k, 0] = x * ct - y * st + positions[:, 0:1]
        points[:, :, k, 1] = x * st + y * ct + positions[:, 1:2]
        points[:, :, k, 2] = up + dip * c + positions[:, 2:3]
    slope_t = np.empty_like(points)
    slope_t[:, 1:-1] = points[:, 2:] - points[:, :-2]
    slope_t[:, 0], slope_t[:, -1] = points[:, 1] - points[:, 0], points[:, -1] - points[:, -2]
    slope_a = np.empty_like(points)
    slope_a[:, :, 1] = points[:, :, 0] - points[:, :, 2]
    slope_a[:, :, 0] = points[:, :, 0] - points[:, :, 1]
    slope_a[:, :, 2] = points[:, :, 1] - points[:, :, 2]
    normals = unit_vectors(cross(slope_t, slope_a))
    uv = np.empty((n, steps + 1, 3, 2))
    uv[..., 0], uv[..., 1] = np.array([1.0, 0.5, 0.0]), t[None, :, None]
    each = (steps + 1) * 3
    faces = grid_faces(steps + 1, 3)[:, ::-1][None] + (np.arange(n) * each)[:, None, None]
    return Mesh(
        points.reshape(-1, 3), normals.reshape(-1, 3), uv.reshape(-1, 2), faces.reshape(-1, 3)
    )


def _outline(shape: str, t: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Half width along the rib, as a share of the greatest."""
    if shape == "sword":
        return np.minimum(1.0, 0.55 + 1.6 * t) * np.clip((1.0 - t) * 2.2, 0.02, 1.0) ** 0.6
    if shape == "heart":
        return np.clip(np.sin(np.pi * (t * 0.94 + 0.06) ** 0.6), 0.03, 1.0)
    return np.clip(np.sin(np.pi * t**0.85), 0.03, 1.0)


def _spread(rng: RandomStream, count: int) -> list[float]:
    """Directions in steps of the golden angle, as in phyllotaxis."""
    start = rng.uniform(0.0, 360.0)
    return [start + 137.5 * k + rng.uniform(-18.0, 18.0) for k in range(count)]


def rosette(
    rng: RandomStream,
    count: int,
    length: float,
    wide: float,
    shape: str = "oval",
    at: Vector = (0.0, 0.0, 0.0),
) -> Mesh:
    """Leaves on stalks out of one point: outer ones low, inner ones upright."""
    turns = _spread(rng, count)
    lifts = [32.0 + 50.0 * k / count + rng.uniform(-8, 8) for k in range(count)]
    sizes = [rng.uniform(0.75, 1.1) for _ in range(count)]
    droops = [rng.uniform(50, 95) for _ in range(count)]
    return leaves(
        [length * s for s in sizes],
        [wide * s for s in sizes],
        droops,
        lifts,
        turns,
        [at] * count,
        shape=shape,
    )


def _polar(turn_deg: float, reach: float, z: float) -> Vector:
    return (math.cos(math.radians(turn_deg)) * reach, math.sin(math.radians(turn_deg)) * reach, z)


def _frond(length: float, lift: float, droop: float) -> Mesh:
    """A palm leaf: a bowed rib with narrow leaflets on both sides."""
    steps = 12
    step = length / steps
    x, z = 0.0, 0.0
    path: list[Vector] = [(0.0, 0.0, 0.0)]
    sizes, lifts, turns, positions = [], [], [], []
    for k in range(steps):
        a = math.radians(lift - droop * k / steps)
        x, z = x + math.cos(a) * step, z + math.sin(a) * step
        path.append((x, 0.0, z))
        if k > 2:
            for side in (-1.0, 1.0):
                sizes.append(0.3 * math.sin(math.pi * (k + 1) / (steps + 2)) + 0.06)
                lifts.append(math.degrees(a) * 0.4 + 5)
                turns.append(side * 58)
                positions.append((x, 0.0, z))
    n = len(sizes)
    leaflets = leaves(
        sizes, [0.032] * n, [45.0] * n, lifts, turns, positions, shape="sword", steps=3
    )
    return join([tube(path, 0.006, sides=5, capped=False), leaflets])


def green(rng: RandomStream, texture: str = "leaf") -> Finish:
    """Finish of one plant's leaves."""
    r, g, b = rng.choice(_GREENS)
    lift = rng.uniform(0.95, 1.2)
    return Finish(texture, (r * lift, g * lift, b * lift), 1.0, "green", "")


def pot(
    builder: ModelBuilder, rng: RandomStream, palette: Palette, radius: float, high: float
) -> None:
    """A pot with earth, standing on z = 0."""
    finish = rng.choice(
        (
            TERRACOTTA,
            CERAMIC,
            Finish("concrete", (0.6, 0.6, 0.58), 0.8, "gray", "stone"),
            Finish("wicker", (0.74, 0.58, 0.38), 0.2, "light brown", "wicker"),
            Finish("", plastic(palette.accent_hue).color, 1.0, palette.accent_hue, "ceramic"),
            Finish("", (0.12, 0.12, 0.13), 1.0, "black", "ceramic"),
        )
    )
    base = radius * rng.uniform(0.68, 0.9)
    rim = 0.03 if finish is TERRACOTTA else 0.012
    profile = [
        (0.0, 0.0),
        (base, 0.0),
        (radius * 0.97, high - rim * 1.5),
        (radius * 1.05, high - rim * 1.5),
        (radius * 1.06, high),
        (radius * 0.95, high),
        (radius * 0.92, high - 0.04),
    ]
    builder.add(finish, lathe(profile, sides=24))
    builder.add(_SOIL, lathe([(0.0, high - 0.025), (radius * 0.94, high - 0.03)][::-1], sides=20))


def snake_plant(rng: RandomStream, palette: Palette) -> Model:
    """A snake plant with upright leaves."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.12, 0.16), rng.uniform(0.22, 0.3)
    pot(builder, rng, palette, radius, high)
    turns = _spread(rng, rng.integer(14, 20))
    roots = [_polar(turn, rng.uniform(0.1, 0.75) * radius, high - 0.03) for turn in turns]
    swords = leaves(
        [rng.uniform(0.4, 0.72) for _ in turns],
        [rng.uniform(0.055, 0.08) for _ in turns],
        [rng.uniform(-4, 12) for _ in turns],
        [rng.uniform(74, 88) for _ in turns],
        turns,
        roots,
        fold=0.35,
        shape="sword",
    )
    builder.add(green(rng, "striped leaf"), swords)
    return _named(builder, "snake plant")


def _named(builder: ModelBuilder, species: str) -> Model:
    return builder.model("potted plant", "plant", species, attributes=("green",))


def leafy_plant(rng: RandomStream, palette: Palette) -> Model:
    """A rosette of broad leaves, like a peace lily or a fern."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.13, 0.18), rng.uniform(0.22, 0.34)
    pot(builder, rng, palette, radius, high)
    kind = rng.choice(("peace lily", "fern", "rubber plant"))
    foliage = green(rng)
    if kind == "fern":
        builder.add(foliage, rosette(rng, 46, 0.42, 0.055, "sword", (0, 0, high - 0.03)))
    elif kind == "peace lily":
        builder.add(foliage, rosette(rng, 30, 0.48, 0.14, "oval", (0, 0, high - 0.03)))
    else:
        builder.add(
            _BARK, rod((0, 0, high - 0.03), (0.02, 0.01, high + 0.6), 0.012, end_radius=0.007)
        )
        turns = _spread(rng, 21)
        stem = [(0.0, 0.0, high + 0.05 + 0.028 * k) for k in range(21)]
        part = leaves(
            [rng.uniform(0.2, 0.27) for _ in turns],
            [0.11] * 21,
            [40.0] * 21,
            [50.0] * 21,
            turns,
            stem,
        )
        builder.add(foliage, part)
    return _named(builder, kind)


def monstera(rng: RandomStream, palette: Palette) -> Model:
    """Long stalks with large heart-shaped leaves."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.15, 0.19), rng.uniform(0.28, 0.36)
    pot(builder, rng, palette, radius, high)
    stalks, tips, sizes = [], [], []
    turns = _spread(rng, rng.integer(14, 19))
    for k, turn in enumerate(turns):
        out, up = rng.uniform(0.1, 0.26), 0.2 + 0.5 * k / len(turns)
        tip = _polar(turn, out, high + up)
        stalks.append(
            tube(
                [_polar(turn, 0.03, high - 0.03), _polar(turn, out * 0.5, high + up * 0.65), tip],
                0.006,
                sides=5,
            )
        )
        tips.append(tip)
        sizes.append(rng.uniform(0.24, 0.33))
    foliage = green(rng)
    builder.add(foliage.tinted(0.9), join(stalks))
    part = leaves(
        sizes,
        [0.85 * s for s in sizes],
        [rng.uniform(30, 70) for _ in turns],
        [rng.uniform(0, 30) for _ in turns],
        turns,
        tips,
        fold=0.12,
        shape="heart",
    )
    builder.add(foliage, part)
    return _named(builder, "monstera")


def indoor_tree(rng: RandomStream, palette: Palette) -> Model:
    """A small tree: a fig with many small leaves, or a palm with fronds."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.16, 0.2), rng.uniform(0.28, 0.36)
    pot(builder, rng, palette, radius, high)
    foliage = green(rng)
    if rng.chance(0.5):
        trunk = rng.uniform(0.3, 0.45)
        part = tube(
            [(0, 0, high - 0.03), (0.02, 0.01, high + trunk * 0.5), (0, 0, high + trunk + 0.3)],
            [0.02, 0.017, 0.01],
        )
        builder.add(_BARK, part)
        crown = high + trunk + 0.32
        turns, positions = _spread(rng, 190), []
        for turn in turns:
            rise = rng.uniform(-1.0, 1.0)
            reach = math.sqrt(max(1.0 - rise * rise, 0.0)) * rng.uniform(0.55, 1.0) * 0.3
            positions.append(_polar(turn, reach, crown + rise * 0.34))
        part = leaves(
            [rng.uniform(0.09, 0.13) for _ in turns],
            [0.05] * 190,
            [40.0] * 190,
            [rng.uniform(-25, 50) for _ in turns],
            turns,
            positions,
            steps=3,
        )
        builder.add(foliage, part)
        return _named(builder, "ficus")
    fronds = []
    for turn in _spread(rng, 11):
        lift, long = rng.uniform(60, 86), rng.uniform(0.75, 1.0)
        fronds.append(
            _frond(long, lift, rng.uniform(60, 100)).turned(turn).moved(0, 0, high - 0.02)
        )
    builder.add(foliage, join(fronds))
    return _named(builder, "palm")


def small_plant(rng: RandomStream, palette: Palette) -> Model:
    """A little plant for tables and sills."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.055, 0.075), rng.uniform(0.09, 0.12)
    pot(builder, rng, palette, radius, high)
    kind = rng.choice(("succulent", "cactus", "herb"))
    if kind == "cactus":
        builder.add(
            green(rng, ""),
            ball(0.07, 0.07, 0.16, at=(0, 0, high + 0.05), sides=12),
            ball(0.035, 0.035, 0.07, at=(0.04, 0, high + 0.07), sides=8),
        )
    else:
        count, long, wide = (26, 0.09, 0.035) if kind == "succulent" else (34, 0.14, 0.04)
        builder.add(green(rng), rosette(rng, count, long, wide, "oval", (0, 0, high - 0.02)))
    return builder.model(
        kind, "plant", "small plant", "potted plant", attributes=("green", "small")
    )


def flower_vase(rng: RandomStream, palette: Palette) -> Model:
    """A vase with cut flowers."""
    builder = ModelBuilder()
    glaze = Finish(
        "",
        plastic(rng.choice((palette.accent_hue, "white", "blue", "teal"))).color,
        1.0,
        "",
        "ceramic",
    )
    high = rng.uniform(0.18, 0.26)
    profile = [
        (0.0, 0.0),
        (0.045, 0.0),
        (0.07, high * 0.35),
        (0.06, high * 0.7),
        (0.03, high * 0.9),
        (0.042, high),
        (0.03, high - 0.01),
    ]
    part = lathe(profile, sides=20, crease_deg=60)
    builder.add(glaze, part)
    ink = rng.choice(
        (
            (0.85, 0.2, 0.25),
            (0.95, 0.75, 0.2),
            (0.9, 0.55, 0.7),
            (0.95, 0.93, 0.88),
            (0.6, 0.35, 0.7),
        )
    )
    stems, heads, roots = [], [], []
    turns = _spread(rng, 9)
    for turn in turns:
        out, up = rng.uniform(0.03, 0.12), rng.uniform(0.12, 0.24)
        tip = _polar(turn, out, high + up)
        stems.append(rod((0, 0, high - 0.05), tip, 0.003, sides=5))
        heads.append(ball(0.05, 0.05, 0.035, at=tip, sides=8))
        roots.append(_polar(turn, out * 0.4, high + up * 0.3))
    stems.append(
        leaves(
            [0.1] * 9, [0.035] * 9, [30.0] * 9, [50.0] * 9, [t + 40 for t in turns], roots, steps=3
        )
    )
    builder.add(green(rng, ""), join(stems))
    builder.add(Finish("", ink), join(heads))
    return builder.model("vase", "flower vase", "vase with flowers", main=glaze)


def hedge_box(rng: RandomStream, palette: Palette) -> Model:
    """A long planter with dense green, for balconies."""
    builder = ModelBuilder()
    finish = palette.furniture_wood(rng)
    builder.add(finish, cushion(0.8, 0.26, 0.3, radius=0.01))
    foliage = green(rng)
    for k in range(5):
        builder.add(foliage, rosette(rng, 26, 0.2, 0.05, "oval", ((k - 2) * 0.15, 0, 0.28)))
    return builder.model("potted plant", "plant", "planter", attributes=("green",))
