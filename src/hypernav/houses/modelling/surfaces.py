"""Curved surfaces: surfaces of revolution, ellipsoids, sheets, rounded outlines."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float64

from hypernav.houses.modelling.mesh import Mesh, join, unit_vectors
from hypernav.houses.modelling.solids import grid_faces


def sheet(
    points: Float64[np.ndarray, "nu nv 3"], *, closed_u: bool = False, fit: bool = False
) -> Mesh:
    """Curved surface through a grid of points, shaded smoothly, facing u × v.

    Args:
        points: Grid of points, metres.
        closed_u: Whether the last row continues at the first (repeat the first row at the end).
        fit: Whether texture coordinates run from 0 to 1 instead of in metres.
    """
    nu, nv = points.shape[:2]
    du = slopes(points)
    if closed_u:
        du[0] = du[-1] = points[1] - points[-2]
    dv = slopes(points.transpose(1, 0, 2)).transpose(1, 0, 2)
    normals = unit_vectors(cross(du, dv))
    if fit:
        u = np.linspace(0.0, 1.0, nu)[:, None] + np.zeros((1, nv))
        v = np.zeros((nu, 1)) + np.linspace(0.0, 1.0, nv)[None, :]
    else:
        u, v = _lengths(points, 0), _lengths(points, 1)
    uv = np.stack([u, v], axis=-1)
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
    middle: tuple[float, float],
    radius: float,
    start_deg: float,
    end_deg: float,
    count: int,
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
