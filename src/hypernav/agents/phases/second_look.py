"""A second look at an uncertain target, from another side, before the robot believes in it."""

import numpy as np

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.approach import Approach
from hypernav.agents.phases.other_side import position_on_other_side
from hypernav.agents.phases.step import Decision, PhaseName, Step, turn_towards
from hypernav.core.goal import Goal
from hypernav.core.trace import Mode
from hypernav.mapping.config import MappingConfig
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.perception.local.target import Target
from hypernav.planning.navigator import Navigator


class SecondLook:
    """Drives to another side of the target and looks; then confirms or rejects it."""

    def __init__(
        self,
        goal: Goal,
        local: LocalPerception,
        navigator: Navigator,
        approach: Approach,
        mapping: MappingConfig,
        clearance_m: float,
        config: SearchConfig,
    ) -> None:
        """Begin with no second look under way.

        Args:
            goal: Target of the search.
            local: Local perception, which knows the target and the latest evidence.
            navigator: Navigator that drives to the other side.
            approach: Approach, begun anew when the look is done.
            mapping: Configuration of the map.
            clearance_m: Distance from obstacles that the robot's middle keeps, metres.
            config: Limit on its steps.
        """
        self._goal = goal
        self._local = local
        self._navigator = navigator
        self._approach = approach
        self._mapping = mapping
        self._clearance_m = clearance_m
        self._config = config
        self._position: tuple[float, float] | None = None
        self._steps = 0

    @property
    def is_under_way(self) -> bool:
        """Whether the robot drives to the other side, or turns to the target there."""
        return self._position is not None

    def begin(self, step: Step, target: Target) -> bool:
        """Look for a position on another side of the target.

        Returns:
            Whether there is one that can be reached.
        """
        with step.clock("verify"):
            seen_from = target.best_view.robot.xy
            self._position = position_on_other_side(
                step.grid, step.robot, target.area, seen_from, self._mapping, self._clearance_m
            )
        self._steps = 0
        if self._position is not None:
            step.events.append("second look wanted")
        return self.is_under_way

    def cancel(self) -> None:
        """End the second look without a verdict."""
        self._position = None

    def act(self, step: Step) -> Decision | PhaseName:
        """Drive to the other side, turn to the target, and judge it by the image there."""
        target, position, robot, thing = (
            self._local.target,
            self._position,
            step.robot,
            self._goal.thing,
        )
        if target is None or position is None:
            return PhaseName.LOOK_AROUND
        self._steps += 1
        if self._steps <= self._config.endurance_steps:
            with step.clock("plan"):
                action = self._navigator.towards(step.grid, robot, np.array([position]))
            if action is not None:
                reason = f"is it really the {thing}? going to look from another side"
                return Decision(action, Mode.VERIFY, reason, self._navigator.remaining(robot))
        turn = turn_towards(robot, target.area.centre, step.motion)
        if turn is not None:
            reason = f"turning to face the {thing} from another side"
            return Decision(turn, Mode.VERIFY, reason, self._navigator.remaining(robot))
        self.cancel()
        self._approach.forget()
        is_missed = self._local.belief.is_missed and self._config.second_look_must_see
        if is_missed or self._local.belief.is_contradicted:
            step.events.append("goal area rejected")
            self._local.belief.reject()
            return PhaseName.LOOK_AROUND
        self._local.belief.confirm()
        return PhaseName.APPROACH
