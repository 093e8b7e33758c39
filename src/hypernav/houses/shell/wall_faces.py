"""Faces of walls with holes for doors and windows."""

from collections.abc import Sequence

import numpy as np

from hypernav.houses.modelling.mesh import Mesh, join

Hole = tuple[float, float, float, float]
"""Hole in a wall: ``(start, end, bottom, top)``, metres along the wall and in height."""


def quad(corners: Sequence[tuple[float, float, float]], facing: tuple[float, float, float]) -> Mesh:
    """Rectangle from its four corners in order; texture coordinates are metres of the scene."""
    points = np.array(corners, dtype=np.float64)
    normal = np.array(facing, dtype=np.float64)
    turn = np.cross(points[1] - points[0], points[2] - points[0])
    if float((turn * normal).sum()) < 0:
        points = points[::-1]
    # Grain and tiles run along the longer horizontal axis of floors, upright on walls.
    axis = int(np.abs(normal).argmax())
    u, v = ((1, 2), (0, 2), (0, 1))[axis]
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64)
    return Mesh(points, np.tile(normal, (4, 1)), points[:, [u, v]], faces)


def floor_quad(x0: float, y0: float, x1: float, y1: float, z: float, *, up: bool = True) -> Mesh:
    """Level rectangle that faces up or down."""
    corners = [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]
    return quad(corners, (0.0, 0.0, 1.0 if up else -1.0))


def wall_rects(start: float, end: float, high: float, holes: Sequence[Hole]) -> list[Hole]:
    """Rectangles of a wall from ``start`` to ``end`` around its holes."""
    rects: list[Hole] = []
    at = start
    for a, b, bottom, top in sorted(holes):
        a, b = max(a, start), min(b, end)
        if a > at:
            rects.append((at, a, 0.0, high))
        if bottom > 0.0:
            rects.append((a, b, 0.0, bottom))
        if top < high:
            rects.append((a, b, top, high))
        at = b
    if at < end:
        rects.append((at, end, 0.0, high))
    return rects


def wall_face(
    along: str, at: float, side: float, start: float, end: float, high: float, holes: Sequence[Hole]
) -> Mesh:
    """Visible face of a wall.

    Args:
        along: Axis that the wall runs along, "x" or "y".
        at: Coordinate of the face: y if the wall runs along x, else x.
        side: Direction that it faces: 1 to larger, -1 to smaller coordinates.
        start: Lower end along the wall.
        end: Upper end along the wall.
        high: Height of the wall, metres.
        holes: Holes in the wall.
    """
    meshes = []
    for a, b, low, top in wall_rects(start, end, high, holes):
        corners = [
            wall_point(along, a, at, low),
            wall_point(along, b, at, low),
            wall_point(along, b, at, top),
            wall_point(along, a, at, top),
        ]
        meshes.append(quad(corners, (0.0, side, 0.0) if along == "x" else (side, 0.0, 0.0)))
    return join(meshes)


def wall_point(along: str, t: float, across: float, z: float) -> tuple[float, float, float]:
    """Point at ``t`` along a wall and ``across`` it."""
    return (t, across, z) if along == "x" else (across, t, z)


def reveal(along: str, low: float, high: float, hole: Hole, *, sill: bool) -> Mesh:
    """Inner faces (reveal) of a hole through a wall between two planes."""
    a, b, bottom, top = hole
    meshes = []
    for t, side in ((a, 1.0), (b, -1.0)):
        corners = [
            wall_point(along, t, low, bottom),
            wall_point(along, t, high, bottom),
            wall_point(along, t, high, top),
            wall_point(along, t, low, top),
        ]
        meshes.append(quad(corners, (side, 0.0, 0.0) if along == "x" else (0.0, side, 0.0)))
    levels = [(top, -1.0)] + ([(bottom, 1.0)] if sill else [])
    for z, side in levels:
        corners = [
            wall_point(along, a, low, z),
            wall_point(along, b, low, z),
            wall_point(along, b, high, z),
            wall_point(along, a, high, z),
        ]
        meshes.append(quad(corners, (0.0, 0.0, side)))
    return join(meshes)
