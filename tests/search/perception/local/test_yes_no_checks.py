from typing import Literal

import numpy as np
import pytest

from chat_models import Parrot
from hypernav.app.build.presets import preset
from hypernav.core.chat import Answer, Question
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import PresenceConfig
from hypernav.search.perception.local.yes_no_checks import VlmPresenceCheck, presence_question

BED = Goal("bed")
VIEW = Observation(
    np.zeros((48, 64, 3), np.uint8),
    np.ones((48, 64), np.float32),
    PinholeCamera.from_hfov(64, 48, 79.0),
    Transform.identity(),
    Pose2(0.0, 0.0, 0.0),
)


@pytest.mark.parametrize(("text", "present"), [("yes", True), ("No, it is a sofa.", False)])
def test_yes_and_no(text: str, present: bool):
    parrot, log = Parrot(text), ExchangeLog()
    assert VlmPresenceCheck(parrot, log).is_present(VIEW, BED) is present
    assert parrot.asked[0].allowed == ("yes", "no")
    assert parrot.asked[0].images[0] is VIEW.rgb
    (exchange,) = log.drain()
    assert (exchange.kind, exchange.answer, exchange.remarks) == ("verify", text, [])


@pytest.mark.parametrize("unsure", ["yes", "no"])
def test_neither_counts_as_configured_and_is_told(unsure: Literal["yes", "no"]):
    log = ExchangeLog()
    check = VlmPresenceCheck(Parrot("perhaps"), log, PresenceConfig(unsure=unsure))
    assert check.is_present(VIEW, BED) is (unsure == "yes")
    assert check.take_report() == {"unsure_presence_checks": 1}
    assert check.take_report() == {"unsure_presence_checks": 0}
    assert f"taken for {unsure}" in log.drain()[0].remarks[0]


@pytest.mark.parametrize(
    ("goal", "question"),
    [
        ("bed", "Is there a bed in this picture?"),
        ("umbrella", "Is there an umbrella in this picture?"),
        ("the chair in the office", "Is there a chair in the office in this picture?"),
        ("unicorn", "Is there a unicorn in this picture?"),
        ("L-shaped sofa", "Is there an L-shaped sofa in this picture?"),
        ("stairs", "Is there stairs in this picture?"),
        ("glass", "Is there a glass in this picture?"),
        ("the black chair", "Is there a black chair in this picture?"),
    ],
)
def test_the_goal_has_the_right_article_in_either_preset(goal: str, question: str):
    for name in ("paper", "default"):
        asked = presence_question(preset(name).presence, VIEW.rgb, Goal(goal))
        assert asked.text.startswith(question)


def test_probabilities_decide_where_there_are_some():
    class Torn(Parrot):
        def ask(self, question: Question) -> Answer:
            return Answer("yes", "m", value="yes", probabilities={"yes": 0.6, "no": 0.4})

    check = VlmPresenceCheck(Torn("yes"), ExchangeLog())
    assert check.is_present(VIEW, BED)
    strict = VlmPresenceCheck(Torn("yes"), ExchangeLog(), PresenceConfig(min_probability=0.7))
    assert not strict.is_present(VIEW, BED)


def test_an_outage_is_neither():
    check = VlmPresenceCheck(Parrot(ModelUnavailableError("gone")), ExchangeLog())
    with pytest.raises(ModelUnavailableError):
        check.is_present(VIEW, BED)


@pytest.mark.parametrize(("text", "present"), [("yes", True), ("no", False)])
def test_an_exam_brings_down_who_says_yes_too_often(text: str, present: bool):
    def says(*calibration: tuple[float, float]) -> bool:
        config = PresenceConfig(calibration=calibration)
        return VlmPresenceCheck(Parrot(text), ExchangeLog(), config).is_present(VIEW, BED)

    assert says((0.0, 0.1), (1.0, 0.9)) is present
    assert says((0.0, 0.1), (1.0, 0.4)) is False
