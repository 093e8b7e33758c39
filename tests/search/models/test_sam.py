from pathlib import Path

import numpy as np
import pytest
from onnx_bytes import identity_model

from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.search.models import sam
from hypernav.search.models.config import OnnxSamConfig
from hypernav.search.models.sam import OnnxSamSegmenter

pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'")

DECODER_INPUTS = (
    "image_embeddings",
    "point_coords",
    "point_labels",
    "mask_input",
    "has_mask_input",
    "orig_im_size",
)


class Port:
    def __init__(self, name: str, shape: list) -> None:
        self.name = name
        self.shape = shape


class Encoder:
    """Stands for an exported image encoder; remembers what it was given."""

    def __init__(self, shape: list) -> None:
        self.shape = shape
        self.blobs: list[np.ndarray] = []

    def get_inputs(self) -> list[Port]:
        return [Port("input_image", self.shape)]

    def run(self, names: object, inputs: dict) -> list[np.ndarray]:
        self.blobs.append(inputs["input_image"])
        return [np.full((1, 256, 64, 64), 7.0, np.float32)]


class Decoder:
    """Answers as the authors' export does: the best of its masks fills the box it was given."""

    def __init__(self) -> None:
        self.inputs: dict[str, np.ndarray] = {}

    def get_inputs(self) -> list[Port]:
        return [Port(name, []) for name in DECODER_INPUTS]

    def get_outputs(self) -> list[Port]:
        return [Port(name, []) for name in ("masks", "iou_predictions", "low_res_masks")]

    def run(self, names: list[str], inputs: dict[str, np.ndarray]) -> list[np.ndarray]:
        assert names == ["masks", "iou_predictions"]
        self.inputs = inputs
        height, width = (int(side) for side in inputs["orig_im_size"])
        corners = inputs["point_coords"][0] * max(height, width) / 1024.0
        (x_min, y_min), (x_max, y_max) = np.rint(corners).astype(int)
        masks = np.full((1, 2, height, width), -5.0, np.float32)
        masks[0, 1, y_min : y_max + 3, x_min : x_max + 3] = 5.0
        return [masks, np.array([[0.2, 0.9]], np.float32)]


def observe(height: int = 480, width: int = 640) -> Observation:
    rgb = np.full((height, width, 3), 128, np.uint8)
    rgb[:, :, 0] = 255
    depth = np.ones((height, width), np.float32)
    camera = PinholeCamera.from_hfov(width, height, 79.0)
    return Observation(rgb, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


@pytest.fixture
def networks(monkeypatch: pytest.MonkeyPatch) -> tuple[Encoder, Decoder]:
    pair = Encoder([1, 3, 1024, 1024]), Decoder()
    by_name = {"encoder.onnx": pair[0], "decoder.onnx": pair[1]}
    monkeypatch.setattr(sam, "open_session", lambda path, threads: by_name[path.name])
    return pair


def segmenter(**settings: object) -> OnnxSamSegmenter:
    return OnnxSamSegmenter("encoder.onnx", "decoder.onnx", OnnxSamConfig.model_validate(settings))


def test_the_best_mask_inside_the_box(networks: tuple[Encoder, Decoder]):
    box = Box(100.0, 50.0, 300.0, 200.0)
    mask = segmenter().segment(observe(), box)
    expected = np.zeros((480, 640), bool)
    expected[50:200, 100:300] = True
    np.testing.assert_array_equal(mask, expected)


def test_the_decoder_gets_what_its_authors_define(networks: tuple[Encoder, Decoder]):
    segmenter().segment(observe(), Box(100.0, 50.0, 300.0, 200.0))
    inputs = networks[1].inputs
    np.testing.assert_allclose(inputs["point_coords"], [[[160.0, 80.0], [480.0, 320.0]]])
    np.testing.assert_array_equal(inputs["point_labels"], [[2.0, 3.0]])
    assert inputs["mask_input"].shape == (1, 1, 256, 256)
    np.testing.assert_array_equal(inputs["has_mask_input"], [0.0])
    np.testing.assert_array_equal(inputs["orig_im_size"], [480.0, 640.0])
    assert all(value.dtype == np.float32 for value in inputs.values())


def test_a_bare_encoder_gets_a_normalised_and_padded_image(networks: tuple[Encoder, Decoder]):
    segmenter().segment(observe(), Box(0.0, 0.0, 9.0, 9.0))
    (blob,) = networks[0].blobs
    assert blob.shape == (1, 3, 1024, 1024)
    np.testing.assert_allclose(blob[0, 0, :768], (255 - 123.675) / 58.395, rtol=1e-5)
    np.testing.assert_allclose(blob[0, 1, :768], (128 - 116.28) / 57.12, rtol=1e-5)
    assert not blob[0, :, 768:].any()


def test_an_encoder_that_normalises_itself_gets_the_plain_image(
    networks: tuple[Encoder, Decoder],
):
    networks[0].shape = ["height", "width", 3]
    segmenter().segment(observe(), Box(0.0, 0.0, 9.0, 9.0))
    (blob,) = networks[0].blobs
    assert blob.shape == (768, 1024, 3)
    np.testing.assert_array_equal(blob[0, 0], [255.0, 128.0, 128.0])


def test_one_image_is_encoded_once_for_all_its_boxes(networks: tuple[Encoder, Decoder]):
    cutter, view = segmenter(), observe()
    cutter.segment(view, Box(0.0, 0.0, 9.0, 9.0))
    cutter.segment(view, Box(50.0, 0.0, 90.0, 9.0))
    assert len(networks[0].blobs) == 1
    cutter.segment(observe(), Box(0.0, 0.0, 9.0, 9.0))
    assert len(networks[0].blobs) == 2


def test_a_point_is_given_with_a_point_that_pads(networks: tuple[Encoder, Decoder]):
    segmenter().segment_point(observe(), 100.0, 50.0)
    inputs = networks[1].inputs
    np.testing.assert_allclose(inputs["point_coords"], [[[160.0, 80.0], [0.0, 0.0]]])
    np.testing.assert_array_equal(inputs["point_labels"], [[1.0, -1.0]])


def test_a_box_outside_the_image_holds_nothing(networks: tuple[Encoder, Decoder]):
    assert not segmenter().segment(observe(), Box(700.0, 0.0, 900.0, 9.0)).any()
    assert networks[0].blobs == []


def test_files_that_are_no_sam(tmp_path: Path):
    path = tmp_path / "other.onnx"
    path.write_bytes(identity_model((1, 10)))
    with pytest.raises(ModelError, match="not a SAM encoder"):
        OnnxSamSegmenter(path, path)
    path.write_bytes(identity_model((1, 3, 1024, 1024)))
    with pytest.raises(ModelError, match="not a SAM decoder"):
        OnnxSamSegmenter(path, path)
    with pytest.raises(ModelError, match="not found"):
        OnnxSamSegmenter(tmp_path / "none.onnx", path)
