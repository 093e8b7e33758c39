"""Navigation to a destination, one action at a time, and gaps that are just too narrow for it."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.geometry.grid import OccupancyGrid, has_cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.inflation import disc
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import Costmap
from hypernav.search.planning.follower import DeadEnd, PathFollower, Route
from hypernav.search.planning.planner import PlannedPath, Planner, astar, is_blocked

HOPE_M = 0.04
"""Error of a map that may close a gap seen from afar, on each of its sides, metres."""
_PRICE = np.float32(10.0)
"""Cost factor of a cell that may turn out to be closed; it stands for the path back then."""
_SAME_GAP_M = 0.5
"""Radius, metres, around a gap that was looked at, within which all gaps count as closed."""

Points = tuple[tuple[float, float], ...]
Destinations = tuple[Float64[np.ndarray, "_ 2"], ...]


@dataclass(frozen=True)
class Gap:
    """A gap that the map shows as just too narrow.

    Attributes:
        position: First position on the way where the robot does not fit, ``(x, y)``, metres.
        look_from: Last position before it where the robot fits, ``(x, y)``, metres.
    """

    position: tuple[float, float]
    look_from: tuple[float, float]


def gap_on_path(
    tight: Costmap,
    hopeful: Costmap,
    start: tuple[float, float],
    targets: Float64[np.ndarray, "n 2"],
    closed: tuple[tuple[float, float], ...],
) -> Gap | None:
    """The first gap on the cheapest path to a destination, if gaps may be wider than they look.

    Args:
        tight: Costmap with the smallest clearance that the robot accepts.
        hopeful: Costmap of the same map with obstacles inflated less, by `HOPE_M`.
        start: Position of the robot ``(x, y)``, metres.
        targets: Points ``(x, y)`` of the destination, metres.
        closed: Positions ``(x, y)``, metres, of gaps that were looked at, and are closed.

    Returns:
        None if there is no such path, if no gap is on it, or if the robot stands in one.
    """
    grid, costs = tight.grid, hopeful.costs.copy()
    doubtful = (tight.costs == 0.0) & (costs > 0.0)
    costs[doubtful] = _PRICE
    known_closed = np.zeros(costs.shape, dtype=bool)
    around = np.argwhere(disc(_SAME_GAP_M, grid.resolution_m))
    for position in closed:
        cells = around - around.max(axis=0) // 2 + np.array(grid.cell_of(*position))
        cells = cells[has_cell(costs.shape, cells[:, 0], cells[:, 1])]
        known_closed[cells[:, 0], cells[:, 1]] = True
    costs[doubtful & known_closed] = 0.0
    if tight.escape is None:
        return None
    wanted = grid.mask_of(targets) & (costs > 0.0)
    path, _ = astar(costs, grid.cell_of(*start), wanted.view(np.uint8))
    in_doubt = np.flatnonzero(doubtful[path[:, 0], path[:, 1]])
    if len(in_doubt) == 0 or in_doubt[0] == 0:  # at 0 the robot stands in it
        return None
    first = int(in_doubt[0])
    (x, y), (from_x, from_y) = grid.centres_of(path[[first, first - 1]]).tolist()
    return Gap((x, y), (from_x, from_y))


class Navigator:
    """Plans a route, keeps it while it holds, and follows it. It has no state of its own."""

    def __init__(self, config: PlanningConfig, embodiment: Embodiment) -> None:
        """Create it.

        Args:
            config: Planning and path following.
            embodiment: Size of the robot, length of a step and angle of a turn.
        """
        self._config = config
        self._clearances_m = config.clearances_m(embodiment.body)
        self._planner = Planner(config, embodiment.body)
        self._follower = PathFollower(config, embodiment.motion)

    def towards(
        self,
        route: Route,
        grid: OccupancyGrid,
        robot: Pose2,
        *destinations: Float64[np.ndarray, "_ 2"],
    ) -> tuple[Action | None, Route]:
        """The next action on the path to a destination.

        Args:
            route: The route of the step before.
            grid: The map.
            robot: Pose of the robot.
            destinations: Points of the destination, ``(x, y)``, ``map`` frame, metres; then those
                that are accepted where these are hard to reach.

        Returns:
            The action, and the route from here on. No action if the robot is at the path's end
            (`Route.arrived`), if there is no path, or if no step brings the robot nearer.
        """
        route = replace(route, age=route.age + 1)
        if self._is_fresh(route, destinations):
            route = route.seen_from(robot)
            points = route.points_left(robot)
            costmap = self._costmap(grid, points, route.clearance_m)
            if not is_blocked(points, costmap):
                action, route = self._follower.next_action(route, robot, costmap)
                if action is not None or route.arrived:
                    return action, route
        return self._plan(route, grid, robot, destinations)

    def path_m(
        self, grid: OccupancyGrid, robot: Pose2, *destinations: Float64[np.ndarray, "_ 2"]
    ) -> float | None:
        """Length of the path that `towards` would take, metres; None if there is none."""
        path = self._planner.plan(grid, robot.xy, *destinations)
        return None if path is None else path.length_m

    def nearest_known(
        self, grid: OccupancyGrid, robot: Pose2, place: tuple[float, float], within_m: float
    ) -> tuple[float, float] | None:
        """The explored position nearest to a place to go `towards`; see `Planner.nearest_known`."""
        return self._planner.nearest_known(grid, robot.xy, place, within_m)

    def is_open(self, grid: OccupancyGrid, start: Pose2, end: Pose2) -> bool:
        """Whether the map shows nothing that the robot would touch on a line between poses."""
        line, clearance_m = (start.xy, end.xy), self._clearances_m[-1]
        costmap = Costmap.of(
            grid, self._config, start.xy, clearance_m, is_squeezed=True, around=line
        )
        return not is_blocked(line, costmap)

    def gap_towards(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        points: Float64[np.ndarray, "n 2"],
        closed: tuple[tuple[float, float], ...],
    ) -> Gap | None:
        """The gap to look at from near, where no path leads to a destination.

        Args:
            grid: The map.
            robot: Pose of the robot.
            points: Points of the destination, ``(x, y)``, metres.
            closed: Positions ``(x, y)``, metres, of gaps that were looked at before.
        """
        tight_m = self._clearances_m[-1]
        tight, hopeful = (
            Costmap.of(grid, self._config, robot.xy, clearance_m, is_squeezed=True)
            for clearance_m in (tight_m, max(tight_m - HOPE_M, 0.0))
        )
        return gap_on_path(tight, hopeful, robot.xy, points, closed)

    def _is_fresh(self, route: Route, destinations: Destinations) -> bool:
        every = self._config.replan_every_steps
        is_young = every is None or route.age < every
        return (
            route.path is not None
            and is_young
            and len(destinations) == len(route.destinations)
            and all(map(self._overlap, destinations, route.destinations))
        )

    def _overlap(
        self, points: Float64[np.ndarray, "_ 2"], before: Float64[np.ndarray, "_ 2"]
    ) -> bool:
        """Whether a path to earlier points of a destination counts as one to the present points."""
        if self._config.replan_when_moved or len(before) == 0:
            return np.array_equal(points, before)
        low, high = points.min(axis=0), points.max(axis=0)
        before_low, before_high = before.min(axis=0), before.max(axis=0)
        return bool((low <= before_high).all() and (before_low <= high).all())

    def _plan(
        self, route: Route, grid: OccupancyGrid, robot: Pose2, destinations: Destinations
    ) -> tuple[Action | None, Route]:
        """Plan anew; the first action of the first path along which one leads on."""
        route = replace(route, destinations=destinations, age=0)
        options = self._planner.options(grid, robot.xy, destinations)
        for costmap, path in self._untried_first(route, options):
            route = route.along(path, costmap.clearance_m, self._config.waypoint_tolerance_m)
            action, route = self._follower.next_action(route, robot, costmap)
            if action is not None or route.arrived:
                return action, route
            if path is not None:
                dead_end = DeadEnd(robot.xy, costmap.clearance_m, path.end)
                route = replace(route, dead_ends=route.dead_ends | {dead_end})
        return None, route

    def _untried_first(
        self, route: Route, options: Iterable[tuple[Costmap, PlannedPath | None]]
    ) -> Iterator[tuple[Costmap, PlannedPath | None]]:
        """The options; paths through a position from which they led nowhere before come last.

        The path out of a dead end may begin by going back. If the same path were then taken again,
        the robot would go to and fro forever.
        """
        tried = list[tuple[Costmap, PlannedPath | None]]()
        for costmap, path in options:
            if path is not None and route.leads_nowhere(path, costmap.clearance_m):
                tried.append((costmap, path))
            else:
                yield costmap, path
        yield from tried

    def _costmap(self, grid: OccupancyGrid, points: Points, clearance_m: float) -> Costmap:
        """The costs along what is left of a path, from the robot on, and around it."""
        is_squeezed = clearance_m < self._clearances_m[0]
        return Costmap.of(
            grid, self._config, points[0], clearance_m, is_squeezed=is_squeezed, around=points
        )
