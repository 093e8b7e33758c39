"""Marks of answers that may name several things."""

import pytest
from pydantic import ValidationError

from exam_answers import TRUE_BOX, boxed
from hypernav.core.goal import Goal
from hypernav.core.trace import Exchange
from hypernav.lab.exam.marking import Given, marked
from hypernav.lab.exam.questions import Answered, ExamQuestion
from memory_folders import view


def told(right: set[str], said: str, *remarks: str) -> Answered:
    """The marked answer to the question in which of six images a bed is."""
    frames = (view(0.0, 0.0, 0.0),) * 6
    name = "houses:1/0/images/shown/bed/0"
    question = ExamQuestion(
        name, "images", "shown", "houses:1", Goal("bed"), frames, right=frozenset(right)
    )
    asked = Exchange(
        kind="choose images",
        asked="m",
        by_model=True,
        question="?",
        answer=said,
        remarks=[*remarks],
    )
    return marked(question, Given(said), [asked])


@pytest.mark.parametrize(
    ("right", "said", "score"),
    [
        ({"2", "5"}, "2, 5", 1.0),
        ({"2", "5"}, "5", 1.0),
        ({"2", "5"}, "2, 3", 0.0),
        ({"2", "5"}, "none", 0.0),
        ({"none"}, "none", 1.0),
        ({"none"}, "1", 0.0),
    ],
)
def test_an_answer_names_some_images_of_the_goal_and_no_other(
    right: set[str], said: str, score: float
):
    answered = told(right, said)
    assert answered.score == score
    assert answered.chance == pytest.approx(len(right) / 7)  # one of six, or none


def test_an_answer_that_names_no_image_is_unusable():
    answered = told({"none"}, "none", "it names no image")
    assert (answered.score, answered.chosen) == (0.0, None)
    assert answered.unusable == "it names no image"


@pytest.mark.parametrize(
    "damage",
    [
        {"image_size": (0, 0)},
        {"true_boxes": [(30.0, 20.0, 20.0, 80.0)]},
        {"true_boxes": [(20.0, 20.0, 1e308, 80.0)]},
        {"things": []},
        {"conditions": {"distance_m": 0.0}},
    ],
)
def test_a_line_from_which_nothing_can_be_predicted_is_refused(damage):
    line = boxed("near", TRUE_BOX).model_dump()
    with pytest.raises(ValidationError, match=r"image|distance"):
        Answered.model_validate(line | damage)
