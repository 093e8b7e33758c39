"""Progress of a robot along a path that changes while it is driven."""

import math

_STEP_M = 0.1
"""Smallest shortening of the path that counts as progress."""
_DETOUR_STEPS_PER_M = 4
"""Number of steps and turns granted per metre of a detour."""


class Progress:
    """Notices a robot that goes to and fro, or stands still, instead of coming nearer.

    It is the path that must get shorter: a robot that drives around a wall gets farther away in a
    straight line. If the path turns out to be longer, the steps of that detour are granted.
    """

    def __init__(self, patience_steps: int) -> None:
        """Begin a path.

        Args:
            patience_steps: Number of steps that may bring the robot no nearer, on top of those of a
                detour.
        """
        self._patience_steps = patience_steps
        self.reset()

    def reset(self) -> None:
        """Begin another path."""
        self._shortest_m, self._longest_m, self._steps = math.inf, 0.0, 0

    def is_made(self, left_m: float) -> bool:
        """Whether the robot still makes progress; to be asked once a step.

        Args:
            left_m: Length of the path that is left, metres.
        """
        if left_m < self._shortest_m - _STEP_M:
            self._shortest_m, self._longest_m, self._steps = left_m, left_m, 0
            return True
        self._steps += 1
        self._longest_m = max(self._longest_m, left_m)
        detour_m = self._longest_m - self._shortest_m
        return self._steps <= self._patience_steps + _DETOUR_STEPS_PER_M * detour_m
