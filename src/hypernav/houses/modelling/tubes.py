"""Round bars, straight and bent."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float64, Int64

from hypernav.houses.modelling.mesh import Mesh, Vector, join, unit_vectors
from hypernav.houses.modelling.solids import grid_faces
from hypernav.houses.modelling.surfaces import circle, cross, slopes


def tube(
    path: Sequence[tuple[float, float, float]] | Float64[np.ndarray, "n 3"],
    radius: float | Sequence[float],
    *,
    sides: int = 8,
    closed: bool = False,
    capped: bool = True,
) -> Mesh:
    """Round bar along a path.

    Args:
        path: Points of its centre line, metres.
        radius: Radius in metres, one for all points or one per point.
        sides: Number of segments around the path.
        closed: Whether the last point is joined to the first.
        capped: Whether open ends are closed by discs.
    """
    line = np.array(path, dtype=np.float64)
    if closed:
        line = np.concatenate([line, line[:1]])
    radii = np.broadcast_to(np.array(radius, dtype=np.float64), (len(path),))
    radii = np.concatenate([radii, radii[:1]]) if closed else radii
    forward = slopes(line)
    if closed:
        forward[0] = forward[-1] = line[1] - line[-2]
    forward = unit_vectors(forward)
    right = _transported(forward)
    up = cross(right, forward)
    cos, sin = circle(sides)
    around = right * cos[:, None, None] - up * sin[:, None, None]
    points = line + around * radii[:, None]
    uv = np.empty((sides + 1, len(line), 2))
    uv[..., 0] = np.linspace(0.0, 2.0 * math.pi * float(radii.max()), sides + 1)[:, None]
    step = line[1:] - line[:-1]
    uv[:, 0, 1] = 0.0
    uv[:, 1:, 1] = np.cumsum(np.sqrt((step * step).sum(axis=1)))
    mesh = Mesh(
        points.reshape(-1, 3),
        around.reshape(-1, 3),
        uv.reshape(-1, 2),
        grid_faces(*points.shape[:2]),
    )
    if closed or not capped:
        return mesh
    ends = [
        _disc(points[:-1, 0], line[0], -forward[0]),
        _disc(points[:-1, -1][::-1], line[-1], forward[-1]),
    ]
    return join([mesh, *ends])


def _transported(forward: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """Sideways direction at every point, transported in parallel along the path."""
    rows = []
    x, y, z = (1.0, 0.0, 0.0) if abs(forward[0][0]) < 0.9 else (0.0, 1.0, 0.0)
    for a, b, c in forward.tolist():
        along = x * a + y * b + z * c
        x, y, z = x - a * along, y - b * along, z - c * along
        length = math.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
        rows.append((x, y, z))
    return np.array(rows)


def _disc(
    ring: Float64[np.ndarray, "n 3"],
    middle: Float64[np.ndarray, "3"],
    normal: Float64[np.ndarray, "3"],
) -> Mesh:
    n = len(ring)
    k = np.arange(n, dtype=np.int64)
    faces = np.stack([np.full(n, n, dtype=np.int64), (k + 1) % n, k], axis=1)
    return Mesh(
        np.concatenate([ring, middle[None]]),
        np.tile(normal, (n + 1, 1)),
        np.zeros((n + 1, 2)),
        faces,
    )


def rod(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    radius: float,
    *,
    end_radius: float | None = None,
    sides: int = 8,
) -> Mesh:
    """Straight round bar, tapered if the radii differ."""
    radii = (radius, radius if end_radius is None else end_radius)
    low, high = np.array(start), np.array(end)
    axis = unit_vectors(high - low)
    side, up = (np.array(v) for v in _beside(*axis.tolist()))
    cos, sin = circle(sides)
    around = side * cos[:, None] - up * sin[:, None]
    n = sides + 1
    positions = np.empty((4 * n + 2, 3))
    positions[:n], positions[n : 2 * n] = low + around * radii[0], high + around * radii[1]
    positions[2 * n : 4 * n] = positions[: 2 * n]
    positions[4 * n], positions[4 * n + 1] = low, high
    normals = np.empty_like(positions)
    normals[:n] = normals[n : 2 * n] = around
    normals[2 * n : 3 * n] = normals[4 * n] = -axis
    normals[3 * n : 4 * n] = normals[4 * n + 1] = axis
    uv = np.zeros((len(positions), 2))
    uv[:n, 0] = uv[n : 2 * n, 0] = np.arange(n) * (2.0 * math.pi * max(radii) / sides)
    length = high - low
    uv[n : 2 * n, 1] = math.sqrt(float((length * length).sum()))
    return Mesh(positions, normals, uv, _rod_faces(sides))


def _beside(x: float, y: float, z: float) -> tuple[Vector, Vector]:
    """Two directions at right angles to a direction and to each other."""
    a, b, c = (1.0, 0.0, 0.0) if abs(x) < 0.9 else (0.0, 1.0, 0.0)
    along = a * x + b * y + c * z
    a, b, c = a - x * along, b - y * along, c - z * along
    length = math.sqrt(a * a + b * b + c * c)
    a, b, c = a / length, b / length, c / length
    return (a, b, c), (b * z - c * y, c * x - a * z, a * y - b * x)


@lru_cache(maxsize=32)
def _rod_faces(sides: int) -> Int64[np.ndarray, "faces 3"]:
    n = sides + 1
    k = np.arange(sides, dtype=np.int64)
    wall = [np.stack([k, k + 1, k + n + 1], axis=1), np.stack([k, k + n + 1, k + n], axis=1)]
    low = np.stack([np.full(sides, 4 * n), k + 2 * n + 1, k + 2 * n], axis=1)
    high = np.stack([np.full(sides, 4 * n + 1), k + 3 * n, k + 3 * n + 1], axis=1)
    faces = np.concatenate([*wall, low, high])
    faces.flags.writeable = False
    return faces
