"""Targets that are not taken for the goal, for now or for good."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from hypernav.core.geometry.transforms import Pose2
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.goal_area import GoalArea
from hypernav.perception.local.target import Target

_SAME_SHARE = 0.5
"""Share of an area's cells in a rejected one from which on both are the same object's."""
_NEW_POSITION_M = 0.4
"""Distance from which on an image counts as another one: neighbouring ones share their errors."""


@dataclass(frozen=True, eq=False)
class _Rejection:
    """A rejected target, and the evidence for it since then.

    Attributes:
        target: The target.
        looks_left: Number of images for which it is not taken for the goal.
        needed: Number of sightings that bring it back; infinite if it is rejected for good.
        scores: Scores of the sightings since the rejection, each from a new position.
        seen_from: Position of the latest of them, ``(x, y)``, metres.
        holds: Whether it is rejected; a target that came back may be rejected again.
    """

    target: Target
    looks_left: float
    needed: float
    scores: tuple[float, ...] = ()
    seen_from: tuple[float, float] = (math.inf, math.inf)
    holds: bool = True

    def covers(self, area: GoalArea) -> bool:
        """Whether an area is of the same object."""
        return self.target.area.covers(area) > _SAME_SHARE

    def seen_again(self, score: float, robot: Pose2, least_score: float) -> "_Rejection":
        """The rejection after one more image that shows the goal there."""
        if math.dist(self.seen_from, robot.xy) < _NEW_POSITION_M:
            return self
        scores = (*self.scores, score)
        if len(scores) < self.needed or sum(scores) < least_score * len(scores):
            return replace(self, scores=scores, seen_from=robot.xy)
        return replace(self, scores=(), needed=2 * self.needed, holds=False)


class Rejections:
    """All rejections of a search."""

    def __init__(self, config: LocalConfig) -> None:
        """Begin with none.

        Args:
            config: How long a rejection lasts, and what brings a target back.
        """
        self._config = config
        self._rejections: list[_Rejection] = []

    @property
    def areas(self) -> Iterator[GoalArea]:
        """Areas that are not taken for the goal."""
        return (one.target.area for one in self._rejections if one.holds)

    def note_a_look(self) -> None:
        """Count one more image; some rejections end by that."""
        self._rejections = [
            replace(one, looks_left=one.looks_left - 1)
            for one in self._rejections
            if one.looks_left > 0
        ]

    def add(self, target: Target, *, for_good: bool) -> None:
        """Reject a target.

        Args:
            target: The target.
            for_good: Whether no later image can bring it back.
        """
        config = self._config
        before = next((one for one in self._rejections if one.covers(target.area)), None)
        needed = float(config.min_verdicts) if before is None else before.needed
        if for_good or not config.believe_again:
            needed = math.inf
        looks_left = config.rejected_for_looks or math.inf
        self._rejections = [one for one in self._rejections if one is not before]
        self._rejections.append(_Rejection(target, looks_left, needed))

    def bars(self, area: GoalArea, score: float, robot: Pose2) -> bool:
        """Whether an area that an image shows stays rejected after this image.

        Args:
            area: Goal area of a detection.
            score: Score of the detection.
            robot: Pose of the robot that took the image.
        """
        is_barred = False
        for number, one in enumerate(self._rejections):
            if one.holds and one.covers(area):
                one = one.seen_again(score, robot, self._config.min_mean_score)
                self._rejections[number] = one
                is_barred |= one.holds
        return is_barred

    def take_most_likely(self) -> Target | None:
        """The target with the best mean score that is not rejected for good; each comes once."""
        soft = [one for one in self._rejections if one.holds and one.needed < math.inf]
        if not soft:
            return None
        best = max(soft, key=lambda one: one.target.mean_score)
        self._rejections = [one for one in self._rejections if one is not best]
        self._rejections.append(replace(best, needed=math.inf, holds=False))
        return best.target
