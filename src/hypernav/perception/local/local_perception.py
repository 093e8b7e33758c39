"""Local perception: the goal in the image and its area on the floor plan."""

import math
from dataclasses import dataclass, replace

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
from hypernav.perception.local.rejections import Rejections
from hypernav.perception.local.target import Target, areas_touch, log_odds_of
from hypernav.perception.local.visibility import is_cut_off, seems_to_hold, should_be_visible

_NO_DEPTH = "too few points with depth"
_REJECTED = "rejected before"
_BESIDE_REJECTED_DEG = 10.0
_MISS_LOG_ODDS = 1.0
"""Weight of an image that misses the target; ours, not measured: as if three in ten images missed a
true target and eight in ten a false one."""


@dataclass(frozen=True, eq=False)
class _Candidate:
    detection: Detection
    area: GoalArea


class LocalPerception:
    """Detects, segments, refines and projects; remembers the target and rejected areas."""

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
        self.reset(Goal("nothing yet"))

    def reset(self, goal: Goal) -> None:
        """Forget target and rejections."""
        self._goal = goal
        self._target: Target | None = None
        self._rejections = Rejections(self._config)
        self._far_position: tuple[float, float] | None = None
        self._score_now = 0.0
        self._missed_now = False
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
        if self._target is None or self._target.sightings < self._config.min_sightings:
            return None
        return self._target

    @property
    def is_convincing(self) -> bool:
        """Whether the detections of the target were certain enough on average."""
        target = self._target
        return (
            target is not None
            and target.mean_score >= self._config.min_mean_score
            and not target.is_outdone
        )

    @property
    def needs_second_look(self) -> bool:
        """Whether the target is too uncertain to be believed from one side."""
        target = self._target
        return (
            target is not None
            and not target.confirmed
            and target.mean_score < self._config.sure_score
        )

    @property
    def is_contradicted(self) -> bool:
        """Whether the target looks more like something else in the latest image."""
        return self._score_now < 0.0

    @property
    def is_missed(self) -> bool:
        """Whether the latest image lacks the target, and that outweighs all earlier sightings."""
        target = self._target
        return self._missed_now and target is not None and target.log_odds < _MISS_LOG_ODDS

    def forget_far_position(self) -> None:
        """Take the next sighting beyond the range of depth in place of the remembered one."""
        self._far_position = None

    def confirm_target(self) -> None:
        """Note that the target was looked at once more."""
        if self._target is not None:
            self._target = replace(self._target, confirmed=True)

    def bar_position(self, observation: Observation) -> bool:
        """Look for another position at the target if something hides it from a robot that faces it.

        Args:
            observation: Present frame of a robot that faces the target, after `look`.

        Returns:
            Whether the target is hidden and there is another position.
        """
        target = self._target
        is_seen = self._score_now > 0.0
        if target is None or is_seen:
            return False
        if not is_cut_off(target.area.seen_points, target.area.height_m, observation):
            return False
        barred = target.barred_at(observation.robot.xy)
        if barred is None:
            return False
        self._target = barred
        return True

    def reject_target(self, *, for_good: bool = False) -> None:
        """Drop the target and take nothing in its area for the goal.

        Args:
            for_good: Whether no later image can bring it back (`LocalConfig.believe_again`).
        """
        if self._target is None:
            return
        self._rejections.add(self._target, for_good=for_good)
        self._target = None

    def reconsider(self) -> bool:
        """Take the most likely of the rejected targets for the goal once more.

        Returns:
            Whether there is one; each comes back in this way once.
        """
        target = self._rejections.take_most_likely()
        if target is None:
            return False
        self._target = replace(target, misses=0, rival_score=0.0, confirmed=False, barred=())
        return True

    def look(self, observation: Observation, *, asks: bool = True) -> list[DetectionRecord]:
        """Search one image and update the target.

        Args:
            observation: Present frame.
            asks: Whether the detector may be asked about it; else only time passes.

        Returns:
            Every detection of the image, and whether it gave a goal area or the reason why not.
        """
        records: list[DetectionRecord] = []
        candidates: list[_Candidate] = []
        far_positions: list[tuple[float, float] | None] = []
        self._score_now, self._missed_now = 0.0, False
        self._rejections.note_a_look()
        if not asks:
            return records
        if self._attention and not self._attention.is_worth_a_question(observation, self._held):
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
            if area is not None and self._rejections.bars(area, score, observation.robot):
                area, reason = None, _REJECTED
            if area is not None:
                candidates.append(_Candidate(detection, area))
            elif reason == _NO_DEPTH:
                far_positions.append(self._far_position_of(detection, observation))
            records.append(_record(detection, mask, accepted=area is not None, reason=reason))
        self._update(candidates, observation)
        if self._config.weigh_rivals:
            self._weigh_rivals([one for one in detections if not one.is_goal], observation)
        if self._target is not None:
            self._far_position = None
        elif self._far_position is None:
            self._far_position = next((one for one in far_positions if one is not None), None)
        return records

    @property
    def _held(self) -> GoalArea | None:
        """Goal area of a held target that needs no second look."""
        target, holds = self.target, self._config.target == "hold"
        return target.area if target and holds and not self.needs_second_look else None

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
        for area in self._rejections.areas:
            away = wrap_angle(robot.bearing_to(*area.centre) - bearing)
            if abs(away) < math.radians(_BESIDE_REJECTED_DEG):
                return None
        reach_m = self._camera.max_depth_m / math.cos(bearing)
        angle = robot.yaw + bearing
        return (robot.x + reach_m * math.cos(angle), robot.y + reach_m * math.sin(angle))

    def _update(self, candidates: list[_Candidate], observation: Observation) -> None:
        if self._config.pick == "nearest":
            candidates = sorted(candidates, key=lambda c: c.area.distance_to(*observation.robot.xy))
        target = self._target
        if target is None or self._config.target == "latest":
            same = candidates[0] if candidates else None
        else:
            same = next((c for c in candidates if areas_touch(c.area, target.area)), None)
        self._score_now = 0.0 if same is None else float(same.detection.score)
        if same is not None:
            self._target = self._merged(same, observation)
        elif (
            target is not None
            and self._config.target == "hold"
            and should_be_visible(target.area.seen_points, target.area.height_m, observation)
        ):
            self._missed_now = True
            self._target = replace(target, misses=target.misses + 1)
            self._drop_if_refuted()

    def _weigh_rivals(self, others: list[Detection], observation: Observation) -> None:
        """Note the score by which the target looks like something else in this image."""
        if self._target is None:
            return
        seen = self._target.area.seen_points
        scores = [float(one.score) for one in others if seems_to_hold(one.box, seen, observation)]
        if scores:
            strongest = max(scores)
            self._target = replace(self._target, rival_score=self._target.rival_score + strongest)
            self._score_now -= strongest
            self._drop_if_refuted()

    def _merged(self, candidate: _Candidate, observation: Observation) -> Target:
        old, detection = self._target, candidate.detection
        if old is None or not areas_touch(candidate.area, old.area):
            score = float(detection.score)
            box_pixels, odds = detection.box.area, log_odds_of(score)
            return Target(candidate.area, observation, box_pixels, score, odds)
        hold = self._config.target == "hold"
        return old.seen_again(candidate.area, detection, observation, join=hold)

    def _drop_if_refuted(self) -> None:
        target = self._target
        if target is None:
            return
        is_refuted = target.missed_share > self._config.max_missed_share or target.is_outdone
        if is_refuted and target.verdicts >= self._config.min_verdicts:
            self.reject_target()


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
