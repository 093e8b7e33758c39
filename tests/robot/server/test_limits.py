"""A server knows how long its robots wait, whatever chat models take."""

import pytest

from hypernav.core.trace import Exchange, Mode, StepTrace
from hypernav.robot.server.limits import Pace


def asked(by_model_s: float, own_s: float) -> StepTrace:
    """A decision for which a model and a component of this program were asked."""
    own = Exchange(kind="verify", asked="x", question="?", answer="yes", seconds=own_s)
    exchanges = [own.model_copy(update={"by_model": True, "seconds": by_model_s}), own]
    return StepTrace(
        step=0, pose=(0.0, 0.0, 0.0), action=None, mode=Mode.EXPLORE, exchanges=exchanges
    )


def test_it_is_the_median_of_the_last_seconds_without_the_time_of_models():
    now_s = [0.0]
    pace = Pace(lambda: now_s[0])
    for _ in range(30):
        now_s[0] += 0.1
        pace.note(None, now_s[0] - 9.0)
    assert pace.median_s() == pytest.approx(9.0)
    now_s[0] += 9.0
    for number in range(20):
        now_s[0] += 0.1
        pace.note(asked(by_model_s=30.0, own_s=0.2), now_s[0] - 30.0 - 0.01 * number)
    assert pace.median_s() == pytest.approx(0.095)


def test_a_slow_ranking_of_remembered_images_is_no_slowness_of_the_server():
    pace = Pace(lambda: 40.0)
    ranked = Exchange(kind="rank images", asked="x", question="?", answer="1", seconds=30.0)
    for _ in range(20):
        pace.note(asked(0.0, 0.0).model_copy(update={"exchanges": [ranked]}), 9.9)
    assert pace.median_s() == pytest.approx(0.1)


def test_a_few_answers_say_nothing():
    now_s = [0.0]
    pace = Pace(lambda: now_s[0])
    for _ in range(19):
        pace.note(None, -5.0)
    assert pace.median_s() is None
    pace.note(None, -5.0)
    assert pace.median_s() == 5.0
    now_s[0] = 11.0
    assert pace.median_s() is None
