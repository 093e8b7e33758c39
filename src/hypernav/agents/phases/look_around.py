"""A full turn around."""

from hypernav.agents.phases.step import Decision, PhaseName, Step
from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.geometry.transforms import Pose2
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
        self._last_position: tuple[float, float] | None = None

    def begin(self) -> None:
        """Turn a full circle from the next step on."""
        self._turns_left = self._turns_of_a_circle

    def cancel(self) -> None:
        """Turn no further."""
        self._turns_left = 0

    def was_at(self, robot: Pose2, within_m: float) -> bool:
        """Whether the latest turn around was here, or within a distance, metres."""
        return (
            self._last_position is not None and robot.distance_to(*self._last_position) < within_m
        )

    def act(self, step: Step) -> Decision | PhaseName:
        """The next turn of the circle, if one is left."""
        if self._turns_left == 0:
            return PhaseName.EXPLORE
        self._turns_left -= 1
        self._last_position = step.robot.xy
        return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, "looking around")
