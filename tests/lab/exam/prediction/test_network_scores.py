"""What the scores of a network are worth, counted in views that show the same things."""

import numpy as np
import pytest

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.lab.exam.prediction.calibration import NO_BOX, log_odds_of, shift_of_looks
from hypernav.lab.exam.prediction.network_scores import Tally
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.onnx_detector import OnnxDetector

BED, OVEN, WALL = Box(20, 20, 60, 80), Box(80, 20, 120, 80), Box(130, 90, 150, 110)
LABELS = {1: ObjectLabel("bed"), 2: ObjectLabel("oven")}


def view(*shown: int) -> Observation:
    ids = np.full((120, 160), -1, np.int32)
    for number, box in ((1, BED), (2, OVEN)):
        if number in shown:
            ids[box.mask(160, 120)] = number
    return Observation(
        np.zeros((120, 160, 3), np.uint8),
        np.full((120, 160), 2.0, np.float32),
        PinholeCamera.from_hfov(160, 120, 79.0),
        Transform.identity(),
        Pose2(0.0, 0.0, 0.0),
        LabelledPixels(ids, LABELS),
    )


class Network(OnnxDetector):
    """Says what it is told to."""

    def __init__(self, *told: tuple[str, Box, float]) -> None:
        self.config = OnnxDetectorConfig(classes=("bed", "oven", "tv"))
        self.told = told

    def detect_all(self, rgb):
        return [Detection(box, score, name) for name, box, score in self.told]

    def _blob(self, rgb):
        raise NotImplementedError

    def _decode(self, outputs):
        raise NotImplementedError

    def _output_shapes(self):
        raise NotImplementedError


def tallied() -> Tally:
    tally = Tally()
    for told in (
        [("bed", BED, 0.9), ("tv", WALL, 0.5)],
        [("bed", BED, 0.7), ("tv", OVEN, 0.6)],
        [("tv", OVEN, 0.4)],
    ):
        tally.add("houses:1", view(1, 2), Network(*told), 0.0)
    tally.add("houses:1", view(1), Network(), 0.0)  # where the oven isn't seen it isn't missed
    tally.add("houses:2", view(1, 2), Network(), 0.0)
    return tally


def test_further_views_of_what_was_named_once_count_and_misses_with_them():
    right = sorted(score for score, is_right in tallied().further_views() if is_right)
    wrong = sorted(score for score, is_right in tallied().further_views() if not is_right)
    assert right == [NO_BOX, NO_BOX, 0.7, 0.9]
    assert wrong == [NO_BOX, 0.4, 0.6]
    assert tallied().nothing == 1
    assert tallied().images == 5


def test_scores_that_come_as_often_of_both_are_worth_nothing_and_misses_speak_against():
    told = [(0.9, True)] * 30 + [(NO_BOX, True)] * 10
    told += [(0.9, False)] * 10 + [(NO_BOX, False)] * 30
    ((_, worth),), missed = log_odds_of(told)
    assert worth == pytest.approx(np.log(3.0), abs=0.1)
    assert missed == pytest.approx(-np.log(3.0), abs=0.1)
    assert log_odds_of([(0.9, True)] * 40) == ((), 0.0)


def test_looks_at_a_thing_count_from_the_first_box_on():
    looks = tallied().looks_at_things(lambda score: score)
    assert sorted(looks) == [([0.6, 0.4], False), ([0.9, 0.7, NO_BOX, NO_BOX], True)]


def things(rights: int, wrongs: int, weights: list[float]) -> list[tuple[list[float], bool]]:
    return [(weights, True)] * rights + [(weights, False)] * wrongs


def test_looks_that_err_together_are_worth_less_than_each_alone():
    alone = shift_of_looks(things(80, 20, [1.4 + np.log(4.0)]))
    assert alone == pytest.approx(0.0, abs=1e-3)
    assert shift_of_looks(things(80, 20, [1.4 + np.log(4.0), 0.7, 0.7])) < -0.3


def test_a_network_that_names_everything_is_believed_less():
    seldom, often = (shift_of_looks(things(20, wrongs, [1.0, 1.0])) for wrongs in (10, 200))
    assert often < seldom - 0.5
