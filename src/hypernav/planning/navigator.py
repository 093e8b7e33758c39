"""Driving to a destination, one action at a time."""

import math
from itertools import pairwise

import numpy as np
from jaxtyping import Float64

from hypernav.core.actions import Action
from hypernav.core.geometry import Pose2
from hypernav.core.grid import OccupancyGrid
from hypernav.mapping.inflation import inflate
from hypernav.planning.config import PlanningConfig
from hypernav.planning.follower import PathFollower
from hypernav.planning.planner import Path, Planner, is_blocked
from hypernav.planning.terrain import Terrain

_MOVED_SHARE = 0.6
"""A step shorter than this share of what was ordered has bumped into something."""
_TOUCHES_M = 0.1
"""How much larger than seen a thing may be that the robot touches."""


class Navigator:
    """Plans, keeps the plan while it holds, follows it, and notices bumps."""

    def __init__(self, config: PlanningConfig) -> None:
        """Create it."""
        self._config = config
        self._planner = Planner(config)
        self._follower = PathFollower(config)
        self.reset()

    def reset(self) -> None:
        """Forget path and last action."""
        self._follower.follow(None)
        self._age, self._inflation_m = 0, self._config.inflation_m
        self._targets: Float64[np.ndarray, "n 2"] = np.zeros((0, 2))
        self._last: tuple[Pose2, Action] | None = None

    @property
    def path(self) -> Path | None:
        """The way that is being followed."""
        return self._follower.path

    @property
    def arrived(self) -> bool:
        """Whether the latest `towards` gave no action because the way is done."""
        return self._follower.arrived

    def towards(
        self, grid: OccupancyGrid, robot: Pose2, targets: Float64[np.ndarray, "n 2"]
    ) -> Action | None:
        """The next action on the way to a destination.

        Args:
            grid: The map.
            robot: Where the robot is.
            targets: Points of the destination, metres.

        Returns:
            The action. None if there is no way, or if no step brings the robot nearer; `arrived`
            tells which.
        """
        self._age += 1
        if self._path_is_fresh(targets):
            terrain = Terrain.of(grid, self._config, robot.xy, self._inflation_m)
            if not is_blocked(self._follower.remaining(robot), terrain):
                action = self._follower.next_action(robot, terrain)
                if action is not None or self.arrived:
                    return action
        return self._plan(grid, robot, targets)

    def note_action(self, robot: Pose2, action: Action) -> None:
        """Remember what the robot was ordered to do, to notice a bump in the next step."""
        self._last = (robot, action)

    def bumped_points(self, robot: Pose2, grid: OccupancyGrid) -> Float64[np.ndarray, "n 2"]:
        """Where something unseen must be, since the last step forward was cut short.

        If the map shows obstacles beside the robot's front, the robot has touched one of them that
        is a little larger than it was seen; else something unseen is right before it.

        Args:
            robot: Where the robot is.
            grid: The map.

        Returns:
            Points around the robot's front, metres; none if it moved as ordered.
        """
        if self._last is None or self._last[1] is not Action.MOVE_FORWARD:
            return np.zeros((0, 2))
        moved = self._last[0].distance_to(*robot.xy)
        if moved >= _MOVED_SHARE * self._config.forward_m:
            return np.zeros((0, 2))
        angles = robot.yaw + np.radians(np.arange(-60.0, 61.0, 10.0))
        front = np.array(robot.xy) + self._config.inflation_m * np.stack(
            [np.cos(angles), np.sin(angles)], axis=1
        )
        beside_known = inflate(grid.occupied, _TOUCHES_M, grid.resolution_m) > 0
        cells = grid.cells_of(front)
        inside = ((cells >= 0) & (cells < np.array(grid.cells.shape))).all(axis=1)
        touched = np.zeros(len(front), dtype=bool)
        touched[inside] = beside_known[cells[inside, 0], cells[inside, 1]]
        return front[touched] if touched.any() else front[3:-3]

    def remaining(self, robot: Pose2) -> list[tuple[float, float]]:
        """The way still to go, from the robot on, metres; empty without a path."""
        points = self._follower.remaining(robot)
        return [*points[:1], *((round(x, 3), round(y, 3)) for x, y in points[1:])]

    def left_m(self, robot: Pose2) -> float:
        """Length of the way still to go, metres; 0 without a path."""
        return sum(math.dist(*leg) for leg in pairwise(self._follower.remaining(robot)))

    def _path_is_fresh(self, targets: Float64[np.ndarray, "n 2"]) -> bool:
        return (
            self.path is not None
            and np.array_equal(targets, self._targets)
            and self._age < self._config.replan_every_steps
        )

    def _plan(
        self, grid: OccupancyGrid, robot: Pose2, targets: Float64[np.ndarray, "n 2"]
    ) -> Action | None:
        """Plan anew, closer to obstacles where there is no way otherwise, and begin."""
        self._targets, self._age = targets, 0
        for inflation_m in self._config.inflations_m:
            self._inflation_m = inflation_m
            terrain = Terrain.of(grid, self._config, robot.xy, inflation_m)
            self._follower.follow(self._planner.plan_on(terrain, robot.xy, targets))
            action = self._follower.next_action(robot, terrain)
            if action is not None or self.arrived:
                return action
        return None
