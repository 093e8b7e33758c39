"""Removes parts of a file that do not belong to the building.

Files from other sources contain accidents: an object that a physics engine threw far away, a dome
for the sky, an endless ground, a mesh scaled to nothing. These must not affect the rest.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.worlds.scenes.ground_sheets import are_sheets, cut_to
from hypernav.worlds.scenes.scene_assembly import MeshPart

_GAP_M = 20.0
_MOST_AREA_M2, _MOST_SIDE_M = 25_000.0, 500.0
"""Largest box of a part of a building."""
_MOST_NAMES = 5


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
    areas = np.array([_area(part) for part in parts])
    low, high = _boxes(parts)
    reasons = {
        k: "no surface" if len(_used(parts[k])) else "no corners that are numbers"
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
    sheets = are_sheets(parts)
    others = [part for part, is_sheet in zip(parts, sheets, strict=True) if not is_sheet]
    building = without_stray_parts(others)[0] if others else []
    if not building or not any(_area(part) for part in building):
        return without_stray_parts(parts)
    low, high = _box(*_boxes(building), np.ones(len(building), dtype=bool))
    grounds = {k: cut_to(parts[k], low, high) for k in np.flatnonzero(sheets).tolist()}
    cut = {k: ground for k, ground in grounds.items() if ground is not None}
    building, left_out = without_stray_parts([p for k, p in enumerate(parts) if k not in cut])
    kept = set(map(id, building))
    together = [cut.get(k) or part for k, part in enumerate(parts) if k in cut or id(part) in kept]
    for k in cut:
        size = _size(*_boxes([parts[k]]))
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


def _area(part: MeshPart) -> float:
    corners = _used(part)
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2.0)


def _boxes(
    parts: Sequence[MeshPart],
) -> tuple[Float64[np.ndarray, "parts 3"], Float64[np.ndarray, "parts 3"]]:
    """Lowest and highest corners of the parts' triangles; 0 for parts without a triangle."""
    low, high = np.zeros((len(parts), 3)), np.zeros((len(parts), 3))
    for k, part in enumerate(parts):
        if len(corners := _used(part).reshape(-1, 3)):
            low[k], high[k] = corners.min(axis=0), corners.max(axis=0)
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
