"""A turn around, full or as far as it shows something."""

from hypernav.agents.phases.gaze import Gaze
from hypernav.agents.phases.step import Decision, PhaseName, Step
from hypernav.core.actions import Action
from hypernav.core.embodiment import MotionConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Mode


class LookAround:
    """Turns until a circle is done, or all of it was seen; then hands over to exploration."""

    def __init__(self, motion: MotionConfig, gaze: Gaze | None) -> None:
        """Begin with nothing to turn.

        Args:
            motion: Angle of a turn.
            gaze: Choice of the turns that show something; None makes every circle a full one.
        """
        self._turns_of_a_circle = motion.turns_of_a_circle
        self._gaze = gaze
        self._turns_left = 0
        self._is_full = True
        self._last_position: tuple[float, float] | None = None

    def begin(self, *, full: bool = True) -> None:
        """Turn around from the next step on.

        Args:
            full: Whether to turn a full circle, whatever it shows.
        """
        self._turns_left = self._turns_of_a_circle
        self._is_full = full

    def cancel(self) -> None:
        """Turn no further."""
        self._turns_left = 0

    def was_at(self, robot: Pose2, within_m: float) -> bool:
        """Whether the latest turn around was here, or within a distance, metres."""
        return (
            self._last_position is not None and robot.distance_to(*self._last_position) < within_m
        )

    def act(self, step: Step) -> Decision | PhaseName:
        """The next turn of the circle, if one is left that shows something."""
        turn = self._next_turn(step)
        if turn is None:
            self.cancel()
            return PhaseName.EXPLORE
        self._turns_left -= 1
        self._last_position = step.robot.xy
        return Decision(turn, Mode.LOOK_AROUND, "looking around")

    def _next_turn(self, step: Step) -> Action | None:
        if self._turns_left == 0:
            return None
        if self._is_full or self._gaze is None:
            return Action.TURN_LEFT
        return self._gaze.worthwhile_turn(step.grid, step.robot)
