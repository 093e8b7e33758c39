import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict

from hypernav.core.chat import Fault, Question
from hypernav.core.errors import (
    ConfigError,
    InvalidAnswerError,
    RefusalError,
    UnparsableAnswerError,
)
from hypernav.search.models.chat.answer_parsing import LONGEST_ANSWER, parse_answer


class Point(BaseModel):
    model_config = ConfigDict(extra="forbid")

    x: float
    y: float


YES_NO = Question("verify", "Is it there?", allowed=("yes", "no"))
NUMBERS = Question("choose block", "Which?", allowed=("1", "2", "3", "12"))
FORM = Question("point", "Where?", form=Point)
OPEN = Question("other", "What?")


def read(question: Question, text: str):
    return parse_answer(question, text, model="m")


@pytest.mark.parametrize(
    ("question", "text", "value"),
    [
        (YES_NO, "yes", "yes"),
        (YES_NO, " Yes.\n", "yes"),
        (YES_NO, "**No**", "no"),
        (YES_NO, "Yes, there is a sofa.", "yes"),
        (YES_NO, '{"answer": "no"}', "no"),
        (YES_NO, '```json\n{"answer": "yes"}\n```', "yes"),
        (YES_NO, "<think>no no no</think>yes", "yes"),
        (NUMBERS, "12", "12"),
        (NUMBERS, "Block 3.", "3"),
        (NUMBERS, '{"answer": 2}', "2"),
        (NUMBERS, '"1"', "1"),
        (NUMBERS, "[3]", "3"),
        (OPEN, "a long answer", "a long answer"),
    ],
)
def test_reads_what_was_allowed(question: Question, text: str, value: str):
    answer = read(question, text)
    assert (answer.value, answer.fault, answer.text) == (value, None, text)
    assert answer.require() == value


@pytest.mark.parametrize(
    ("question", "text", "fault"),
    [
        (YES_NO, "", Fault.UNPARSABLE),
        (YES_NO, "   ", Fault.UNPARSABLE),
        (YES_NO, "<think>yes", Fault.CUT),
        (YES_NO, "maybe", Fault.INVALID),
        (YES_NO, "yes or no, who knows", Fault.UNPARSABLE),
        (YES_NO, "I'm sorry, I can't help with that.", Fault.REFUSED),
        (NUMBERS, "7", Fault.INVALID),
        (NUMBERS, '{"answer": "42"}', Fault.INVALID),
        (NUMBERS, "1 or 2", Fault.UNPARSABLE),
        (NUMBERS, "True", Fault.INVALID),
        (FORM, "over there", Fault.UNPARSABLE),
        (FORM, '{"x": 1, "y"', Fault.UNPARSABLE),
        (FORM, '{"x": 1}', Fault.INVALID),
        (FORM, '{"x": "left", "y": 2}', Fault.INVALID),
        (FORM, '{"x": 1, "y": 2, "z": 3}', Fault.INVALID),
        (FORM, "I cannot answer this.", Fault.REFUSED),
    ],
)
def test_names_the_fault_of_anything_else(question: Question, text: str, fault: Fault):
    answer = read(question, text)
    assert (answer.value, answer.fault) == (None, fault)
    assert answer.detail


def test_reads_a_form_amid_prose():
    answer = read(FORM, 'Sure! ```json\n{"x": 1.5, "y": 2}\n``` Anything else?')
    assert answer.value == Point(x=1.5, y=2.0)


def test_a_refusal_by_the_server_is_one_whatever_the_text():
    assert parse_answer(YES_NO, "yes", model="m", refused=True).fault is Fault.REFUSED


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("I'm sorry, no comment, yes or no", RefusalError),
        ("well", InvalidAnswerError),
        ("a b c", UnparsableAnswerError),
    ],
)
def test_require_raises_the_error_of_the_fault(text: str, error: type[Exception]):
    with pytest.raises(error, match=r"^m: "):
        read(YES_NO, text).require()


@given(st.text(max_size=200), st.sampled_from([YES_NO, NUMBERS, FORM, OPEN]))
def test_any_text_gives_a_value_or_a_fault(text: str, question: Question):
    answer = read(question, text)
    assert (answer.value is None) == (answer.fault is not None)
    if question.allowed:
        assert answer.value is None or answer.value in question.allowed


@given(st.sampled_from(NUMBERS.allowed), st.sampled_from(["{}", " {} ", "{}.", '"{}"', "**{}**"]))
def test_an_allowed_answer_is_read_in_any_dress(label: str, dress: str):
    assert read(NUMBERS, dress.format(label)).value == label


@pytest.mark.parametrize(
    "wrong",
    [
        {"allowed": ("a", "a")},
        {"allowed": ("a", " ")},
        {"allowed": ("a",), "form": Point},
        {"max_tokens": 0},
    ],
)
def test_a_question_that_cannot_be_answered_is_refused(wrong: dict):
    with pytest.raises(ConfigError):
        Question("other", "What?", **wrong)


def test_the_text_can_always_be_written_to_a_file():
    answer = read(OPEN, "a\ud83d b \ud83d\ude00")
    assert answer.text == "a\ufffd b \U0001f600"


def test_an_endless_answer_is_cut_and_of_no_use():
    answer = parse_answer(OPEN, "a bed " * 1_000_000, model="m")
    assert len(answer.text) == LONGEST_ANSWER
    assert answer.fault is Fault.UNPARSABLE
    again = parse_answer(OPEN, answer.text, model="m")  # as a recording replays it
    assert (again.text, again.fault, again.detail) == (answer.text, answer.fault, answer.detail)
