"""Paths over the map, by A* over a costmap."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64, UInt8

from hypernav.core.embodiment import BodyConfig
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.search.mapping.inflation import distance_from, joined_to
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import Costmap
from hypernav.search.planning.costmap_kernels import cost_of_line, expand, path_back, shortcut

_BESIDE_M = 0.1
"""Gap up to which a path ends in the destination, since cells have a size, metres."""


def astar(
    costs: Float32[np.ndarray, "rows columns"],
    start: tuple[int, int],
    targets: UInt8[np.ndarray, "rows columns"],
) -> tuple[Int64[np.ndarray, "n 2"], float]:
    """The cheapest path from a cell to any target cell.

    Args:
        costs: Factor on the length of a path through a cell, at least 1; 0 where closed.
        start: Open cell ``(row, column)`` to start from.
        targets: Mask of the cells to reach: not 0 there.

    Returns:
        Cells ``[row, column]`` from start to target, and the cost, in cells of cost 1; no cells and
        infinity if there is no path.
    """
    rows = np.flatnonzero(targets.max(axis=1))
    columns = np.flatnonzero(targets.max(axis=0))
    if rows.size == 0:
        return np.zeros((0, 2), dtype=np.int64), np.inf
    box = (int(rows[0]), int(rows[-1]), int(columns[0]), int(columns[-1]))
    spent, came_from, found = expand(costs, *start, targets, box, 0.0)
    if found < 0:
        return np.zeros((0, 2), dtype=np.int64), np.inf
    return path_back(came_from, found, costs.shape[1] + 2), float(spent[found])


def costs_to_go(
    costs: Float32[np.ndarray, "rows columns"],
    end: tuple[int, int],
    robot: tuple[int, int],
    slack: float,
) -> Float32[np.ndarray, "rows columns"]:
    """Costs of the cheapest paths to a cell from the cells around the robot.

    Args:
        costs: Costs of cells, as for `astar`.
        end: Open cell ``(row, column)`` to go to.
        robot: Cell ``(row, column)`` of the robot, whose surroundings matter.
        slack: Cost beyond that of the robot's path up to which paths are searched, in cells.

    Returns:
        Cost in cells; infinite where there is no path, and for most of what is farther away.
    """
    rows, columns = costs.shape
    targets = np.zeros(costs.shape, dtype=np.uint8)
    targets[robot] = 1
    spent, _, _ = expand(costs, *end, targets, (0, rows - 1, 0, columns - 1), slack)
    return np.ascontiguousarray(spent.reshape(rows + 2, columns + 2)[1:-1, 1:-1])


@dataclass(frozen=True)
class PlannedPath:
    """A path for the robot's middle, ``map`` frame.

    Attributes:
        waypoints: Points ``(x, y)`` from the start to the end, metres: corners, or every cell.
        gap_m: Distance from the path's end to the nearest cell of the destination, metres; more
            than 0 where the destination itself cannot be entered.
        cost: Cost of the path over its cells, in cells of free floor far from obstacles.
        is_known: Whether all its cells are explored.
    """

    waypoints: tuple[tuple[float, float], ...]
    gap_m: float
    cost: float
    is_known: bool

    @property
    def enters(self) -> bool:
        """Whether it leads into the destination, to within the size of the cells."""
        return self.gap_m < _BESIDE_M

    @property
    def is_sure(self) -> bool:
        """Whether it leads into the destination over explored floor."""
        return self.enters and self.is_known

    @property
    def end(self) -> tuple[float, float]:
        """Last waypoint, ``(x, y)``, metres."""
        return self.waypoints[-1]

    @property
    def length_m(self) -> float:
        """Length of the polyline, metres."""
        corners = np.array(self.waypoints)
        return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())


class Planner:
    """A* on inflated obstacles."""

    def __init__(self, config: PlanningConfig, body: BodyConfig) -> None:
        """Create the planner.

        Args:
            config: Cost factors and margins.
            body: Size of the robot.
        """
        self._config = config
        self._clearances_m = config.clearances_m(body)

    def plan(
        self,
        grid: OccupancyGrid,
        start: tuple[float, float],
        *destinations: Float64[np.ndarray, "_ 2"],
    ) -> PlannedPath | None:
        """The best of the paths to a destination; see `options`.

        From inside an inflated obstacle the path first leads out of it. A destination that cannot
        be entered moves to the cell nearest to it (`PlanningConfig.end_in_obstacle`), at most
        `PlanningConfig.max_gap_m` away. Where no path leads, or only through the unknown, obstacles
        are inflated less (`PlanningConfig.squeeze_m`, `PlanningConfig.prefer_known`).

        Args:
            grid: The map.
            start: Position of the robot ``(x, y)``, metres.
            destinations: Points ``(x, y)`` of the destination, as for `options`, metres.

        Returns:
            The path; None if there is none.
        """
        return next((path for _, path in self.options(grid, start, destinations) if path), None)

    def options(
        self,
        grid: OccupancyGrid,
        start: tuple[float, float],
        destinations: Sequence[Float64[np.ndarray, "_ 2"]],
    ) -> Iterator[tuple[Costmap, PlannedPath | None]]:
        """The paths to choose from, the best first.

        Args:
            grid: The map.
            start: Position of the robot ``(x, y)``, metres.
            destinations: Points ``(x, y)`` of the destination, metres, then those that are accepted
                where these are hard to reach; at least one point each.

        Yields:
            A costmap, and the path on it; None if there is none. They are computed when they are
            asked for, or all at once where `PlanningConfig.prefer_known` must compare them.
        """

        @cache
        def costmap(clearance_m: float) -> Costmap:
            is_squeezed = clearance_m < self._clearances_m[0]
            return Costmap.of(grid, self._config, start, clearance_m, is_squeezed=is_squeezed)

        options = (
            (costmap(clearance_m), self._plan_on(costmap(clearance_m), start, points))
            for points in destinations
            for clearance_m in self._clearances_m
        )
        first = next(options)
        is_sure = first[1] is not None and first[1].is_sure
        if is_sure or not self._config.prefer_known:
            yield first
            yield from options
        else:
            yield from _known_first([first, *options])

    def nearest_known(
        self,
        grid: OccupancyGrid,
        start: tuple[float, float],
        place: tuple[float, float],
        within_m: float,
    ) -> tuple[float, float] | None:
        """The explored position nearest to a place that a path leads to.

        Obstacles are inflated less only where that leads nearer by more than the size of the cells.

        Args:
            grid: The map.
            start: Position of the robot ``(x, y)``, metres.
            place: The place ``(x, y)``, metres.
            within_m: Largest distance from the place, metres.

        Returns:
            Middle of a cell ``(x, y)``, metres; None if there is none.
        """
        nearest, least_m = None, within_m
        for clearance_m in self._clearances_m:
            is_squeezed = clearance_m < self._clearances_m[0]
            costmap = Costmap.of(grid, self._config, start, clearance_m, is_squeezed=is_squeezed)
            if costmap.escape is None:
                continue
            here = costmap.grid.cell_of(*start)
            is_open = (costmap.is_open > 0) & costmap.grid.explored & _reachable(costmap, here)
            points = costmap.grid.centres_of(np.argwhere(is_open))
            away_m = np.linalg.norm(points - np.array(place), axis=1)
            if len(points) and away_m.min() <= least_m:
                x, y = points[away_m.argmin()].tolist()
                nearest, least_m = (x, y), float(away_m.min()) - _BESIDE_M
        return nearest

    def _plan_on(
        self,
        costmap: Costmap,
        start: tuple[float, float],
        targets: Float64[np.ndarray, "n 2"],
    ) -> PlannedPath | None:
        """The cheapest path on a costmap."""
        config = self._config
        if config.targets == "nearest-straight":
            offsets = ((targets - np.array(start)) ** 2).sum(axis=1)
            targets = targets[[int(offsets.argmin())]]
        if costmap.escape is None:
            return None
        here = costmap.grid.cell_of(*start)
        goal, gap_m = _enterable_goal(costmap, here, targets, config)
        if gap_m == np.inf or (config.max_gap_m is not None and gap_m > config.max_gap_m):
            return None
        cells, cost = astar(costmap.costs, here, goal)
        if len(cells) == 0:
            return None
        is_known = bool(costmap.grid.explored[tuple(cells.T)].all())
        if config.waypoints == "corners":
            cells = cells[shortcut(costmap.costs, cells, *costmap.continuous(*start))]
        points = [(float(x), float(y)) for x, y in costmap.grid.centres_of(cells)]
        waypoints = (start, *(points[1:] if len(points) > 1 else points))
        return PlannedPath(waypoints, gap_m, cost, is_known)


def _known_first(
    options: list[tuple[Costmap, PlannedPath | None]],
) -> list[tuple[Costmap, PlannedPath | None]]:
    """The options in the order of preference.

    First come paths that enter the destination over explored floor at less than half the cost of
    the first that enters it, then the others that enter it, then the rest.
    """
    costs = [path.cost for _, path in options if path is not None and path.enters]
    most = costs[0] / 2.0 if costs else 0.0

    def rank(option: tuple[Costmap, PlannedPath | None]) -> int:
        path = option[1]
        if path is None or not path.enters:
            return 2
        return 0 if path.is_known and path.cost < most else 1

    return sorted(options, key=rank)


def is_blocked(points: tuple[tuple[float, float], ...], costmap: Costmap) -> bool:
    """Whether a polyline touches a cell that is closed to the robot, or leaves the costmap.

    Args:
        points: Corners of the polyline, ``(x, y)``, metres.
        costmap: Costmap of the robot's surroundings.
    """
    corners = [costmap.continuous(*point) for point in points]
    return any(np.isinf(cost_of_line(costmap.costs, *a, *b)) for a, b in pairwise(corners))


def _reachable(costmap: Costmap, here: tuple[int, int]) -> Bool[np.ndarray, "rows columns"]:
    """Mask of the cells that a path leads to from a cell."""
    # Diagonal steps need both neighbours, so what is 8-reachable is 4-connected.
    return joined_to(here, costmap.costs > 0.0)


def _enterable_goal(
    costmap: Costmap,
    here: tuple[int, int],
    targets: Float64[np.ndarray, "n 2"],
    config: PlanningConfig,
) -> tuple[UInt8[np.ndarray, "rows columns"], float]:
    """Mask of the cells to go to: 1 there; and their distance from the destination, metres."""
    enterable = costmap.is_open > 0
    if config.end_in_obstacle == "reachable":
        enterable &= _reachable(costmap, here)
    wanted = costmap.grid.mask_of(targets)
    known = enterable & costmap.grid.explored
    for allowed in (known, enterable):
        goal = wanted & allowed
        if goal.any():
            return goal.view(np.uint8), 0.0
    # Beside a destination that cannot be entered only known cells count: a goal area reaches into
    # the wall that it hangs on, and no path to it begins behind that wall.
    if wanted.any():
        away = distance_from(wanted)
    else:  # beyond the explored map: the enterable cell nearest to the first target
        rows, columns = np.indices(enterable.shape)
        row, column = costmap.continuous(*targets[0])
        away = np.hypot(rows + 0.5 - row, columns + 0.5 - column)
    away = np.where(known, away, np.inf)
    nearest = np.unravel_index(int(away.argmin()), away.shape)
    beside = np.zeros(wanted.shape, dtype=bool)
    beside[nearest] = True
    return beside.view(np.uint8), float(away[nearest]) * costmap.grid.resolution_m
