from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from hypernav.core.errors import ModelError
from hypernav.search.models import onnx_detector
from hypernav.search.models.onnx_detector import OnnxDetectorConfig
from hypernav.search.models.yolov8 import Yolov8Detector

CLASSES = ("bed", "sofa", "chair")
CELLS = 40 * 40 + 20 * 20 + 10 * 10


class Network:
    """An export for 320 × 320 pixels whose cells all say the same, or one of another form."""

    def __init__(self, *, said: dict[int, tuple[float, ...]] | None = None, rows: int = 7):
        self.output = np.zeros((1, rows, CELLS), np.float32)
        for cell, values in (said or {}).items():
            self.output[0, :, cell] = values
        self.inputs: list[np.ndarray] = []

    def get_inputs(self):
        return [SimpleNamespace(name="images", shape=[1, 3, 320, 320], type="tensor(float)")]

    def run(self, names, inputs):
        self.inputs.append(inputs["images"])
        return [self.output]


@pytest.fixture
def detector(monkeypatch, tmp_path: Path):
    path = tmp_path / "yolov8n.onnx"
    path.write_bytes(b"a network")

    def opened(network: Network) -> Yolov8Detector:
        monkeypatch.setattr(onnx_detector, "open_session", lambda path, threads: network)
        return Yolov8Detector(path, OnnxDetectorConfig(classes=CLASSES))

    return opened


def test_a_box_lies_around_its_middle_in_pixels_of_the_image(detector):
    network = Network(said={7: (160.0, 100.0, 80.0, 40.0, 0.1, 0.9, 0.2)})
    (found,) = detector(network).detect_all(np.zeros((480, 640, 3), np.uint8))  # half as large
    assert found.label == "sofa"
    assert found.score == pytest.approx(0.9)
    box = found.box
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx((240, 160, 400, 240))


def test_the_image_is_rgb_from_0_to_1_in_the_corner_and_grey_beside_it(detector):
    network = Network()
    image = np.zeros((240, 320, 3), np.uint8)
    image[..., 0] = 255
    detector(network).detect_all(image)
    (given,) = network.inputs[-1]
    assert given[0, :240].min() == given[0].max() == 1.0
    assert given[1:, :240].max() == 0.0
    assert given[:, 240:] == pytest.approx(114 / 255)


def test_two_boxes_of_one_thing_are_one(detector):
    one, other = (160.0, 100.0, 80.0, 40.0, 0, 0.9, 0), (161.0, 100.0, 80.0, 40.0, 0, 0.8, 0)
    network = Network(said={7: one, 8: other})
    (found,) = detector(network).detect_all(np.zeros((480, 640, 3), np.uint8))
    assert found.score == pytest.approx(0.9)


def test_an_export_with_suppression_or_other_classes_is_refused(detector):
    with pytest.raises(ModelError, match=r"is not a YOLOv8 with 3 classes.*without suppression"):
        detector(Network(rows=6))
