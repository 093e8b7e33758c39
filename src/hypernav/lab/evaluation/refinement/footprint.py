"""The true footprint of a goal on the floor plan, and the share of a goal area outside it."""

from collections.abc import Collection
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import has_cell
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import HasSurfaces
from hypernav.search.memory.goal_area import GoalArea

_SUBCELL_BITS = 8


@dataclass(frozen=True, eq=False)
class Footprint:
    """The cells that the goal covers, seen from above.

    Attributes:
        cells: Mask of the cells.
        corner: ``[row, column]`` of the first cell, counted from the origin of the ``map`` frame.
        resolution_m: Side of a cell, metres.
    """

    cells: Bool[np.ndarray, "rows columns"]
    corner: tuple[int, int]
    resolution_m: float

    @staticmethod
    def of_instances(
        scene: HasSurfaces, instances: Collection[int], map_to_scene: Transform, resolution_m: float
    ) -> "Footprint":
        """The footprint of some of a scene's instances: their triangles, seen from above.

        Args:
            scene: The scene.
            instances: Ids of the instances; at least one of them has triangles.
            map_to_scene: Transform of the present episode.
            resolution_m: Side of a cell, metres.
        """
        corners = scene.triangles_of(instances).reshape(-1, 3)
        flat = map_to_scene.inverse().apply(corners)[:, :2] / resolution_m
        return Footprint.of_triangles(flat.reshape(-1, 3, 2), resolution_m)

    @staticmethod
    def of_triangles(triangles: Float64[np.ndarray, "n 3 2"], resolution_m: float) -> "Footprint":
        """The footprint of triangles on the floor plan, ``(x, y)`` in cells; at least one."""
        column, row = np.floor(triangles.min(axis=(0, 1))).astype(int) - 1
        columns, rows = np.floor(triangles.max(axis=(0, 1))).astype(int) + 2 - (column, row)
        cells = np.zeros((rows, columns), dtype=np.uint8)
        # OpenCV measures from the centre of the first pixel.
        scaled = (triangles - (column, row) - 0.5) * (1 << _SUBCELL_BITS)
        for corners in np.rint(scaled).astype(np.int32):
            cv2.fillConvexPoly(cells, corners, (1,), shift=_SUBCELL_BITS)
        return Footprint(cells.astype(bool), (int(row), int(column)), resolution_m)

    def centres(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the cells, ``(x, y)``, ``map`` frame, metres."""
        return (np.argwhere(self.cells) + self.corner + 0.5)[:, ::-1] * self.resolution_m

    def holds(
        self, points: Float64[np.ndarray, "n 2"], *, within_cells: int
    ) -> Bool[np.ndarray, " n"]:
        """Which points lie on the footprint, or within a tolerance beside it.

        Args:
            points: Points ``(x, y)``, ``map`` frame, metres.
            within_cells: Tolerance in both directions, cells.
        """
        padded = np.pad(self.cells, within_cells).astype(np.uint8)
        side = 2 * within_cells + 1
        wide = cv2.dilate(padded, np.ones((side, side), np.uint8)).astype(bool)
        cells = np.floor(points[:, ::-1] / self.resolution_m).astype(int)
        rows, columns = (cells - self.corner + within_cells).T
        inside = has_cell(wide.shape, rows, columns)
        return inside & wide[np.where(inside, rows, 0), np.where(inside, columns, 0)]


SEEN_TOLERANCE_CELLS = 1
"""Distance from the footprint within which a seen cell counts as on it: twice half a cell."""


@dataclass(frozen=True)
class OffTarget:
    """How many cells of a goal area lie off the goal.

    Attributes:
        seen: Number of the cells that the area's points fall into, before dilation.
        seen_off: Number of these that lie off the footprint.
    """

    seen: int
    seen_off: int

    @property
    def share_off(self) -> float:
        """Share of the seen cells that lie off the footprint."""
        return self.seen_off / self.seen

    @staticmethod
    def of(area: GoalArea, footprint: Footprint) -> "OffTarget":
        """Count the cells of an area, which lies on the footprint's grid."""
        on = footprint.holds(area.seen_points, within_cells=SEEN_TOLERANCE_CELLS)
        return OffTarget(len(on), int((~on).sum()))
