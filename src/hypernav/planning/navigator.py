"""Navigation to a destination, one action at a time."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float64

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.planning.config import PlanningConfig
from hypernav.planning.costmap import Costmap
from hypernav.planning.follower import PathFollower
from hypernav.planning.planner import PlannedPath, Planner, is_blocked

_NEAR_M = 0.25
"""Distance between positions that are the same for a path."""


@dataclass(frozen=True)
class _DeadEnd:
    """A position from which no sequence of actions leads on along a path.

    Attributes:
        position: The position ``(x, y)``, metres.
        clearance_m: Distance from obstacles that the path keeps, metres.
        end: End of the path.
    """

    position: tuple[float, float]
    clearance_m: float
    end: tuple[float, float]

    def is_on(self, path: PlannedPath, clearance_m: float) -> bool:
        """Whether a path leads to the same end by this position."""
        is_alike = clearance_m == self.clearance_m and math.dist(path.end, self.end) <= _NEAR_M
        return is_alike and _distance_m(self.position, path.waypoints) <= _NEAR_M


class Navigator:
    """Plans, keeps the plan while it holds, and follows it."""

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
        self.reset()

    def reset(self) -> None:
        """Forget the path."""
        self._follower.follow(None)
        self._age, self._clearance_m = 0, self._clearances_m[0]
        self._destinations: tuple[Float64[np.ndarray, "_ 2"], ...] = ()
        self._dead_ends: set[_DeadEnd] = set()

    @property
    def path(self) -> PlannedPath | None:
        """The path that is being followed."""
        return self._follower.path

    @property
    def arrived(self) -> bool:
        """Whether the latest `towards` gave no action because the robot is at the path's end."""
        return self._follower.arrived

    def towards(
        self, grid: OccupancyGrid, robot: Pose2, *destinations: Float64[np.ndarray, "_ 2"]
    ) -> Action | None:
        """The next action on the path to a destination.

        Args:
            grid: The map.
            robot: Pose of the robot.
            destinations: Points of the destination, ``(x, y)``, metres; then those that will do
                where these are hard to reach.

        Returns:
            The action. None if there is no path, or if no step brings the robot nearer; `arrived`
            tells which.
        """
        self._age += 1
        if self._path_is_fresh(destinations):
            costmap = self._costmap(grid, robot)
            if not is_blocked(self._follower.remaining(robot), costmap):
                action = self._follower.next_action(robot, costmap)
                if action is not None or self.arrived:
                    return action
        return self._plan(grid, robot, destinations)

    def remaining(self, robot: Pose2) -> list[tuple[float, float]]:
        """The path that is left, from the robot on, metres; empty without a path."""
        points = self._follower.remaining(robot)
        return [*points[:1], *((round(x, 3), round(y, 3)) for x, y in points[1:])]

    def left_m(self, robot: Pose2) -> float:
        """Length of the path that is left, metres; 0 without a path."""
        return sum(math.dist(*leg) for leg in pairwise(self._follower.remaining(robot)))

    @property
    def planned(self) -> int:
        """Number of actions that are left of the sequence under way; 0 without one."""
        return self._follower.planned

    def _path_is_fresh(self, destinations: tuple[Float64[np.ndarray, "_ 2"], ...]) -> bool:
        every = self._config.replan_every_steps
        is_young = every is None or self._age < every
        return (
            self.path is not None
            and is_young
            and len(destinations) == len(self._destinations)
            and all(map(self._overlap, destinations, self._destinations))
        )

    def _overlap(
        self, points: Float64[np.ndarray, "_ 2"], before: Float64[np.ndarray, "_ 2"]
    ) -> bool:
        """Whether a path to the points of before leads to these, too."""
        if self._config.replan_when_moved or len(before) == 0:
            return np.array_equal(points, before)
        low, high = points.min(axis=0), points.max(axis=0)
        before_low, before_high = before.min(axis=0), before.max(axis=0)
        return bool((low <= before_high).all() and (before_low <= high).all())

    def _plan(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        destinations: tuple[Float64[np.ndarray, "_ 2"], ...],
    ) -> Action | None:
        """Plan anew and begin."""
        self._destinations, self._age = destinations, 0
        for costmap, path in self._untried_first(
            self._planner.options(grid, robot.xy, destinations)
        ):
            self._clearance_m = costmap.clearance_m
            self._follower.follow(path)
            action = self._follower.next_action(robot, costmap)
            if action is not None or self.arrived:
                return action
            if path is not None:
                self._dead_ends.add(_DeadEnd(robot.xy, costmap.clearance_m, path.end))
        return None

    def _untried_first(
        self, options: Iterable[tuple[Costmap, PlannedPath | None]]
    ) -> Iterator[tuple[Costmap, PlannedPath | None]]:
        """The options; those that pass a position where they led nowhere before come last.

        The way out of a dead end may begin by going back. If the same path were taken again from
        there, the robot would go to and fro for ever.
        """
        tried = list[tuple[Costmap, PlannedPath | None]]()
        for costmap, path in options:
            if path is not None and self._leads_nowhere(costmap, path):
                tried.append((costmap, path))
            else:
                yield costmap, path
        yield from tried

    def _leads_nowhere(self, costmap: Costmap, path: PlannedPath) -> bool:
        return any(one.is_on(path, costmap.clearance_m) for one in self._dead_ends)

    def _costmap(self, grid: OccupancyGrid, robot: Pose2) -> Costmap:
        is_squeezed = self._clearance_m < self._clearances_m[0]
        return Costmap.of(grid, self._config, robot.xy, self._clearance_m, is_squeezed=is_squeezed)


def _distance_m(position: tuple[float, float], corners: Sequence[tuple[float, float]]) -> float:
    """Distance of a position from a polyline, metres."""
    ends = np.array(corners, dtype=np.float64)
    starts, legs = ends[:-1], np.diff(ends, axis=0)
    away = np.array(position) - starts
    along = (away * legs).sum(axis=1) / np.maximum((legs**2).sum(axis=1), 1e-12)
    nearest = starts + np.clip(along, 0.0, 1.0)[:, None] * legs
    return float(np.linalg.norm(nearest - np.array(position), axis=1).min())
