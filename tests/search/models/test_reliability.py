"""What is known of a network belongs to its file."""

import shutil
from itertools import pairwise
from pathlib import Path

import pytest

from hypernav.core.errors import ModelError
from hypernav.core.score_weights import MISSED, NEUTRAL
from hypernav.search.models.reliability import (
    Reliability,
    file_beside,
    known,
    reliability_of,
    sha256_of,
    write_reliability,
)
from hypernav.search.models.yolox import YoloxDetector


def measured(network: Path, **changes: object) -> Reliability:
    content = {"sha256": sha256_of(network), "boxes": [[0.2, -1.0], [0.9, 2.0]], "missed": -0.5}
    return Reliability.model_validate(content | changes)


@pytest.mark.parametrize("curve", [NEUTRAL, *(one.boxes for one in known().values())])
def test_a_higher_score_never_speaks_less_for_the_goal(curve):
    assert all(a < b and x <= y for (a, x), (b, y) in pairwise(curve))
    assert curve[0][1] < 0.0 < curve[-1][1]


def test_a_known_network_is_known_by_its_content_whatever_its_name(test_data, tmp_path):
    pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'")
    shutil.copyfile(test_data / "models" / "yolox_nano.onnx", tmp_path / "mine.onnx")
    detector = YoloxDetector(tmp_path / "mine.onnx")
    assert detector.score_weights == known()["yolox-nano"].boxes
    assert detector.missed_weight == MISSED
    own = measured(tmp_path / "mine.onnx")  # what was measured here comes first
    assert write_reliability(tmp_path / "mine.onnx", own) == file_beside(tmp_path / "mine.onnx")
    again = YoloxDetector(tmp_path / "mine.onnx")
    assert (again.score_weights, again.missed_weight) == (own.boxes, -0.5)


def test_of_another_network_nothing_is_known(tmp_path: Path):
    network = tmp_path / "net.onnx"
    network.write_bytes(b"some weights")
    assert reliability_of(network) is None
    write_reliability(network, measured(network))
    assert reliability_of(network) == measured(network)


def test_what_was_measured_of_other_weights_or_is_damaged_is_refused(tmp_path: Path):
    network = tmp_path / "net.onnx"
    network.write_bytes(b"some weights")
    write_reliability(network, measured(network))
    network.write_bytes(b"trained on")
    with pytest.raises(ModelError, match=r"measured of another net\.onnx; measure it again"):
        reliability_of(network)
    file_beside(network).write_text('{"boxes": [[0.9, 1], [0.1, 2]]}')
    with pytest.raises(ModelError, match=r"reliability\.json cannot be used"):
        reliability_of(network)
