"""What speaks for and against places that may be the goal, as values."""

from dataclasses import dataclass, replace

from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.memory.target import Target


@dataclass(frozen=True, eq=False)
class Rejection:
    """A rejected target of the paper's search, which keeps one place alone.

    Attributes:
        target: The target.
        looks_left: Number of images for which it is not taken for the goal.
    """

    target: Target
    looks_left: float


@dataclass(frozen=True, eq=False)
class GoalEvidence:
    """What a search knows of the goal on one floor.

    Attributes:
        candidates: What may be the goal, however little speaks for it.
        chosen: Number of the candidate that is gone to; None if there is none.
        rejections: Places that are not taken for the goal, for now or for good (paper).
        far_position: Nearest position ``(x, y)``, metres, of a goal that was seen beyond the range
            of depth; remembered until there is a target, or it is forgotten. None if there is none,
            or if it lay behind a rejected area.
        seen: Numbers of the candidates that the latest image shows.
        count: Number of candidates so far.
    """

    candidates: tuple[Target, ...] = ()
    chosen: int | None = None
    rejections: tuple[Rejection, ...] = ()
    far_position: tuple[float, float] | None = None
    seen: frozenset[int] = frozenset()
    count: int = 0

    @property
    def target(self) -> Target | None:
        """What is gone to as the goal; None if nothing is."""
        return next((one for one in self.candidates if one.number == self.chosen), None)

    @property
    def rejected_areas(self) -> tuple[GoalArea, ...]:
        """Areas that are not taken for the goal."""
        refuted = [one for one in self.candidates if one.is_refuted]
        return tuple(one.area for one in (*refuted, *(one.target for one in self.rejections)))

    def with_target(self, target: Target) -> "GoalEvidence":
        """The evidence with the candidate of this number replaced."""
        return replace(
            self,
            candidates=tuple(
                target if one.number == target.number else one for one in self.candidates
            ),
        )
