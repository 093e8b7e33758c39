"""View positions in a building, and the straight drives between them."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy import ndimage

from hypernav.houses.plan.shapes import FloorPlan
from hypernav.worlds.surface.walkable import WalkableGrid

MOST_POSITIONS = 140
"""Number of positions above which the spacing is increased, to limit the size of the page."""
_SPACINGS_M = (2.0, 2.5, 3.0)
_APART = 0.6
_REACH = 2.5
_SNAP = 0.25
"""Smallest distance of two positions, length of the longest drive, and largest shift of a position
from its lattice point, relative to the spacing."""
_ROOMY_M = 0.3
"""Clearance beyond which more clearance makes a position no better."""

Point = tuple[float, float]


@dataclass(frozen=True)
class WalkGraph:
    """Positions and the drives between them.

    Attributes:
        positions: Standable points, metres, scene frame; the middles of rooms come first.
        neighbours: For every position, in increasing order, those that the robot can reach in a
            straight line, and return from.
    """

    positions: tuple[Point, ...]
    neighbours: tuple[tuple[int, ...], ...]


def walk_graph(grid: WalkableGrid, plan: FloorPlan) -> WalkGraph:
    """Spread positions over the largest connected floor.

    There is one near the middle of every room, in every door, and on a square lattice, each moved
    to where there is room around it. The lattice is 2 m wide, in large buildings 2.5 or 3 m, where
    more than `MOST_POSITIONS` would be needed. Where positions are not connected, some are added
    on the shortest path between them.

    Args:
        grid: Where the robot can stand.
        plan: Floor plan of the building.
    """
    floor = _Floor(grid)
    graph = WalkGraph((), ())
    for spacing in _SPACINGS_M:
        graph = _graph_with(floor, plan, spacing)
        if len(graph.positions) <= MOST_POSITIONS:
            break
    return graph


class _Floor:
    """The largest connected floor and the clearance on it."""

    def __init__(self, grid: WalkableGrid) -> None:
        self.grid = grid
        self._free = grid.components == 0
        distance: Float64[np.ndarray, "rows columns"] = np.asarray(
            ndimage.distance_transform_edt(np.pad(self._free, 1))
        )
        self._clearance = distance[1:-1, 1:-1] * grid.cell_m

    def roomy_point(self, point: Point, reach_m: float) -> Point | None:
        """Middle of the cell near a point that has room around it; None if none is in reach."""
        cell_m, reach = self.grid.cell_m, max(round(reach_m / self.grid.cell_m), 1)
        row, column = self.grid.cell_of(*point)
        top, left = max(row - reach, 0), max(column - reach, 0)
        window = np.s_[top : max(row + reach + 1, 0), left : max(column + reach + 1, 0)]
        rows, columns = np.nonzero(self._free[window])
        if rows.size == 0:
            return None
        away_m = np.hypot(rows + top - row, columns + left - column) * cell_m
        room_m = np.minimum(self._clearance[window][rows, columns], _ROOMY_M)
        best = int(np.argmax(room_m - 0.5 * away_m))
        x0, y0 = self.grid.origin
        return (
            float(x0 + (columns[best] + left + 0.5) * cell_m),
            float(y0 + (rows[best] + top + 0.5) * cell_m),
        )

    def can_drive(self, a: Point, b: Point) -> bool:
        """Whether the robot can drive straight from one point to the other and back."""
        return all(
            math.dist(self.grid.step(*start, end[0] - start[0], end[1] - start[1]), end)
            < self.grid.cell_m
            for start, end in ((a, b), (b, a))
        )


def _graph_with(floor: _Floor, plan: FloorPlan, spacing: float) -> WalkGraph:
    points = _spread(floor, plan, spacing)
    links = {
        (a, b)
        for a, b in itertools.combinations(range(len(points)), 2)
        if math.dist(points[a], points[b]) <= _REACH * spacing
        and floor.can_drive(points[a], points[b])
    }
    _connect(floor, points, links)
    neighbours = _neighbours(len(points), links)
    return WalkGraph(tuple(points), tuple(tuple(sorted(own)) for own in neighbours))


def _spread(floor: _Floor, plan: FloorPlan, spacing: float) -> list[Point]:
    rows, columns = floor.grid.components.shape
    x0, y0 = floor.grid.origin
    wanted = [
        *(room.inner.centre for room in plan.rooms),
        *(opening.middle for opening in plan.openings if opening.is_passable),
        *(
            (float(x), float(y))
            for y in np.arange(y0 + spacing / 2, y0 + rows * floor.grid.cell_m, spacing)
            for x in np.arange(x0 + spacing / 2, x0 + columns * floor.grid.cell_m, spacing)
        ),
    ]
    points = list[Point]()
    for place in wanted:
        point = floor.roomy_point(place, _SNAP * spacing)
        if point is not None and not any(
            math.dist(point, other) < _APART * spacing and floor.can_drive(point, other)
            for other in points
        ):
            points.append(point)
    return points


def _connect(floor: _Floor, points: list[Point], links: set[tuple[int, int]]) -> None:
    """Add drives, and positions if necessary, until all positions are connected."""
    while len(reached := _reached(len(points), links)) < len(points):
        others = [n for n in range(len(points)) if n not in reached]
        field = floor.grid.distance_field(np.array([points[n] for n in sorted(reached)]))
        b = min(others, key=lambda n: field.distance(*points[n]))
        end = field.path(*points[b])[-1]
        a = min(sorted(reached), key=lambda n: math.dist(points[n], end))
        _bridge(floor, points, links, a, b)


def _reached(count: int, links: set[tuple[int, int]]) -> set[int]:
    """Positions that can be reached from the first."""
    neighbours = _neighbours(count, links)
    reached, ahead = {0}, [0]
    while ahead:
        new = [n for n in neighbours[ahead.pop()] if n not in reached]
        reached.update(new)
        ahead += new
    return reached


def _neighbours(count: int, links: set[tuple[int, int]]) -> list[list[int]]:
    neighbours = [list[int]() for _ in range(count)]
    for a, b in sorted(links):
        neighbours[a].append(b)
        neighbours[b].append(a)
    return neighbours


def _bridge(
    floor: _Floor, points: list[Point], links: set[tuple[int, int]], a: int, b: int
) -> None:
    """Link two positions, through the middle of the path between them if necessary."""
    if floor.can_drive(points[a], points[b]):
        links.add((min(a, b), max(a, b)))
        return
    path = np.array(floor.grid.shortest_path(points[a], points[b]))
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    half = along[-1] / 2
    middle = float(np.interp(half, along, path[:, 0])), float(np.interp(half, along, path[:, 1]))
    points.append(floor.roomy_point(middle, min(half / 2, _ROOMY_M)) or middle)
    between = len(points) - 1
    _bridge(floor, points, links, a, between)
    _bridge(floor, points, links, between, b)
