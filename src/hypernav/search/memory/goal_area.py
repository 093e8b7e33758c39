"""Goal areas: the cells that refined detections project to."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int32

from hypernav.core.geometry.grid import has_cell
from hypernav.core.observation import Observation
from hypernav.search.mapping.inflation import distance_from
from hypernav.search.memory.image_kernels import points_under
from hypernav.search.memory.visibility import lies_open


def points_under_mask(
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    *,
    min_depth_m: float,
    max_depth_m: float,
    stride: int = 1,
    window: tuple[int, int, int, int] | None = None,
) -> Float64[np.ndarray, "n 3"]:
    """The masked pixels as points ``(x, y, z)`` in the ``map`` frame, metres.

    Pixels without a measured depth are skipped. Points above the robot are kept: a goal may hang on
    a wall.

    Args:
        mask: Mask of the target's pixels.
        observation: Frame that the mask was made from.
        min_depth_m: Lower limit of the sensor's range, exclusive, metres.
        max_depth_m: Upper limit of the sensor's range, exclusive, metres.
        stride: Step between the pixels in use, in both directions, pixels.
        window: First column and row in use, and the ones after the last; all by default.

    Raises:
        ValueError: The mask has another size than the depth image.
    """
    if mask.shape != observation.depth.shape:
        raise ValueError(f"expected a mask of {observation.depth.shape} pixels, got {mask.shape}")
    if window is None:
        left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
        window = (left - left % stride, top - top % stride, left + width, top + height)
    return points_under(
        np.require(mask, np.bool_, ["C", "W"]),
        np.require(observation.depth, np.float32, ["C", "W"]),
        window,
        stride,
        (float(np.float32(min_depth_m)), float(np.float32(max_depth_m))),  # as the depths are
        observation.camera.lens,
        observation.camera_to_map.rows,
    )


@dataclass(frozen=True, eq=False)
class GoalArea:
    """The area of the target on the floor plan; all positions are in the ``map`` frame.

    It has cells of its own, ``[row, column]``, since the map's cells move when the map grows.

    Attributes:
        mask: Mask of the dilated cells.
        views: Number of images in which points of the target fall into a cell.
        entry: Mask of the cells that the robot may go to.
        before: Mask of the entry cells that lie between the target and a camera that saw it.
        origin: Lower left corner ``(x, y)`` of the masks, metres.
        resolution_m: Side of a cell, metres.
        height_m: Median height of the target's points above the floor, metres.
        is_guessed: Whether its outline was guessed from a box, and may include what stands before
            the target.
    """

    mask: Bool[np.ndarray, "rows columns"]
    views: Int32[np.ndarray, "rows columns"]
    entry: Bool[np.ndarray, "rows columns"]
    before: Bool[np.ndarray, "rows columns"]
    origin: tuple[float, float]
    resolution_m: float
    height_m: float
    is_guessed: bool = False

    @staticmethod
    def from_points(
        points: Float64[np.ndarray, "n 3"],
        *,
        resolution_m: float,
        kernel: int = 5,
        iterations: int = 3,
        largest_cluster_only: bool = True,
        stray_share: float = 0.0,
    ) -> "GoalArea | None":
        """Project points to cells and dilate them (paper: 5×5 kernel, 3 iterations).

        Args:
            points: Points ``(x, y, z)`` of the target, ``map`` frame, metres.
            resolution_m: Side of a map cell, metres.
            kernel: Side of the dilation kernel, cells.
            iterations: Number of dilations.
            largest_cluster_only: Whether to keep only the dilated cluster with the most points, so
                that a mask that leaks to the wall behind does not move the goal there.
            stray_share: Share of the largest part's points below which a part is another object's.

        Returns:
            The area, or None without points.
        """
        if len(points) == 0:
            return None
        cells = np.floor(points[:, 1::-1] / resolution_m).astype(np.int64)
        reach = (kernel // 2) * iterations + 1
        low = cells.min(axis=0) - reach
        shape = cells.max(axis=0) + reach + 1 - low
        counts = np.zeros(tuple(shape), dtype=np.int64)
        np.add.at(counts, tuple((cells - low).T), 1)
        seen = counts > 0
        if stray_share > 0.0:
            _, parts = cv2.connectedComponents(seen.astype(np.uint8), connectivity=8)
            weights = np.bincount(parts.ravel(), weights=counts.ravel())
            seen = (weights >= stray_share * weights.max())[parts] & seen
        mask = cv2.dilate(
            seen.astype(np.uint8), np.ones((kernel, kernel), np.uint8), iterations=iterations
        ).astype(bool)
        if largest_cluster_only:
            _, clusters = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
            weights = np.bincount(clusters.ravel(), weights=counts.ravel())
            weights[0] = -1.0
            mask = clusters == int(weights.argmax())
            seen &= mask
        origin = (float(low[1]) * resolution_m, float(low[0]) * resolution_m)
        height_m = float(np.median(points[:, 2]))
        views = seen.astype(np.int32)
        return GoalArea(mask, views, mask, np.zeros_like(mask), origin, resolution_m, height_m)

    def joined(self, other: "GoalArea") -> "GoalArea":
        """The union of both areas, from two images of the same target; views are added up."""
        size = self.resolution_m
        corners = [np.round(np.array(a.origin)[::-1] / size).astype(int) for a in (self, other)]
        low = np.minimum(*corners)
        ends = [c + a.mask.shape for c, a in zip(corners, (self, other), strict=True)]
        shape = tuple(np.maximum(*ends) - low)
        mask, entry, before = np.zeros((3, *shape), dtype=bool)
        views = np.zeros(shape, dtype=np.int32)
        for corner, area in zip(corners, (self, other), strict=True):
            row, column = corner - low
            rows, columns = area.mask.shape
            window = (slice(row, row + rows), slice(column, column + columns))
            mask[window] |= area.mask
            views[window] += area.views
            entry[window] |= area.entry
            before[window] |= area.before
        origin = (float(low[1]) * size, float(low[0]) * size)
        is_guessed = self.is_guessed or other.is_guessed
        return GoalArea(mask, views, entry, before, origin, size, self.height_m, is_guessed)

    def entered_from(self, observation: Observation, reach_m: float) -> "GoalArea":
        """The same area, entered near the seen cells where an image shows that no wall is between.

        Dilation alone leads through a thin wall into the next room, but an image of the target also
        shows what lies on the same side of the walls. Without such cells the area stays as it is.

        Args:
            observation: Frame that shows the target.
            reach_m: Largest distance of an entry cell from the seen cells, metres.
        """
        margin = math.ceil(reach_m / self.resolution_m)
        wide = self._widened(margin)
        entry = (distance_from(wide.seen) * self.resolution_m <= reach_m) & ~wide.seen
        entry[entry] = lies_open(wide._centres(entry), observation)
        if not entry.any():
            return self
        before = entry.copy()
        x, y, _ = observation.camera_to_map.translation
        before[entry] = _are_before(wide._centres(entry), self.seen_points, np.array([x, y]))
        return replace(wide, entry=entry, before=before)

    def _widened(self, margin: int) -> "GoalArea":
        """The same area with masks that are larger by a margin, cells."""
        shift = margin * self.resolution_m
        masks = (self.mask, self.views, self.entry, self.before)
        mask, views, entry, before = (_padded(one, margin) for one in masks)
        origin = (self.origin[0] - shift, self.origin[1] - shift)
        return replace(self, mask=mask, views=views, entry=entry, before=before, origin=origin)

    @cached_property
    def seen(self) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the cells that points of the target fall into."""
        return self.views > 0

    @cached_property
    def points(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the dilated cells, ``(x, y)``, metres."""
        return self._centres(self.mask)

    @cached_property
    def entry_points(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the cells that the robot may go to, ``(x, y)``, metres."""
        return self._centres(self.entry)

    @cached_property
    def inner_entry_points(self) -> Float64[np.ndarray, "n 2"]:
        """The entry points in the nearer half of their distances to the target, ``(x, y)``, metres.

        Only cells that many images show count as the target: a single one may include a shadow.
        """
        often = 2 * self.views >= self.views.max()
        away_m = distance_from(often)[self.entry]
        return self.entry_points[away_m <= (away_m.min() + away_m.max()) / 2.0]

    @cached_property
    def entry_before(self) -> Bool[np.ndarray, " n"]:
        """Which of the entry points lie between the target and a camera that saw it."""
        return self.before[self.entry]

    @cached_property
    def seen_points(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the cells that the target was seen in, ``(x, y)``, metres."""
        return self._centres(self.seen)

    @cached_property
    def nearest_seen_points(self) -> Float64[np.ndarray, "n 2"]:
        """For every entry point the nearest of the `seen_points`, ``(x, y)``, metres."""
        _, labels = cv2.distanceTransformWithLabels(
            (~self.seen).astype(np.uint8),
            cv2.DIST_L2,
            cv2.DIST_MASK_PRECISE,
            labelType=cv2.DIST_LABEL_PIXEL,
        )
        number = np.asarray(labels, dtype=np.int64)
        # Every seen cell has a label of its own; the cells nearest to it have the same label.
        points = np.zeros((int(number.max()) + 1, 2))
        points[number[self.seen]] = self.seen_points
        return points[number[self.entry]]

    def beside(self, gap_m: float) -> tuple[Float64[np.ndarray, "n 2"], Float64[np.ndarray, "n 2"]]:
        """Points ``(x, y)``, metres, within a gap of entry points; their nearest `seen_points`."""
        wide = self._widened(math.ceil(gap_m / self.resolution_m))
        away_m = distance_from(wide.entry) * self.resolution_m
        is_beside = ~wide.entry & ~wide.seen & (away_m <= gap_m)
        beside = replace(wide, entry=is_beside)
        return beside.entry_points, beside.nearest_seen_points

    @cached_property
    def centre(self) -> tuple[float, float]:
        """Mean ``(x, y)`` of the cells that the target was seen in, metres."""
        x, y = self.seen_points.mean(axis=0)
        return (float(x), float(y))

    def distance_to(self, x: float, y: float) -> float:
        """Straight distance to the nearest cell that the robot may go to, metres."""
        offsets = self.entry_points - np.array([x, y])
        return float(np.sqrt((offsets**2).sum(axis=1).min()))

    def distance_to_seen(self, x: float, y: float) -> float:
        """Straight distance to the nearest cell that the target was seen in, metres."""
        return float(np.linalg.norm(self.seen_points - np.array([x, y]), axis=1).min())

    def covers(self, other: "GoalArea") -> float:
        """The share of another area's seen cells that lie in this area's dilated cells, 0 to 1."""
        size = self.resolution_m
        left, bottom = (
            round((b - a) / size) for a, b in zip(self.origin, other.origin, strict=True)
        )
        height, width = other.mask.shape
        if not (-height < bottom < len(self.mask) and -width < left < self.mask.shape[1]):
            return 0.0  # far apart, as most areas are
        rows, columns = np.nonzero(other.seen)
        rows, columns = rows + bottom, columns + left
        inside = has_cell(self.mask.shape, rows, columns)
        hits = self.mask[rows[inside], columns[inside]].sum()
        return float(hits) / len(rows)

    @cached_property
    def outlines(self) -> list[list[tuple[float, float]]]:
        """Polygons ``(x, y)`` around the dilated cells, metres, for images and the trace."""
        contours, _ = cv2.findContours(
            self.mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_TC89_L1
        )
        (left, bottom), size = self.origin, self.resolution_m
        return [
            [
                (
                    round(left + (float(x) + 0.5) * size, 3),
                    round(bottom + (float(y) + 0.5) * size, 3),
                )
                for x, y in contour.reshape(-1, 2)
            ]
            for contour in contours
        ]

    def _centres(self, mask: Bool[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "n 2"]:
        cells = np.argwhere(mask)
        return np.array(self.origin) + (cells[:, ::-1] + 0.5) * self.resolution_m


def _are_before(
    points: Float64[np.ndarray, "n 2"],
    seen: Float64[np.ndarray, "m 2"],
    camera: Float64[np.ndarray, "2"],
) -> Bool[np.ndarray, " n"]:
    """Which points lie before seen ones: in their directions from a camera, and nearer to it."""
    middle = np.arctan2(*(seen.mean(axis=0) - camera)[::-1])

    def away(of: Float64[np.ndarray, "_ 2"]) -> Float64[np.ndarray, " _"]:
        bearings = np.arctan2(of[:, 1] - camera[1], of[:, 0] - camera[0]) - middle
        return np.mod(bearings + np.pi, 2.0 * np.pi) - np.pi

    of_seen, of_points = away(seen), away(points)
    farthest_m = np.linalg.norm(seen - camera, axis=1).max()
    is_nearer = np.linalg.norm(points - camera, axis=1) < farthest_m
    return is_nearer & (of_points >= of_seen.min()) & (of_points <= of_seen.max())


def _padded(cells: np.ndarray, margin: int) -> np.ndarray:
    """Cells with a margin of zeros; `np.pad` takes ten times as long."""
    rows, columns = cells.shape
    wide = np.zeros((rows + 2 * margin, columns + 2 * margin), dtype=cells.dtype)
    wide[margin : margin + rows, margin : margin + columns] = cells
    return wide
