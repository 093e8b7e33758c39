"""Removes parts of a file that do not belong to the building.

Files from other sources contain accidents: an object that a physics engine threw far away, a dome
for the sky, a mesh scaled to nothing. These must not affect the rest. And a simulated world often
stands on a ground of a hundred metres. It may be the only floor there is, so it can't be left out
whole; but a robot shall not search the plain around the building, so the ground is cut to it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart

_GAP_M = 20.0
_MOST_AREA_M2, _MOST_SIDE_M = 25_000.0, 500.0
"""Largest box of a part of a building."""
_MOST_NAMES = 5
_LEAST_GROUND_M, _MOST_GROUND_HEIGHT_M = 50.0, 1.0
_TIMES_THE_REST = 4.0
_MOST_GROUND_FACES = 10_000

_Corner = Float64[np.ndarray, "k"]


def without_stray_parts(parts: Sequence[MeshPart]) -> tuple[list[MeshPart], list[str]]:
    """The parts that make up the building, and what is left out.

    A part is left out if it has no surface, if it is larger than any building while most of the
    rest is not, or if along one axis a gap of more than 20 m separates it from the group of parts
    with the most surface.

    Args:
        parts: Parts of a file, scene frame.

    Returns:
        The parts to keep, in their order; all of them if none would be left. "NAME (why)" for every
        node of which something is left out.
    """
    used = [_used(part) for part in parts]
    areas = np.array([_area(corners) for corners in used])
    low, high = _boxes(used)
    reasons = {
        k: "no surface" if len(used[k]) else "no corners that are numbers"
        for k in np.flatnonzero(areas == 0.0).tolist()
    }
    building = _with_most_surface(low, high, areas, areas > 0.0)
    large = (areas > 0.0) & _is_too_large(low, high)
    if large.any():
        small = (areas > 0.0) & ~large
        rest = _with_most_surface(low, high, areas, small)
        is_most = rest.any() and 2 * rest.sum() >= small.sum()
        if is_most and not _is_too_large(*_box(low, high, rest)):
            building = rest
            reasons |= {k: _size(low[k], high[k]) for k in np.flatnonzero(large).tolist()}
    if not building.any():
        return list(parts), []
    lowest, highest = _box(low, high, building)
    for k in np.flatnonzero(~building).tolist():
        away = float(np.max(np.maximum(low[k] - highest, lowest - high[k])))
        reasons.setdefault(k, f"{away:.0f} m from the rest")
    return [part for k, part in enumerate(parts) if building[k]], _by_node(parts, reasons)


def without_surroundings(parts: Sequence[MeshPart]) -> tuple[list[MeshPart], list[str]]:
    """The parts that make up the building, with its ground cut to it, and what is left out.

    Args:
        parts: Parts of a file, scene frame.

    Returns:
        The parts to keep, in their order; for every node of which something is left out,
        "NAME (why)".
    """
    may_be_ground = np.array([_is_ground(part) for part in parts], dtype=bool)
    if not may_be_ground.any():
        return without_stray_parts(parts)
    others = [part for part, is_ground in zip(parts, may_be_ground, strict=True) if not is_ground]
    building = without_stray_parts(others)[0] if others else []
    if not building or not any(_area(_used(part)) for part in building):
        return without_stray_parts(parts)
    low, high = _box(*_boxes(list(map(_used, building))), np.ones(len(building), dtype=bool))
    grounds = {k: _cut_to(parts[k], low, high) for k in np.flatnonzero(may_be_ground).tolist()}
    cut = {k: ground for k, ground in grounds.items() if ground is not None}
    building, left_out = without_stray_parts([p for k, p in enumerate(parts) if k not in cut])
    kept = set(map(id, building))
    together = [cut.get(k) or part for k, part in enumerate(parts) if k in cut or id(part) in kept]
    for k in cut:
        size = _size(*_boxes([_used(parts[k])]))
        left_out.append(f"what {parts[k].node} has around the rest ({size})")
    return [part for part in together if len(part.faces)], left_out


def in_one_line(left_out: Sequence[str]) -> str:
    """What is left out, the first five by name."""
    more = len(left_out) - _MOST_NAMES
    return ", ".join(left_out[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


def _used(part: MeshPart) -> Float64[np.ndarray, "faces 3 3"]:
    """Corners of the triangles, without non-finite ones."""
    corners = part.vertices[part.faces].astype(np.float64)
    return corners[np.isfinite(corners).all(axis=(1, 2))]


def _area(corners: Float64[np.ndarray, "faces 3 3"]) -> float:
    sides = corners[:, 1:] - corners[:, :1]
    a, b = sides[:, 0], sides[:, 1]
    # np.cross and np.linalg.norm cost as much as the rest for files of many thousand small parts
    normals = a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
    return float(np.sqrt((normals * normals).sum(axis=1)).sum() / 2.0)


def _boxes(
    used: Sequence[Float64[np.ndarray, "faces 3 3"]],
) -> tuple[Float64[np.ndarray, "parts 3"], Float64[np.ndarray, "parts 3"]]:
    """Lowest and highest corners of the parts' triangles; 0 for parts without a triangle."""
    low, high = np.zeros((len(used), 3)), np.zeros((len(used), 3))
    for k, corners in enumerate(used):
        if len(corners):
            low[k], high[k] = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    return low, high


def _box(
    low: Float64[np.ndarray, "parts 3"],
    high: Float64[np.ndarray, "parts 3"],
    among: Bool[np.ndarray, "parts"],
) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    return low[among].min(axis=0), high[among].max(axis=0)


def _is_too_large(
    low: Float64[np.ndarray, "*n 3"], high: Float64[np.ndarray, "*n 3"]
) -> Bool[np.ndarray, "*n"]:
    size = high - low
    too_wide = size[..., 0] * size[..., 1] > _MOST_AREA_M2
    return np.asarray(too_wide | (size.max(axis=-1) > _MOST_SIDE_M))


def _with_most_surface(
    low: Float64[np.ndarray, "parts 3"],
    high: Float64[np.ndarray, "parts 3"],
    areas: Float64[np.ndarray, "parts"],
    among: Bool[np.ndarray, "parts"],
) -> Bool[np.ndarray, "parts"]:
    """The group with the most surface that is not divided by an empty layer across an axis."""
    group = among.copy()
    while True:
        before = group.copy()
        for axis in range(3):
            members = np.flatnonzero(group)
            members = members[np.argsort(low[members, axis], kind="stable")]
            reach = np.maximum.accumulate(high[members, axis])
            splits = np.flatnonzero(low[members[1:], axis] - reach[:-1] > _GAP_M) + 1
            largest = max(np.split(members, splits), key=lambda some: float(areas[some].sum()))
            group[:] = False
            group[largest] = True
        if (group == before).all():
            return group


def _size(low: Float64[np.ndarray, "*n 3"], high: Float64[np.ndarray, "*n 3"]) -> str:
    return " × ".join(f"{side:.0f}" for side in (high - low).ravel()) + " m large"


def _by_node(parts: Sequence[MeshPart], reasons: dict[int, str]) -> list[str]:
    named: dict[str, str] = {}
    for k in sorted(reasons):
        named.setdefault(parts[k].node, reasons[k])
    return [f"{node} ({why})" for node, why in named.items()]


def _cut_to(
    ground: MeshPart, low: Float64[np.ndarray, "3"], high: Float64[np.ndarray, "3"]
) -> MeshPart | None:
    """A ground within a box in the plane; None if it is no larger than fits."""
    corners = ground.vertices[ground.faces][:, :, :2].astype(np.float64)
    size = np.ptp(corners.reshape(-1, 2), axis=0)
    if size.prod() <= _TIMES_THE_REST * (high - low)[:2].prod():
        return None
    low, high = low[:2], high[:2]
    beyond = (corners.max(axis=1) < low).any(axis=1) | (corners.min(axis=1) > high).any(axis=1)
    rows = _corner_rows(ground)
    polygons = [_cut_triangle(rows[k], low, high) for k in np.flatnonzero(~beyond).tolist()]
    triangles = [
        np.stack([polygon[0], polygon[k], polygon[k + 1]])
        for polygon in polygons
        for k in range(1, len(polygon) - 1)
    ]
    whole = np.stack(triangles) if triangles else np.zeros((0, 3, rows.shape[2]))
    return replace(
        ground,
        vertices=whole[:, :, :3].reshape(-1, 3).astype(np.float32),
        faces=np.arange(3 * len(whole), dtype=np.int32).reshape(-1, 3),
        uv=None if ground.uv is None else whole[:, :, 3:].astype(np.float32),
        colors=None,
        normals=None,
    )


def _is_ground(part: MeshPart) -> bool:
    """Whether a part may be a ground: longer than 50 m, level and simple."""
    if not 0 < len(part.faces) <= _MOST_GROUND_FACES:
        return False
    corners = part.vertices[part.faces].reshape(-1, 3)
    if not np.isfinite(corners).all():
        return False
    size = np.ptp(corners, axis=0)
    return bool(size[:2].max() > _LEAST_GROUND_M and size[2] < _MOST_GROUND_HEIGHT_M)


def _corner_rows(ground: MeshPart) -> Float64[np.ndarray, "faces 3 k"]:
    """Position of every corner, and its texture coordinates behind it."""
    positions = ground.vertices[ground.faces].astype(np.float64)
    if ground.uv is None:
        return positions
    return np.concatenate([positions, ground.uv.astype(np.float64)], axis=2)


def _cut_triangle(
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
