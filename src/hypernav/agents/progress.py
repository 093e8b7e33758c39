"""Whether a robot gets on along a way that changes while it is driven."""

import math

_STEP_M = 0.1
"""Less is not nearer."""
_DETOUR_STEPS_PER_M = 4
"""Steps and turns of a detour that turned out to be necessary."""


class Progress:
    """Notices a robot that goes to and fro, or stands still, instead of coming nearer.

    It is the way that must get shorter: who walks around a wall gets farther away as the crow
    flies. If the way turns out to be longer, that detour is waited for.
    """

    def __init__(self, patience_steps: int) -> None:
        """Begin a way.

        Args:
            patience_steps: Steps that may bring the robot no nearer, on top of those that a detour
                takes.
        """
        self._patience_steps = patience_steps
        self.reset()

    def reset(self) -> None:
        """Begin another way."""
        self._shortest_m, self._longest_m, self._steps = math.inf, 0.0, 0

    def is_made(self, left_m: float) -> bool:
        """Whether the robot still gets on; to be asked once a step.

        Args:
            left_m: Length of the way that is left.
        """
        if left_m < self._shortest_m - _STEP_M:
            self._shortest_m, self._longest_m, self._steps = left_m, left_m, 0
            return True
        self._steps += 1
        self._longest_m = max(self._longest_m, left_m)
        detour_m = self._longest_m - self._shortest_m
        return self._steps <= self._patience_steps + _DETOUR_STEPS_PER_M * detour_m
