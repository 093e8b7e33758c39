"""Several detectors as one: what each says, or doesn't say, of a thing is evidence about it.

The weight of an image (`hypernav.core.score_weights`) is the mean of theirs, a logarithmic opinion
pool: what one of them mistakes, the other often mistakes, too, so that a sum would count it twice.
In views of 2,125 things in training buildings the best factor for the sum of YOLOX-nano's and
PicoDet-S's weights is 0.53.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hypernav.core.components.abilities import ChecksGoal, missed_weight_of, score_weights_of
from hypernav.core.components.protocols import Detector
from hypernav.core.config import Curve, along
from hypernav.core.errors import GoalError
from hypernav.core.geometry.boxes import Detection
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.score_weights import NEUTRAL

_SAME_IOU = 0.5
"""Overlap from which on boxes of two detectors are of one thing."""


class DetectorsTogether:
    """Detects with several detectors.

    Its scores are on the scale of the first detector: the score with which that one alone would be
    worth as much as all of them are together.
    """

    def __init__(self, *detectors: Detector) -> None:
        """Take the detectors, two or more, each with what is known of its scores."""
        self.parts = detectors
        self._curves = [score_weights_of(one) or NEUTRAL for one in detectors]
        self._missed = [missed_weight_of(one) for one in detectors]
        self._names: dict[tuple[int, str], bool] = {}

    @property
    def score_weights(self) -> Curve:
        """What its scores are worth: what the first detector's are."""
        return self._curves[0]

    @property
    def missed_weight(self) -> float:
        """What it is worth that no detector sees a candidate."""
        return float(np.mean(self._missed))

    def check_goal(self, goal: Goal) -> object:
        """Refuse a goal that no detector has a name for.

        Raises:
            GoalError: None has; the message is the first one's.
        """
        if not any(self._can_name(number, goal.text) for number in range(len(self.parts))):
            first = self.parts[0]
            assert isinstance(first, ChecksGoal)
            return first.check_goal(goal)
        return goal.text

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """All that any detector finds, the likeliest first; one box for each thing and name.

        Raises:
            GoalError: No detector has a name for the goal.
        """
        self.check_goal(goal)
        asked = [k for k in range(len(self.parts)) if self._can_name(k, goal.text)]
        told = [
            (along(self._curves[number], one.score), number, one)
            for number in asked
            for one in self.parts[number].detect(observation, goal)
        ]
        told.sort(key=lambda one: -one[0])
        found: list[tuple[float, Detection]] = []
        while told:
            (_, _, best), same = told[0], dict[int, float]()
            left = []
            for weight, number, one in told:
                if not _is_same(one, best):
                    left.append((weight, number, one))
                else:  # of one detector only its surest box counts
                    same.setdefault(number, weight)
            found.append((self._together(same, best, asked), best))
            told = left
        found.sort(key=lambda one: -one[0])
        return [replace(one, score=self._score_of(weight)) for weight, one in found]

    def things_in(
        self, observation: Observation, detections: Sequence[Detection]
    ) -> list[Detection]:
        """All that `detect` found."""
        return list(detections)

    def _together(self, said: dict[int, float], one: Detection, asked: Sequence[int]) -> float:
        """The weight of what some of the detectors that were asked said, and the others did not."""
        able = [k for k in asked if k in said or self._can_name(k, one.label)]
        return float(np.mean([said.get(number, self._missed[number]) for number in able]))

    def _score_of(self, weight: float) -> float:
        """The score of the first detector that is worth so much."""
        scores, weights = zip(*self._curves[0], strict=True)
        rising = np.maximum.accumulate(weights)
        return float(np.interp(weight, rising, scores))

    def _can_name(self, number: int, name: str) -> bool:
        """Whether a detector has a name for a thing; it has, unless it says otherwise."""
        if (number, name) not in self._names:
            detector = self.parts[number]
            try:
                if isinstance(detector, ChecksGoal):
                    detector.check_goal(Goal(name))
                self._names[number, name] = True
            except GoalError:
                self._names[number, name] = False
        return self._names[number, name]


def _is_same(one: Detection, other: Detection) -> bool:
    """Whether two boxes are of one thing with one name."""
    if one is other:
        return True
    same_name = one.is_goal if other.is_goal else not one.is_goal and one.label == other.label
    return same_name and one.box.iou(other.box) >= _SAME_IOU
