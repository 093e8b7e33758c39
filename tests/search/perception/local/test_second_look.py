from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.models.picodet import PicodetDetector
from hypernav.search.models.yolox import YoloxDetector
from hypernav.search.perception.local.second_look import detect_twice

BOX, ELSEWHERE = Box(300.0, 200.0, 340.0, 260.0), Box(10.0, 10.0, 99.0, 99.0)


def observe(rgb: np.ndarray) -> Observation:
    camera = PinholeCamera.from_hfov(rgb.shape[1], rgb.shape[0], 79.0)
    depth = np.ones(rgb.shape[:2], dtype=np.float32)
    return Observation(rgb, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("kind", "file"),
    [(YoloxDetector, "yolox_nano.onnx"), (PicodetDetector, "picodet_s_416_coco.onnx")],
)
def test_weak_boxes_are_looked_at_once_more_from_nearer(kind, file: str, test_data: Path):
    pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'")
    image = Image.open(test_data / "rgbd" / "lounge" / "frame-000116.color.png")
    detector, lounge = kind(test_data / "models" / file), np.asarray(image.convert("RGB"))
    before = [one for one in detector.detect(observe(lounge), Goal("chair")) if one.is_goal]
    told = detect_twice(detector, observe(lounge), Goal("chair"), 0.6)
    after = [one for one in told if one.is_goal]
    assert {one.box for one in before} == {one.box for one in after}
    score_of = {one.box: one.score for one in after}
    assert all(score_of[one.box] == one.score for one in before if one.score >= 0.6)
    changed = [one for one in before if score_of[one.box] != one.score]
    assert 1 <= len(changed) <= 3
    assert all(score_of[one.box] <= (one.score + 1.0) / 2.0 for one in before)
    assert [one.score for one in told] == sorted((one.score for one in told), reverse=True)


@dataclass
class OneThing:
    """A user's detector of one thing: it sees it at `BOX`, and in a part where that is there."""

    first: float
    again: float
    looks_closer: bool = True
    parts: list[Observation] = field(default_factory=list)

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        if observation.rgb.shape == (480, 640, 3):
            return [Detection(BOX, self.first, goal.text)]
        self.parts.append(observation)
        x, y = 320.0 - observation.camera.cx, 240.0 - observation.camera.cy  # its corner
        moved = Box(BOX.x_min - x, BOX.y_min - y, BOX.x_max - x, BOX.y_max - y)
        return [
            Detection(moved, self.again, goal.text),
            Detection(moved, 0.99, "another", is_goal=False),
            Detection(Box(0.0, 0.0, 5.0, 5.0), 0.98, goal.text),
        ]


VIEW = observe(np.zeros((480, 640, 3), np.uint8))


def scores(detector: OneThing, below: float = 0.6) -> list[float]:
    return [one.score for one in detect_twice(detector, VIEW, Goal("bed"), below)]


def test_any_detector_with_scores_is_asked_again_and_the_mean_counts():
    detector = OneThing(0.4, 0.8)
    assert scores(detector) == pytest.approx([0.6])
    (part,) = detector.parts
    assert part.rgb.shape == (150, 150, 3)  # 2.5 times the longer side
    ray = part.camera.unproject(np.array([320.0 - 245.0]), np.array([240.0 - 155.0]), 1.0)
    assert np.allclose(ray, [[0.0, 0.0, 1.0]])  # the part's camera sees what the whole one saw


@pytest.mark.parametrize(
    ("detector", "below"),
    [
        (OneThing(0.7, 0.1), 0.6),
        (OneThing(0.4, 0.8), 0.0),
        (OneThing(0.4, 0.8, looks_closer=False), 0.6),
    ],
)
def test_strong_boxes_and_detectors_that_say_so_are_not_asked_again(detector, below: float):
    assert scores(detector, below) == [detector.first]
    assert not detector.parts


def test_what_is_not_seen_again_loses_half():
    missing = OneThing(0.4, 0.8)
    missing.detect = lambda observation, goal: (  # type: ignore[method-assign]
        [Detection(BOX, 0.4, goal.text)] if observation.rgb.shape[1] == 640 else []
    )
    assert scores(missing) == pytest.approx([0.2])


def test_a_detector_with_an_order_of_its_own_keeps_it():
    two = OneThing(0.4, 0.8)
    strong = Detection(ELSEWHERE, 0.9, "bed")
    two.detect = lambda observation, goal: (  # type: ignore[method-assign]
        [Detection(BOX, 0.4, "bed"), strong] if observation.rgb.shape[1] == 640 else []
    )
    assert scores(two) == pytest.approx([0.2, 0.9])


def test_a_part_keeps_depth_and_truth_of_its_pixels():
    depth = np.arange(480 * 640, dtype=np.float32).reshape(480, 640)
    part = replace(VIEW, depth=depth).part(slice(400, 600), slice(10, 30))
    assert np.array_equal(part.depth, depth[400:480, 10:30])
    assert (part.camera.width, part.camera.height) == (20, 80)
    rows, columns = np.array([5]), np.array([7])
    whole = replace(VIEW, depth=depth).points_at(rows + 400, columns + 10)
    assert np.allclose(part.points_at(rows, columns), whole)
