"""The search that the agents of this package share; they differ in how they explore."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from hypernav.agents.config import SearchConfig
from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.errors import WorldError
from hypernav.core.geometry import Pose2
from hypernav.core.goal import Goal
from hypernav.core.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.protocols import PresenceCheck
from hypernav.core.trace import BlockRecord, ExchangeLog, Mode, StepTrace
from hypernav.mapping import TopDownMap
from hypernav.perception.explorer import Destination, Explorer, last_free_towards
from hypernav.perception.local import LocalPerception, Target
from hypernav.planning import Navigator

GAVE_UP = "gave up"
"""Event of the last step when an agent stops because nothing is left to explore."""

_CHOICES_PER_STEP = 4
_PROGRESS_M = 0.1
_CLOSE_BY_M = 1.5
"""From here on the straight distance tells whether the robot comes nearer; before, a way may lead
around a wall."""


@dataclass(frozen=True)
class _Decision:
    """What to do in this step, and why."""

    action: Action
    mode: Mode
    reason: str


class SearchAgent:
    """Builds a map, looks for the goal, explores while it is out of sight, stops at it."""

    def __init__(
        self,
        *,
        world_map: TopDownMap,
        local: LocalPerception,
        explorer: Explorer,
        navigator: Navigator,
        presence: PresenceCheck | None,
        log: ExchangeLog,
        config: SearchConfig,
    ) -> None:
        """Put the parts together; `hypernav.build` does it from a configuration.

        Args:
            world_map: Draws the map.
            local: Sees the goal and says where it is.
            explorer: Says where to go while the goal is out of sight.
            navigator: Drives there.
            presence: Looks once more before STOP; None trusts the goal area.
            log: What detectors and reasoners were asked, for the trace.
            config: Values of the method.
        """
        self._map = world_map
        self._local = local
        self._explorer = explorer
        self._navigator = navigator
        self._presence = presence
        self._log = log
        self._config = config
        self._last_step: StepTrace | None = None

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        self._goal = goal
        self._map = TopDownMap(self._map.config)
        self._local.reset(goal)
        self._explorer.reset(goal)
        self._navigator.reset()
        self._log.drain()
        self._trajectory: list[tuple[float, float]] = []
        self._destination: Destination | None = None
        self._destination_age = 0
        self._turns_left = self._turns_of_a_circle() if self._config.look_around_at_start else 0
        self._pursued: list[tuple[float, float]] = []
        self._all_explored = False
        self._last_step = None
        self._step = 0
        self._forget_approach()

    def _forget_approach(self) -> None:
        self._nearest_m, self._steps_without_progress = math.inf, 0

    @property
    def last_step(self) -> StepTrace:
        """The trace of the latest `act`."""
        if self._last_step is None:
            raise WorldError("the agent has not acted yet; call reset(goal), then act(observation)")
        return self._last_step

    @property
    def grid(self) -> OccupancyGrid:
        """The map drawn so far."""
        return self._map.grid

    def act(self, observation: Observation) -> Action:
        """Look, decide, and say what to do next."""
        clock, self._events = ModuleClock(), list[str]()
        self._blocks: list[BlockRecord] = []
        self._trajectory.append(observation.robot.xy)
        with clock("map"):
            self._map.integrate(observation)
            self._map.mark_occupied(self._navigator.bumped_points(observation.robot))
        with clock("local"):
            detections = self._local.look(observation)
        decision = self._approach(observation, clock) or self._explore(observation, clock)
        self._navigator.note_action(observation.robot, decision.action)
        robot, target = observation.robot, self._local.target
        self._last_step = StepTrace(
            step=self._step,
            pose=(robot.x, robot.y, robot.yaw),
            action=decision.action,
            mode=decision.mode,
            reason=decision.reason,
            destination=self._destination_point(target),
            path=list(self._navigator.remaining(robot)),
            goal_area=target.area.outlines if target else [],
            detections=detections,
            blocks=self._blocks,
            exchanges=self._log.drain(),
            events=self._events,
            seconds=clock.seconds,
        )
        self._step += 1
        return decision.action

    def _approach(self, observation: Observation, clock: ModuleClock) -> _Decision | None:
        """Go to the goal area, if there is one; None if there is none or no way near it (yet)."""
        target = self._local.target
        if target is None:
            self._forget_approach()
            return None
        robot = observation.robot
        if not self._is_near_enough(target, robot):
            with clock("plan"):
                action = self._navigator.towards(self.grid, robot, target.area.points)
            path = self._navigator.path
            leads_there = path is not None and path.gap_m <= self._config.stop_distance_m
            if path is None or not (leads_there or self._all_explored):
                self._forget_approach()
                return None
            if action is not None:
                self._leave_exploration()
                return _Decision(action, Mode.APPROACH, f"going to the {self._goal.thing}")
        self._leave_exploration()
        return self._verify(observation, target, clock)

    def _leave_exploration(self) -> None:
        """Local perception wins."""
        self._turns_left = 0
        if self._destination is not None:
            self._events.append("goal seen")
            self._destination = None

    def _is_near_enough(self, target: Target, robot: Pose2) -> bool:
        """Within the stop distance, or close by and not coming any nearer."""
        left_m = target.area.distance_to(*robot.xy)
        if left_m < self._nearest_m - _PROGRESS_M or left_m > _CLOSE_BY_M:
            self._nearest_m, self._steps_without_progress = left_m, 0
        else:
            self._steps_without_progress += 1
        return (
            left_m <= self._config.stop_distance_m
            or self._steps_without_progress > self._config.approach_patience_steps
        )

    def _verify(
        self, observation: Observation, target: Target, clock: ModuleClock
    ) -> _Decision | None:
        """At the goal area: look at it, then stop, or reject it and search on (None)."""
        turn = self._turn_towards(observation.robot, target.area.centre)
        if self._config.face_target and turn is not None:
            return _Decision(turn, Mode.VERIFY, f"turning to face the {self._goal.thing}")
        view = target.best_view if self._config.verify_view == "best" else observation
        with clock("verify"):
            present = self._local.is_convincing and (
                self._presence is None or self._presence.is_present(view, self._goal)
            )
        if present:
            self._events.append("goal reached")
            return _Decision(Action.STOP, Mode.STOP, f"here is the {self._goal.thing}")
        self._events.append("goal area rejected")
        self._local.reject_target()
        self._forget_approach()
        return None

    def _explore(self, observation: Observation, clock: ModuleClock) -> _Decision:
        """Drive to a destination of global perception."""
        robot = observation.robot
        if self._turns_left > 0:
            self._turns_left -= 1
            return _Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, "looking around first")
        self._drop_finished_destination(robot)
        if self._config.pursue_far_sightings:
            self._pursue(robot)
        for _ in range(_CHOICES_PER_STEP):
            if self._destination is None:
                with clock("global"):
                    self._choose_destination(robot)
            if self._destination is None:
                return self._end_of_exploration()
            with clock("plan"):
                action = self._navigator.towards(self.grid, robot, np.array([self._destination.xy]))
            if action is not None:
                self._destination_age += 1
                return _Decision(action, Mode.EXPLORE, self._destination.reason)
            arrived = self._navigator.arrived
            self._end_destination("destination reached" if arrived else "no path to destination")
        return _Decision(Action.TURN_LEFT, Mode.EXPLORE, "no way to any destination, looking again")

    def _end_of_exploration(self) -> _Decision:
        """Nothing is left to explore: go as near as possible to a goal in sight, or give up."""
        if self._local.target is not None and not self._all_explored:
            self._all_explored = True
            reason = f"all is explored, going as near to the {self._goal.thing} as possible"
            return _Decision(Action.TURN_LEFT, Mode.APPROACH, reason)
        self._events.append(GAVE_UP)
        return _Decision(Action.STOP, Mode.STOP, "nothing is left to explore")

    def _pursue(self, robot: Pose2) -> None:
        """Head for a goal that is in sight but too far away to be measured."""
        bearing = self._local.far_bearing
        if bearing is None:
            return
        point = last_free_towards(self.grid, robot, bearing)
        near_m = 2.0 * self._config.arrival_distance_m
        if robot.distance_to(*point) <= near_m:
            return
        # Been there, and the goal was still out of reach: explore instead of going to and fro.
        if any(math.dist(point, place) <= near_m for place in self._pursued):
            return
        if self._destination is None or not self._destination.is_sighting:
            self._events.append("goal seen far away")
        reason = f"the {self._goal.thing} is in sight, too far away to be measured"
        self._destination = Destination(*point, reason=reason, is_sighting=True)

    def _drop_finished_destination(self, robot: Pose2) -> None:
        """The conditions for a new destination: reached, endurance exceeded, nothing left there."""
        destination, config = self._destination, self._config
        if destination is None:
            return
        if robot.distance_to(*destination.xy) < config.arrival_distance_m:
            self._end_destination("destination reached")
        elif self._destination_age >= config.endurance_steps:
            self._end_destination("endurance exceeded")
        elif (
            config.drop_explored and not destination.is_sighting and self._is_explored(destination)
        ):
            self._end_destination("destination explored")

    def _end_destination(self, event: str) -> None:
        if self._destination is not None:
            self._events.append(event)
            if self._destination.is_sighting:
                self._pursued.append(self._destination.xy)
            else:
                self._explorer.remember_visit(*self._destination.xy)
            self._destination = None
            self._destination_age = 0

    def _choose_destination(self, robot: Pose2) -> None:
        self._destination = self._explorer.next_destination(self.grid, robot, self._trajectory)
        self._destination_age = 0
        if self._destination is not None:
            self._blocks = [
                BlockRecord(number=b.number, x_min=b.x_min, y_min=b.y_min, size_m=b.size_m)
                for b in self._destination.blocks
            ]

    def _is_explored(self, destination: Destination) -> bool:
        """Whether nothing unknown is left around a destination."""
        grid = self.grid
        row, column = grid.cell_of(*destination.xy)
        reach = math.ceil(self._config.drop_explored_radius_m / grid.resolution_m)
        window = (
            slice(max(row - reach, 0), row + reach + 1),
            slice(max(column - reach, 0), column + reach + 1),
        )
        beside_unknown = cv2.dilate((~grid.explored[window]).astype(np.uint8), np.ones((3, 3)))
        return not bool((grid.free[window] & (beside_unknown > 0)).any())

    def _destination_point(self, target: Target | None) -> tuple[float, float] | None:
        if target is not None:
            return target.area.centre
        return None if self._destination is None else self._destination.xy

    def _turn_towards(self, robot: Pose2, point: tuple[float, float]) -> Action | None:
        bearing = robot.bearing_to(*point)
        if abs(bearing) <= math.radians(self._config.turn_angle_deg) / 2 + 1e-6:
            return None
        return Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT

    def _turns_of_a_circle(self) -> int:
        return round(360.0 / self._config.turn_angle_deg)
