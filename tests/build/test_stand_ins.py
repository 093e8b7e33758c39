import pytest

from hypernav.build.choosing import choose_components
from hypernav.build.component_specs import ComponentSpecs
from hypernav.build.stand_ins import segmenter_words

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
