"""The check at the goal area, before the robot says that the goal is here."""

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.approach import Approach
from hypernav.agents.phases.second_look import SecondLook
from hypernav.agents.phases.step import Decision, PhaseName, Step, turn_towards
from hypernav.core.actions import Action
from hypernav.core.components.protocols import PresenceCheck
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, Mode
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.perception.local.target import Target
from hypernav.planning.navigator import Navigator


class Verify:
    """Faces the goal area and looks at it; then stops, goes elsewhere, or rejects it for good."""

    def __init__(
        self,
        goal: Goal,
        local: LocalPerception,
        navigator: Navigator,
        approach: Approach,
        second_look: SecondLook,
        presence: PresenceCheck | None,
        config: SearchConfig,
    ) -> None:
        """Put it together.

        Args:
            goal: Target of the search.
            local: Local perception, which knows the target.
            navigator: Navigator that drove to the goal area.
            approach: Approach, begun anew when the target turns out to be cut off or wrong.
            second_look: Second look, begun when the target is uncertain.
            presence: Presence check before STOP; None trusts the goal area.
            config: Checks to make.
        """
        self._goal = goal
        self._local = local
        self._navigator = navigator
        self._approach = approach
        self._second_look = second_look
        self._presence = presence
        self._config = config

    def act(self, step: Step) -> Decision | PhaseName:
        """Turn to the goal area, look at it, and decide."""
        target = self._local.target
        if target is None:
            return PhaseName.LOOK_AROUND
        turn = turn_towards(step.robot, target.area.centre, step.motion)
        if self._config.face_target and turn is not None:
            reason = f"turning to face the {self._goal.thing}"
            return Decision(turn, Mode.VERIFY, reason, self._navigator.remaining(step.robot))
        if self._config.see_before_stop and self._local.belief.bar_position(step.observation):
            step.events.append("goal area not in sight from here")
            self._approach.forget()
            return PhaseName.APPROACH
        if self._local.belief.needs_second_look and self._second_look.begin(step, target):
            return PhaseName.SECOND_LOOK
        with step.clock("verify"):
            present = self._is_present(step, target)
        if present:
            step.events.append("goal reached")
            reason = f"here is the {self._goal.thing}"
            return Decision(Action.STOP, Mode.STOP, reason, ending=Ending.FOUND)
        step.events.append("goal area rejected")
        self._local.belief.reject(for_good=self._local.belief.is_convincing)
        self._approach.forget()
        return PhaseName.LOOK_AROUND

    def _is_present(self, step: Step, target: Target) -> bool:
        if not self._local.belief.is_convincing:
            return False
        best = self._config.verify_view == "best"
        view = target.best_view if best else step.observation
        return self._presence is None or self._presence.is_present(view, self._goal)
