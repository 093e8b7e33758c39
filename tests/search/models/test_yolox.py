from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from onnx_bytes import identity_model
from PIL import Image

from hypernav.core.errors import GoalError, ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.models.closed_set import COCO_CLASSES, class_for
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.onnx_detector import keep_best_boxes
from hypernav.search.models.yolox import YoloxDetector

pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'")


@pytest.fixture(scope="module")
def detector(test_data: Path) -> YoloxDetector:
    return YoloxDetector(test_data / "models" / "yolox_nano.onnx")


@pytest.fixture(scope="module")
def lounge(test_data: Path) -> np.ndarray:
    image = Image.open(test_data / "rgbd" / "lounge" / "frame-000116.color.png")
    return np.asarray(image.convert("RGB"))


def observe(rgb: np.ndarray) -> Observation:
    camera = PinholeCamera.from_hfov(rgb.shape[1], rgb.shape[0], 79.0)
    depth = np.ones(rgb.shape[:2], dtype=np.float32)
    return Observation(rgb, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


def goals(found):
    return [one for one in found if one.is_goal]


def test_sees_both_sofas_of_a_real_lounge(detector: YoloxDetector, lounge: np.ndarray):
    found = goals(detector.detect(observe(lounge), Goal("sofa")))
    found = [one for one in found if one.score > 0.5]  # weaker ones are candidates only
    assert [one.label for one in found] == ["couch", "couch"]
    assert found[0].score >= found[1].score
    right, left = Box(370.0, 150.0, 640.0, 335.0), Box(0.0, 212.0, 310.0, 480.0)  # drawn by eye
    assert max(found[0].box.iou(right), found[1].box.iou(right)) > 0.85
    assert max(found[0].box.iou(left), found[1].box.iou(left)) > 0.6


def test_finds_nothing_of_another_kind(detector: YoloxDetector, lounge: np.ndarray):
    found = detector.detect(observe(lounge), Goal("toilet"))
    assert goals(found) == []
    assert {"couch", "chair"} <= {one.label for one in found}


def test_same_image_same_answer(detector: YoloxDetector, lounge: np.ndarray):
    first, second = detector.detect_all(lounge), detector.detect_all(lounge)
    assert [(d.box, d.score, d.label) for d in first] == [(d.box, d.score, d.label) for d in second]


@pytest.mark.parametrize("shape", [(480, 640), (640, 480), (1080, 1920), (100, 100), (1, 1)])
def test_boxes_lie_inside_a_image_of_any_size(
    detector: YoloxDetector, lounge: np.ndarray, shape: tuple[int, int]
):
    height, width = shape
    image = np.asarray(Image.fromarray(lounge).resize((width, height)))
    for found in detector.detect_all(image):
        assert found.box == found.box.clipped(width, height)
        assert found.box.area > 0.0


def test_an_export_with_decoding_built_in_gives_the_same_boxes(
    detector: YoloxDetector, lounge: np.ndarray, test_data: Path
):
    class Decoded:
        """The raw network with the decoding of ``--decode_in_inference`` behind it."""

        def __init__(self, raw):
            self.raw = raw

        def run(self, names, inputs):
            output = self.raw.run(names, inputs)[0].copy()
            cells, strides = [], []
            for stride in (8, 16, 32):
                side = 416 // stride
                for row in range(side):
                    cells += [(column, row) for column in range(side)]
                strides += [stride] * side * side
            stride_of = np.array(strides, dtype=np.float32)[:, None]
            output[0, :, :2] = (output[0, :, :2] + np.array(cells)) * stride_of
            output[0, :, 2:4] = np.exp(output[0, :, 2:4]) * stride_of
            return [output]

    decoded = YoloxDetector(test_data / "models" / "yolox_nano.onnx")
    decoded._session = Decoded(decoded._session)
    for a, b in zip(detector.detect_all(lounge), decoded.detect_all(lounge), strict=True):
        assert a.label == b.label
        assert a.box.iou(b.box) > 0.999


def test_a_network_gone_mad_gives_no_box_outside_the_image(test_data: Path, lounge: np.ndarray):
    class Mad:
        def run(self, names, inputs):
            output = np.random.default_rng(0).normal(0.0, 50.0, (1, 3549, 85)).astype(np.float32)
            output[0, ::7] = np.nan
            output[0, ::11] = np.inf
            return [output]

    mad = YoloxDetector(test_data / "models" / "yolox_nano.onnx")
    mad._session = Mad()
    for found in mad.detect_all(lounge):
        assert found.box == found.box.clipped(lounge.shape[1], lounge.shape[0])


@pytest.mark.parametrize(
    ("goal", "name"),
    [
        ("sofa", "couch"),
        ("the television", "tv"),
        ("Fridge", "refrigerator"),
        ("plant", "potted plant"),
        ("chairs", "chair"),
        ("table", "dining table"),
        ("cell-phone", "cell phone"),
        ("bear", "bear"),
    ],
)
def test_goal_names_a_class(goal: str, name: str):
    assert COCO_CLASSES[class_for(Goal(goal), COCO_CLASSES)] == name


@pytest.mark.parametrize("name", COCO_CLASSES)
def test_every_class_names_itself(name: str):
    assert COCO_CLASSES[class_for(Goal(name), COCO_CLASSES)] == name


@pytest.mark.parametrize(
    ("goal", "hint"), [("red chair", "chair"), ("umbrela", "umbrella"), ("wardrobe", "closest")]
)
def test_goal_outside_the_classes_names_the_closest(
    detector: YoloxDetector, lounge: np.ndarray, goal: str, hint: str
):
    with pytest.raises(GoalError, match=hint):
        detector.check_goal(Goal(goal))
    with pytest.raises(GoalError, match=hint):
        detector.detect(observe(lounge), Goal(goal))


def test_missing_file(tmp_path: Path):
    with pytest.raises(ModelError, match="not found"):
        YoloxDetector(tmp_path / "none.onnx")


def test_not_an_onnx_file(tmp_path: Path):
    path = tmp_path / "text.onnx"
    path.write_text("hello")
    with pytest.raises(ModelError, match="not an ONNX model"):
        YoloxDetector(path)


def test_onnx_file_of_another_network(tmp_path: Path):
    path = tmp_path / "identity.onnx"
    path.write_bytes(identity_model((1, 3, 416, 416)))
    with pytest.raises(ModelError, match=r"expected an output of \[1, 3549, 85\]"):
        YoloxDetector(path)
    path.write_bytes(identity_model((1, 10)))
    with pytest.raises(ModelError, match="one float input"):
        YoloxDetector(path)


def test_wrong_number_of_classes(test_data: Path):
    with pytest.raises(ModelError, match="2 classes"):
        YoloxDetector(
            test_data / "models" / "yolox_nano.onnx", OnnxDetectorConfig(classes=("bed", "sofa"))
        )


corners = st.floats(0.0, 100.0)


@given(
    st.lists(
        st.tuples(corners, corners, st.floats(0.1, 50), st.floats(0.1, 50), st.integers(0, 2)),
        max_size=20,
    ),
    st.floats(0.1, 0.9),
    st.sampled_from([1.0, 1e-3]),  # pixels, or shares of an image
)
def test_kept_boxes_of_a_class_never_overlap_more_than_allowed(rows, max_iou: float, unit: float):
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    boxes = np.concatenate([table[:, :2], table[:, :2] + table[:, 2:4]], axis=1) * unit
    scores = np.linspace(0.1, 0.9, len(boxes))
    classes = table[:, 4].astype(np.int64)
    kept = keep_best_boxes(boxes, scores, classes, max_iou)
    as_boxes = [Box(*map(float, boxes[i])) for i in range(len(boxes))]
    for place, i in enumerate(kept):
        for j in kept[:place]:
            assert classes[i] != classes[j] or as_boxes[i].iou(as_boxes[j]) <= max_iou + 1e-9
    for i in set(range(len(boxes))) - set(kept):
        assert any(
            classes[i] == classes[j] and as_boxes[i].iou(as_boxes[j]) > max_iou - 1e-9 for j in kept
        )
    assert [scores[i] for i in kept] == sorted((scores[i] for i in kept), reverse=True)
