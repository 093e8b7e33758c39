"""Patience with a destination that the robot doesn't reach, as a value that every step replaces."""

import math
from dataclasses import dataclass, replace

from hypernav.agents.config import SearchConfig

_STEP_M = 0.1
"""Smallest shortening of the path that counts as progress."""
_DETOUR_STEPS_PER_M = 4
"""Number of steps and turns granted per metre of a detour."""


def patience_of(config: SearchConfig) -> "Progress | Endurance":
    """The patience that a search has with a new destination."""
    if config.give_up_when_stuck:
        return Progress(config.patience_steps)
    return Endurance(config.endurance_steps)


@dataclass(frozen=True)
class Endurance:
    """Grants every destination the same number of steps (paper: endurance limit).

    Attributes:
        limit: Number of steps for each destination.
        steps: Number of steps so far.
    """

    limit: int
    steps: int = 0

    worn_out = "endurance exceeded"

    def after(self, left_m: float, planned: int) -> "Endurance":
        """The patience after one more step; see `Progress.after`."""
        return replace(self, steps=self.steps + 1)

    @property
    def lasts(self) -> bool:
        """Whether the destination may be kept."""
        return self.steps <= self.limit


@dataclass(frozen=True)
class Progress:
    """Notices a robot that goes to and fro, or stands still, instead of coming nearer.

    It is the path that must get shorter: a robot that drives around a wall gets farther away in a
    straight line. If the path turns out to be longer, the steps of that detour are granted, and so
    are the turns of a robot that shunts its way through a gap.

    Attributes:
        patience_steps: Number of steps that may bring the robot no nearer, on top of those of a
            detour and of a planned sequence of actions.
        shortest_m: Length of the shortest path that was left so far, metres.
        longest_m: Length of the longest since then, metres.
        steps: Number of steps since then.
        planned: Largest number of planned actions since then.
    """

    patience_steps: int
    shortest_m: float = math.inf
    longest_m: float = 0.0
    steps: int = 0
    planned: int = 0

    worn_out = "no progress to destination"

    def after(self, left_m: float, planned: int) -> "Progress":
        """The patience after one more step.

        Args:
            left_m: Length of the path that is left, metres.
            planned: Number of actions that are left of the sequence under way.
        """
        if left_m < self.shortest_m - _STEP_M:
            return Progress(self.patience_steps, left_m, left_m)
        return replace(
            self,
            longest_m=max(self.longest_m, left_m),
            steps=self.steps + 1,
            planned=max(self.planned, planned),
        )

    @property
    def lasts(self) -> bool:
        """Whether the robot still makes progress."""
        detour_m = max(self.longest_m - self.shortest_m, 0.0)
        granted = self.planned + _DETOUR_STEPS_PER_M * detour_m
        return self.steps <= self.patience_steps + granted
