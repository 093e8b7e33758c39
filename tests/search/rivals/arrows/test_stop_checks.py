"""The question whether the robot is at the goal."""

import numpy as np
import pytest

from chat_models import Parrot
from hypernav.core.errors import LabelsMissingError
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.rivals.arrows.prompted import ChatStopCheck, TruthStopCheck
from images import thing_before_wall

BED = Goal("the bed")


@pytest.mark.parametrize(
    ("says", "here", "unsure"), [("yes", True, 0), ("No.", False, 0), ("perhaps", False, 1)]
)
def test_a_model_is_asked_with_the_plain_image(says, here, unsure):
    chat, log = Parrot(says), ExchangeLog()
    check, seen = ChatStopCheck(chat, log), thing_before_wall()
    assert check.is_here(seen, BED) is here
    assert "looks for a bed" in chat.asked[0].text
    np.testing.assert_array_equal(chat.asked[0].images[0], seen.rgb)
    assert [one.kind for one in log.drain()] == ["stop"]
    assert check.take_report() == {"unsure_stop_checks": unsure}
    assert check.take_report() == {"unsure_stop_checks": 0}


@pytest.mark.parametrize(("thing_m", "here"), [(0.8, True), (1.6, False)])
def test_the_stand_in_says_yes_near_the_goal(thing_m, here):
    check = TruthStopCheck(ExchangeLog())
    assert check.is_here(thing_before_wall(thing_m=thing_m), BED) is here


def test_the_stand_in_says_no_to_another_thing_however_near():
    assert not TruthStopCheck(ExchangeLog()).is_here(thing_before_wall(thing_m=0.8), Goal("sofa"))


def test_the_stand_in_needs_labels():
    with pytest.raises(LabelsMissingError):
        TruthStopCheck(ExchangeLog()).is_here(thing_before_wall(with_truth=False), BED)
