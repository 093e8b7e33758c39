from types import SimpleNamespace

import pytest

from hypernav.app.build.agents import build_search
from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.stand_ins import (
    beside_published,
    labels_warning,
    segmenter_words,
    unmeasured,
)
from hypernav.app.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import DepthCutConfig, LocalConfig
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector

YOLOX = "yolox:net.onnx"
MOBILE_SAM = "onnx-sam:mobile_sam_encoder.onnx,mobile_sam_decoder.onnx"


def words_of(published="MobileSAM", **specs):
    chosen = choose_components(ComponentSpecs(**specs))
    return segmenter_words(chosen, published, detector_words="ground truth", model="")


def test_what_segments_instead_is_named_with_the_remedy():
    told = words_of(detector=YOLOX)
    assert told.words == "depth cut, in place of MobileSAM"
    assert "depth cut, in place of MobileSAM" in told.warning
    assert "--segmenter onnx-sam:" in told.warning


def test_masks_of_the_ground_truth_stand_in_as_well_and_nothing_else_could():
    told = words_of()
    assert told.words == "masks of ground truth, in place of MobileSAM"
    assert "--segmenter" not in told.warning


@pytest.mark.parametrize(
    ("specs", "is_said"),
    [
        ({}, True),
        ({"agent": "frontier"}, True),
        ({"detector": YOLOX}, False),
        ({"vlm": "openai:http://localhost:8000/v1"}, False),
    ],
)
def test_true_labels_are_named_before_a_search(specs, is_said):
    said = labels_warning(choose_components(ComponentSpecs(**specs)))
    assert ("true labels" in said) == is_said


@pytest.mark.parametrize(
    ("published", "specs", "words"),
    [
        ("MobileSAM", {"detector": YOLOX, "segmenter": MOBILE_SAM}, "mobile_sam_encoder.onnx"),
        ("MobileSAM", {"detector": YOLOX, "segmenter": "sam:org/Mobile-SAM"}, "Mobile-SAM"),
        ("", {"detector": YOLOX}, "depth cut"),
        ("", {}, "none"),
    ],
)
def test_nothing_stands_in_for_the_real_one_or_where_none_is_asked_for(published, specs, words):
    told = words_of(published, **specs)
    assert words in told.words
    assert "in place of" not in told.words
    assert told.warning == ""


@pytest.mark.parametrize(
    "name",
    ["QwenVL-7B", "Qwen/Qwen2.5-VL-7B-Instruct", "qwen2-vl:7b", "Qwen2_5-VL-7B-AWQ (replayed)"],
)
def test_the_papers_model_goes_by_family_and_size(name):
    chosen = choose_components(ComponentSpecs(vlm=f"openai:http://localhost:1/v1#{name}"))
    assert beside_published(chosen, "QwenVL-7B", name) == name
    assert beside_published(chosen, "", "") == "none"


@pytest.mark.parametrize(
    "name", ["", "the model at http://localhost:1/v1", "Qwen2.5-VL-72B", "Qwen2.5-7B", "llava-7b"]
)
def test_another_model_or_none_is_named_beside_the_papers(name):
    chosen = choose_components(ComponentSpecs())
    said = beside_published(chosen, "QwenVL-7B", name)
    assert said == f"{name or 'none'}; the published one is QwenVL-7B"


def test_no_segmenter_at_all_is_no_choice():
    for vlm in (None, "openai:http://localhost:8000/v1"):
        with pytest.raises(ConfigError, match="unknown segmenter 'none'; use depth-cut"):
            choose_components(ComponentSpecs(vlm=vlm, segmenter="none"))


def test_a_search_around_own_components_cuts_as_configured(monkeypatch):
    made: list[DepthCutConfig] = []

    def noting(config: DepthCutConfig) -> DepthCutSegmenter:
        made.append(config)
        return DepthCutSegmenter(config)

    monkeypatch.setattr("hypernav.app.build.agents.DepthCutSegmenter", noting)
    config = preset("default").model_copy(update={"depth_cut": DepthCutConfig(depth_gap_m=0.3)})
    build_search(config, GroundTruthDetector(), ExchangeLog())
    assert [one.depth_gap_m for one in made] == [0.3]


def test_a_detector_whose_scores_nobody_measured_says_so_with_the_remedy():
    known, local = SimpleNamespace(score_weights=((0.0, -1.0), (1.0, 1.0))), LocalConfig()
    chosen = choose_components(ComponentSpecs(detector=YOLOX))
    told = unmeasured(chosen, SimpleNamespace(), local)
    assert "nobody measured how far the scores of YOLOX (net.onnx) can be trusted" in told
    assert f"hypernav exam --detector {YOLOX}" in told
    assert unmeasured(chosen, known, local) == ""
    assert unmeasured(chosen, SimpleNamespace(), LocalConfig(target="latest")) == ""
    weighed = LocalConfig(score_weights=((0.0, -1.0), (1.0, 1.0)))  # by --exam
    assert unmeasured(chosen, SimpleNamespace(), weighed) == ""
    both = choose_components(ComponentSpecs(detector=f"{YOLOX}+picodet:pico.onnx"))
    told = unmeasured(both, SimpleNamespace(parts=(known, SimpleNamespace())), local)
    assert "hypernav exam --detector picodet:pico.onnx" in told
