"""What a score says about a candidate."""

from types import SimpleNamespace

from hypernav.core.score_weights import MISSED, NEUTRAL
from hypernav.search.perception.local.belief import weight_of
from hypernav.search.perception.local.config import LocalConfig

CURVE = ((0.0, -1.0), (1.0, 2.0))


def test_a_detector_brings_what_its_scores_are_worth():
    local = LocalConfig().for_detector(SimpleNamespace(score_weights=CURVE, missed_weight=-0.3))
    assert weight_of(0.5, local) == 0.5
    assert local.missed_weight == -0.3


def test_a_detector_of_which_nothing_is_known_begins_neutral():
    local = LocalConfig().for_detector(object())
    assert local.score_weights == NEUTRAL
    assert local.missed_weight == MISSED


def test_what_is_configured_comes_first():
    own = LocalConfig(score_weights=((0.0, 0.0), (1.0, 1.0)), missed_weight=-2.0)
    assert own.for_detector(SimpleNamespace(score_weights=CURVE, missed_weight=-0.3)) == own
