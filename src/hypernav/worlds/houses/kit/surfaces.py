"""Round things: surfaces of revolution, tubes, spheres and curved sheets."""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.houses.kit.mesh import Mesh, join, unit_vectors
from hypernav.worlds.houses.kit.solids import grid_faces


def sheet(
    points: Float64[np.ndarray, "nu nv 3"], *, closed_u: bool = False, fit: bool = False
) -> Mesh:
    """A curved surface through a grid of points, shaded smoothly, facing u × v.

    Args:
        points: Grid of positions, metres.
        closed_u: Whether the last row continues at the first (repeat the first row at the end).
        fit: Texture coordinates from 0 to 1 instead of metres.
    """
    nu, nv = points.shape[:2]
    du = np.gradient(points, axis=0)
    if closed_u:
        du[0] = du[-1] = (points[1] - points[-2]) / 2.0
    dv = np.gradient(points, axis=1)
    normals = unit_vectors(np.cross(du, dv))
    if fit:
        u = np.linspace(0.0, 1.0, nu)[:, None] + np.zeros((1, nv))
        v = np.zeros((nu, 1)) + np.linspace(0.0, 1.0, nv)[None, :]
    else:
        u, v = _lengths(points, 0), _lengths(points, 1)
    uv = np.stack([u, v], axis=-1)
    return Mesh(
        points.reshape(-1, 3), normals.reshape(-1, 3), uv.reshape(-1, 2), grid_faces(nu, nv)
    )


def _lengths(points: Float64[np.ndarray, "nu nv 3"], axis: int) -> Float64[np.ndarray, "nu nv"]:
    """Length along an axis, averaged over the other, so that texture lines stay parallel."""
    step = np.diff(points, axis=axis)
    length = np.sqrt((step * step).sum(axis=-1)).mean(axis=1 - axis)
    total = np.concatenate([[0.0], np.cumsum(length)])
    return total[:, None] + np.zeros(points.shape[:2]) if axis == 0 else total[None, :] + np.zeros(
        points.shape[:2]
    )


def lathe(
    profile: Sequence[tuple[float, float]], *, sides: int = 20, crease_deg: float = 35.0
) -> Mesh:
    """A surface of revolution about z.

    Args:
        profile: ``(radius, z)`` from bottom to top along the outside.
        sides: Around.
        crease_deg: A bend sharper than this stays sharp.
    """
    points = [np.array(p, dtype=np.float64) for p in profile]
    runs: list[list[Float64[np.ndarray, "2"]]] = [[points[0]]]
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
    angles = [2.0 * math.pi * k / sides for k in range(sides + 1)]
    cos = np.array([math.cos(a) for a in angles])
    sin = np.array([math.sin(a) for a in angles])
    cos[-1], sin[-1] = cos[0], sin[0]
    slope = np.gradient(run, axis=0) if len(run) > 2 else np.repeat(run[1:] - run[:1], 2, axis=0)
    normal_r, normal_z = slope[:, 1], -slope[:, 0]
    radius, z = run[:, 0], run[:, 1]
    positions = np.stack(
        [radius * cos[:, None], radius * sin[:, None], z + 0.0 * cos[:, None]], axis=-1
    )
    normals = unit_vectors(
        np.stack(
            [normal_r * cos[:, None], normal_r * sin[:, None], normal_z + 0.0 * cos[:, None]],
            axis=-1,
        )
    )
    step = np.diff(run, axis=0)
    along = np.concatenate([[0.0], np.cumsum(np.sqrt((step * step).sum(axis=1)))])
    around = 2.0 * math.pi * max(float(radius.mean()), 1e-3) * np.linspace(0.0, 1.0, sides + 1)
    uv = np.stack([around[:, None] + 0.0 * along, along + 0.0 * around[:, None]], axis=-1)
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
    """A cylinder or cone frustum that stands on ``at``, closed above and below."""
    top = radius if top_radius is None else top_radius
    b = min(bevel, height * 0.4, radius * 0.5, top * 0.5)
    profile = [(0.0, 0.0), (radius - b, 0.0)]
    if b > 0.0:
        profile += [(radius, b), (top, height - b)]
    else:
        profile += [(radius, 0.0), (top, height)] if radius != profile[-1][0] else [(top, height)]
    profile += [(top - b, height), (0.0, height)] if b > 0.0 else [(0.0, height)]
    return lathe(profile, sides=sides, crease_deg=50.0 if b > 0.0 else 35.0).moved(*at)


def ball(
    x: float, y: float, z: float, *, at: tuple[float, float, float] = (0.0, 0.0, 0.0), sides: int = 16
) -> Mesh:
    """An ellipsoid with these diameters around ``at``."""
    rings = max(sides // 2, 3)
    profile = [
        (math.sin(math.pi * k / rings), -math.cos(math.pi * k / rings)) for k in range(rings + 1)
    ]
    profile[0], profile[-1] = (0.0, -1.0), (0.0, 1.0)
    sphere = lathe(profile, sides=sides, crease_deg=80.0)
    return Mesh(sphere.positions, sphere.positions, sphere.uv / 2.0, sphere.faces).scaled(
        x / 2.0, y / 2.0, z / 2.0
    ).moved(*at)


def tube(
    path: Sequence[tuple[float, float, float]] | Float64[np.ndarray, "n 3"],
    radius: float | Sequence[float],
    *,
    sides: int = 8,
    closed: bool = False,
    capped: bool = True,
) -> Mesh:
    """A round bar along a path.

    Args:
        path: Points of its middle line, metres.
        radius: One for all, or one per point.
        sides: Around.
        closed: Whether the end joins the beginning.
        capped: Whether open ends are closed by discs.
    """
    line = np.array(path, dtype=np.float64)
    if closed:
        line = np.concatenate([line, line[:1]])
    radii = np.broadcast_to(np.array(radius, dtype=np.float64), (len(path),))
    radii = np.concatenate([radii, radii[:1]]) if closed else radii
    forward = np.gradient(line, axis=0) if len(line) > 2 else np.repeat(line[1:] - line[:1], 2, 0)
    if closed:
        forward[0] = forward[-1] = line[1] - line[-2]
    forward = unit_vectors(forward)
    right = _transported(forward)
    up = np.cross(right, forward)
    angles = [2.0 * math.pi * k / sides for k in range(sides + 1)]
    cos = np.array([math.cos(a) for a in angles])[:, None, None]
    sin = np.array([math.sin(a) for a in angles])[:, None, None]
    around = right * cos - up * sin
    around[-1] = around[0]
    points = line + around * radii[:, None]
    mesh = sheet(points, closed_u=True)
    mesh = Mesh(mesh.positions, around.reshape(-1, 3), mesh.uv, mesh.faces)
    if closed or not capped:
        return mesh
    ends = [
        _disc(points[:-1, 0], line[0], -forward[0]),
        _disc(points[:-1, -1][::-1], line[-1], forward[-1]),
    ]
    return join([mesh, *ends])


def _transported(forward: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """A sideways direction at every point that never twists about the path."""
    rows = []
    side = np.array([1.0, 0.0, 0.0]) if abs(forward[0][0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    for direction in forward:
        side = side - direction * float((side * direction).sum())
        side = unit_vectors(side)
        rows.append(side)
    return np.array(rows)


def _disc(
    ring: Float64[np.ndarray, "n 3"], middle: Float64[np.ndarray, "3"], normal: Float64[np.ndarray, "3"]
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
    """A straight round bar, tapered if the radii differ."""
    return tube([start, end], [radius, radius if end_radius is None else end_radius], sides=sides)


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
    """A rectangle with round corners around the origin, counter-clockwise."""
    hx, hy = x / 2.0 - radius, y / 2.0 - radius
    corners = (((hx, hy), 0), ((-hx, hy), 90), ((-hx, -hy), 180), ((hx, -hy), 270))
    return [p for c, a in corners for p in arc(c, radius, a, a + 90, steps + 1)]
