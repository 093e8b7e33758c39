import pytest

from hypernav.core.errors import GoalError
from hypernav.core.goal import MAX_GOAL_LENGTH, Goal


@pytest.mark.parametrize("text", ["bed", "a" * MAX_GOAL_LENGTH, "canapé d'angle", "椅子", "🛏️"])
def test_what_a_person_may_write_is_a_goal(text):
    assert Goal(text).text == text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (" ", "is empty"),
        ("\u200b", r"'\\u200b' names nothing"),
        ("...", "names nothing"),
        ("a" * (MAX_GOAL_LENGTH + 1), "501 characters"),
        ("bed\n", r"U\+000A"),
        ("\x1b[2J", r"U\+001B"),
        ("bed\x9b", r"U\+009B"),
        ("bed\udcff", "no valid UTF-8"),
    ],
)
def test_what_nobody_could_read_is_refused(text, words):
    with pytest.raises(GoalError, match=words):
        Goal(text)


@pytest.mark.parametrize("text", ["grey sofa", "the grey sofa", "A grey sofa"])
def test_a_thing_is_told_with_its_article(text):
    assert Goal(text).in_sentence == "the grey sofa"


@pytest.mark.parametrize(
    "text",
    [
        "It is a grey sofa located next to the lamp.",
        "the couch is located near the window",
        "There are two chairs",
        "please find the bed",
        "Grey sofa. It has two cushions",
    ],
)
def test_a_sentence_is_told_in_quotation_marks(text):
    assert Goal(f" {text}").in_sentence == f"“{text}”"
