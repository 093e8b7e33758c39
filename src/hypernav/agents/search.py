"""The search that the agents of this package share; they differ in how they explore."""

from dataclasses import dataclass

import numpy as np

from hypernav.agents.config import SearchConfig
from hypernav.agents.exploration import Exploration, turn_towards
from hypernav.agents.progress import Progress
from hypernav.agents.second_look import place_for_second_look
from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.errors import WorldError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.protocols import PresenceCheck
from hypernav.core.trace import ExchangeLog, Mode, StepTrace
from hypernav.mapping.top_down_map import TopDownMap
from hypernav.perception.explorers.explorer import Explorer
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.perception.local.target import Target
from hypernav.planning.bump_sensor import BumpSensor
from hypernav.planning.config import PlanningConfig
from hypernav.planning.navigator import Navigator

GAVE_UP = "gave up"
"""Event of the last step when an agent stops because nothing is left to explore."""

_CLOSE_BY_M = 1.5
"""Who gets no nearer than this is at the goal area: something stands around it."""


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
        planning: PlanningConfig,
        presence: PresenceCheck | None,
        log: ExchangeLog,
        config: SearchConfig,
    ) -> None:
        """Put the parts together; `hypernav.build.agents` does it from a configuration.

        Args:
            world_map: Draws the map.
            local: Sees the goal and says where it is.
            explorer: Says where to go while the goal is out of sight.
            planning: How it drives.
            presence: Looks once more before STOP; None trusts the goal area.
            log: What detectors and reasoners were asked, for the trace.
            config: Values of the method.
        """
        self._map = world_map
        self._local = local
        # Each keeps to a plan of its own: steps that lead to two places by turns lead to none.
        self._navigator = Navigator(planning)
        self._exploration = Exploration(explorer, Navigator(planning), config)
        self._bumps = BumpSensor(planning)
        self._presence = presence
        self._log = log
        self._config = config
        self._progress = Progress(config.patience_steps)
        self._last_step: StepTrace | None = None

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        self._goal = goal
        self._map = TopDownMap(self._map.config)
        self._local.reset(goal)
        self._exploration.reset(goal)
        self._navigator.reset()
        self._bumps.reset()
        self._log.drain()
        self._trajectory: list[tuple[float, float]] = []
        self._turns_left = self._turns_of_a_circle() if self._config.look_around_at_start else 0
        self._all_explored = False
        self._rest_steps = 0
        self._ends: list[tuple[float, float]] = []
        self._last_step = None
        self._step = 0
        self._forget_approach()

    def _forget_approach(self) -> None:
        self._progress.reset()
        self._second_look: tuple[float, float] | None = None

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
        self._trajectory.append(observation.robot.xy)
        with clock("map"):
            self._map.integrate(observation)
            self._map.mark_occupied(self._bumps.points(observation.robot, self.grid))
        with clock("local"):
            detections = self._local.look(observation)
        decision = self._approach(observation, clock) or self._explore(observation, clock)
        self._bumps.note_action(observation.robot, decision.action)
        robot, target = observation.robot, self._local.target
        self._last_step = StepTrace(
            step=self._step,
            pose=(robot.x, robot.y, robot.yaw),
            action=decision.action,
            mode=decision.mode,
            reason=decision.reason,
            destination=self._destination_point(target),
            path=self._way_left(robot, decision.mode),
            goal_area=target.area.outlines if target else [],
            detections=detections,
            blocks=self._exploration.drain_offered(),
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
        if self._rest_steps > 0 and not self._all_explored:
            self._rest_steps -= 1
            return None
        robot = observation.robot
        if self._second_look is not None:
            return self._look_again(observation, target, self._second_look, clock)
        if target.distance_to(*robot.xy) > self._config.stop_distance_m:
            with clock("plan"):
                action = self._navigator.towards(self.grid, robot, target.entry_points)
            path = self._navigator.path
            leads_there = path is not None and path.gap_m <= self._config.approach_gap_m
            if path is None or not (leads_there or self._all_explored):
                self._forget_approach()
                return None
            left_m = self._navigator.left_m(robot)
            if action is not None and self._progress.is_made(left_m):
                self._leave_exploration()
                return _Decision(action, Mode.APPROACH, f"going to the {self._goal.thing}")
            if left_m > _CLOSE_BY_M and not self._all_explored:
                self._rest_steps = self._config.endurance_steps
                self._events.append("goal out of reach for now")
                self._forget_approach()
                return None
        self._leave_exploration()
        return self._verify(observation, target, clock)

    def _leave_exploration(self) -> None:
        """Local perception wins."""
        self._turns_left = 0
        if self._exploration.destination is not None:
            self._events.append("goal seen")
            self._exploration.destination = None

    def _verify(
        self, observation: Observation, target: Target, clock: ModuleClock
    ) -> _Decision | None:
        """At the goal area: look at it, then stop, or reject it and search on (None)."""
        turn = self._turn_towards(observation.robot, target)
        if self._config.face_target and turn is not None:
            return _Decision(turn, Mode.VERIFY, f"turning to face the {self._goal.thing}")
        if self._config.see_before_stop and self._local.bar_place(observation):
            self._events.append("goal area not in sight from here")
            self._forget_approach()
            return self._approach(observation, clock)
        if self._local.needs_second_look:
            with clock("verify"):
                place = place_for_second_look(
                    self.grid,
                    observation.robot,
                    target.area,
                    target.best_view.robot.xy,
                    self._map.config,
                )
            if place is not None:
                self._second_look, self._second_look_steps = place, 0
                self._events.append("second look wanted")
                return self._look_again(observation, target, place, clock)
        view = target.best_view if self._config.verify_view == "best" else observation
        with clock("verify"):
            present = self._local.is_convincing and (
                self._presence is None or self._presence.is_present(view, self._goal)
            )
        if present:
            self._events.append("goal reached")
            return _Decision(Action.STOP, Mode.STOP, f"here is the {self._goal.thing}")
        return self._reject()

    def _look_again(
        self,
        observation: Observation,
        target: Target,
        place: tuple[float, float],
        clock: ModuleClock,
    ) -> _Decision | None:
        """Look at an uncertain target from another side; go back to it, or reject it (None)."""
        robot, thing = observation.robot, self._goal.thing
        self._second_look_steps += 1
        if self._second_look_steps <= self._config.endurance_steps:
            with clock("plan"):
                action = self._navigator.towards(self.grid, robot, np.array([place]))
            if action is not None:
                reason = f"is it really the {thing}? going to look from another side"
                return _Decision(action, Mode.VERIFY, reason)
        turn = self._turn_towards(robot, target)
        if turn is not None:
            return _Decision(turn, Mode.VERIFY, f"turning to face the {thing} from another side")
        if self._local.is_contradicted:
            return self._reject()
        self._local.confirm_target()
        self._forget_approach()
        return self._approach(observation, clock)

    def _reject(self) -> None:
        """Drop the target, for good."""
        self._events.append("goal area rejected")
        self._local.reject_target()
        self._forget_approach()

    def _explore(self, observation: Observation, clock: ModuleClock) -> _Decision:
        """Drive to a destination of global perception."""
        if self._turns_left > 0:
            self._turns_left -= 1
            return _Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, "looking around")
        chosen = self._exploration.next_action(
            self.grid,
            observation.robot,
            self._trajectory,
            far_bearing=self._local.far_bearing,
            clock=clock,
            events=self._events,
        )
        if chosen is None:
            return self._end_of_exploration(observation.robot)
        return _Decision(chosen[0], Mode.EXPLORE, chosen[1])

    def _end_of_exploration(self, robot: Pose2) -> _Decision:
        """Nothing is left to explore: go as near as possible to a goal in sight, or give up."""
        if self._local.target is not None and not self._all_explored:
            self._all_explored = True
            reason = f"all is explored, going as near to the {self._goal.thing} as possible"
            return _Decision(Action.TURN_LEFT, Mode.APPROACH, reason)
        if self._config.look_again_before_giving_up and self._is_new_end(robot):
            self._ends.append(robot.xy)
            self._exploration.forget_visits()
            self._map.forget_bumps()
            self._turns_left = self._turns_of_a_circle()
            return _Decision(
                Action.TURN_LEFT, Mode.LOOK_AROUND, "nothing is left to explore, looking once more"
            )
        self._events.append(GAVE_UP)
        return _Decision(Action.STOP, Mode.STOP, "nothing is left to explore")

    def _is_new_end(self, robot: Pose2) -> bool:
        """Whether exploration has not yet ended around here."""
        near_m = 2.0 * self._config.arrival_distance_m
        return all(robot.distance_to(*place) > near_m for place in self._ends)

    def _destination_point(self, target: Target | None) -> tuple[float, float] | None:
        if target is not None:
            return target.area.centre
        destination = self._exploration.destination
        return None if destination is None else destination.xy

    def _way_left(self, robot: Pose2, mode: Mode) -> list[tuple[float, float]]:
        if mode is Mode.EXPLORE:
            return self._exploration.way_left(robot)
        return self._navigator.remaining(robot) if mode in (Mode.APPROACH, Mode.VERIFY) else []

    def _turn_towards(self, robot: Pose2, target: Target) -> Action | None:
        return turn_towards(robot, target.area.centre, self._config.turn_angle_deg)

    def _turns_of_a_circle(self) -> int:
        return round(360.0 / self._config.turn_angle_deg)
