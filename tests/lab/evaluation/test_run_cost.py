"""What a run costs, by an exam and by its first episodes."""

import pytest

from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.exam_file import Calibration, Cost, ExamFile, Predicted
from hypernav.app.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.lab.evaluation.run_cost import (
    FEWER_LOOKS,
    SWITCHES,
    cost_by_exam,
    cost_lines,
    kinds_asked,
    pace_words,
)

DEFAULT = preset("default")
MODEL = ComponentSpecs(vlm="openai:http://localhost:8000/v1#qwen")
KINDS = kinds_asked(choose_components(MODEL))
EXAM = ExamFile(
    format="hypernav-exam",
    version=2,
    model="qwen",
    who={},
    worth=Calibration(),
    predictions=(
        Predicted(
            preset="default",
            steps=100.0,
            asked={"ground": 100.0, "crop": 20.0, "choose block": 4.0, "verify": 1.0},
            asked_without={
                "block": {"ground": 150.0, "crop": 30.0, "verify": 1.0},
                "presence": {"ground": 70.0, "crop": 10.0, "choose block": 3.0},
            },
            seconds=2.0,
        ),
    ),
    costs={
        "ground": Cost(calls=1.0, seconds=0.5, tokens_in=400.0, tokens_out=10.0),
        "crop": Cost(calls=1.0, seconds=0.1, tokens_in=100.0, tokens_out=1.0),
        "choose block": Cost(calls=1.5, seconds=3.0, tokens_in=1000.0, tokens_out=100.0),
        "verify": Cost(calls=1.0, seconds=0.2, tokens_in=400.0, tokens_out=1.0),
    },
)


def test_a_search_costs_the_sum_of_its_questions():
    cost = cost_by_exam(EXAM, "default", DEFAULT, KINDS)
    assert sum(cost.calls.values()) == pytest.approx(100.0 + 20.0 + 6.0 + 1.0)
    assert cost.seconds == pytest.approx(2.0 + 50.0 + 2.0 + 12.0 + 0.2)
    assert cost.tokens_in == pytest.approx(40_000 + 2000 + 4000 + 400)


def test_switches_save_what_they_say():
    whole = cost_by_exam(EXAM, "default", DEFAULT, KINDS)
    total = sum(whole.calls.values())
    for changes, switch in (
        ({"grounding": {"score_crops": 0}}, SWITCHES["crop"]),
        ({"search": {"looks": "at-destinations"}}, FEWER_LOOKS),
    ):
        less = cost_by_exam(EXAM, "default", DEFAULT.with_(**changes), KINDS)
        saved = 1.0 - sum(less.calls.values()) / total
        assert whole.saved_by()[switch] == pytest.approx(saved)
        assert saved > 0.1


def test_only_what_the_model_is_asked_counts():
    by_rule = choose_components(ComponentSpecs(vlm=MODEL.vlm, reasoner="geometric"), presence=False)
    assert kinds_asked(by_rule) == ["ground", "crop"]
    assert set(cost_by_exam(EXAM, "default", DEFAULT, kinds_asked(by_rule)).calls) == {
        "ground",
        "crop",
    }
    nobody = cost_by_exam(
        EXAM, "default", DEFAULT, kinds_asked(choose_components(ComponentSpecs()))
    )
    assert not nobody.calls
    assert cost_lines(nobody, 10, 1, DEFAULT)[-1] == "no model is asked"


@pytest.mark.parametrize(
    ("left_out", "ground"), [((), 100.0), (("choose block",), 150.0), (("verify",), 70.0)]
)
def test_searches_that_leave_a_question_out_are_those_that_count(left_out, ground):
    kinds = [kind for kind in KINDS if kind not in left_out]
    cost = cost_by_exam(EXAM, "default", DEFAULT, kinds)
    assert cost.calls["ground"] == ground
    old = EXAM.predictions[0].model_copy(update={"asked_without": {}})
    before = cost_by_exam(
        EXAM.model_copy(update={"predictions": (old,)}), "default", DEFAULT, kinds
    )
    assert before.calls["ground"] == 100.0


def test_money_is_told_where_there_is_a_price():
    priced = DEFAULT.with_(price={"in_per_million": 1.0, "out_per_million": 10.0})
    cost = cost_by_exam(EXAM, "default", priced, KINDS)
    said = cost_lines(cost, 1000, 2, priced)
    spent = 1000 * (cost.tokens_in * 1.0 + cost.tokens_out * 10.0) / 1e6
    assert f"{spent:.4g} in money" in said
    assert f"about {1000 * cost.seconds / 2 / 3600:.1f} h with 2 at a time" in said[0]


def test_an_exam_without_searches_says_how_to_get_them():
    with pytest.raises(ConfigError, match="--predict"):
        cost_by_exam(EXAM.model_copy(update={"predictions": ()}), "default", DEFAULT, KINDS)


@pytest.mark.parametrize(
    ("kinds", "changes", "words"),
    [
        (("ground", "crop", "choose block", "verify"), {}, "about 53 questions takes 9 min"),
        (("ground", "crop", "choose block", "verify"), {"crops": 0}, "about 33 questions"),
        (("choose block", "verify"), {}, "about 1 questions takes 14 s"),
        ((), {}, "an answer takes 10 s"),
    ],
)
def test_one_answer_tells_how_long_a_search_takes(
    kinds: tuple[str, ...], changes: dict[str, int], words: str
):
    config = preset("default")
    crops = changes.get("crops", config.grounding.score_crops)
    grounding = config.grounding.model_copy(update={"score_crops": crops})
    said = pace_words(10.0, config.model_copy(update={"grounding": grounding}), kinds)
    assert said.startswith("an answer takes 10 s")
    assert words in said
