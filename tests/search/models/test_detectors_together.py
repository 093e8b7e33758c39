from dataclasses import dataclass, field

import numpy as np
import pytest

from hypernav.core.config import Curve, along
from hypernav.core.errors import GoalError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.models.detectors_together import DetectorsTogether

BOX, NEARLY, ELSEWHERE = Box(10, 10, 50, 50), Box(12, 11, 52, 50), Box(200, 10, 250, 60)
VIEW = Observation(
    np.zeros((120, 320, 3), np.uint8),
    np.ones((120, 320), np.float32),
    PinholeCamera.from_hfov(320, 120, 79.0),
    Transform.identity(),
    Pose2(0.0, 0.0, 0.0),
)
CURVE: Curve = ((0.0, -2.0), (0.5, 0.0), (1.0, 4.0))


@dataclass
class Told:
    """A detector that says what it is told to."""

    found: list[Detection]
    names: tuple[str, ...] = ("bed", "sofa")
    score_weights: Curve = CURVE
    missed_weight: float = -1.0
    asked: list[str] = field(default_factory=list)

    def check_goal(self, goal: Goal) -> None:
        if goal.text not in self.names:
            raise GoalError(f"no {goal.text}")

    def detect(self, observation, goal: Goal) -> list[Detection]:
        self.asked.append(goal.text)
        return self.found


def weights(*detectors: Told) -> list[float]:
    """The weights of the goals that they find together."""
    together = DetectorsTogether(*detectors)
    found = together.detect(VIEW, Goal("bed"))
    return [along(together.score_weights, one.score) for one in found if one.is_goal]


def bed(box: Box, score: float) -> Detection:
    return Detection(box, score, "bed")


def test_what_detectors_say_counts_on_average():
    low, high = along(CURVE, 0.5), along(CURVE, 0.75)
    (agreed,) = weights(Told([bed(BOX, 0.75)]), Told([bed(NEARLY, 0.75)]))
    (between,) = weights(Told([bed(BOX, 0.5)]), Told([bed(NEARLY, 0.75)]))
    (doubted,) = weights(Told([bed(BOX, 0.75)]), Told([]))
    assert agreed == pytest.approx(high)
    assert between == pytest.approx((low + high) / 2.0)
    assert doubted == pytest.approx((high - 1.0) / 2.0)


def test_each_scale_counts_by_what_was_measured_of_it():
    timid: Curve = ((0.0, -2.0), (0.1, 3.0))
    (agreed,) = weights(Told([bed(BOX, 0.5)]), Told([bed(BOX, 0.1)], score_weights=timid))
    (by_own,) = weights(Told([bed(BOX, 0.5)]), Told([bed(BOX, 0.1)]))
    assert by_own < 0.0 < agreed


def test_two_boxes_of_one_detector_count_once_and_two_things_stay_two():
    once = weights(Told([bed(BOX, 0.75)]), Told([bed(BOX, 0.75)]))
    twice = weights(Told([bed(BOX, 0.75), bed(NEARLY, 0.7)]), Told([bed(BOX, 0.75)]))
    assert once == twice
    assert len(weights(Told([bed(BOX, 0.75)]), Told([bed(ELSEWHERE, 0.75)]))) == 2


def test_a_detector_without_a_name_for_it_doubts_nothing():
    sees, lacks = Told([bed(BOX, 0.75)]), Told([], names=("chair",))
    (alone,) = weights(sees, lacks)
    assert alone == pytest.approx(along(CURVE, 0.75))
    assert lacks.asked == []
    with pytest.raises(GoalError, match="no bed"):
        weights(lacks, Told([], names=("chair",)))


def test_another_name_for_the_same_pixels_stays_beside_as_a_rival():
    rival = Detection(NEARLY, 0.9, "sofa", is_goal=False)
    together = DetectorsTogether(Told([bed(BOX, 0.6)]), Told([rival]))
    found = together.detect(VIEW, Goal("bed"))
    assert [(one.label, one.is_goal) for one in found] == [("sofa", False), ("bed", True)]
    assert all(0.0 <= one.score <= 1.0 for one in found)
    assert together.missed_weight == -1.0
