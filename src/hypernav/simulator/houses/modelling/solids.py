"""Boxes, prisms and cushions."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float64, Int64

from hypernav.simulator.houses.modelling.model import Mesh, unit_vectors

_SMOOTH_DEG = 30.0
"""Greatest angle between sides of a prism that are shaded as one round side."""
_CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
# The axes that texture coordinates run along on the sides across each axis.
_UV_AXES = ((1, 2), (0, 2), (0, 1))
# Every corner of a box is three vertices, one for each side that meets there.
_OWN = np.arange(3)[None, :] == np.tile(np.arange(3), 8)[:, None]
_SIGNS = np.repeat(_CORNERS, 3, axis=0)
_INSET = np.where(_OWN, 0.0, 1.0)
_FLAT_NORMALS = np.where(_OWN, _SIGNS, 0.0)
_CORNER_UV = np.array(_UV_AXES)[np.tile(np.arange(3), 8)]


@lru_cache(maxsize=1)
def _bevelled_topology() -> tuple[Int64[np.ndarray, "flat 3"], Int64[np.ndarray, "bevel 3"]]:
    """Triangles over vertices numbered ``3 * corner + axis``: six sides; sides and bevels."""

    def wound(vertices: list[int], outward: Float64[np.ndarray, "3"]) -> list[list[int]]:
        points = [_CORNERS[v // 3] * np.where(np.arange(3) == v % 3, 1.0, 0.9) for v in vertices]
        normal = np.cross(points[1] - points[0], points[2] - points[0])
        order = vertices if float((normal * outward).sum()) > 0 else vertices[::-1]
        return [[order[0], order[i], order[i + 1]] for i in range(1, len(order) - 1)]

    def ring(corners: list[int], axis: int) -> list[int]:
        u, v = _UV_AXES[axis]
        by_angle = sorted(corners, key=lambda c: math.atan2(_CORNERS[c][v], _CORNERS[c][u]))
        return [3 * c + axis for c in by_angle]

    flat: list[list[int]] = []
    bevel: list[list[int]] = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            corners = [c for c in range(8) if _CORNERS[c][axis] == sign]
            flat += wound(ring(corners, axis), np.eye(3)[axis] * sign)
    for along in range(3):
        a, b = (k for k in range(3) if k != along)
        for sa in (-1.0, 1.0):
            for sb in (-1.0, 1.0):
                low, high = (c for c in range(8) if _CORNERS[c][a] == sa and _CORNERS[c][b] == sb)
                quad = [3 * low + a, 3 * low + b, 3 * high + b, 3 * high + a]
                bevel += wound(quad, np.eye(3)[a] * sa + np.eye(3)[b] * sb)
    for corner in range(8):
        bevel += wound([3 * corner, 3 * corner + 1, 3 * corner + 2], _CORNERS[corner])
    return np.array(flat, dtype=np.int64), np.array(flat + bevel, dtype=np.int64)


def box(
    x: float,
    y: float,
    z: float,
    *,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    bevel: float = 0.0,
) -> Mesh:
    """Box that stands on ``at``: centred in x and y, rising from ``at[2]``.

    Args:
        x: Width, metres.
        y: Depth, metres.
        z: Height, metres.
        at: Centre of its lower side.
        bevel: Width of the rounded edges, metres; 0 for sharp edges.
    """
    half = np.array([x, y, z]) / 2.0
    inset = np.minimum(bevel, half * 0.49)
    positions = _SIGNS * (half - _INSET * inset)
    uv = np.take_along_axis(positions + half, _CORNER_UV, axis=1)
    flat, bevels = _bevelled_topology()
    faces = bevels if bevel > 0.0 else flat
    return Mesh(positions + np.array((at[0], at[1], at[2] + half[2])), _FLAT_NORMALS, uv, faces)


def panel(x: float, z: float, *, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mesh:
    """Upright rectangle that faces +y and stands on ``at``, with an image fitted to it.

    Texture coordinates run from 0 to 1, upright and not mirrored for a viewer in front of it.
    """
    h = x / 2.0
    positions = np.array([[h, 0.0, 0.0], [-h, 0.0, 0.0], [-h, 0.0, z], [h, 0.0, z]]) + at
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    normals = np.tile([0.0, 1.0, 0.0], (4, 1))
    return Mesh(positions, normals, uv, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64))


def tile(x: float, y: float, *, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mesh:
    """Level rectangle that faces up, with an image fitted to it (u along x, v along y)."""
    hx, hy = x / 2.0, y / 2.0
    positions = np.array([[-hx, -hy, 0.0], [hx, -hy, 0.0], [hx, hy, 0.0], [-hx, hy, 0.0]]) + at
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    return Mesh(positions, normals, uv, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64))


def _rounded_grid_lines(half: float, radius: float, rounds: int, flats: int) -> list[float]:
    inner = half - radius
    edge = [inner + radius * math.tan(math.pi / 4.0 * k / rounds) for k in range(1, rounds + 1)]
    middle = [-inner + 2.0 * inner * k / flats for k in range(flats + 1)]
    return [-e for e in reversed(edge)] + middle + edge


def cushion(
    x: float,
    y: float,
    z: float,
    *,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    radius: float = 0.05,
    puff: float = 0.0,
    rounds: int = 2,
    flats: int = 1,
) -> Mesh:
    """Box with round edges, as of upholstery, that stands on ``at``.

    Args:
        x: Width, metres.
        y: Depth, metres.
        z: Height, metres.
        at: Centre of its lower side.
        radius: Radius of the edges, metres.
        puff: Bulge of the top beyond the box, metres; needs ``flats`` above 1 to show.
        rounds: Number of segments of an edge's half arc.
        flats: Number of segments of the flat part.
    """
    return _cushion(x, y, z, radius, puff, rounds, flats).moved(*at)


@lru_cache(maxsize=512)
def _cushion(
    x: float, y: float, z: float, radius: float, puff: float, rounds: int, flats: int
) -> Mesh:
    half = np.array([x, y, z]) / 2.0
    radius = min(radius, float(half.min()) * 0.98)
    sides = []
    for axis in range(3):
        u_axis, v_axis = _UV_AXES[axis]
        u = np.array(_rounded_grid_lines(float(half[u_axis]), radius, rounds, flats))
        v = np.array(_rounded_grid_lines(float(half[v_axis]), radius, rounds, flats))
        for sign in (-1.0, 1.0):
            grid = np.zeros((len(u), len(v), 3))
            grid[..., u_axis] = u[:, None]
            grid[..., v_axis] = v[None, :]
            grid[..., axis] = sign * half[axis]
            sides.append((grid, axis, sign))
    meshes = [_rounded_side(grid, axis, sign, half, radius) for grid, axis, sign in sides]
    positions = np.concatenate([m.positions for m in meshes])
    normals = np.concatenate([m.normals for m in meshes])
    if puff:
        fx = 1.0 - np.minimum(np.abs(positions[:, 0] / half[0]), 1.0) ** 2
        fy = 1.0 - np.minimum(np.abs(positions[:, 1] / half[1]), 1.0) ** 2
        lift = np.where(positions[:, 2] > 0.0, puff, puff * 0.3) * fx * fy
        slope_x = 2.0 * puff * positions[:, 0] / half[0] ** 2 * fy
        slope_y = 2.0 * puff * positions[:, 1] / half[1] ** 2 * fx
        facing = np.sign(normals[:, 2]) * normals[:, 2] ** 2
        positions[:, 2] += lift * np.sign(positions[:, 2])
        normals = unit_vectors(
            normals + np.stack([slope_x * np.abs(facing), slope_y * np.abs(facing), 0 * fx], axis=1)
        )
    starts = np.cumsum([0] + [len(m.positions) for m in meshes[:-1]])
    faces = np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)])
    uv = np.concatenate([m.uv for m in meshes])
    return Mesh(positions + np.array((0.0, 0.0, half[2])), normals, uv, faces)


def _rounded_side(
    grid: Float64[np.ndarray, "nu nv 3"],
    axis: int,
    sign: float,
    half: Float64[np.ndarray, "3"],
    radius: float,
) -> Mesh:
    points = grid.reshape(-1, 3)
    inner = np.clip(points, -(half - radius), half - radius)
    normals = unit_vectors(points - inner)
    positions = inner + radius * normals
    uv = (points + half)[:, list(_UV_AXES[axis])]
    faces = grid_faces(grid.shape[0], grid.shape[1])
    if (sign > 0) == (axis == 1):
        faces = faces[:, ::-1]
    return Mesh(positions, normals, uv, faces)


@lru_cache(maxsize=512)
def grid_faces(nu: int, nv: int) -> Int64[np.ndarray, "faces 3"]:
    """Triangles of a grid of vertices ``[u, v]``, counter-clockwise seen against u × v."""
    i = np.arange(nu - 1)[:, None] * nv + np.arange(nv - 1)[None, :]
    i = i.reshape(-1).astype(np.int64)
    faces = np.concatenate(
        [np.stack([i, i + nv, i + nv + 1], axis=1), np.stack([i, i + nv + 1, i + 1], axis=1)]
    )
    faces.flags.writeable = False
    return faces


def prism(outline: Sequence[tuple[float, float]], height: float, *, z: float = 0.0) -> Mesh:
    """Prism over a polygon in the xy plane.

    Args:
        outline: Corners of the polygon, metres, counter-clockwise; may be concave, must not cross
            itself.
        height: Height of the prism, metres.
        z: Height of its lower side, metres.
    """
    points = np.array(outline, dtype=np.float64)
    n = len(points)
    following = np.roll(points, -1, axis=0)
    edge = following - points
    length = np.sqrt((edge * edge).sum(axis=1))
    side = np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.maximum(length, 1e-12)[:, None]
    before = np.roll(side, 1, axis=0)
    smooth = (side * before).sum(axis=1) > math.cos(math.radians(_SMOOTH_DEG))
    start = np.where(smooth[:, None], side + before, side)
    end_smooth, after = np.roll(smooth, -1), np.roll(side, -1, axis=0)
    end = np.where(end_smooth[:, None], side + after, side)
    along = np.concatenate([[0.0], np.cumsum(length)])

    def quad_rows(xy: np.ndarray, level: float) -> np.ndarray:
        return np.column_stack([xy, np.full(n, level)])

    positions = np.concatenate(
        [
            quad_rows(points, z),
            quad_rows(following, z),
            quad_rows(following, z + height),
            quad_rows(points, z + height),
            quad_rows(points, z + height),
            quad_rows(points, z),
        ]
    )
    flat = np.zeros(n)
    normals = unit_vectors(
        np.concatenate(
            [np.column_stack([v, flat]) for v in (start, end, end, start)]
            + [np.tile([0.0, 0.0, s], (n, 1)) for s in (1.0, -1.0)]
        )
    )
    uv = np.concatenate(
        [
            np.column_stack([along[:-1], flat]),
            np.column_stack([along[1:], flat]),
            np.column_stack([along[1:], flat + height]),
            np.column_stack([along[:-1], flat + height]),
            points,
            points,
        ]
    )
    k = np.arange(n, dtype=np.int64)
    sides = np.concatenate(
        [np.stack([k, k + n, k + 2 * n], axis=1), np.stack([k, k + 2 * n, k + 3 * n], axis=1)]
    )
    cap = np.array(_ear_clip([(float(x), float(y)) for x, y in points]), dtype=np.int64)
    return Mesh(positions, normals, uv, np.concatenate([sides, cap + 4 * n, cap[:, ::-1] + 5 * n]))


def _ear_clip(points: list[tuple[float, float]]) -> list[tuple[int, int, int]]:
    def turn(a: int, b: int, c: int) -> float:
        (ax, ay), (bx, by), (cx, cy) = points[a], points[b], points[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    def holds(a: int, b: int, c: int, p: int) -> bool:
        return turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0

    left = list(range(len(points)))
    triangles = []
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            if turn(a, b, c) <= 0 or any(holds(a, b, c, p) for p in left if p not in (a, b, c)):
                continue
            triangles.append((a, b, c))
            left.pop(i)
            break
        else:
            break  # only slivers without area are left
    if len(left) == 3:
        triangles.append((left[0], left[1], left[2]))
    return triangles
