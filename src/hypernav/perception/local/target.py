"""What the robot believes to be the goal, and the evidence for and against it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.boxes import Detection
from hypernav.core.observation import Observation
from hypernav.perception.local.goal_area import GoalArea

_BARRED_M = 0.4
"""So far around a place that is cut off from the target all others are, too."""


@dataclass(frozen=True, eq=False)
class Target:
    """What the robot believes to be the goal.

    Attributes:
        area: Where it is.
        best_view: The image that showed it largest.
        best_pixels: How large that was, square pixels of the box.
        mean_score: Of the detections in the images that showed it.
        sightings: Images that showed it.
        misses: Images that should have shown it and did not.
        rival_score: Sum over all images of the score by which the detector took it for something
            else.
        confirmed: Whether it was looked at once more, from another side.
        barred: Places ``(x, y)``, metres, that turned out to be cut off from it.
    """

    area: GoalArea
    best_view: Observation
    best_pixels: float
    mean_score: float
    sightings: int = 1
    misses: int = 0
    rival_score: float = 0.0
    confirmed: bool = False
    barred: tuple[tuple[float, float], ...] = ()

    @cached_property
    def entry_points(self) -> Float64[np.ndarray, "n 2"]:
        """Where the robot may go to be at the target, ``(x, y)``, metres.

        Not where it is barred, unless it is barred everywhere.
        """
        points = self.area.entry_points
        is_open = _far_from(points, self.barred)
        return points[is_open] if is_open.any() else points

    def distance_to(self, x: float, y: float) -> float:
        """Straight distance to the nearest place where the robot may go, metres."""
        return float(np.linalg.norm(self.entry_points - np.array([x, y]), axis=1).min())

    def barred_at(self, place: tuple[float, float]) -> "Target | None":
        """The same, not to be entered around a place ``(x, y)``.

        None if no other place is left, or if there is nothing to enter around this one.
        """
        other = _far_from(self.entry_points, (place,))
        if other.all() or not other.any():
            return None
        return replace(self, barred=(*self.barred, place))

    @property
    def is_outdone(self) -> bool:
        """Whether it looked more like something else than like the goal."""
        return self.rival_score > self.mean_score * self.sightings

    @property
    def missed_share(self) -> float:
        """Of the images that should have shown it, the share that did not."""
        return self.misses / self.verdicts

    @property
    def verdicts(self) -> int:
        """Images that showed it or should have."""
        return self.sightings + self.misses

    def seen_again(
        self, area: GoalArea, detection: Detection, observation: Observation, *, join: bool
    ) -> "Target":
        """After one more image that shows it.

        Args:
            area: Where that image shows it.
            detection: What the detector said.
            observation: The image.
            join: Keep what other images have shown of it, instead of the latest alone.
        """
        pixels, score = detection.box.area, float(detection.score)
        better = pixels > self.best_pixels
        return replace(
            self,
            area=self.area.joined(area) if join else area,
            best_view=observation if better else self.best_view,
            best_pixels=max(pixels, self.best_pixels),
            mean_score=self.mean_score + (score - self.mean_score) / (self.sightings + 1),
            sightings=self.sightings + 1,
        )


def same_place(a: GoalArea, b: GoalArea) -> bool:
    """Whether two areas touch."""
    return a.covers(b) > 0.0 or b.covers(a) > 0.0


def _far_from(
    points: Float64[np.ndarray, "n 2"], places: tuple[tuple[float, float], ...]
) -> Bool[np.ndarray, " n"]:
    """Whether points are not right beside one of some places."""
    is_far = np.ones(len(points), dtype=bool)
    for place in places:
        is_far &= np.linalg.norm(points - np.array(place), axis=1) > _BARRED_M
    return is_far
