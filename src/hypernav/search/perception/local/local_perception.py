"""Local perception: the goal in the image and its goal area on the map.

Where the goal's depth is not measured, about where it may be, and on what floor.
"""

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.components.abilities import NamesThings, SeesAllThings, SegmentsPoints
from hypernav.core.components.protocols import Detector, Segmenter
from hypernav.core.embodiment import CameraConfig
from hypernav.core.exploring.floors import Sightings
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.naming.kind_shapes import kind_shape
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord
from hypernav.search.memory.floor import Floor, counted_from
from hypernav.search.memory.goal_area import GoalArea, points_under_mask
from hypernav.search.memory.thing import is_in_room
from hypernav.search.memory.things import Things
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.belief import (
    Sighting,
    before_a_look,
    is_rejected,
    weight_of,
    with_earlier_looks,
    with_latest,
    with_sightings,
)
from hypernav.search.perception.local.second_look import detect_twice
from hypernav.search.perception.local.shape import (
    MANY_PIXELS,
    measure_of,
    measured_form,
    shape_evidence,
)

_LEAST_LEFT = 0.25  # share of a mask below which it is too thin to be eroded
_STRAY_SHARE = 0.05
"""Share of the points below which a separate part of a guessed mask belongs to another thing."""

_BESIDE_REJECTED_DEG = 10.0
"""Angle to a rejected area, degrees, within which a goal out of range is ignored."""
_BELOW_M, _ABOVE_M = -2.3, 3.4
"""Heights above the floor, metres, at which things of the floors below and above are, about: they
tell how far away one is whose line of sight alone is known."""
_IN_REACH = 0.25
"""Share of the pixels of a goal, or right below it, with a depth from which it is in reach."""
_LEAST_BELOW_PX = 3.0
"""Least height of what counts as right below a goal, pixels; else it is half the goal's."""

_NO_DEPTH = "too few points with depth"
_REJECTED = "rejected before"
_OFF_FLOOR = "on another floor"
_STRONG = 0.3
"""Least score of another thing to be remembered, and of a goal out of range to be followed."""
_NEARER = 0.75
"""Share of the entry reach that is left where the goal's outline was guessed from a box."""
_CERTAIN = 0.99
"""Score from which the detector is so certain that the form of the thing is not measured."""


def eroded(
    mask: Bool[np.ndarray, "height width"], config: LocalConfig
) -> Bool[np.ndarray, "height width"]:
    """A mask without its edge (paper: "erode the segmentation area").

    Args:
        mask: Mask of the goal's pixels.
        config: Size of the kernel, and whether a mask of which little would be left stays as it is:
            a thin object would vanish, which is worse than some background.
    """
    kernel = np.ones((config.erosion_px, config.erosion_px), np.uint8)
    inner = cv2.erode(mask.astype(np.uint8), kernel).astype(bool)
    vanishes = np.count_nonzero(inner) < _LEAST_LEFT * np.count_nonzero(mask)
    return mask if vanishes and config.keep_thin_masks else inner


def projected(
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    config: LocalConfig,
    camera: CameraConfig,
    *,
    cell_size_m: float,
    is_guessed: bool = False,
) -> GoalArea | None:
    """The goal area under a mask; None if too few of its pixels have a depth within the range.

    Args:
        mask: Mask of the goal's pixels, already eroded if it is to be.
        observation: Frame that the mask was made from.
        config: Least number of points, dilation and choice of the cluster.
        camera: Camera, whose range of depth counts.
        cell_size_m: Side of a map cell, metres.
        is_guessed: Whether the mask was guessed from a box, so that small parts may be strays.
    """
    points = points_under_mask(
        mask,
        observation,
        min_depth_m=camera.min_depth_m,
        max_depth_m=camera.max_depth_m,
        stride=2 if np.count_nonzero(mask) > MANY_PIXELS else 1,
    )
    if len(points) < config.min_points:
        return None
    return GoalArea.from_points(
        points,
        resolution_m=cell_size_m,
        kernel=config.dilation_kernel,
        iterations=config.dilation_iterations,
        largest_cluster_only=config.largest_cluster_only,
        stray_share=_STRAY_SHARE if is_guessed else 0.0,
    )


def far_position_of(
    box: Box, observation: Observation, camera: CameraConfig, rejected: Sequence[GoalArea]
) -> tuple[float, float] | None:
    """Nearest position ``(x, y)`` of a goal out of range, metres; None beside a rejected area.

    Args:
        box: Box of the goal in the image.
        observation: The image.
        camera: Camera, whose range of depth counts.
        rejected: Areas that were rejected before.
    """
    robot = observation.robot
    bearing = observation.camera.bearing_of((box.x_min + box.x_max) / 2.0)
    for area in rejected:
        away = wrap_angle(robot.bearing_to(*area.centre) - bearing)
        if abs(away) < math.radians(_BESIDE_REJECTED_DEG):
            return None
    return _position_at(camera.max_depth_m / math.cos(bearing), bearing, observation)


def off_floor_out_of_range(
    box: Box,
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    camera: CameraConfig,
    grid: OccupancyGrid,
    ground_m: float,
) -> tuple[float, float, float] | None:
    """About where a goal out of range is that lies below or above the room of the robot's floor.

    Args:
        box: Box of the goal in the image.
        mask: Mask of its pixels.
        observation: The image, with heights counted from the robot's ground.
        camera: Camera, whose range of depth counts.
        grid: Map of the robot's floor.
        ground_m: Height of that ground above the floor, metres.

    Returns:
        Position ``(x, y)``, as if a storey lay between, and the height at which its line of sight
        leaves the range, metres: the goal lies at least so far below or above. None if it may be in
        the room, as far as its line of sight tells, or within range.
    """
    camera_at = observation.camera_to_map.translation
    column, row = (
        np.array([box.x_min + box.x_max]) / 2.0,
        np.array([box.y_min + box.y_max]) / 2.0,
    )
    point = observation.camera.unproject(column, row, np.array([camera.max_depth_m]))
    nearest = observation.camera_to_map.apply(point)[0]
    if is_in_room(float(nearest[2]), ground_m):
        return None
    if _may_be_in_range(box, mask, observation, camera, grid):
        return None
    away = nearest - camera_at
    z = _BELOW_M if away[2] < 0.0 else _ABOVE_M
    x, y, _ = (camera_at + max(1.0, (z - camera_at[2]) / away[2]) * away).tolist()
    return (x, y, float(nearest[2]) + ground_m)


def _may_be_in_range(
    box: Box,
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    camera: CameraConfig,
    grid: OccupancyGrid,
) -> bool:
    """Whether a goal without depth may be near: mirrors, glass and black things have none.

    What such a thing stands on, or the wall on which it hangs, has, and comes right below it in the
    image. Right before the camera nothing has: there the map tells.
    """
    height, width = observation.depth.shape
    below_px = max((box.y_max - box.y_min) / 2.0, _LEAST_BELOW_PX)
    below = Box(box.x_min, box.y_max, box.x_max, box.y_max + below_px)
    for pixels in (mask, below.mask(width, height)):
        depths = observation.depth[pixels]
        measured = np.count_nonzero(is_measured(depths, farthest_m=camera.max_depth_m))
        if measured >= _IN_REACH * depths.size:
            return True
    bearing = observation.camera.bearing_of((box.x_min + box.x_max) / 2.0)
    blind_m = np.arange(0.0, camera.min_depth_m + grid.resolution_m, grid.resolution_m)
    before = [_position_at(float(away_m), bearing, observation) for away_m in blind_m]
    return any(grid.state_at(*position) == Cell.OCCUPIED for position in before)


def _position_at(away_m: float, bearing: float, observation: Observation) -> tuple[float, float]:
    """Position ``(x, y)`` on the map so far from the robot in a direction, metres."""
    robot = observation.robot
    angle = robot.yaw + bearing
    return (robot.x + away_m * math.cos(angle), robot.y + away_m * math.sin(angle))


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
        detections = detect_twice(self.detector, observation, goal, config.look_closer_below)
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
                remembered = known.known_before(search.number)
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
