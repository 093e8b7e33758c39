from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.picodet import PicodetDetector

pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'")

STRIDES = (8, 16, 32, 64)


@pytest.fixture(scope="module")
def detector(test_data: Path) -> PicodetDetector:
    return PicodetDetector(test_data / "models" / "picodet_s_416_coco.onnx")


@pytest.fixture(scope="module")
def lounge(test_data: Path) -> np.ndarray:
    image = Image.open(test_data / "rgbd" / "lounge" / "frame-000116.color.png")
    return np.asarray(image.convert("RGB"))


def test_sees_both_sofas_of_a_real_lounge(detector: PicodetDetector, lounge: np.ndarray):
    found = [one for one in detector.detect_all(lounge) if one.score > 0.5]
    assert [one.label for one in found] == ["couch", "couch"]
    right, left = Box(370.0, 150.0, 640.0, 335.0), Box(0.0, 212.0, 335.0, 480.0)  # drawn by eye
    assert found[0].box.iou(right) > 0.9
    assert found[1].box.iou(left) > 0.9


@pytest.mark.parametrize("shape", [(480, 640), (640, 480), (100, 100), (1, 1)])
def test_boxes_lie_inside_an_image_of_any_size(
    detector: PicodetDetector, lounge: np.ndarray, shape: tuple[int, int]
):
    height, width = shape
    for found in detector.detect_all(np.asarray(Image.fromarray(lounge).resize((width, height)))):
        assert found.box == found.box.clipped(width, height)
        assert found.box.area > 0.0


def test_where_no_score_is_high_enough_there_is_no_box(test_data: Path, lounge: np.ndarray):
    path = test_data / "models" / "picodet_s_416_coco.onnx"
    assert PicodetDetector(path, OnnxDetectorConfig(score_threshold=1.0)).detect_all(lounge) == []


def outputs(stride: int, row: int, column: int, distances: tuple[int, ...], label: int):
    """What a network says that is sure of one box, as a distance of whole strides to each side."""
    cells = [(416 + one - 1) // one for one in STRIDES]
    scores = [np.zeros((1, n * n, 80), np.float32) for n in cells]
    shares = [np.zeros((1, n * n, 32), np.float32) for n in cells]
    level = STRIDES.index(stride)
    cell = row * cells[level] + column
    scores[level][0, cell, label] = 0.9
    for side, distance in enumerate(distances):
        shares[level][0, cell, 8 * side + distance] = 50.0
    return [*scores, *shares]


@pytest.mark.parametrize("stride", STRIDES)
def test_distances_are_strides_from_the_middle_of_a_cell(test_data: Path, stride: int):
    detector = PicodetDetector(test_data / "models" / "picodet_s_416_coco.onnx")

    class Sure:
        def run(self, names, inputs):
            return outputs(stride, 3, 2, (1, 2, 3, 2), label=56)

    detector._session = Sure()
    (found,) = detector.detect_all(np.zeros((416, 832, 3), np.uint8))  # stretched to 416 × 416
    x, y = 2.5 * stride, 3.5 * stride
    true = Box(x - stride, y - 2 * stride, x + 3 * stride, y + 2 * stride).clipped(416, 416)
    assert found.label == "chair"
    assert found.score == pytest.approx(0.9)
    box = found.box
    assert (box.x_min / 2, box.y_min, box.x_max / 2, box.y_max) == pytest.approx(
        (true.x_min, true.y_min, true.x_max, true.y_max), abs=1e-3
    )


def test_a_network_gone_mad_gives_no_box_outside_the_image(test_data: Path, lounge: np.ndarray):
    class Mad:
        def run(self, names, inputs):
            rng = np.random.default_rng(0)
            sizes = [(1, n, k) for k in (80, 32) for n in (2704, 676, 169, 49)]
            mad = [rng.normal(0.0, 50.0, size).astype(np.float32) for size in sizes]
            for one in mad:
                one[0, ::7], one[0, ::11] = np.nan, np.inf
            return mad

    detector = PicodetDetector(test_data / "models" / "picodet_s_416_coco.onnx")
    detector._session = Mad()
    for found in detector.detect_all(lounge):
        assert found.box == found.box.clipped(lounge.shape[1], lounge.shape[0])
        assert 0.0 <= found.score <= 1.0


def test_another_network_or_list_of_classes_is_refused(test_data: Path):
    models = test_data / "models"
    with pytest.raises(
        ModelError, match=r"is not a PicoDet with 80 classes.*; begin with yolox:, yolov8: or"
    ):
        PicodetDetector(models / "yolox_nano.onnx")
    with pytest.raises(ModelError, match="2 classes"):
        PicodetDetector(
            models / "picodet_s_416_coco.onnx", OnnxDetectorConfig(classes=("bed", "sofa"))
        )
