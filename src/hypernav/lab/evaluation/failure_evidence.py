"""The evidence for the classification of a failure, gathered from trace and ground truth."""

import math
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.core.trace import DetectionRecord, Ending, StepTrace
from hypernav.core.world import GoalTruth, Instance, SceneTruth
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeStep
from hypernav.lab.evaluation.failures import MISPLACED_M, BelievedTarget, Facts, Failure, TargetKind
from hypernav.search.planning.planner import PlannedPath, Planner
from hypernav.simulator.houses.episodes.queries import near_misses

_WRONG_BELIEFS = frozenset(
    {Failure.FALSE_DETECTION, Failure.LANGUAGE, Failure.WRONG_MAP, Failure.TARGET_SURROUNDED}
)


def decisive_step(failure: Failure, steps: Sequence[StepTrace]) -> int:
    """Index of the step that decided a failed episode.

    If the robot took a wrong object for the goal, or placed the goal wrongly, that is the step at
    which it first did so; if it saw the goal and missed it, the first step with a detection; else
    the last step.

    Args:
        failure: Class of the failure.
        steps: Trace of the episode, at least one step.
    """
    last = len(steps) - 1
    if failure in _WRONG_BELIEFS:
        doubtful = (n for n in range(last, -1, -1) if not steps[n].goal_area)
        return min(next(doubtful, -1) + 1, last)
    if failure is Failure.SEEN_BUT_MISSED:
        seen = (n for n, step in enumerate(steps) if step.detections)
        return next(seen, last)
    return last


_SPACING_M = 0.05
_BESIDE_M = 1.5
"""Distance within which a robot without a trace that stops is assumed to mean an object, metres."""
_LACKING_SHARE = 0.01
"""Share of the pixels below the horizon that hit nothing in an image that lacks data."""
_OUT_OF_BOUNDS_M = 0.3
"""Distance from where a robot can stand beyond which a path leads where nobody can, metres."""


class FailureEvidence:
    """Gathers the evidence for the rules of failure classification, step by step."""

    def __init__(self, truth: SceneTruth, goal: GoalTruth, config: HyPerNavConfig) -> None:
        """Begin an episode."""
        self._truth = truth
        self._goal = goal.goal
        self._distance_of = goal.distance
        self._goal_ids = np.array([i.id for i in goal.instances], dtype=np.int64)
        self._config = config
        self._last: EpisodeStep | None = None
        self._votes: Counter[int] = Counter()
        self._explains = False
        self._lacks_data = False
        self._believed_for = 0
        self._believed_at_m = 0.0
        self.goal_sightings = 0

    def watch(self, step: EpisodeStep) -> None:
        """Add the evidence of one step."""
        self._last = step
        self._explains = self._explains or step.grid is not None
        self.goal_sightings += step.goal_in_view
        if step.trace.goal_area:
            if self._believed_for == 0:
                self._believed_at_m = self._distance_of(*self._truth.position)
            self._believed_for += 1
        else:
            self._believed_for = 0
        truth = step.observation.truth
        if truth is None:
            return
        self._lacks_data = self._lacks_data or _lacks_data(step.observation, truth)
        if not step.trace.goal_area:
            self._votes.clear()
        for detection in step.trace.detections:
            if detection.accepted and (number := _instance_under(detection, truth)) >= 0:
                self._votes[number] += 1

    def facts(self, result: EpisodeResult, *, stopped: bool, success_distance_m: float) -> Facts:
        """The evidence about the episode at its end.

        Args:
            result: Result of the episode.
            stopped: Whether the robot took STOP.
            success_distance_m: Greatest distance that counts as success, metres.
        """
        last = self._last
        return Facts(
            outcome=result.outcome,
            stopped=stopped,
            gave_up=last is not None and last.trace.ending is Ending.GAVE_UP,
            distance_to_goal_m=result.metrics.distance_to_goal_m,
            success_distance_m=success_distance_m,
            goal_sightings=self.goal_sightings,
            target=(
                None
                if last is None or result.metrics.success
                else self._believed_target(last, stopped)
            ),
            error=result.detail,
        )

    def _believed_target(self, last: EpisodeStep, stopped: bool) -> BelievedTarget | None:
        """The object that the robot took for the goal."""
        if not self._explains:
            return self._object_beside_robot() if stopped else None
        if not last.trace.goal_area:
            return None
        area = self._in_scene(_outline_points(last.trace.goal_area))
        instance = self._object_of(area)
        if instance is None:
            return BelievedTarget(TargetKind.OTHER, "building")
        middle = (area.min(axis=0) + area.max(axis=0)) / 2.0
        path, stop_m = self._path_on_map(last), self._config.stop_reach_m
        leads_there = path is not None and path.gap_m <= stop_m
        step_m = self._config.embodiment.motion.forward_m
        return BelievedTarget(
            kind=self._kind_of(instance),
            name=_name(instance),
            offset_m=_gap(instance, middle),
            is_surrounded=self._is_surrounded(area),
            map_leads_there=None if last.grid is None else leads_there,
            lacks_data=self._lacks_data and path is not None and self._leaves_the_floor(path),
            short_m=0.0 if stopped else self._believed_at_m - step_m * self._believed_for,
        )

    def _in_scene(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "n 2"]:
        """Points of the robot's map in the scene frame, by the robot's own odometry."""
        lifted = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
        return self._truth.map_to_scene.apply(lifted)[:, :2]

    def _object_of(self, area: Float64[np.ndarray, "n 2"]) -> Instance | None:
        """The object that the goal area stands for; None if that is part of the building.

        Candidates are the objects whose pixels were accepted while there was a goal area. Of those
        at the goal area the one with most sightings is taken; if none is there, the nearest.
        """
        middle = (area.min(axis=0) + area.max(axis=0)) / 2.0
        if not self._votes:
            return _nearest(self._truth, middle, _BESIDE_M)
        seen = [self._truth.instances[number] for number in self._votes]
        there = [i for i in seen if _gap(i, middle) <= MISPLACED_M]
        if there:
            # Of equally many sightings the nearer object wins, so that chance plays no part.
            winner = max(there, key=lambda i: (self._votes[i.id], -_gap(i, middle), -i.id))
        else:
            winner = min(seen, key=lambda i: (_gap(i, middle), i.id))
        return winner if winner.label is not None else None

    def _object_beside_robot(self) -> BelievedTarget:
        """The object that a robot without a trace means by STOP: a goal nearby, else the nearest.

        A STOP most likely means a goal nearby, so this errs on the lenient side.
        """
        here = np.array(self._truth.position[:2])
        goals = [self._truth.instances[int(n)] for n in self._goal_ids]
        close = [i for i in goals if _gap(i, here) <= _BESIDE_M]
        instance = close[0] if close else _nearest(self._truth, here, math.inf)
        if instance is None:
            return BelievedTarget(TargetKind.OTHER, "building")
        return BelievedTarget(self._kind_of(instance), _name(instance))

    def _kind_of(self, instance: Instance) -> TargetKind:
        if instance.id in self._goal_ids:
            return TargetKind.GOAL
        misses = near_misses(self._truth.instances, self._goal)
        return TargetKind.NEAR_MISS if instance.id in {i.id for i in misses} else TargetKind.OTHER

    def _is_surrounded(self, area: Float64[np.ndarray, "n 2"]) -> bool:
        """Whether in truth no reachable position to stand is near the area."""
        walkable = self._truth.walkable
        here = walkable.component_of(*self._truth.position)
        positions = walkable.centres(max(here, 0))
        low, high = area.min(axis=0), area.max(axis=0)
        stop_m = self._config.stop_reach_m
        near = ((positions > low - stop_m) & (positions < high + stop_m)).all(axis=1)
        if not near.any():
            return True
        gaps = positions[near][:, None, :] - area[None, :, :]
        return bool((gaps**2).sum(axis=2).min() > stop_m**2)

    def _path_on_map(self, last: EpisodeStep) -> PlannedPath | None:
        """The path of the agent's own planner to its goal area; None without one, or a map."""
        grid: OccupancyGrid | None = last.grid
        if grid is None:
            return None
        area = _outline_points(last.trace.goal_area)
        planner = Planner(self._config.planning, self._config.embodiment.body)
        return planner.plan(grid, last.observation.robot.xy, area)

    def _leaves_the_floor(self, path: PlannedPath) -> bool:
        """Whether a path leads where in truth nobody can stand."""
        z = self._truth.position[2]
        for x, y in self._in_scene(_along(path.waypoints)).tolist():
            stand = self._truth.walkable.nearest_standable(x, y, z)
            if math.hypot(stand[0] - x, stand[1] - y) > _OUT_OF_BOUNDS_M:
                return True
        return False


def _outline_points(polygons: list[list[tuple[float, float]]]) -> Float64[np.ndarray, "n 2"]:
    """Points along the outlines, at most `_SPACING_M` apart."""
    return np.concatenate([_along([*polygon, polygon[0]]) for polygon in polygons])


def _along(corners: Sequence[tuple[float, float]]) -> Float64[np.ndarray, "n 2"]:
    """Points along a line from corner to corner, at most `_SPACING_M` apart, without its end."""
    line = np.array(corners, dtype=np.float64)
    points = [line[:1]]
    for a, b in pairwise(line):
        count = max(math.ceil(float(np.linalg.norm(b - a)) / _SPACING_M), 1)
        points.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.concatenate(points)


def _lacks_data(observation: Observation, truth: LabelledPixels) -> bool:
    """Whether an image shows nothing where in a whole building there is a wall or a floor."""
    _, slopes = observation.camera.ray_slopes()
    rotation = observation.camera_to_map.rotation
    below = truth.ids[rotation[2, 1] * slopes + rotation[2, 2] < 0.0]
    return below.size > 0 and float((below < 0).mean()) >= _LACKING_SHARE


def _instance_under(detection: DetectionRecord, truth: LabelledPixels) -> int:
    """Id of the instance that most pixels of a detection show, -1 if most show none."""
    ids = truth.ids
    mask: Bool[np.ndarray, "height width"] = np.zeros(ids.shape, dtype=bool)
    if detection.outlines:
        filled = np.zeros(ids.shape, dtype=np.uint8)
        polygons = [np.array(outline, dtype=np.int32) for outline in detection.outlines]
        mask = cv2.fillPoly(filled, polygons, (1,)).astype(bool)
    else:
        x_min, y_min, x_max, y_max = (round(value) for value in detection.box)
        mask[max(y_min, 0) : max(y_max, 0), max(x_min, 0) : max(x_max, 0)] = True
    if not mask.any():
        return -1
    return int(np.bincount(ids[mask] + 1).argmax()) - 1


def _nearest(
    truth: SceneTruth, point: Float64[np.ndarray, "2"], within_m: float
) -> Instance | None:
    """The labelled object nearest to a point of the floor plan."""
    labelled = [i for i in truth.instances if i.label is not None]
    gaps = [(_gap(i, point), i.id) for i in labelled]
    if not gaps or min(gaps)[0] > within_m:
        return None
    return truth.instances[min(gaps)[1]]


def _gap(instance: Instance, point: Float64[np.ndarray, "2"]) -> float:
    """Horizontal distance of a point to an object's box, metres."""
    low, high = np.array(instance.box_min[:2]), np.array(instance.box_max[:2])
    return float(np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0)))


def _name(instance: Instance) -> str:
    return instance.label.category if instance.label is not None else instance.name
