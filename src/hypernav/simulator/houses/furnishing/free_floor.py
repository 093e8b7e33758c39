"""Free floor of a room while furniture is placed: connectivity for the robot and for people."""

import math

import cv2
import numpy as np
from jaxtyping import Bool, Float64
from scipy.ndimage import distance_transform_edt

from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect

_CELL_M = 0.05
_MARGIN_M = 0.6
STANDING_RADIUS_M = 0.19
"""Radius of a slim robot, metres; all cells where it fits must stay connected."""

_CONSERVATIVE_RADIUS_M = 0.225
"""Radius with a margin for the raster, metres; tighter positions don't count as view points."""

WALKING_RADIUS_M = 0.375
"""Half of the clear width of the paths between doors and to the furniture, metres."""

Point = tuple[float, float]


class FreeFloor:
    """Rasters of one room: cells where a slim robot fits, and cells wide enough to walk."""

    def __init__(self, plan: FloorPlan, number: int) -> None:
        """Start with the empty room.

        Args:
            plan: Floor plan of the house.
            number: Index of the room.
        """
        inner = plan.rooms[number].inner
        self._origin = (inner.x0 - _MARGIN_M, inner.y0 - _MARGIN_M)
        columns = math.ceil((inner.width + 2 * _MARGIN_M) / _CELL_M)
        rows = math.ceil((inner.depth + 2 * _MARGIN_M) / _CELL_M)
        floor = np.zeros((rows, columns), dtype=bool)
        floor[self._cells(inner)] = True
        self._anchors: list[Point] = []
        for opening in plan.openings_of(number):
            if opening.is_passable:
                floor[self._cells(opening.strip(-_MARGIN_M, _MARGIN_M))] = True
                upper = opening.rooms[1] == number
                self._anchors.append(
                    opening.strip(0.5, 0.52).centre if upper else opening.strip(-0.52, -0.5).centre
                )
        clearance = (np.asarray(distance_transform_edt(floor)) - 0.5) * _CELL_M
        self._standing = clearance > STANDING_RADIUS_M
        self._walking = clearance > WALKING_RADIUS_M
        self._conservative = clearance > _CONSERVATIVE_RADIUS_M
        # Cells inside the doorways belong to the neighbours as well; paths end before them.
        room = np.zeros_like(floor)
        room[self._cells(inner)] = True
        self._standing &= room
        self._walking &= room
        self._conservative &= room

    def _cells(self, rect: Rect) -> tuple[slice, slice]:
        x, y = self._origin
        return (
            slice(max(round((rect.y0 - y) / _CELL_M), 0), max(round((rect.y1 - y) / _CELL_M), 0)),
            slice(max(round((rect.x0 - x) / _CELL_M), 0), max(round((rect.x1 - x) / _CELL_M), 0)),
        )

    def _cell(self, point: Point) -> tuple[int, int]:
        return (
            math.floor((point[1] - self._origin[1]) / _CELL_M),
            math.floor((point[0] - self._origin[0]) / _CELL_M),
        )

    def allows(self, rects: list[Rect], anchors: list[Point]) -> bool:
        """Whether the floor stays connected if these rectangles are occupied.

        Args:
            rects: Footprints of new furniture.
            anchors: Further points that must be reached with full walking width.
        """
        standing, walking = self._without(rects)
        if not (_is_connected(standing) and _is_connected(self._conservative_without(rects))):
            return False
        wanted = [*self._anchors, *anchors]
        if not wanted:
            return True
        _, parts = cv2.connectedComponents(walking.view(np.uint8), connectivity=4)
        numbers = set()
        for point in wanted:
            row, column = self._cell(point)
            if not (0 <= row < parts.shape[0] and 0 <= column < parts.shape[1]):
                return False
            numbers.add(int(parts[row, column]))
        return len(numbers) == 1 and 0 not in numbers

    def occupy(self, rects: list[Rect], anchors: list[Point]) -> None:
        """Occupy rectangles of the floor and add points that must stay within reach."""
        self._standing, self._walking = self._without(rects)
        self._conservative = self._conservative_without(rects)
        self._anchors += anchors

    def standing_points(self) -> Float64[np.ndarray, "n 2"]:
        """Centres of the cells that a slim robot can certainly reach, 10 cm apart."""
        _, parts, stats, _ = cv2.connectedComponentsWithStats(
            self._conservative.view(np.uint8), connectivity=4
        )
        if len(stats) < 2:
            return np.zeros((0, 2))
        largest = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
        rows, columns = np.nonzero(parts[::2, ::2] == largest)
        x, y = self._origin
        return np.column_stack([x + (2 * columns + 0.5) * _CELL_M, y + (2 * rows + 0.5) * _CELL_M])

    def _without(
        self, rects: list[Rect]
    ) -> tuple[Bool[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
        standing, walking = self._standing.copy(), self._walking.copy()
        for rect in rects:
            standing[self._cells(rect.grown(STANDING_RADIUS_M))] = False
            walking[self._cells(rect.grown(WALKING_RADIUS_M + 0.02))] = False
        return standing, walking

    def _conservative_without(self, rects: list[Rect]) -> Bool[np.ndarray, "rows columns"]:
        sure = self._conservative.copy()
        for rect in rects:
            sure[self._cells(rect.grown(_CONSERVATIVE_RADIUS_M))] = False
        return sure


def _is_connected(free: Bool[np.ndarray, "rows columns"]) -> bool:
    """Whether the free cells are one connected component, up to two cells."""
    _, _, stats, _ = cv2.connectedComponentsWithStats(free.view(np.uint8), connectivity=4)
    sizes = stats[1:, cv2.CC_STAT_AREA]
    return len(sizes) < 2 or int(sizes.sum() - sizes.max()) <= 2
