"""Exploration from one destination of global perception to the next."""

import math

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.gaze import Gaze
from hypernav.agents.phases.look_around import LookAround
from hypernav.agents.phases.step import Decision, PhaseName, Step, turn_towards
from hypernav.agents.progress import patience_of
from hypernav.core.actions import Action
from hypernav.core.components.abilities import Prefetches, answers_at_once
from hypernav.core.components.protocols import Explorer
from hypernav.core.destination import Destination
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block
from hypernav.core.trace import BlockRecord, Mode
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.planning.navigator import Navigator

_CHOICES_PER_STEP = 4
_WORTH_A_TURN_M = 0.3
"""Length of the shortest boundary to the unknown that is no noise."""


class Explore:
    """Holds a destination until it is reached, given up or explored; then asks for the next.

    Attributes:
        destination: Present destination of the robot; None if there is none.
    """

    def __init__(
        self,
        goal: Goal,
        local: LocalPerception,
        explorer: Explorer,
        navigator: Navigator,
        look_around: LookAround,
        gaze: Gaze | None,
        config: SearchConfig,
    ) -> None:
        """Begin without a destination.

        Args:
            goal: Target of the search.
            local: Local perception, which knows the direction of a goal that is too far away to be
                measured.
            explorer: Explorer that chooses destinations.
            navigator: Navigator that drives there.
            look_around: Turn around, begun before questions about the map where the camera is asked
                only then.
            gaze: Choice of the turns that show something; None looks at the boundary right around
                a destination.
            config: Conditions under which a destination ends.
        """
        explorer.reset(goal)
        self._goal = goal
        self._local = local
        self._explorer = explorer
        self._navigator = navigator
        self._look_around = look_around
        self._gaze = gaze
        self._config = config
        self._patience = patience_of(config)
        self._age = self._unasked = 0
        self._left: list[tuple[float, float]] = []
        self._pursued: list[tuple[float, float]] = []
        self._expired: Destination | None = None
        self._offered: tuple[Block, ...] = ()
        self.destination: Destination | None = None

    def act(self, step: Step) -> Decision | PhaseName:
        """The next action towards a destination, or the end where nothing is left to explore."""
        config, grid, robot = self._config, step.grid, step.robot
        self._pursue(step)
        turn = self._look_across(step)
        if turn is not None:
            self._age += 1
            return self._decision(turn, "looking at what is unexplored here", robot)
        self._drop_finished(step)
        self._expire()
        self._reconsider(step)
        for _ in range(_CHOICES_PER_STEP):
            destination = self.destination
            if destination is None:
                if config.looks == "at-destinations" and not self._has_looked(robot):
                    self._look_around.begin()
                    return PhaseName.LOOK_AROUND
                with step.clock("global"):
                    destination = self._explorer.next_destination(grid, robot, step.trajectory)
                if destination is None:
                    return PhaseName.END
                self._left.clear()
                self._begin(destination)
            turn = self._facing_turn(destination, step)
            if turn is not None:
                return self._decision(turn, destination.reason, robot)
            with step.clock("plan"):
                action = self._navigator.towards(grid, robot, np.array([destination.xy]))
            if action is None:
                arrived = self._navigator.arrived
                self._end("destination reached" if arrived else "no path to destination", step)
                if destination.holds:
                    break  # The next move is chosen from another image.
            elif not self._patience.lasts(self._navigator.left_m(robot), self._navigator.planned):
                self._end(self._patience.worn_out, step)
            else:
                self._age += 1
                if isinstance(self._explorer, Prefetches):
                    self._explorer.prefetch(grid, robot, step.trajectory, destination)
                return self._decision(action, destination.reason, robot)
        return self._decision(Action.TURN_LEFT, "no way to any destination, looking again", robot)

    def _has_looked(self, robot: Pose2) -> bool:
        return self._look_around.was_at(robot, self._config.arrival_distance_m)

    def _reconsider(self, step: Step) -> None:
        """Change the destination if the explorer, asked again on the way, names another.

        One that was left for another is not gone back to on the way, so that no robot wavers.
        """
        destination, every = self.destination, self._config.reconsider_steps
        if (
            every is None
            or self._config.looks == "at-destinations"
            or destination is None
            or destination.is_sighting
            or not answers_at_once(self._explorer)
        ):
            return
        self._unasked += 1
        if self._unasked < every:
            return
        self._unasked = 0
        with step.clock("global"):
            other = self._explorer.next_destination(step.grid, step.robot, step.trajectory)
        if other is None:
            return
        self._offered = other.blocks
        near_m = 2.0 * self._config.arrival_distance_m
        if all(math.dist(other.xy, one) > near_m for one in (destination.xy, *self._left)):
            step.events.append("destination changed")
            self._left.append(destination.xy)
            self._begin(other)

    def _expire(self) -> None:
        """Ask again where to go after as many steps as the explorer wished.

        Nothing ends by this: patience goes on if the answer is the same as before.
        """
        destination = self.destination
        if destination is None or destination.most_steps is None:
            return
        self._unasked += 1
        if self._unasked >= destination.most_steps:
            self._expired, self.destination = destination, None

    def _begin(self, destination: Destination) -> None:
        again, self._expired = self._expired, None
        self.destination, self._offered = destination, destination.blocks
        self._unasked = 0
        if again is None or math.dist(again.xy, destination.xy) > self._arrival_m(destination):
            self._age = 0
            self._patience.reset()

    def _decision(self, action: Action, reason: str, robot: Pose2) -> Decision:
        return Decision(action, Mode.EXPLORE, reason, self._navigator.remaining(robot))

    def leave(self, step: Step) -> None:
        """Drop the destination, since the robot goes to the goal."""
        if self.destination is not None:
            step.events.append("goal seen")
            self.destination = None

    def forget_visits(self) -> None:
        """Explore anew over the same map: what counts as visited may hardly have been seen."""
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

    def _pursue(self, step: Step) -> None:
        """Head for a goal that was in sight, but too far away to be measured."""
        position = self._local.far_position
        if not self._config.pursue_far_sightings or position is None:
            return
        # Been there, and the goal was still out of reach: explore instead of going to and fro.
        near_m = 2.0 * self._config.arrival_distance_m
        if any(math.dist(position, other) <= near_m for other in self._pursued):
            self._local.forget_far_position()
            return
        if self.destination is None or not self.destination.is_sighting:
            step.events.append("goal seen far away")
            self._patience.reset()
        reason = f"the {self._goal.thing} is in sight, too far away to be measured"
        self.destination = Destination(*position, reason=reason, is_sighting=True)

    def _arrival_m(self, destination: Destination) -> float:
        return destination.arrival_m or self._config.arrival_distance_m

    def _facing_turn(self, destination: Destination, step: Step) -> Action | None:
        """At a destination with a heading, the turn towards it, if it is not as good as ahead."""
        face, robot = destination.face, step.robot
        if face is None or robot.distance_to(*destination.xy) >= self._arrival_m(destination):
            return None
        ahead = (robot.x + math.cos(face), robot.y + math.sin(face))
        return turn_towards(robot, ahead, step.motion)

    def _look_across(self, step: Step) -> Action | None:
        """At the destination, the turn towards what is still unexplored around it.

        A robot that comes to a door sideways has not yet looked through it.
        """
        destination, config, grid, robot = self.destination, self._config, step.grid, step.robot
        if (
            not config.look_across_boundary
            or destination is None
            or destination.is_sighting
            or destination.holds
            or self._age >= config.endurance_steps
            or robot.distance_to(*destination.xy) >= self._arrival_m(destination)
        ):
            return None
        if self._gaze is not None:
            return self._gaze.worthwhile_turn(grid, robot)
        points = unexplored_boundary(grid, destination.xy, config.drop_explored_radius_m)
        if len(points) * grid.resolution_m < _WORTH_A_TURN_M:
            return None
        away = points - np.array(robot.xy)
        ahead = np.array(robot.xy) + (away / np.linalg.norm(away, axis=1, keepdims=True)).mean(0)
        return turn_towards(robot, (float(ahead[0]), float(ahead[1])), step.motion)

    def _drop_finished(self, step: Step) -> None:
        """The conditions for a new destination: reached, or nothing left there."""
        destination, config, grid, robot = self.destination, self._config, step.grid, step.robot
        if destination is None:
            return
        if robot.distance_to(*destination.xy) < self._arrival_m(destination):
            if self._facing_turn(destination, step) is None:
                self._end("destination reached", step)
        elif (
            config.drop_explored
            and not destination.is_sighting
            and not destination.holds
            and len(unexplored_boundary(grid, destination.xy, config.drop_explored_radius_m)) == 0
        ):
            self._end("destination explored", step)

    def _end(self, event: str, step: Step) -> None:
        if self.destination is None:
            return
        step.events.append(event)
        if self.destination.is_sighting:
            self._pursued.append(self.destination.xy)
            self._local.forget_far_position()
        else:
            self._explorer.remember_visit(*self.destination.xy)
        self.destination, self._age = None, 0


def unexplored_boundary(
    grid: OccupancyGrid, position: tuple[float, float], radius_m: float
) -> Float64[np.ndarray, "n 2"]:
    """Free cells beside unknown ones around a position; points ``(x, y)``, all in metres."""
    row, column = grid.cell_of(*position)
    reach = math.ceil(radius_m / grid.resolution_m)
    bottom, left = max(row - reach, 0), max(column - reach, 0)
    around = grid.cells[bottom : max(row + reach + 1, 0), left : max(column + reach + 1, 0)]
    beside_unknown = cv2.dilate((around == Cell.UNKNOWN).view(np.uint8), np.ones((3, 3)))
    return grid.centres_of(
        np.argwhere((around == Cell.FREE) & (beside_unknown > 0)) + np.array([bottom, left])
    )
