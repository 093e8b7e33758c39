"""Grounds that reach far beyond a building: they are cut to it.

A simulated world often stands on a ground of a hundred metres. It may be the only floor there is,
so it can't be left out whole; but a robot shall not search the plain around the building.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.worlds.scenes.scene_assembly import MeshPart

_LEAST_SIDE_M, _MOST_HEIGHT_M = 50.0, 1.0
_TIMES_THE_REST = 4.0
_MOST_FACES = 10_000

_Corner = Float64[np.ndarray, "k"]


def are_sheets(parts: Sequence[MeshPart]) -> Bool[np.ndarray, "parts"]:
    """Which parts may be grounds: longer than 50 m, level and simple."""
    return np.array([_is_sheet(part) for part in parts], dtype=bool)


def cut_to(
    sheet: MeshPart, low: Float64[np.ndarray, "3"], high: Float64[np.ndarray, "3"]
) -> MeshPart | None:
    """A ground within a box in the plane; None if it is no larger than fits.

    Args:
        sheet: A part that may be a ground.
        low: Lowest corner of the box of all other parts.
        high: Its highest corner.
    """
    corners = sheet.vertices[sheet.faces][:, :, :2].astype(np.float64)
    size = np.ptp(corners.reshape(-1, 2), axis=0)
    if size.prod() <= _TIMES_THE_REST * (high - low)[:2].prod():
        return None
    low, high = low[:2], high[:2]
    beyond = (corners.max(axis=1) < low).any(axis=1) | (corners.min(axis=1) > high).any(axis=1)
    rows = _rows(sheet)
    polygons = [_cut(rows[k], low, high) for k in np.flatnonzero(~beyond).tolist()]
    triangles = [
        np.stack([polygon[0], polygon[k], polygon[k + 1]])
        for polygon in polygons
        for k in range(1, len(polygon) - 1)
    ]
    whole = np.stack(triangles) if triangles else np.zeros((0, 3, rows.shape[2]))
    return replace(
        sheet,
        vertices=whole[:, :, :3].reshape(-1, 3).astype(np.float32),
        faces=np.arange(3 * len(whole), dtype=np.int32).reshape(-1, 3),
        uv=None if sheet.uv is None else whole[:, :, 3:].astype(np.float32),
        colors=None,
        normals=None,
    )


def _is_sheet(part: MeshPart) -> bool:
    if not 0 < len(part.faces) <= _MOST_FACES:
        return False
    corners = part.vertices[part.faces].reshape(-1, 3)
    if not np.isfinite(corners).all():
        return False
    size = np.ptp(corners, axis=0)
    return bool(size[:2].max() > _LEAST_SIDE_M and size[2] < _MOST_HEIGHT_M)


def _rows(sheet: MeshPart) -> Float64[np.ndarray, "faces 3 k"]:
    """Position of every corner, and its texture coordinates behind it."""
    positions = sheet.vertices[sheet.faces].astype(np.float64)
    if sheet.uv is None:
        return positions
    return np.concatenate([positions, sheet.uv.astype(np.float64)], axis=2)


def _cut(
    triangle: Float64[np.ndarray, "3 k"],
    low: Float64[np.ndarray, "2"],
    high: Float64[np.ndarray, "2"],
) -> list[_Corner]:
    """The corners of a triangle's part within a box in the plane (Sutherland and Hodgman)."""
    polygon = list(triangle)
    for axis in range(2):
        for sign, bound in ((1.0, low[axis]), (-1.0, high[axis])):
            polygon = _on_one_side(polygon, axis, sign, float(bound))
    return polygon


def _on_one_side(polygon: list[_Corner], axis: int, sign: float, bound: float) -> list[_Corner]:
    kept: list[_Corner] = []
    for k, corner in enumerate(polygon):
        before = polygon[k - 1]
        here, there = sign * (corner[axis] - bound), sign * (before[axis] - bound)
        if (here < 0.0) != (there < 0.0):
            kept.append(before + (corner - before) * (there / (there - here)))
        if here >= 0.0:
            kept.append(corner)
    return kept
