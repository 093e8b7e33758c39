"""A full turn around."""

from hypernav.agents.phases.step import Decision, PhaseName, Step
from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.trace import Mode


class LookAround:
    """Turns until a full circle is done, then hands over to exploration."""

    def __init__(self, motion: MotionConfig) -> None:
        """Begin with nothing to turn.

        Args:
            motion: Angle of a turn.
        """
        self._turns_of_a_circle = motion.turns_of_a_circle
        self._turns_left = 0

    def begin(self) -> None:
        """Turn a full circle from the next step on."""
        self._turns_left = self._turns_of_a_circle

    def cancel(self) -> None:
        """Turn no further."""
        self._turns_left = 0

    def act(self, step: Step) -> Decision | PhaseName:
        """The next turn of the circle, if one is left."""
        if self._turns_left == 0:
            return PhaseName.EXPLORE
        self._turns_left -= 1
        return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, "looking around")
