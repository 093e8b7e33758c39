"""Meshes of leaves, single and in rosettes."""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.houses.modelling.mesh import Finish, Mesh, Vector, join, unit_vectors
from hypernav.houses.modelling.solids import grid_faces
from hypernav.houses.modelling.surfaces import cross
from hypernav.houses.modelling.tubes import tube
from hypernav.houses.random_stream import RandomStream

_GREENS = ((0.2, 0.43, 0.16), (0.27, 0.5, 0.2), (0.16, 0.36, 0.17), (0.38, 0.56, 0.25))


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
