"""What the robot believes to be the goal, and the evidence for and against it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.boxes import Box, Detection
from hypernav.core.observation import Observation
from hypernav.perception.goal_area import GoalArea

_NEAREST_M = 0.3
_SAME_WIDTH = 0.5
"""Overlap over union of the columns of a box and of an area."""
_DEPTH_SLACK_M = 0.5
_RECOGNISABLE_M = (1.0, 4.0)
_BARRED_M = 0.4
"""So far around a place that is cut off from the target all others are, too."""
_IN_BETWEEN_M = 0.15
_MEASURABLE_M = 0.6
"""What is nearer may itself be too near for the depth camera."""
_HIDDEN_SHARE = 0.8


@dataclass(frozen=True, eq=False)
class Target:
    """What the robot believes to be the goal.

    Attributes:
        area: Where it is.
        best_view: The picture that showed it largest.
        best_pixels: How large that was, square pixels of the box.
        mean_score: Of the detections in the pictures that showed it.
        sightings: Pictures that showed it.
        misses: Pictures that should have shown it and did not.
        rival_score: Sum over all pictures of the score by which the detector took it for something
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
        """Of the pictures that should have shown it, the share that did not."""
        return self.misses / self.verdicts

    @property
    def verdicts(self) -> int:
        """Pictures that showed it or should have."""
        return self.sightings + self.misses

    def seen_again(
        self, area: GoalArea, detection: Detection, observation: Observation, *, join: bool
    ) -> "Target":
        """After one more picture that shows it.

        Args:
            area: Where that picture shows it.
            detection: What the detector said.
            observation: The picture.
            join: Keep what other pictures have shown of it, instead of the latest alone.
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


def is_cut_off(area: GoalArea, observation: Observation) -> bool:
    """Whether something hides an area from a camera that looks at it, such as a wall in between.

    What lies below, above or beside the picture is not hidden.
    """
    points = np.column_stack([area.seen_points, np.full(len(area.seen_points), area.height_m)])
    ahead = observation.camera_to_map.inverse().apply(points)
    camera, distance = observation.camera, np.maximum(ahead[:, 2], 1e-6)
    column = camera.fx * ahead[:, 0] / distance + camera.cx
    row = camera.fy * ahead[:, 1] / distance + camera.cy
    shown = (ahead[:, 2] > _NEAREST_M) & (column >= 0) & (column < camera.width)
    shown &= (row >= 0) & (row < camera.height)
    if not shown.any():
        return False
    nearest = float(distance[shown].min())
    if nearest < _MEASURABLE_M:
        return False
    # What is too near to be measured has depth 0, and is in between as well. The area's own near
    # side hides its far one, so all is compared with the near side.
    depth = observation.depth[row[shown].astype(int), column[shown].astype(int)]
    return bool((depth < nearest - _IN_BETWEEN_M).mean() > _HIDDEN_SHARE)


def should_be_visible(area: GoalArea, observation: Observation) -> bool:
    """Whether most of an area lies in free sight of the camera, near enough to be recognised."""
    distance, column = _projected(area, observation)
    nearest, farthest = _RECOGNISABLE_M
    good = (distance > nearest) & (distance < farthest)
    good &= (column >= 0) & (column < observation.camera.width)
    if good.sum() < 0.8 * len(distance):
        return False
    # Nothing may stand in between: compare with the farthest return in the column.
    returns = observation.depth.max(axis=0)[column[good].astype(int)]
    return bool(((returns > distance[good] - 0.3) | (returns == 0)).mean() > 0.8)


def seems_to_hold(box: Box, area: GoalArea, observation: Observation) -> bool:
    """Whether a box seems to hold the thing in an area: it is as wide, and as far away."""
    distance, column = _projected(area, observation)
    ahead = distance > _NEAREST_M
    if not ahead.any():
        return False
    distance, column = distance[ahead], column[ahead]
    left, right = np.clip([column.min(), column.max()], 0.0, observation.camera.width)
    overlap = min(right, box.x_max) - max(left, box.x_min)
    union = max(right, box.x_max) - min(left, box.x_min)
    x_min, y_min, x_max, y_max = box.pixels()
    depth = observation.depth[y_min:y_max, x_min:x_max]
    depth = depth[depth > 0.0]
    if overlap < _SAME_WIDTH * union or len(depth) == 0:
        return False
    middle = float(np.median(depth))
    return bool(distance.min() - _DEPTH_SLACK_M < middle < distance.max() + _DEPTH_SLACK_M)


def _projected(
    area: GoalArea, observation: Observation
) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, " n"]]:
    """How far ahead the seen cells of an area are, metres, and in which columns of the picture."""
    points = np.zeros((len(area.seen_points), 3))
    points[:, :2] = area.seen_points
    in_camera = observation.camera_to_map.inverse().apply(points)
    camera, distance = observation.camera, in_camera[:, 2]
    return distance, camera.fx * in_camera[:, 0] / np.maximum(distance, 1e-6) + camera.cx


def _far_from(
    points: Float64[np.ndarray, "n 2"], places: tuple[tuple[float, float], ...]
) -> Bool[np.ndarray, " n"]:
    """Whether points are not right beside one of some places."""
    is_far = np.ones(len(points), dtype=bool)
    for place in places:
        is_far &= np.linalg.norm(points - np.array(place), axis=1) > _BARRED_M
    return is_far
