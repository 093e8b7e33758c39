"""What speaks for and against places that may be the goal, as values."""

import math
from dataclasses import dataclass, replace

from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.memory.target import Target

_SAME_SHARE = 0.5
"""Share of an area's cells in a rejected one from which on both are the same object's."""
_NEW_POSITION_M = 0.4
"""Distance from which on an image counts as another one: neighbouring ones share their errors."""


@dataclass(frozen=True, eq=False)
class Rejection:
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

    def seen_again(self, score: float, robot: Pose2, least_score: float) -> "Rejection":
        """The rejection after one more image that shows the goal there."""
        if math.dist(self.seen_from, robot.xy) < _NEW_POSITION_M:
            return self
        scores = (*self.scores, score)
        if len(scores) < self.needed or sum(scores) < least_score * len(scores):
            return replace(self, scores=scores, seen_from=robot.xy)
        return replace(self, scores=(), needed=2 * self.needed, holds=False)


@dataclass(frozen=True, eq=False)
class GoalEvidence:
    """What a search knows of the goal on one floor.

    Attributes:
        target: What is taken for the goal, however seldom it was seen; None if there is nothing.
        rejections: What is not taken for the goal, for now or for good.
        far_position: Nearest position ``(x, y)``, metres, of a goal that was seen beyond the range
            of depth; remembered until there is a target, or it is forgotten. None if there is none,
            or if it lay behind a rejected area.
        score_now: Score of the target in the latest image, less that of its strongest rival.
        missed_now: Whether the latest image should have shown the target and did not.
    """

    target: Target | None = None
    rejections: tuple[Rejection, ...] = ()
    far_position: tuple[float, float] | None = None
    score_now: float = 0.0
    missed_now: bool = False

    @property
    def is_contradicted(self) -> bool:
        """Whether the target looks more like something else in the latest image."""
        return self.score_now < 0.0

    @property
    def rejected_areas(self) -> tuple[GoalArea, ...]:
        """Areas that are not taken for the goal."""
        return tuple(one.target.area for one in self.rejections if one.holds)
