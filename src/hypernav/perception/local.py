"""Local perception: is the goal in the picture, and where on the floor plan is it?"""

import math
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.boxes import Detection
from hypernav.core.config import RoomConfig
from hypernav.core.geometry import wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.protocols import Detector, Segmenter
from hypernav.core.trace import DetectionRecord
from hypernav.perception.goal_area import GoalArea, points_under_mask

_NO_DEPTH = "too few points with depth"
_BESIDE_REJECTED_DEG = 10.0


class LocalConfig(RoomConfig):
    """How a detection becomes a goal area.

    Attributes:
        min_depth_m: Nearest usable depth.
        max_depth_m: Farthest usable depth.
        erosion_px: Side of the kernel that erodes the mask, so that its edge does not spill onto
            the background (paper: "the mask is eroded").
        min_points: Fewer points of the target with depth are not trusted.
        dilation_kernel: Side of the kernel that dilates the cells (paper: 5×5).
        dilation_iterations: How often (paper: 3).
        largest_cluster_only: Keep only the cells that hang together with most points.
        target: "latest": every new detection moves the goal area (paper). "hold": the robot keeps
            to one target, whose area grows with every look at it, and other detections do not
            distract it.
        pick: Which of several detections becomes the target: the detector's "first" (paper), or
            the one "nearest" to the robot.
        min_sightings: A target counts only when seen in this many pictures.
        min_mean_score: A target whose detections were less certain on average is rejected when the
            robot stands before it.
        max_missed_share: A held target is dropped when, of the pictures that should have shown it,
            more than this share did not. 1 never drops one.
        min_verdicts: Pictures needed before that share is believed.
    """

    min_depth_m: float = 0.5
    max_depth_m: float = 5.0
    erosion_px: int = 5
    min_points: int = 12
    dilation_kernel: int = 5
    dilation_iterations: int = 3
    largest_cluster_only: bool = True
    target: Literal["latest", "hold"] = "hold"
    pick: Literal["first", "nearest"] = "nearest"
    min_sightings: int = 1
    min_mean_score: float = 0.45
    max_missed_share: float = 0.75
    min_verdicts: int = 4


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
    """

    area: GoalArea
    best_view: Observation
    best_pixels: float
    mean_score: float
    sightings: int = 1
    misses: int = 0


@dataclass(frozen=True, eq=False)
class _Candidate:
    detection: Detection
    area: GoalArea


class LocalPerception:
    """Detect, segment, refine, project; remembers the target and what was rejected."""

    def __init__(
        self, detector: Detector, segmenter: Segmenter, config: LocalConfig, *, cell_size_m: float
    ) -> None:
        """Create it.

        Args:
            detector: Finds boxes of the goal.
            segmenter: Finds the pixels in a box; not asked where a detection has its own mask.
            config: Values of the method.
            cell_size_m: Of the map.
        """
        self._detector = detector
        self._segmenter = segmenter
        self._config = config
        self._cell_size_m = cell_size_m
        self.reset(Goal("nothing yet"))

    def reset(self, goal: Goal) -> None:
        """Forget target and rejections."""
        self._goal = goal
        self._target: Target | None = None
        self._rejected: list[GoalArea] = []
        self._far_bearing: float | None = None

    @property
    def far_bearing(self) -> float | None:
        """Direction of a goal that the latest picture shows beyond the range of depth.

        Radians from the robot's heading, positive to the left; None if there is no such sighting,
        or if it lies behind a rejected area.
        """
        return self._far_bearing

    @property
    def target(self) -> Target | None:
        """The target, once it was seen often enough."""
        if self._target is None or self._target.sightings < self._config.min_sightings:
            return None
        return self._target

    @property
    def is_convincing(self) -> bool:
        """Whether the detections of the target were certain enough on average."""
        target = self._target
        return target is not None and target.mean_score >= self._config.min_mean_score

    def reject_target(self) -> None:
        """Drop the target and never take anything in its area for the goal again."""
        if self._target is not None:
            self._rejected.append(self._target.area)
            self._target = None

    def look(self, observation: Observation) -> list[DetectionRecord]:
        """Search one picture and update the target.

        Returns:
            Every detection of the picture, and why it did or did not give a goal area.
        """
        records: list[DetectionRecord] = []
        candidates: list[_Candidate] = []
        self._far_bearing = None
        for detection in self._detector.detect(observation, self._goal):
            mask = self._refined_mask(detection, observation)
            area, reason = self._area(mask, observation)
            if area is not None:
                candidates.append(_Candidate(detection, area))
            elif reason == _NO_DEPTH and self._far_bearing is None:
                self._far_bearing = self._bearing_of(detection, observation)
            records.append(_record(detection, mask, accepted=area is not None, reason=reason))
        self._update(candidates, observation)
        return records

    def _refined_mask(
        self, detection: Detection, observation: Observation
    ) -> Bool[np.ndarray, "height width"]:
        mask = detection.mask
        if mask is None:
            mask = self._segmenter.segment(observation, detection.box)
        kernel = np.ones((self._config.erosion_px, self._config.erosion_px), np.uint8)
        eroded = cv2.erode(mask.astype(np.uint8), kernel).astype(bool)
        # A thin thing would vanish; a little background is the smaller evil.
        return eroded if 4 * int(eroded.sum()) >= int(mask.sum()) else mask

    def _area(
        self, mask: Bool[np.ndarray, "height width"], observation: Observation
    ) -> tuple[GoalArea | None, str]:
        config = self._config
        points = points_under_mask(
            mask,
            observation,
            min_depth_m=config.min_depth_m,
            max_depth_m=config.max_depth_m,
            stride=2 if int(mask.sum()) > 4000 else 1,
        )
        if len(points) < config.min_points:
            return None, _NO_DEPTH
        area = GoalArea.from_points(
            points,
            resolution_m=self._cell_size_m,
            kernel=config.dilation_kernel,
            iterations=config.dilation_iterations,
            largest_cluster_only=config.largest_cluster_only,
        )
        if area is None:
            return None, _NO_DEPTH
        if any(rejected.covers(area) > 0.5 for rejected in self._rejected):
            return None, "rejected before"
        return area, ""

    def _bearing_of(self, detection: Detection, observation: Observation) -> float | None:
        camera, robot = observation.camera, observation.robot
        column = (detection.box.x_min + detection.box.x_max) / 2.0
        bearing = math.atan2(camera.cx - column, camera.fx)
        for rejected in self._rejected:
            away = wrap_angle(robot.bearing_to(*rejected.centre) - bearing)
            if abs(away) < math.radians(_BESIDE_REJECTED_DEG):
                return None
        return bearing

    def _update(self, candidates: list[_Candidate], observation: Observation) -> None:
        if self._config.pick == "nearest":
            candidates = sorted(candidates, key=lambda c: c.area.distance_to(*observation.robot.xy))
        if self._target is None or self._config.target == "latest":
            if candidates:
                self._target = self._merged(candidates[0], observation)
            return
        same = next((c for c in candidates if _same_place(c.area, self._target.area)), None)
        if same is not None:
            self._target = self._merged(same, observation)
        elif _should_be_visible(self._target.area, observation):
            self._target = replace(self._target, misses=self._target.misses + 1)
            self._drop_if_refuted()

    def _merged(self, candidate: _Candidate, observation: Observation) -> Target:
        old, pixels = self._target, candidate.detection.box.area
        if old is None or not _same_place(candidate.area, old.area):
            return Target(candidate.area, observation, pixels, float(candidate.detection.score))
        better = pixels > old.best_pixels
        hold = self._config.target == "hold"
        return Target(
            area=old.area.joined(candidate.area) if hold else candidate.area,
            best_view=observation if better else old.best_view,
            best_pixels=max(pixels, old.best_pixels),
            mean_score=old.mean_score
            + (float(candidate.detection.score) - old.mean_score) / (old.sightings + 1),
            sightings=old.sightings + 1,
            misses=old.misses,
        )

    def _drop_if_refuted(self) -> None:
        target = self._target
        if target is None:
            return
        verdicts = target.sightings + target.misses
        share = target.misses / verdicts
        if verdicts >= self._config.min_verdicts and share > self._config.max_missed_share:
            self.reject_target()


def _same_place(a: GoalArea, b: GoalArea) -> bool:
    return a.covers(b) > 0.0 or b.covers(a) > 0.0


def _should_be_visible(area: GoalArea, observation: Observation) -> bool:
    """Whether most of an area lies in free sight of the camera, near enough to be recognised."""
    camera = observation.camera
    points = np.zeros((len(area.seen_points), 3))
    points[:, :2] = area.seen_points
    in_camera = observation.camera_to_map.inverse().apply(points)
    distance = in_camera[:, 2]
    column = camera.fx * in_camera[:, 0] / np.maximum(distance, 1e-6) + camera.cx
    good = (distance > 1.0) & (distance < 4.0) & (column >= 0) & (column < camera.width)
    if good.sum() < 0.8 * len(points):
        return False
    # Nothing may stand in between: compare with the farthest return in the column.
    columns = column[good].astype(int)
    farthest = observation.depth.max(axis=0)[columns]
    return bool(((farthest > distance[good] - 0.3) | (farthest == 0)).mean() > 0.8)


def _record(
    detection: Detection,
    mask: Bool[np.ndarray, "height width"],
    *,
    accepted: bool,
    reason: str,
) -> DetectionRecord:
    contours, _ = cv2.findContours(
        mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_TC89_KCOS
    )
    box = detection.box
    return DetectionRecord(
        box=(round(box.x_min, 1), round(box.y_min, 1), round(box.x_max, 1), round(box.y_max, 1)),
        score=round(float(detection.score), 4),
        label=detection.label,
        outlines=[[(int(x), int(y)) for x, y in c.reshape(-1, 2)] for c in contours if len(c) > 2],
        accepted=accepted,
        reason=reason,
    )
