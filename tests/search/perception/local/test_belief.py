"""What a score and a form say about a candidate."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from certainty import certain
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.score_weights import MISSED, NEUTRAL
from hypernav.search.memory.goal_area import GoalArea
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.belief import Sighting, weight_of

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


@given(st.floats(-4.0, 4.0), st.floats(0.0, 8.0))
def test_a_form_that_fits_adds_nothing_and_one_that_contradicts_takes_half_away(
    score: float, shift: float
):
    area = certain(GoalArea.from_points(np.zeros((1, 3)), resolution_m=0.05))
    seen = Detection(Box(0.0, 0.0, 1.0, 1.0), 0.5, "bed")
    assert Sighting(seen, area, score, shift).weight == score
    assert Sighting(seen, area, score, -shift).weight == pytest.approx(score - shift / 2.0)
