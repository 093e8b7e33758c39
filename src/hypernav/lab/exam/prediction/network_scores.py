"""Measures what the scores of a network are worth as evidence, in views of training buildings.

A search believes in a candidate after one box of it. So what counts is how often *further* views of
what was taken for the goal give a score, where it is the goal and where it is something else.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import dropwhile

import numpy as np

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.config import along
from hypernav.core.episode import Episode
from hypernav.core.errors import GoalError, ModelError, StartError
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import Observation
from hypernav.core.world import Simulator
from hypernav.lab.exam.bank import Bank, ExamSize
from hypernav.lab.exam.prediction.calibration import NO_BOX, log_odds_of, shift_of_looks
from hypernav.search.models.closed_set import class_for
from hypernav.search.models.onnx_detector import OnnxDetector
from hypernav.search.models.reliability import Reliability, sha256_of
from hypernav.search.perception.local.second_look import looked_closer
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.stand_ins.noisy_detector import distance_to

BUILDINGS: dict[ExamSize, int] = {"quick": 12, "full": 60}
_VIEWS = 24  # of a building
_THINGS = 12
"""Number of things of a building that the views are aimed at."""
_NEAREST_M, _FARTHEST_M = 0.8, 5.0
_ASIDE_RAD = 0.35
"""Standard deviation of the heading from the direction of the thing."""
_LEAST_SHARE = 0.002
"""Least share of the image that a thing covers in a view that should show it."""
_SAME_IOU = 0.3
"""Overlap from which on a box is of a thing."""
_LEAST = 20
"""Least number of further views of right and of wrong things from which weights are told."""

Taken = tuple[str, int, str]
"""Building and number of a thing, and what it was taken for."""


@dataclass
class Tally:
    """What a network said in all views.

    Attributes:
        views: Of each thing and name that was ever said of it, the score in every view that shows
            the thing; `NO_BOX` where it was not said.
        right: Whether the name is one of the thing.
        images: Number of images.
        nothing: Number of boxes around no thing.
    """

    views: dict[Taken, list[float]] = field(default_factory=dict)
    right: dict[Taken, bool] = field(default_factory=dict)
    images: int = 0
    nothing: int = 0
    _shown: dict[tuple[str, int], int] = field(default_factory=lambda: defaultdict(int))

    def add(
        self, scene: str, observation: Observation, detector: OnnxDetector, below: float
    ) -> None:
        """Ask the network about one view.

        Args:
            scene: The building.
            observation: The view, with true labels.
            detector: The network.
            below: Score below which it looks once more (`LocalConfig.look_closer_below`).
        """
        truth = true_labels(observation)
        seen = {k: true_detection(truth, k) for k in visible_objects(truth, _LEAST_SHARE)}
        seen = {k: one for k, one in seen.items() if distance_to(one, observation) <= _FARTHEST_M}
        said: dict[Taken, float] = {}
        for one in detector.detect_all(observation.rgb):
            over = {k: true.box.iou(one.box) for k, true in seen.items()}
            over = {k: iou for k, iou in over.items() if iou >= _SAME_IOU}
            if not over:
                self.nothing += 1
                continue
            named = [k for k in over if _is_named(truth.labels[k], one, detector.config.classes)]
            taken = (scene, max(named or over, key=over.__getitem__), one.label)
            self.right[taken] = bool(named)
            twice = looked_closer(one, detector, observation, Goal(one.label), below)
            said[taken] = max(said.get(taken, NO_BOX), twice.score)
        for taken, views in self.views.items():
            if taken[0] == scene and taken[1] in seen and taken not in said:
                views.append(NO_BOX)
        for taken, score in said.items():
            earlier = [NO_BOX] * self._shown[taken[:2]]
            self.views.setdefault(taken, earlier).append(score)
        for number in seen:
            self._shown[scene, number] += 1
        self.images += 1

    def further_views(self) -> list[tuple[float, bool]]:
        """Scores in views of what another view had named so, and whether the name is right."""
        return [
            (score, self.right[taken])
            for taken, scores in self.views.items()
            for at, score in enumerate(scores)
            if any(other > NO_BOX for k, other in enumerate(scores) if k != at)
        ]

    def looks_at_things(self, weight: Callable[[float], float]) -> list[tuple[list[float], bool]]:
        """For each thing the weights of the looks at it, from the first box on; and if it is right.

        Args:
            weight: What a score, or `NO_BOX`, is worth.
        """
        return [
            ([weight(one) for one in dropwhile(lambda score: score < 0.0, scores)], self.right[it])
            for it, scores in self.views.items()
        ]


def measure(
    detector: OnnxDetector, config: HyPerNavConfig, size: ExamSize, watch: Callable[[str], None]
) -> Reliability:
    """Measure what a network's scores are worth.

    Args:
        detector: The network.
        config: The robot whose camera sees the buildings, and when the network looks once more.
        size: How many buildings.
        watch: Function that is called with the name of every building.

    Raises:
        ModelError: The network says too little for a judgement.
    """
    tally, scenes = Tally(), list[str]()
    for scene, observation in training_views(config, size):
        if scene not in scenes:
            scenes.append(scene)
            watch(scene)
        tally.add(scene, observation, detector, config.local.look_closer_below)
    further = tally.further_views()
    rights = sum(is_right for _, is_right in further)
    if min(rights, len(further) - rights) < _LEAST:
        raise ModelError(
            f"{detector.path}: of {len(further)} further views of what it named, {rights} are of "
            f"things named rightly; expected at least {_LEAST} of these, and of the others: use "
            "--size full, or a lower score_threshold"
        )
    boxes, missed = log_odds_of(further)
    shift = shift_of_looks(tally.looks_at_things(lambda s: missed if s < 0.0 else along(boxes, s)))
    return Reliability(
        sha256=sha256_of(detector.path),
        boxes=tuple((score, round(weight + shift, 3)) for score, weight in boxes),
        missed=round(min(missed + shift, 0.0), 3),
        buildings=tuple(scenes),
        images=tally.images,
        right=sum(tally.right.values()),
        alike=len(tally.right) - sum(tally.right.values()),
        nothing=tally.nothing,
    )


def training_views(config: HyPerNavConfig, size: ExamSize) -> Iterator[tuple[str, Observation]]:
    """Views of things in buildings that belong to the exam's training bank, with true labels."""
    sheets = Bank("train", "full", ("boxes",)).sheets()
    for _, sheet in zip(range(BUILDINGS[size]), sheets, strict=False):
        world = open_world(sheet.scene, config)
        try:
            for observation in _views(world, np.random.default_rng(sheet.number)):
                yield sheet.scene, observation
        finally:
            world.close()


def _views(world: Simulator, rng: np.random.Generator) -> Iterator[Observation]:
    """Views of some things, each from several sides and distances."""
    truth = world.truth
    things = [one for one in truth.instances if one.label is not None]
    things = [things[k] for k in rng.permutation(len(things))[:_THINGS].tolist()]
    points = truth.walkable.centres()
    for number in range(_VIEWS):
        thing = things[number % len(things)]
        x, y, _ = ((np.array(thing.box_min) + np.array(thing.box_max)) / 2.0).tolist()
        away_m = np.hypot(points[:, 0] - x, points[:, 1] - y)
        near = points[(away_m >= _NEAREST_M) & (away_m <= _FARTHEST_M)]
        if not len(near):
            continue
        at = near[int(rng.integers(len(near)))]
        heading = math.atan2(y - at[1], x - at[0]) + float(rng.normal(0.0, _ASIDE_RAD))
        start = Pose2(float(at[0]), float(at[1]), heading)
        try:
            yield world.reset(Episode(truth.name, str(number), Goal(thing.name), start))
        except StartError:
            continue


def _is_named(label: ObjectLabel, said: Detection, classes: tuple[str, ...]) -> bool:
    """Whether a network's word is one for a thing."""
    if label.is_named(said.label):
        return True
    try:
        return classes[class_for(Goal(label.category), classes)] == said.label
    except GoalError:
        return False
