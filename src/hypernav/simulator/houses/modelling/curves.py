"""Curved surfaces: surfaces of revolution, ellipsoids, sheets, rounded outlines, round bars."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float64, Int64

from hypernav.simulator.houses.modelling.model import Mesh, Vector, join, unit_vectors
from hypernav.simulator.houses.modelling.solids import grid_faces


def sheet(points: Float64[np.ndarray, "nu nv 3"], *, closed_u: bool = False) -> Mesh:
    """Curved surface through a grid of points, shaded smoothly, facing u × v.

    Args:
        points: Grid of points, metres.
        closed_u: Whether the last row continues at the first (repeat the first row at the end).
    """
    nu, nv = points.shape[:2]
    du = slopes(points)
    if closed_u:
        du[0] = du[-1] = points[1] - points[-2]
    dv = slopes(points.transpose(1, 0, 2)).transpose(1, 0, 2)
    normals = unit_vectors(cross(du, dv))
    uv = np.stack([_lengths(points, 0), _lengths(points, 1)], axis=-1)
    return Mesh(
        points.reshape(-1, 3), normals.reshape(-1, 3), uv.reshape(-1, 2), grid_faces(nu, nv)
    )


def slopes(points: Float64[np.ndarray, "n ..."]) -> Float64[np.ndarray, "n ..."]:
    """Finite differences along the first axis: central inside, one-sided at both ends."""
    slopes = np.empty_like(points)
    slopes[1:-1] = points[2:] - points[:-2]
    slopes[0] = points[1] - points[0]
    slopes[-1] = points[-1] - points[-2]
    return slopes


def cross(
    a: Float64[np.ndarray, "*n 3"], b: Float64[np.ndarray, "*n 3"]
) -> Float64[np.ndarray, "*n 3"]:
    """Cross product of vectors."""
    result = np.empty(a.shape)
    result[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    result[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    result[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result


@lru_cache(maxsize=64)
def circle(sides: int) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "n"]]:
    """Cosines and sines of a full circle; the last values equal the first."""
    angles = [2.0 * math.pi * k / sides for k in range(sides)]
    cos = np.array([math.cos(a) for a in angles] + [1.0])
    sin = np.array([math.sin(a) for a in angles] + [0.0])
    return cos, sin


def _lengths(points: Float64[np.ndarray, "nu nv 3"], axis: int) -> Float64[np.ndarray, "nu nv"]:
    """Length along an axis, averaged over the other, so that texture lines stay parallel."""
    step = np.diff(points, axis=axis)
    length = np.sqrt((step * step).sum(axis=-1)).mean(axis=1 - axis)
    total = np.concatenate([[0.0], np.cumsum(length)])
    return (
        total[:, None] + np.zeros(points.shape[:2])
        if axis == 0
        else total[None, :] + np.zeros(points.shape[:2])
    )


def lathe(
    profile: Sequence[tuple[float, float]], *, sides: int = 20, crease_deg: float = 35.0
) -> Mesh:
    """Surface of revolution about z.

    Args:
        profile: ``(radius, z)`` from bottom to top along the outside.
        sides: Number of segments around the axis.
        crease_deg: Smallest angle of the profile that is shaded as a sharp edge, degrees.
    """
    return _lathe(tuple((float(r), float(z)) for r, z in profile), sides, crease_deg)


@lru_cache(maxsize=1024)
def _lathe(profile: tuple[tuple[float, float], ...], sides: int, crease_deg: float) -> Mesh:
    points = [np.array(p, dtype=np.float64) for p in profile]
    runs: list[list[Float64[np.ndarray, 2]]] = [[points[0]]]
    for before, here, after in zip(points, points[1:], [*points[2:], None], strict=False):
        runs[-1].append(here)
        if after is None:
            break
        a, b = here - before, after - here
        cos = float((a * b).sum()) / max(math.hypot(*a) * math.hypot(*b), 1e-12)
        if cos < math.cos(math.radians(crease_deg)):
            runs.append([here])
    return join(_revolve(np.array(run), sides) for run in runs)


def _revolve(run: Float64[np.ndarray, "n 2"], sides: int) -> Mesh:
    cos, sin = circle(sides)
    slope = slopes(run)
    normal_r, normal_z = slope[:, 1], -slope[:, 0]
    radius, z = run[:, 0], run[:, 1]
    positions = np.empty((sides + 1, len(run), 3))
    positions[..., 0], positions[..., 1] = radius * cos[:, None], radius * sin[:, None]
    positions[..., 2] = z
    length = np.sqrt(normal_r * normal_r + normal_z * normal_z) + 1e-12
    normals = np.empty_like(positions)
    normals[..., 0], normals[..., 1] = (
        normal_r / length * cos[:, None],
        normal_r / length * sin[:, None],
    )
    normals[..., 2] = normal_z / length
    step = np.diff(run, axis=0)
    along = np.concatenate([[0.0], np.cumsum(np.sqrt((step * step).sum(axis=1)))])
    around = 2.0 * math.pi * max(float(radius.mean()), 1e-3) * np.linspace(0.0, 1.0, sides + 1)
    uv = np.empty((sides + 1, len(run), 2))
    uv[..., 0], uv[..., 1] = around[:, None], along
    return Mesh(
        positions.reshape(-1, 3),
        normals.reshape(-1, 3),
        uv.reshape(-1, 2),
        grid_faces(sides + 1, len(run)),
    )


def cylinder(
    radius: float,
    height: float,
    *,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    sides: int = 16,
    top_radius: float | None = None,
    bevel: float = 0.0,
) -> Mesh:
    """Cylinder or cone frustum that stands on ``at``, closed above and below."""
    top = radius if top_radius is None else top_radius
    b = min(bevel, height * 0.4, radius * 0.5, top * 0.5)
    profile = [(0.0, 0.0), (radius - b, 0.0)]
    if b > 0.0:
        profile += [(radius, b), (top, height - b)]
    else:
        profile.append((top, height))
    profile += [(top - b, height), (0.0, height)] if b > 0.0 else [(0.0, height)]
    return lathe(profile, sides=sides, crease_deg=50.0 if b > 0.0 else 35.0).moved(*at)


def ball(
    x: float,
    y: float,
    z: float,
    *,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    sides: int = 16,
) -> Mesh:
    """Ellipsoid of three diameters (metres) around ``at``."""
    rings = max(sides // 2, 3)
    profile = [
        (math.sin(math.pi * k / rings), -math.cos(math.pi * k / rings)) for k in range(rings + 1)
    ]
    profile[0], profile[-1] = (0.0, -1.0), (0.0, 1.0)
    sphere = lathe(profile, sides=sides, crease_deg=80.0)
    return (
        Mesh(sphere.positions, sphere.positions, sphere.uv / 2.0, sphere.faces)
        .scaled(x / 2.0, y / 2.0, z / 2.0)
        .moved(*at)
    )


def arc(
    middle: tuple[float, float], radius: float, start_deg: float, end_deg: float, count: int
) -> list[tuple[float, float]]:
    """Points of a circular arc in a plane, both ends included."""
    angles = [
        math.radians(start_deg + (end_deg - start_deg) * k / (count - 1)) for k in range(count)
    ]
    return [(middle[0] + radius * math.cos(a), middle[1] + radius * math.sin(a)) for a in angles]


def rounded_outline(x: float, y: float, radius: float, steps: int = 4) -> list[tuple[float, float]]:
    """Outline of a rectangle with round corners around the origin, counter-clockwise."""
    hx, hy = x / 2.0 - radius, y / 2.0 - radius
    corners = (((hx, hy), 0), ((-hx, hy), 90), ((-hx, -hy), 180), ((hx, -hy), 270))
    return [p for c, a in corners for p in arc(c, radius, a, a + 90, steps + 1)]


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
