"""The approach to the goal area."""

import numpy as np
from jaxtyping import Float64

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.explore import Explore
from hypernav.agents.phases.look_around import LookAround
from hypernav.agents.phases.step import Decision, PhaseName, Step
from hypernav.agents.progress import patience_of
from hypernav.core.actions import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Mode
from hypernav.mapping.top_down_map import TopDownMap
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.perception.local.target import Target
from hypernav.planning.navigator import Navigator

_CLOSE_BY_M = 1.5
"""Length of path below which a stuck robot is at the goal area: something stands around it."""


class Approach:
    """Drives to where the goal area may be entered; rests for a while where no path leads there.

    Attributes:
        as_near_as_possible: Whether the end of the nearest path must suffice, because the goal
            comes first or because everything else is explored.
    """

    def __init__(
        self,
        goal: Goal,
        local: LocalPerception,
        navigator: Navigator,
        inside: Navigator,
        world_map: TopDownMap,
        explore: Explore,
        look_around: LookAround,
        config: SearchConfig,
    ) -> None:
        """Begin with no approach under way.

        Args:
            goal: Target of the search.
            local: Local perception, which knows the target.
            navigator: Navigator that drives there.
            inside: Navigator for the last step, into the goal area.
            world_map: Map, which knows what hides the target.
            explore: Exploration, left when the robot goes to the target: local perception wins.
            look_around: Turn around, left likewise.
            config: Distances, and the steps until the robot is stuck.
        """
        self._goal = goal
        self._local = local
        self._navigator = navigator
        self._inside = inside
        self._map = world_map
        self._explore = explore
        self._look_around = look_around
        self._config = config
        self._patience = patience_of(config)
        self._rest_steps = 0
        self.as_near_as_possible = config.local_first

    def forget(self) -> None:
        """Begin the next approach with new patience."""
        self._patience.reset()

    def rests(self) -> bool:
        """Whether the robot explores for now because it was stuck; to be asked once a step."""
        if self._rest_steps == 0 or self.as_near_as_possible:
            return False
        self._rest_steps -= 1
        return True

    def act(self, step: Step) -> Decision | PhaseName:
        """The next action towards the goal area, or the phase that takes over."""
        target, robot, config = self._local.target, step.robot, self._config
        if target is None:
            return PhaseName.LOOK_AROUND
        goals = self._goals(target)
        if _distance_m(robot, goals[0]) > config.stop_distance_m:
            with step.clock("plan"):
                action = self._navigator.towards(step.grid, robot, *goals)
                if action is None and self._navigator.arrived and config.enter_fully:
                    action = self._step_inside(step, target)
            path = self._navigator.path
            leads_there = path is not None and path.gap_m <= config.approach_gap_m
            if path is None or not (leads_there or self.as_near_as_possible):
                self.forget()
                return PhaseName.LOOK_AROUND
            left_m = self._navigator.left_m(robot)
            if action is not None and self._patience.lasts(left_m, self._navigator.planned):
                self._leave_exploration(step)
                reason = f"going to the {self._goal.thing}"
                return Decision(action, Mode.APPROACH, reason, self._navigator.remaining(robot))
            if config.local_first and (action is not None or not leads_there):
                step.events.append("goal area given up for now")
                self._local.belief.reject()
                self.forget()
                return PhaseName.LOOK_AROUND
            if left_m > _CLOSE_BY_M and not self.as_near_as_possible:
                self._rest_steps = config.endurance_steps
                step.events.append("goal out of reach for now")
                self.forget()
                return PhaseName.LOOK_AROUND
        self._leave_exploration(step)
        return PhaseName.VERIFY

    def _step_inside(self, step: Step, target: Target) -> Action | None:
        """The next action into the goal area from right before it; None if there is none."""
        points = target.area.inner_entry_points
        action, path = self._inside.towards(step.grid, step.robot, points), self._inside.path
        is_near = path is not None and path.is_sure and path.length_m < _CLOSE_BY_M
        return action if is_near else None

    def _goals(self, target: Target) -> list[Float64[np.ndarray, "_ 2"]]:
        """Sets of positions to go to, in the order of preference."""
        goals = [target.entry_points]
        if self._config.enter_in_sight:
            in_sight = target.entry_points_in_sight(self._map.eye_level)
            if 0 < len(in_sight) < len(goals[0]):
                goals.insert(0, in_sight)
        return goals

    def _leave_exploration(self, step: Step) -> None:
        """Leave exploration: local perception wins."""
        self._look_around.cancel()
        self._explore.leave(step)


def _distance_m(robot: Pose2, points: Float64[np.ndarray, "n 2"]) -> float:
    return float(np.linalg.norm(points - np.array(robot.xy), axis=1).min())
