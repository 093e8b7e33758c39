"""Local perception: the goal in the image and its area on the floor plan."""

import math

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.components.abilities import NamesThings
from hypernav.core.components.protocols import Detector, Segmenter
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.sightings import Sightings
from hypernav.core.trace import DetectionRecord
from hypernav.perception.local.attention import Attention
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.goal_area import GoalArea
from hypernav.perception.local.refinement import eroded, projected
from hypernav.perception.local.target import Target
from hypernav.perception.local.target_belief import Candidate, TargetBelief

_NO_DEPTH = "too few points with depth"
_REJECTED = "rejected before"
_BESIDE_REJECTED_DEG = 10.0


class LocalPerception:
    """Detects, segments, refines and projects.

    Attributes:
        belief: What is believed about the target after all images so far.
    """

    def __init__(
        self,
        detector: Detector,
        segmenter: Segmenter,
        config: LocalConfig,
        camera: CameraConfig,
        *,
        cell_size_m: float,
        attention: Attention | None = None,
        sightings: Sightings | None = None,
    ) -> None:
        """Create it.

        Args:
            detector: Detector that finds boxes of the goal.
            segmenter: Segmenter of the pixels in a box; not asked where a detection has its own
                mask.
            config: Refinement, projection and evidence.
            camera: Camera, whose range of depth counts.
            cell_size_m: Side of a map cell, metres.
            attention: Choice of the images that the detector is asked about; None asks about all.
            sightings: Memory of all that is detected; None keeps none.
        """
        self._detector = detector
        self._attention = attention
        self._sightings = sightings
        self._segmenter = segmenter
        self._config = config
        self._camera = camera
        self._cell_size_m = cell_size_m
        self.belief: TargetBelief = TargetBelief(config)
        self.reset(Goal("nothing yet"))

    def reset(self, goal: Goal) -> None:
        """Forget target and rejections."""
        self._goal = goal
        self.belief.reset()
        self._far_position: tuple[float, float] | None = None
        if self._attention is not None:
            self._attention.reset()
        if self._sightings is not None:
            self._sightings.reset()

    @property
    def far_position(self) -> tuple[float, float] | None:
        """The nearest position of a goal that was seen beyond the range of depth.

        ``(x, y)``, metres; it is remembered until there is a target, or it is forgotten. None if
        there is no such sighting, or if it lay behind a rejected area.
        """
        return self._far_position

    @property
    def target(self) -> Target | None:
        """The target, once it was seen often enough."""
        return self.belief.target

    def forget_far_position(self) -> None:
        """Take the next sighting beyond the range of depth in place of the remembered one."""
        self._far_position = None

    def look(self, observation: Observation, *, asks: bool = True) -> list[DetectionRecord]:
        """Search one image and update the target.

        Args:
            observation: Present frame.
            asks: Whether the detector may be asked about it; else only time passes.

        Returns:
            Every detection of the image, and whether it gave a goal area or the reason why not.
        """
        records: list[DetectionRecord] = []
        candidates: list[Candidate] = []
        far_positions: list[tuple[float, float] | None] = []
        belief = self.belief
        belief.begin_a_look()
        if not asks:
            return records
        attention = self._attention
        if attention and not attention.is_worth_a_question(observation, belief.held_area):
            return records
        detections = self._detector.detect(observation, self._goal)
        if self._sightings is not None:
            self._sightings.note(observation, detections)
            if self._sightings.everything and isinstance(self._detector, NamesThings):
                named = self._sightings.named
                self._sightings.note_named(self._detector.name_things(observation, besides=named))
        for detection in (one for one in detections if one.is_goal):
            mask = self._refined_mask(detection, observation)
            area, reason = self._area(mask, observation)
            score = float(detection.score)
            if area is not None and belief.rejections.bars(area, score, observation.robot):
                area, reason = None, _REJECTED
            if area is not None:
                candidates.append(Candidate(detection, area))
            elif reason == _NO_DEPTH:
                far_positions.append(self._far_position_of(detection, observation))
            records.append(_record(detection, mask, accepted=area is not None, reason=reason))
        belief.update(candidates, observation)
        if self._config.weigh_rivals:
            belief.weigh_rivals([one for one in detections if not one.is_goal], observation)
        if belief.has_sighting:
            self._far_position = None
        elif self._far_position is None:
            self._far_position = next((one for one in far_positions if one is not None), None)
        return records

    def _refined_mask(
        self, detection: Detection, observation: Observation
    ) -> Bool[np.ndarray, "height width"]:
        if self._config.pixels == "box":
            height, width = observation.depth.shape
            return detection.box.mask(width, height)
        mask = detection.mask
        if mask is None:
            mask = self._segmenter.segment(observation, detection.box)
        return eroded(mask, self._config)

    def _area(
        self, mask: Bool[np.ndarray, "height width"], observation: Observation
    ) -> tuple[GoalArea | None, str]:
        area = projected(
            mask, observation, self._config, self._camera, cell_size_m=self._cell_size_m
        )
        if area is None:
            return None, _NO_DEPTH
        if self._config.entry_reach_m > 0.0:
            area = area.entered_from(observation, self._config.entry_reach_m)
        return area, ""

    def _far_position_of(
        self, detection: Detection, observation: Observation
    ) -> tuple[float, float] | None:
        """The position in the middle of a box at the end of the range; None behind a rejection."""
        robot, camera, box = observation.robot, observation.camera, detection.box
        column = (box.x_min + box.x_max) / 2.0
        bearing = camera.bearing_of(column)
        for area in self.belief.rejections.areas:
            away = wrap_angle(robot.bearing_to(*area.centre) - bearing)
            if abs(away) < math.radians(_BESIDE_REJECTED_DEG):
                return None
        reach_m = self._camera.max_depth_m / math.cos(bearing)
        angle = robot.yaw + bearing
        return (robot.x + reach_m * math.cos(angle), robot.y + reach_m * math.sin(angle))


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
