"""The target of an approach, and the evidence for and against it."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.sight_lines import lines_are_clear

_LEAST_LIKELY = 0.05
_BARRED_M = 0.4
"""Radius around a position that is cut off from the target, within which all others are, too."""


@dataclass(frozen=True, eq=False)
class Target:
    """The object that the robot takes for the goal.

    Attributes:
        area: Goal area of the target.
        best_view: Frame that showed the target largest.
        best_pixels: Area of its box in that frame, square pixels.
        mean_score: Mean score of its detections.
        log_odds: Logarithm of the odds that it is the goal, by the scores of its detections.
        sightings: Number of images that showed it.
        misses: Number of images that should have shown it and did not.
        rival_score: Sum of the scores, over all images, by which the detector took it for something
            else.
        confirmed: Whether a second look, from another side, was taken.
        barred: Positions ``(x, y)``, metres, that turned out to be cut off from it.
    """

    area: GoalArea
    best_view: Observation
    best_pixels: float
    mean_score: float
    log_odds: float = 0.0
    sightings: int = 1
    misses: int = 0
    rival_score: float = 0.0
    confirmed: bool = False
    barred: tuple[tuple[float, float], ...] = ()

    @cached_property
    def entry_points(self) -> Float64[np.ndarray, "n 2"]:
        """Points where the robot may enter the goal area, ``(x, y)``, metres.

        Barred positions are left out, unless all are barred.
        """
        points = self.area.entry_points
        is_open = _far_from(points, self.barred)
        return points[is_open] if is_open.any() else points

    def entry_points_in_sight(self, eye_level: OccupancyGrid) -> Float64[np.ndarray, "n 2"]:
        """Those of `entry_points` between which and the target nothing stands; there may be none.

        What was seen over a counter is seen from before the counter, too: positions between the
        target and a camera that saw it count, whatever the map shows there.

        Args:
            eye_level: Map of what is as high as the camera.
        """
        area = self.area
        points, seen, before = area.entry_points, area.nearest_seen_points, area.entry_before
        is_open = _far_from(points, self.barred)
        points, seen, before = points[is_open], seen[is_open], before[is_open]
        is_clear = lines_are_clear(eye_level, points, seen, through=area.seen_points)
        return points[is_clear | before]

    def distance_to(self, x: float, y: float) -> float:
        """Straight distance to the nearest entry point, metres."""
        return float(np.linalg.norm(self.entry_points - np.array([x, y]), axis=1).min())

    def barred_at(self, position: tuple[float, float]) -> "Target | None":
        """The same target, not to be entered around a position ``(x, y)``.

        None if no other entry point is left, or if there is none around this position.
        """
        other = _far_from(self.entry_points, (position,))
        if other.all() or not other.any():
            return None
        return replace(self, barred=(*self.barred, position))

    @property
    def is_outdone(self) -> bool:
        """Whether the target looked more like something else than like the goal."""
        return self.rival_score > self.mean_score * self.sightings

    @property
    def missed_share(self) -> float:
        """Share of the images that should have shown the target and did not."""
        return self.misses / self.verdicts

    @property
    def verdicts(self) -> int:
        """Number of images that showed the target or should have."""
        return self.sightings + self.misses

    def seen_again(
        self, area: GoalArea, detection: Detection, observation: Observation, *, join: bool
    ) -> "Target":
        """The target after one more image that shows it.

        Args:
            area: Goal area in that image.
            detection: Detection in that image.
            observation: Frame of that image.
            join: Whether to keep the areas of earlier images, instead of the latest alone.
        """
        pixels, score = detection.box.area, float(detection.score)
        better = pixels > self.best_pixels
        return replace(
            self,
            area=self.area.joined(area) if join else area,
            best_view=observation if better else self.best_view,
            best_pixels=max(pixels, self.best_pixels),
            mean_score=self.mean_score + (score - self.mean_score) / (self.sightings + 1),
            log_odds=self.log_odds + log_odds_of(score),
            sightings=self.sightings + 1,
        )


def log_odds_of(score: float) -> float:
    """What one detection says, its score taken for a probability; none is quite certain."""
    likely = min(max(score, _LEAST_LIKELY), 1.0 - _LEAST_LIKELY)
    return math.log(likely / (1.0 - likely))


def areas_touch(a: GoalArea, b: GoalArea) -> bool:
    """Whether two areas touch."""
    return a.covers(b) > 0.0 or b.covers(a) > 0.0


def _far_from(
    points: Float64[np.ndarray, "n 2"], positions: tuple[tuple[float, float], ...]
) -> Bool[np.ndarray, " n"]:
    """Whether points are not right beside one of some positions."""
    is_far = np.ones(len(points), dtype=bool)
    for position in positions:
        is_far &= np.linalg.norm(points - np.array(position), axis=1) > _BARRED_M
    return is_far
