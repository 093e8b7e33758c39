"""Size and form of what a mask shows, measured in the depth image."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

_LEAST_POINTS = 40
_TRIM = (3.0, 97.0)
"""Percentiles that stand for the ends: masks bleed over edges."""
_BESIDE_PX = 3
_AROUND_PX = 40
"""Largest distance from a thing, pixels, up to which its surroundings are examined."""
_EDGE_SHARE = 0.03
"""A box that ends so near the image's edge, as a share of the image, is cut off there."""
_NEARER_M = 0.12  # difference in depth from which something beside a thing may hide it
_HIDDEN_SHARE = 0.3  # share of an end's outline with something nearer, from which it is hidden
_SHORT_OF_BOX = 0.1
"""Share of the box that a mask may fall short of it."""
_MOST_POINTS = 4000
_PLANE_M = 0.03  # distance within which a point lies in a plane
_ON_PLANE = 0.8  # share of its points in a plane from which a thing is flat
_LEVEL = 0.85
_UPRIGHT = 0.2
"""Cosines of the angle between normal and vertical: least of a level, most of an upright face."""


@dataclass(frozen=True)
class Form:
    """Size and form of what an image shows of a thing; heights are above the floor, metres.

    Attributes:
        bottom_m: Height of its lowest part in view.
        top_m: Height of its highest part in view.
        long_m: Horizontal extent in view, metres: along a flat upright face, else across the line
            of sight.
        is_bottom_seen: Whether its lower end is in view, not cut off by the image or hidden.
        is_top_seen: The same for the top.
        is_long_seen: The same for its left and right sides.
        level_share: Share of its surface in view that is level.
        goes_on: Share of the surroundings in the image that lie in the plane of a flat thing; 0 if
            it is not flat.
        is_plane_upright: Whether it is a flat upright face, as of a screen or a door.
    """

    bottom_m: float
    top_m: float
    long_m: float
    is_bottom_seen: bool
    is_top_seen: bool
    is_long_seen: bool
    level_share: float
    goes_on: float
    is_plane_upright: bool


def measured_form(
    observation: Observation, mask: Bool[np.ndarray, "height width"], box: Box
) -> Form | None:
    """The form of what a mask shows; None where too few of its pixels have depth.

    Masks cut by depth often lack legs and edges, and hold some of what is behind. So an end counts
    as seen only where the mask reaches the detector's box, and the extent of a thing that is not
    flat is measured across the line of sight.

    Args:
        observation: A frame whose map has its floor at height 0.
        mask: Pixels of the thing.
        box: Box of the detection, pixels.
    """
    part = _Part.around(mask, observation)
    rows, columns = np.nonzero(part.mask & is_measured(part.depth))
    if len(rows) < _LEAST_POINTS:
        return None
    step = -(-len(rows) // _MOST_POINTS)
    points = part.points(rows[::step], columns[::step])
    normal = _normal_of_flat(points)
    is_upright = normal is not None and abs(float(normal[2])) < _UPRIGHT
    across = observation.camera_to_map.rotation[:, 0]
    if normal is not None and is_upright:
        across = np.array([-normal[1], normal[0], 0.0]) / np.hypot(normal[0], normal[1])
    bottom, top = np.percentile(points[:, 2], _TRIM)
    left, right = np.percentile(points @ across, _TRIM)
    is_bottom_seen, is_top_seen, is_long_seen = _ends_seen(part, box)
    goes_on = 0.0 if normal is None else _plane_beyond(part, points, normal)
    return Form(
        float(bottom),
        float(top),
        float(right - left),
        is_bottom_seen,
        is_top_seen,
        is_long_seen,
        _level_share(part),
        goes_on,
        is_upright,
    )


@dataclass(frozen=True, eq=False)
class _Part:
    """The part of a frame around a mask: images are large, and most things in them small.

    Attributes:
        observation: The whole frame.
        mask: Pixels of the thing, in the part.
        depth: Depth, in the part, metres.
        row: First row of the part in the whole frame.
        column: First column of the part in the whole frame.
    """

    observation: Observation
    mask: Bool[np.ndarray, "rows columns"]
    depth: Float32[np.ndarray, "rows columns"]
    row: int
    column: int

    @staticmethod
    def around(mask: Bool[np.ndarray, "height width"], observation: Observation) -> "_Part":
        """The part with the whole mask and a margin around it."""
        left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
        row, column = max(top - _AROUND_PX, 0), max(left - _AROUND_PX, 0)
        rows = slice(row, top + height + _AROUND_PX)
        columns = slice(column, left + width + _AROUND_PX)
        depth = observation.depth[rows, columns]
        return _Part(observation, mask[rows, columns], depth, row, column)

    @property
    def margins(self) -> tuple[int, int, int, int]:
        """Pixels of the frame beyond the part's upper, right, lower and left edge."""
        (height, width), (rows, columns) = self.observation.depth.shape, self.mask.shape
        return (self.row, width - self.column - columns, height - self.row - rows, self.column)

    def points(self, rows: np.ndarray, columns: np.ndarray) -> Float64[np.ndarray, "n 3"]:
        """Points of pixels of the part, given by row and column, ``map`` frame, metres."""
        depth, camera = self.depth[rows, columns], self.observation.camera
        return self.observation.camera_to_map.apply(
            camera.unproject_pixels(rows + self.row, columns + self.column, depth)
        )


def _ends_seen(part: _Part, box: Box) -> tuple[bool, bool, bool]:
    """Whether the thing ends in view at its bottom, at its top, and at both of its sides."""
    top, right, bottom, left = [_ends(part, turns) for turns in range(4)]
    rows, columns = np.nonzero(part.mask)
    rows, columns = rows + part.row, columns + part.column
    high, wide = box.y_max - box.y_min, box.x_max - box.x_min
    top &= bool(rows.min() - box.y_min < _SHORT_OF_BOX * high)
    bottom &= bool(box.y_max - 1 - rows.max() < _SHORT_OF_BOX * high)
    left &= bool(columns.min() - box.x_min < _SHORT_OF_BOX * wide)
    right &= bool(box.x_max - 1 - columns.max() < _SHORT_OF_BOX * wide)
    return bottom, top, left and right


def _ends(part: _Part, turns: int) -> bool:
    """Whether a mask ends towards one edge of the image: the upper one after quarter turns."""
    depth, mask = np.rot90(part.depth, turns), np.rot90(part.mask, turns)
    beyond = part.margins[turns]
    first = mask.argmax(axis=0)
    columns = np.flatnonzero(mask.any(axis=0))
    extent = int(first[columns].min())
    if beyond + extent < _EDGE_SHARE * part.observation.depth.shape[turns % 2]:
        return False
    # Only the part of the outline that reaches as far as the thing itself does.
    span = max(int(np.flatnonzero(mask.any(axis=1))[-1]) - extent, 1)
    columns = columns[first[columns] <= extent + 0.3 * span]
    inner, outer = first[columns] + 1, np.maximum(first[columns] - _BESIDE_PX, 0)
    own, other = depth[np.minimum(inner, len(depth) - 1), columns], depth[outer, columns]
    nearer = is_measured(own) & is_measured(other) & (other < own - _NEARER_M)
    return float(nearer.mean()) < _HIDDEN_SHARE


def _level_share(part: _Part) -> float:
    """Share of a thing's pixels whose surface is level, seen from above or below."""
    rows, columns = np.nonzero(part.mask)
    step = max(int((len(rows) / _MOST_POINTS) ** 0.5), 1) * 2
    window = np.ix_(
        np.arange(rows.min(), rows.max() + 1, step),
        np.arange(columns.min(), columns.max() + 1, step),
    )
    grid_rows, grid_columns = np.broadcast_arrays(*window)
    depth = part.depth[window]
    if min(depth.shape) < 3:
        return 0.0
    points = part.points(grid_rows.ravel(), grid_columns.ravel()).reshape(*depth.shape, 3)
    down, right = np.diff(points, axis=0)[:, :-1], np.diff(points, axis=1)[:-1]
    normals = np.cross(right, down)
    length = np.linalg.norm(normals, axis=2)
    valid = part.mask[window] & is_measured(depth)
    valid = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & (length > 0.0)
    if not valid.any():
        return 0.0
    return float((np.abs(normals[valid][:, 2]) > _LEVEL * length[valid]).mean())


def _normal_of_flat(points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "3"] | None:
    """The normal of the plane that most points lie in; None if they lie in none."""
    normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    away = np.abs((points - np.median(points, axis=0)) @ normal)
    return normal if (away < _PLANE_M).mean() >= _ON_PLANE else None


def _plane_beyond(
    part: _Part, points: Float64[np.ndarray, "n 3"], normal: Float64[np.ndarray, "3"]
) -> float:
    """How much of what surrounds a flat thing lies in its plane."""
    rows, columns = np.nonzero(part.mask)
    across = min(int(np.ptp(rows)), int(np.ptp(columns))) // 3 + 1
    width = 2 * min(max(across, 8), _AROUND_PX) + 1
    mask = part.mask.astype(np.uint8)
    wide = cv2.dilate(mask, np.ones((width, width), np.uint8)).astype(bool)
    slim = cv2.dilate(mask, np.ones((7, 7), np.uint8)).astype(bool)
    around = np.nonzero(wide & ~slim & is_measured(part.depth))
    if len(around[0]) < _LEAST_POINTS:
        return 0.0
    away = np.abs((part.points(*around) - np.median(points, axis=0)) @ normal)
    return float((away < _PLANE_M).mean())
