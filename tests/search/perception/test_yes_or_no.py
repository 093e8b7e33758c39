"""Questions that a chat model answers with yes or no."""

import numpy as np
import pytest

from chat_models import Parrot
from hypernav.core.chat import Answer
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.exchanges import YesNoAsker, probability_of_yes, yes_no_question

QUESTION = yes_no_question("verify", "Is it here?", np.zeros((4, 4, 3), np.uint8))


@pytest.mark.parametrize(("says", "yes"), [("Yes.", 1.0), ("no", 0.0), ("perhaps", None)])
def test_without_probabilities_yes_is_one_and_no_is_nothing(says, yes):
    assert YesNoAsker(Parrot(says), ExchangeLog()).ask(QUESTION) == yes


def test_a_model_that_tells_probabilities_is_taken_at_them():
    torn = Answer("yes", "torn", value="yes", probabilities={"yes": 0.6, "no": 0.4})
    assert probability_of_yes(torn) == 0.6


def test_what_is_neither_is_counted_once_and_told_with_what_it_comes_to():
    log = ExchangeLog()
    asker = YesNoAsker(Parrot("perhaps", "no", "who knows"), log)
    answers = [asker.ask(QUESTION, "taken for no") for _ in range(3)]
    assert answers == [None, 0.0, None]
    remarks = [one.remarks for one in log.drain()]
    assert remarks[1] == []
    assert all(told[0].endswith("; taken for no") for told in remarks[::2])
    assert [asker.take_report()["unsure_answers"] for _ in range(2)] == [2, 0]
