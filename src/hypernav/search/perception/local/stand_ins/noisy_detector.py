"""A stand-in for a detector of known quality: true labels with misses and false alarms."""

import math

import numpy as np

from hypernav.core.config import Curve
from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, normalise, same_name
from hypernav.core.observation import Observation
from hypernav.search.models.reliability import known
from hypernav.search.perception.config import DetectorQuality
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.yes_no_checks import confusions

_LEAST_SCORE = 0.05
_ALARM_SIDES = (0.05, 0.4)
"""Least and largest side of a false alarm, as a share of the image's."""


LEVELS = {
    "perfect": DetectorQuality(),
    "good": DetectorQuality(
        missed_near=0.1,
        missed_far=0.2,
        never_found=0.01,
        confused_alike=0.04,
        confused_other=0.002,
        false_alarms=0.002,
        right_score=0.8,
        wrong_score=0.4,
        score_sd=0.1,
        jitter_px=2.0,
    ),
    "fair": DetectorQuality(
        missed_near=0.2,
        missed_far=0.35,
        never_found=0.03,
        confused_alike=0.09,
        confused_other=0.005,
        false_alarms=0.005,
        right_score=0.75,
        wrong_score=0.45,
        score_sd=0.15,
        jitter_px=3.0,
    ),
    "poor": DetectorQuality(
        missed_near=0.4,
        missed_far=0.6,
        never_found=0.07,
        confused_alike=0.17,
        confused_other=0.01,
        false_alarms=0.01,
        right_score=0.7,
        wrong_score=0.5,
        score_sd=0.17,
        jitter_px=4.0,
    ),
}
"""The qualities of ``noisy:LEVEL``, the best first.

``perfect`` makes no errors: it sees what ground truth sees, but gives boxes without masks. ``poor``
makes about as many as YOLOX-nano on views of generated houses (benchmarks/detector_errors.py),
``fair`` about half of them and ``good`` about a fifth.
"""
_CUSTOM = "custom"
"""The level whose rates are those of the section ``noisy_detector``."""


class NoisyDetector:
    """Detects the goal from the labels of a simulated world, with set error rates.

    It gives boxes only, as most detectors do, so a segmenter finds the pixels. Misses, false alarms
    and scores are independent from image to image, which is kinder than a real detector is: its
    errors persist while the view hardly changes. What persists here is drawn once for each object
    and episode: that it is never found, or that it is taken for the goal.

    Attributes:
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        looks_closer: See `hypernav.core.components.abilities.looks_closer`.
        score_weights: See `hypernav.core.components.abilities.score_weights_of`; YOLOX-nano's,
            which it imitates.
    """

    looks_at_colours = False
    looks_closer = False
    score_weights: Curve = known()["yolox-nano"].boxes

    def __init__(
        self, level: str, truth: EpisodeTruth, config: DetectorQuality | None = None
    ) -> None:
        """Create the detector.

        Args:
            level: Name of the quality: "perfect", "good", "fair", "poor" or "custom".
            truth: Source of the episode's random generator.
            config: Error rates of "custom".

        Raises:
            ConfigError: There is no such level.
        """
        levels = LEVELS | {_CUSTOM: config or DetectorQuality()}
        if level not in levels:
            raise ConfigError(
                f"--detector noisy:{level:.40}: expected one of {', '.join(levels)}; the error "
                f"rates of {_CUSTOM} are in the section 'noisy_detector'"
            )
        self._quality = levels[level]
        self._truth = truth
        self._rng: np.random.Generator | None = None
        self._seems: dict[int, bool] = {}
        """Whether an object seems to be the goal, by its number."""

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Goals found, other things taken for the goal, and false alarms; best first.

        Raises:
            LabelsMissingError: The world supplies no labels.
            TruthMissingError: This episode's generator was not set.
        """
        rng = self._rng_of_episode()
        pixels = true_labels(observation)
        detections: list[Detection] = []
        for number in visible_objects(pixels):
            label = pixels.labels[number]
            if self._seems_goal(number, label, goal, rng):
                true = true_detection(pixels, number)
                if rng.random() >= self._quality.missed_at(distance_to(true, observation)):
                    box = self._jittered(true.box, observation, rng)
                    score = self._score(rng, is_right=label.satisfies(goal))
                    detections.append(Detection(box, score, goal.thing))
        for _ in range(int(rng.poisson(self._quality.false_alarms))):
            score = self._score(rng, is_right=False)
            detections.append(Detection(_random_box(observation, rng), score, goal.thing))
        return sorted(detections, key=lambda one: -one.score)

    def _rng_of_episode(self) -> np.random.Generator:
        """The generator; with that of another episode, what was drawn for objects is forgotten."""
        rng = self._truth.rng
        if rng is not self._rng:
            self._rng, self._seems = rng, {}
        return rng

    def _seems_goal(
        self, number: int, label: ObjectLabel, goal: Goal, rng: np.random.Generator
    ) -> bool:
        """Whether an object is taken for the goal in this episode; drawn when it is first seen."""
        if number not in self._seems:
            quality = self._quality
            if label.satisfies(goal):
                chance = 1.0 - quality.never_found
            else:
                alike = resembles(label, goal)
                chance = quality.confused_alike if alike else quality.confused_other
            self._seems[number] = bool(rng.random() < chance)
        return self._seems[number]

    def _score(self, rng: np.random.Generator, *, is_right: bool) -> float:
        mean = self._quality.right_score if is_right else self._quality.wrong_score
        return float(np.clip(rng.normal(mean, self._quality.score_sd), _LEAST_SCORE, 1.0))

    def _jittered(self, box: Box, observation: Observation, rng: np.random.Generator) -> Box:
        """A box with shifted edges, at least a pixel of it in the image."""
        by_px = rng.normal(0.0, self._quality.jitter_px, 4)
        height, width = observation.depth.shape
        x_min = float(np.clip(box.x_min + by_px[0], 0.0, width - 1.0))
        y_min = float(np.clip(box.y_min + by_px[1], 0.0, height - 1.0))
        x_max = float(np.clip(box.x_max + by_px[2], x_min + 1.0, width))
        y_max = float(np.clip(box.y_max + by_px[3], y_min + 1.0, height))
        return Box(x_min, y_min, x_max, y_max)


def resembles(label: ObjectLabel, goal: Goal) -> bool:
    """Whether an object that isn't the goal is easily taken for it.

    It is if the goal names it or its head noun (a red armchair for "blue armchair", a shower
    curtain for "window curtain"), or if the two are a pair that models confuse.
    """
    head_noun = normalise(label.category).rsplit(" ", maxsplit=1)[-1]
    return head_noun in normalise(goal.text).split() or any(
        same_name(label.category, other) for other in confusions(goal)
    )


def distance_to(detection: Detection, observation: Observation) -> float:
    """Median depth of an object's pixels, metres; infinite where none has depth."""
    depth = observation.depth[detection.mask]
    measured = depth[depth > 0.0]
    return float(np.median(measured)) if measured.size else math.inf


def _random_box(observation: Observation, rng: np.random.Generator) -> Box:
    """A box anywhere in the image, with sides of all sizes."""
    height, width = observation.depth.shape
    least, most = np.log(_ALARM_SIDES)
    shares = np.exp(rng.uniform(least, most, 2))
    x_size, y_size = float(shares[0] * width), float(shares[1] * height)
    x_min, y_min = float(rng.uniform(0.0, width - x_size)), float(rng.uniform(0.0, height - y_size))
    return Box(x_min, y_min, x_min + x_size, y_min + y_size)
