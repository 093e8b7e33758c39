"""Driving from one destination of global perception to the next, while the goal is out of sight."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.agents.config import SearchConfig
from hypernav.agents.progress import Progress
from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block
from hypernav.core.trace import BlockRecord
from hypernav.perception.explorers.explorer import (
    Destination,
    Explorer,
    Prefetches,
    last_free_towards,
)
from hypernav.planning.navigator import Navigator

_CHOICES_PER_STEP = 4
_WORTH_A_TURN_M = 0.3
"""A shorter boundary to the unknown is noise."""


class Exploration:
    """Holds a destination until it is reached, given up or explored; then asks for the next.

    Attributes:
        destination: Where the robot is going.
    """

    def __init__(self, explorer: Explorer, navigator: Navigator, config: SearchConfig) -> None:
        """Put it together.

        Args:
            explorer: Says where to go.
            navigator: Drives there.
            config: When a destination ends.
        """
        self._explorer = explorer
        self._navigator = navigator
        self._config = config
        self._progress = Progress(config.patience_steps)
        self.reset(Goal("nothing yet"))

    def reset(self, goal: Goal) -> None:
        """Forget all destinations."""
        self._explorer.reset(goal)
        self._goal = goal
        self._age = 0
        self._navigator.reset()
        self._progress.reset()
        self._pursued: list[tuple[float, float]] = []
        self.destination: Destination | None = None
        self._offered: tuple[Block, ...] = ()

    def next_action(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        trajectory: Sequence[tuple[float, float]],
        *,
        far_bearing: float | None,
        clock: ModuleClock,
        events: list[str],
    ) -> tuple[Action, str] | None:
        """What to do now, and why.

        Args:
            grid: The map.
            robot: Where the robot is.
            trajectory: Where it was.
            far_bearing: Direction of a goal that is in sight but too far away to be measured.
            clock: Takes the time.
            events: Takes what happened to destinations.

        Returns:
            None if nothing is left to explore.
        """
        config = self._config
        turn = self._look_across(grid, robot)
        if turn is not None:
            self._age += 1
            return turn, "looking at what is unexplored here"
        self._drop_finished(grid, robot, events)
        if config.pursue_far_sightings and far_bearing is not None:
            self._pursue(grid, robot, far_bearing, events)
        for _ in range(_CHOICES_PER_STEP):
            if self.destination is None:
                with clock("global"):
                    self.destination = self._explorer.next_destination(grid, robot, trajectory)
                self._age = 0
                self._progress.reset()
                if self.destination is None:
                    return None
                self._offered = self.destination.blocks
            with clock("plan"):
                action = self._navigator.towards(grid, robot, np.array([self.destination.xy]))
            if action is None:
                arrived = self._navigator.arrived
                self._end("destination reached" if arrived else "no path to destination", events)
            elif config.give_up_when_stuck and not self._progress.is_made(
                self._navigator.left_m(robot)
            ):
                self._end("no progress to destination", events)
            else:
                self._age += 1
                if isinstance(self._explorer, Prefetches):
                    self._explorer.prefetch(grid, robot, trajectory, self.destination)
                return action, self.destination.reason
        return Action.TURN_LEFT, "no way to any destination, looking again"

    def way_left(self, robot: Pose2) -> list[tuple[float, float]]:
        """The way still to go to the destination, from the robot on, metres."""
        return self._navigator.remaining(robot)

    def forget_visits(self) -> None:
        """Explore anew over the same map: a place counts as visited even if it was hardly seen."""
        self._explorer.reset(self._goal)

    def drain_offered(self) -> list[BlockRecord]:
        """The blocks of the map question that was asked since the last call, if any."""
        offered, self._offered = self._offered, ()
        return [
            BlockRecord(
                number=block.number, x_min=block.x_min, y_min=block.y_min, size_m=block.size_m
            )
            for block in offered
        ]

    def _pursue(self, grid: OccupancyGrid, robot: Pose2, bearing: float, events: list[str]) -> None:
        """Head for a goal that is in sight but too far away to be measured."""
        point = last_free_towards(grid, robot, bearing)
        near_m = 2.0 * self._config.arrival_distance_m
        if robot.distance_to(*point) <= near_m:
            return
        # Been there, and the goal was still out of reach: explore instead of going to and fro.
        if any(math.dist(point, place) <= near_m for place in self._pursued):
            return
        if self.destination is None or not self.destination.is_sighting:
            events.append("goal seen far away")
            self._progress.reset()
        reason = f"the {self._goal.thing} is in sight, too far away to be measured"
        self.destination = Destination(*point, reason=reason, is_sighting=True)

    def _look_across(self, grid: OccupancyGrid, robot: Pose2) -> Action | None:
        """At the destination, the turn towards what is still unexplored around it.

        Who comes to a door sideways has not yet looked through it.
        """
        destination, config = self.destination, self._config
        if (
            not config.look_across_boundary
            or destination is None
            or destination.is_sighting
            or self._age >= config.endurance_steps
            or robot.distance_to(*destination.xy) >= config.arrival_distance_m
        ):
            return None
        points = unexplored_boundary(grid, destination.xy, config.drop_explored_radius_m)
        if len(points) * grid.resolution_m < _WORTH_A_TURN_M:
            return None
        away = points - np.array(robot.xy)
        ahead = np.array(robot.xy) + (away / np.linalg.norm(away, axis=1, keepdims=True)).mean(0)
        return turn_towards(robot, (float(ahead[0]), float(ahead[1])), config.turn_angle_deg)

    def _drop_finished(self, grid: OccupancyGrid, robot: Pose2, events: list[str]) -> None:
        """The conditions for a new destination: reached, endurance exceeded, nothing left there."""
        destination, config = self.destination, self._config
        if destination is None:
            return
        if robot.distance_to(*destination.xy) < config.arrival_distance_m:
            self._end("destination reached", events)
        elif self._age >= config.endurance_steps and not config.give_up_when_stuck:
            self._end("endurance exceeded", events)
        elif (
            config.drop_explored
            and not destination.is_sighting
            and len(unexplored_boundary(grid, destination.xy, config.drop_explored_radius_m)) == 0
        ):
            self._end("destination explored", events)

    def _end(self, event: str, events: list[str]) -> None:
        if self.destination is None:
            return
        events.append(event)
        if self.destination.is_sighting:
            self._pursued.append(self.destination.xy)
        else:
            self._explorer.remember_visit(*self.destination.xy)
        self.destination, self._age = None, 0


def unexplored_boundary(
    grid: OccupancyGrid, place: tuple[float, float], radius_m: float
) -> Float64[np.ndarray, "n 2"]:
    """Where free floor borders on the unknown around a place ``(x, y)``; all in metres."""
    row, column = grid.cell_of(*place)
    reach = math.ceil(radius_m / grid.resolution_m)
    bottom, left = max(row - reach, 0), max(column - reach, 0)
    window = (slice(bottom, row + reach + 1), slice(left, column + reach + 1))
    beside_unknown = cv2.dilate((~grid.explored[window]).astype(np.uint8), np.ones((3, 3)))
    return grid.centres_of(
        np.argwhere(grid.free[window] & (beside_unknown > 0)) + np.array([bottom, left])
    )


def turn_towards(robot: Pose2, point: tuple[float, float], turn_angle_deg: float) -> Action | None:
    """The turn that brings a point ``(x, y)``, metres, ahead; None if it is as good as ahead."""
    bearing = robot.bearing_to(*point)
    if abs(bearing) <= math.radians(turn_angle_deg) / 2 + 1e-6:
        return None
    return Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT
