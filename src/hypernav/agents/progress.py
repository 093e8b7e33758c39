"""Patience with a destination that the robot doesn't reach."""

import math

from hypernav.agents.config import SearchConfig

_STEP_M = 0.1
"""Smallest shortening of the path that counts as progress."""
_DETOUR_STEPS_PER_M = 4
"""Number of steps and turns granted per metre of a detour."""


def patience_of(config: SearchConfig) -> "Progress | Endurance":
    """The patience that a search has with its destinations."""
    if config.give_up_when_stuck:
        return Progress(config.patience_steps)
    return Endurance(config.endurance_steps)


class Endurance:
    """Grants every destination the same number of steps (paper: endurance limit)."""

    worn_out = "endurance exceeded"

    def __init__(self, steps: int) -> None:
        """Begin with a destination.

        Args:
            steps: Number of steps for each destination.
        """
        self._limit = steps
        self.reset()

    def reset(self) -> None:
        """Begin with another destination."""
        self._steps = 0

    def lasts(self, left_m: float, planned: int) -> bool:
        """Whether a step is left; to be asked once a step."""
        self._steps += 1
        return self._steps <= self._limit


class Progress:
    """Notices a robot that goes to and fro, or stands still, instead of coming nearer.

    It is the path that must get shorter: a robot that drives around a wall gets farther away in a
    straight line. If the path turns out to be longer, the steps of that detour are granted, and so
    are the turns of a robot that shunts its way through a gap.
    """

    worn_out = "no progress to destination"

    def __init__(self, patience_steps: int) -> None:
        """Begin a path.

        Args:
            patience_steps: Number of steps that may bring the robot no nearer, on top of those of a
                detour and of a planned sequence of actions.
        """
        self._patience_steps = patience_steps
        self.reset()

    def reset(self) -> None:
        """Begin another path."""
        self._shortest_m, self._longest_m = math.inf, 0.0
        self._steps = self._planned = 0

    def lasts(self, left_m: float, planned: int) -> bool:
        """Whether the robot still makes progress; to be asked once a step.

        Args:
            left_m: Length of the path that is left, metres.
            planned: Number of actions that are left of the sequence under way.
        """
        if left_m < self._shortest_m - _STEP_M:
            self._shortest_m, self._longest_m = left_m, left_m
            self._steps = self._planned = 0
            return True
        self._steps += 1
        self._planned = max(self._planned, planned)
        self._longest_m = max(self._longest_m, left_m)
        detour_m = self._longest_m - self._shortest_m
        granted = self._planned + _DETOUR_STEPS_PER_M * detour_m
        return self._steps <= self._patience_steps + granted
