"""Candidates for the goal, and the evidence for and against them, as values."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.search.mapping.sight_lines import lines_are_clear
from hypernav.search.memory.goal_area import GoalArea

_SAME_POSITION_M = 0.4
"""Distance within which two positions count as one, metres: of views, and of what is barred."""
_PRIOR = -1.4
"""Log-odds of a candidate before any look: what a detector reports weakly is seldom right."""
_MOST_BY_LOOKS = 6.0
"""Largest shift of the log-odds by all looks together: a detector often makes the same mistake from
all sides, so the candidate's form must still be able to refute it."""
_BESIDE_M = 2.0
"""Distance from an entry point, metres, up to which a view of the target is beside it."""
_SAME_VIEW_DEG = 22.5
"""Views share their errors below this turn around the target, or half a halving of the distance."""


def log_odds_by(weights: Iterable[float]) -> float:
    """Log-odds that something is the goal, by the weights of all looks at it."""
    return _PRIOR + min(sum(weights), _MOST_BY_LOOKS)


@dataclass(frozen=True)
class ViewEvidence:
    """Evidence of the images from about one position for or against a candidate.

    Attributes:
        position: Position ``(x, y)`` of the robot, ``map`` frame, metres.
        weight: Shift of the log-odds that the candidate is the goal.
    """

    position: tuple[float, float]
    weight: float


@dataclass(frozen=True)
class Measure:
    """Measurements of a candidate's form in one image.

    Attributes:
        towards: Direction from the candidate to the camera, ``map`` frame, radians.
        width_m: Its horizontal extent, metres: of a flat upright face along it, else across the
            line of sight. None where the image doesn't show it whole.
        is_face: Whether it is a flat upright face, whose extent shows from any side.
        level_share: Share of its surface that is level and faces up, 0 to 1; None where it is too
            far away to tell.
        is_below_eye: Whether its top is so far below the camera that a level one would show.
    """

    towards: float
    width_m: float | None
    is_face: bool
    level_share: float | None
    is_below_eye: bool


@dataclass(frozen=True, eq=False)
class Candidate:
    """An object that may be the goal. The robot goes to one of them at a time, its target.

    Attributes:
        area: Goal area of the object.
        best_view: Frame that showed the object largest.
        best_pixels: Area of its box in that frame, square pixels.
        looks: Looks at it, each from another position.
        measures: Measurements of its form, each from an image that shows it.
        form: Shift of the log-odds by all measurements together.
        is_form_doubtful: Whether its form would speak against it if it were the same from another
            side.
        needed: Log-odds from which the robot goes to it; more than it has if it was refuted.
        is_last_chance: Whether the robot goes to it because nothing else is left.
        confirmed: Whether a second look, from another side, was taken.
        barred: Positions ``(x, y)``, metres, that turned out to be cut off from it.
        number: Number of the candidate in its search.
    """

    area: GoalArea
    best_view: Observation
    best_pixels: float
    looks: tuple[ViewEvidence, ...] = ()
    measures: tuple[Measure, ...] = ()
    form: float = 0.0
    is_form_doubtful: bool = False
    needed: float = -math.inf
    is_last_chance: bool = False
    confirmed: bool = False
    barred: tuple[tuple[float, float], ...] = ()
    number: int = 0

    @cached_property
    def entry_points(self) -> Float64[np.ndarray, "n 2"]:
        """Points where the robot may enter the goal area, ``(x, y)``, ``map`` frame, metres.

        Barred positions are left out, unless all are barred.
        """
        points = self.area.entry_points
        is_open = _far_from(points, self.barred)
        return points[is_open] if is_open.any() else points

    def entry_points_in_sight(self, eye_level: OccupancyGrid) -> Float64[np.ndarray, "n 2"]:
        """The unbarred entry points with a clear line to the target, ``(x, y)``; there may be none.

        A target that was seen over a counter is seen from before the counter, too: points between
        the target and a camera that saw it count, whatever the map shows there.

        Args:
            eye_level: Map of what is as high as the camera; see `TopDownMap.eye_level`.
        """
        area = self.area
        points, seen, before = area.entry_points, area.nearest_seen_points, area.entry_before
        is_open = _far_from(points, self.barred)
        points, seen, before = points[is_open], seen[is_open], before[is_open]
        is_clear = lines_are_clear(eye_level, points, seen, through=area.seen_points)
        return points[is_clear | before]

    def points_beside_in_sight(
        self, eye_level: OccupancyGrid, gap_m: float
    ) -> Float64[np.ndarray, "n 2"]:
        """Points beside the entry points with a clear line to the target, ``(x, y)``, metres.

        Args:
            eye_level: Map of what is as high as the camera; see `TopDownMap.eye_level`.
            gap_m: Largest distance from an entry point, metres.
        """
        points, seen = self.area.beside(gap_m)
        is_open = _far_from(points, self.barred)
        points, seen = points[is_open], seen[is_open]
        return points[lines_are_clear(eye_level, points, seen, through=self.area.seen_points)]

    @property
    def nearest_view(self) -> tuple[float, float]:
        """A position, no frame: ``(x, y)``, metres, the nearest from which it was seen."""
        positions = [one.position for one in self.looks if one.weight > 0.0]
        positions.append(self.best_view.robot.xy)
        return min(positions, key=lambda position: self.area.distance_to(*position))

    @property
    def views_beside(self) -> Float64[np.ndarray, "n 2"]:
        """The same position, if it is so near that the goal may be reached there; else none."""
        view = self.nearest_view
        near = self.distance_to(*view) <= _BESIDE_M
        return np.array([view] if near else []).reshape(-1, 2)

    def distance_to(self, x: float, y: float) -> float:
        """Straight distance from a position, metres, to the nearest entry point, metres."""
        dx, dy = self.entry_points[:, 0] - x, self.entry_points[:, 1] - y
        return math.sqrt((dx * dx + dy * dy).min())

    def barred_at(self, position: tuple[float, float]) -> "Candidate | None":
        """The same candidate with the entry points around a position ``(x, y)``, metres, barred.

        None if no other entry point would be left, or if there is none around this position.
        """
        other = _far_from(self.entry_points, (position,))
        if other.all() or not other.any():
            return None
        return replace(self, barred=(*self.barred, position))

    @property
    def log_odds(self) -> float:
        """Natural logarithm of the odds that it is the goal, by all looks at it and its form."""
        return log_odds_by(one.weight for one in self.looks) + self.form

    @property
    def chance(self) -> float:
        """Chance that it is the goal, by the same."""
        return 1.0 / (1.0 + math.exp(-self.log_odds))

    @property
    def is_refuted(self) -> bool:
        """Whether it was rejected, and too little new evidence has spoken for it since."""
        return self.log_odds < self.needed

    def seen_again(
        self, area: GoalArea, detection: Detection, observation: Observation, *, join: bool
    ) -> "Candidate":
        """The candidate after one more image that shows it.

        Args:
            area: Goal area in that image.
            detection: Detection in that image.
            observation: Frame of that image.
            join: Whether to keep the areas of earlier images, instead of the latest alone.
        """
        pixels = detection.box.area
        return replace(
            self,
            area=self.area.joined(area) if join else area,
            best_view=observation if pixels > self.best_pixels else self.best_view,
            best_pixels=max(pixels, self.best_pixels),
        )

    def with_look(self, position: tuple[float, float], weight: float) -> "Candidate":
        """The candidate after one more look from a position ``(x, y)``, metres.

        Images from about one position share their errors: only their largest weight counts.
        """
        same = [one for one in self.looks if self._is_same_view(one.position, position)]
        if not same:
            return replace(self, looks=(*self.looks, ViewEvidence(position, weight)))
        nearest = min(same, key=lambda one: math.dist(one.position, position))
        if weight <= nearest.weight:
            return self
        better = replace(nearest, weight=weight)
        return replace(self, looks=tuple(better if one is nearest else one for one in self.looks))

    def _is_same_view(self, a: tuple[float, float], b: tuple[float, float]) -> bool:
        if math.dist(a, b) < _SAME_POSITION_M:
            return True
        x, y = self.area.centre
        from_a, from_b = math.dist(a, (x, y)), math.dist(b, (x, y))
        if min(from_a, from_b) == 0.0:
            return False
        towards_a, towards_b = math.atan2(a[1] - y, a[0] - x), math.atan2(b[1] - y, b[0] - x)
        turn = math.remainder(towards_a - towards_b, math.tau)
        side = math.degrees(abs(turn)) / _SAME_VIEW_DEG
        return math.hypot(side, 2.0 * math.log2(from_a / from_b)) < 1.0


def areas_touch(a: GoalArea, b: GoalArea) -> bool:
    """Whether the dilated cells of one of two areas hold a seen cell of the other."""
    return a.covers(b) > 0.0 or b.covers(a) > 0.0


def _far_from(
    points: Float64[np.ndarray, "n 2"], positions: tuple[tuple[float, float], ...]
) -> Bool[np.ndarray, " n"]:
    """Which points are farther than `_SAME_POSITION_M` from all given positions; all in metres."""
    is_far = np.ones(len(points), dtype=bool)
    for position in positions:
        is_far &= np.linalg.norm(points - np.array(position), axis=1) > _SAME_POSITION_M
    return is_far


@dataclass(frozen=True, eq=False)
class Rejection:
    """A rejected target of the paper's search, which keeps only one target at a time.

    Attributes:
        target: The target.
        looks_left: Number of further images for which it is not taken for the goal.
    """

    target: Candidate
    looks_left: float


@dataclass(frozen=True, eq=False)
class GoalEvidence:
    """What a search knows of the goal on one floor: candidates and rejections.

    Attributes:
        candidates: All objects that may be the goal, however little speaks for them.
        chosen: Number of the candidate that the robot goes to; None if there is none.
        rejections: Targets that are not taken for the goal, for now or for good (paper).
        far_position: Position ``(x, y)``, metres, at the end of the range of depth in the direction
            of a goal that was seen beyond it; kept until there is a target or its pursuit ends.
            None if there is none, or if it lay behind a rejected area.
        seen: Numbers of the candidates that the latest image shows.
        count: Number of candidates so far, for the next one's number.
    """

    candidates: tuple[Candidate, ...] = ()
    chosen: int | None = None
    rejections: tuple[Rejection, ...] = ()
    far_position: tuple[float, float] | None = None
    seen: frozenset[int] = frozenset()
    count: int = 0

    @property
    def target(self) -> Candidate | None:
        """The candidate that the robot goes to; None if there is none."""
        return next((one for one in self.candidates if one.number == self.chosen), None)

    @property
    def rejected_areas(self) -> tuple[GoalArea, ...]:
        """Areas of refuted candidates and rejected targets, which are not taken for the goal."""
        refuted = [one for one in self.candidates if one.is_refuted]
        return tuple(one.area for one in (*refuted, *(one.target for one in self.rejections)))

    def with_candidate(self, candidate: Candidate) -> "GoalEvidence":
        """The evidence with the candidate of this number replaced."""
        return replace(
            self,
            candidates=tuple(
                candidate if one.number == candidate.number else one for one in self.candidates
            ),
        )
