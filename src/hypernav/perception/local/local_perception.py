"""Local perception: the goal in the image and its goal area on the map."""

from dataclasses import KW_ONLY, dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.components.abilities import NamesThings, SeesAllThings, SegmentsPoints
from hypernav.core.components.protocols import Detector, Segmenter
from hypernav.core.embodiment import CameraConfig
from hypernav.core.exploring.sightings import Sightings
from hypernav.core.geometry.boxes import Detection
from hypernav.core.goal import Goal
from hypernav.core.kind_shapes import kind_shape
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord
from hypernav.mapping.memory.floor import Floor, counted_from
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.memory.thing import is_in_room
from hypernav.mapping.memory.things import Things
from hypernav.perception.local.belief import (
    Sighting,
    before_a_look,
    is_rejected,
    weight_of,
    with_earlier_looks,
    with_latest,
    with_sightings,
)
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.out_of_range import far_position_of, off_floor_out_of_range
from hypernav.perception.local.refinement import eroded, projected
from hypernav.perception.shape.evidence import measure_of, shape_evidence
from hypernav.perception.shape.form import measured_form

_NO_DEPTH = "too few points with depth"
_REJECTED = "rejected before"
_OFF_FLOOR = "on another floor"
_STRONG = 0.3
"""Least score of another thing to be remembered, and of a goal out of range to be followed."""
_NEARER = 0.75
"""Share of the entry reach that is left where the goal's outline was guessed from a box."""
_CERTAIN = 0.99
"""Score from which the detector is so certain that the form of the thing is not measured."""


@dataclass(frozen=True, eq=False)
class LocalPerception:
    """Detects, segments, refines and projects the goal. The memory keeps what it finds.

    Attributes:
        detector: Detector that finds boxes of the goal.
        segmenter: Segmenter of the pixels in a box; not asked where a detection has its own mask.
        config: Refinement, projection and evidence.
        camera: Camera, whose range of depth counts.
        cell_size_m: Side of a map cell, metres.
        names_things: Whether all that the detector can name is remembered, not only its detections.
        tells_floors: Whether a goal below or above the room of the robot's floor is on another one,
            and no candidate on this.
    """

    detector: Detector
    segmenter: Segmenter
    config: LocalConfig
    camera: CameraConfig
    _: KW_ONLY
    cell_size_m: float
    names_things: bool = False
    tells_floors: bool = False

    def look(
        self,
        observation: Observation,
        goal: Goal,
        floor: Floor,
        *,
        ground_m: float = 0.0,
        asks: bool = True,
    ) -> list[DetectionRecord]:
        """Search one image for the goal, and update the memory of the floor.

        Args:
            observation: Present frame, with heights counted from the robot's ground.
            goal: Goal of the search.
            floor: Memory of the floor that the robot is on.
            ground_m: Height of that ground above the floor, metres.
            asks: Whether the detector is asked; else the image only counts as one more taken.

        Returns:
            A record of every detection of the goal; with candidates, one "rejected before" is not
            accepted, yet counts as evidence.
        """
        search, config = floor.search, self.config
        search.evidence = before_a_look(search.evidence)
        if not asks:
            return []
        detections = self.detector.detect(observation, goal)
        least = 0.0 if config.target == "latest" else _STRONG
        strong = [one for one in detections if one.score >= least]
        floor.sightings = self._with_things(floor.sightings, observation, strong)
        known = floor.things
        if search.lasts:
            floor.things = self._remembered(floor, observation, goal, detections, ground_m)
        evidence, records = search.evidence, list[DetectionRecord]()
        sightings, far_position = list[Sighting](), evidence.far_position
        for detection in (one for one in detections if one.is_goal):
            whole = self._mask(detection, observation)
            mask = whole if config.pixels == "box" else eroded(whole, config)
            area = self._area(mask, observation, is_guessed=detection.mask is None)
            reason = _NO_DEPTH
            if area is not None and self.tells_floors and not is_in_room(area.height_m, ground_m):
                reason = _OFF_FLOOR
                if detection.score >= least:
                    search.note_off_floor((*area.centre, area.height_m + ground_m))
            elif area is not None:
                reason = _REJECTED if is_rejected(evidence, area) else ""
                if not reason or config.target == "candidates":
                    sightings.append(self._sighting(detection, area, whole, observation, goal))
            elif self.tells_floors and (
                off_floor := off_floor_out_of_range(
                    detection.box, whole, observation, self.camera, floor.map.grid, ground_m
                )
            ):
                reason = _OFF_FLOOR
                if search.seen_off_floor is None and detection.score >= least:
                    search.note_off_floor(off_floor)
            elif far_position is None and detection.score >= least:
                areas = evidence.rejected_areas
                far_position = far_position_of(detection.box, observation, self.camera, areas)
            records.append(_record(detection, mask, reason))
        if config.target == "latest":
            evidence = with_latest(evidence, sightings, observation)
        else:
            others = [one for one in detections if not one.is_goal]
            evidence = with_sightings(evidence, config, sightings, others, observation)
            if evidence.count > search.evidence.count:
                remembered = search.remembered_of(known)
                evidence = with_earlier_looks(evidence, search.evidence, remembered, goal, config)
        if evidence.target is not None:
            far_position = search.seen_off_floor = None
        search.evidence = replace(evidence, far_position=far_position)
        return records

    def _with_things(
        self, known: Sightings, observation: Observation, detections: list[Detection]
    ) -> Sightings:
        known = known.with_detections(observation, detections)
        if self.names_things and isinstance(self.detector, NamesThings):
            named = self.detector.name_things(observation, besides=known.named)
            known = known.with_named(named)
        return known

    def _remembered(
        self,
        floor: Floor,
        observation: Observation,
        goal: Goal,
        detections: list[Detection],
        ground_m: float,
    ) -> Things:
        """The floor's things after an image: the goal in all of them, the rest in new views.

        A detector of the goal alone misses nothing else.
        """
        only: Goal | None = goal
        search = floor.search
        refuted = [area.centre for area in search.evidence.rejected_areas]
        if not search.has_new_view:
            detections = [one for one in detections if one.is_goal]
        elif isinstance(self.detector, SeesAllThings):
            detections, only = self.detector.things_in(observation, detections), None
        from_floor = counted_from(-ground_m, observation)
        things = floor.things.after_image(
            from_floor,
            [one for one in detections if one.score >= _STRONG],
            self.camera,
            search=search.number,
            only=only,
            tells_floors=self.tells_floors,
            ground_m=ground_m,
            floor_map=floor.map,
        )
        if only is not None:
            search.note_others(things.others_in(from_floor, goal), things, goal)
        return things.refuted_at(refuted, goal, search.number) if refuted else things

    def _mask(
        self, detection: Detection, observation: Observation
    ) -> Bool[np.ndarray, "height width"]:
        if self.config.pixels == "box":
            height, width = observation.depth.shape
            return detection.box.mask(width, height)
        if detection.mask is not None:
            return detection.mask
        if detection.point is not None and isinstance(self.segmenter, SegmentsPoints):
            return self.segmenter.segment_point(observation, *detection.point)
        return self.segmenter.segment(observation, detection.box)

    def _sighting(
        self,
        detection: Detection,
        area: GoalArea,
        mask: Bool[np.ndarray, "height width"],
        observation: Observation,
        goal: Goal,
    ) -> Sighting:
        """A sighting, whose form counts if it is uncertain and the kind's forms are known."""
        seen = Sighting(detection, area, weight_of(detection.score, self.config))
        if self.config.target == "latest" or detection.score >= _CERTAIN:
            return seen
        kind = kind_shape(goal.thing)
        if kind is None:
            return seen
        form = measured_form(observation, mask, detection.box)
        if form is None:
            return seen
        shape = shape_evidence(form, kind).log_odds
        measure = measure_of(form, area.centre, observation)
        return replace(seen, shape=shape, measure=measure, kind=kind)

    def _area(
        self,
        mask: Bool[np.ndarray, "height width"],
        observation: Observation,
        *,
        is_guessed: bool,
    ) -> GoalArea | None:
        area = projected(
            mask,
            observation,
            self.config,
            self.camera,
            cell_size_m=self.cell_size_m,
            is_guessed=is_guessed and self.config.target == "candidates",
        )
        if area is None:
            return None
        area = replace(area, is_guessed=is_guessed)
        if self.config.entry_reach_m > 0.0:
            reach_m = self.config.entry_reach_m * (_NEARER if is_guessed else 1.0)
            area = area.entered_from(observation, reach_m)
        return area


def _record(
    detection: Detection, mask: Bool[np.ndarray, "height width"], reason: str
) -> DetectionRecord:
    """The record of a detection; a reason says why it is not accepted."""
    contours, _ = cv2.findContours(
        mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_TC89_KCOS
    )
    box = detection.box
    return DetectionRecord(
        box=(round(box.x_min, 1), round(box.y_min, 1), round(box.x_max, 1), round(box.y_max, 1)),
        score=round(float(detection.score), 4),
        label=detection.label,
        outlines=[[(int(x), int(y)) for x, y in c.reshape(-1, 2)] for c in contours if len(c) > 2],
        accepted=not reason,
        reason=reason,
    )
