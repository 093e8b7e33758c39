import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.chat import Question, Usage
from hypernav.core.errors import ChatTransportError
from hypernav.search.models.chat.message_parts import (
    finite_number,
    read_content,
    read_reasoning,
    read_usage,
    thinking_tokens,
)
from hypernav.search.models.chat.server.answer_probabilities import (
    answer_probabilities,
    parse_decision,
    parse_logprobs,
)

HUGE = 10**400
NONSENSE: tuple[object, ...] = (None, True, "7", -1, 0.5, HUGE, -HUGE, math.nan, math.inf, [], {})
WHICH = Question("choose block", "Which?", allowed=("3", "7"))

json_values = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.sampled_from([HUGE, -HUGE, -1, 0]),
        st.integers(),
        st.floats(),
        st.sampled_from(["3", "7", "token", "text"]),
        st.text(max_size=5),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.dictionaries(
            st.sampled_from(
                [
                    "token",
                    "logprob",
                    "top_logprobs",
                    "value",
                    "probability",
                    "probabilities",
                    "choice",
                    "type",
                    "3",
                    "7",
                ]
            ),
            inner,
            max_size=5,
        ),
    ),
    max_leaves=20,
)


@pytest.mark.parametrize("names", [("prompt", "completion"), ("input", "output")])
def test_token_counts_are_read_under_both_names(names: tuple[str, str]):
    counts = {f"{names[0]}_tokens": 812, f"{names[1]}_tokens": 7}
    assert read_usage(counts) == Usage(812, 7)


@pytest.mark.parametrize("count", NONSENSE)
def test_a_count_that_cannot_be_counts_as_not_told(count: object):
    assert read_usage({"prompt_tokens": count, "completion_tokens": 7}) == Usage(0, 7)
    assert read_usage(count) == Usage()


@given(json_values)
def test_a_number_is_finite_or_none(value: object):
    number = finite_number(value)
    assert number is None or math.isfinite(number)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ("a bed", "a bed"),
        ([{"type": "text", "text": "a "}, {"type": "text", "text": "bed"}], "a bed"),
        ([{"type": "image_url"}, {"type": "output_text", "text": "a bed"}, 7, None], "a bed"),
        ([{"text": ["a bed"]}], ""),
        (None, ""),
        ({"text": "a bed"}, ""),
        (7, ""),
    ],
)
def test_content_is_a_text_or_a_list_of_parts(content: object, text: str):
    assert read_content(content) == text


@given(json_values)
def test_no_reported_probabilities_break_us(value: object):
    tokens = parse_logprobs([{"token": "7", "logprob": -0.1, "top_logprobs": value}])
    told = answer_probabilities(tokens, ("3", "7"))
    assert not told or math.isclose(sum(told.values()), 1.0)
    parse_logprobs(value)


@given(json_values, st.sampled_from(["systemone", "decisions"]))
def test_no_decision_breaks_us(value: object, endpoint: str):
    for answers in (value, [value], {"question": value}, {"question": {"probabilities": value}}):
        try:
            _, told, _, _ = parse_decision(endpoint, {"answers": answers}, WHICH)
        except ChatTransportError:
            continue
        assert not told or math.isclose(sum(told.values()), 1.0)


@pytest.mark.parametrize(
    ("usage", "tokens"),
    [
        ({"completion_tokens": 90, "completion_tokens_details": {"reasoning_tokens": 80}}, 80),
        # Gemini: in the total alone (mozilla-ai/any-llm#1293)
        ({"prompt_tokens": 20, "completion_tokens": 168, "total_tokens": 736}, 548),
        ({"prompt_tokens": 20, "total_tokens": 36}, 16),
        ({"prompt_tokens": 20, "completion_tokens": 5, "total_tokens": 25}, 0),
        ({"completion_tokens": 5, "total_tokens": 25}, 0),
        ({"prompt_tokens": 20, "completion_tokens": 5}, 0),
        (None, 0),
    ],
)
def test_tokens_of_thoughts_are_counted_wherever_they_are_told(usage: object, tokens: int):
    assert thinking_tokens(usage) == tokens


@given(json_values)
def test_no_thoughts_break_us(value: object):
    for name in ("reasoning", "reasoning_content", "content"):
        assert isinstance(read_reasoning({name: value}), str)
    assert thinking_tokens({"prompt_tokens": 1, "total_tokens": value}) >= 0
    assert thinking_tokens({"completion_tokens_details": value}) == 0


@pytest.mark.parametrize("field", ["reasoning", "reasoning_content", "thinking"])
def test_thoughts_are_read_under_all_their_names(field: str):
    assert read_reasoning({"content": "yes", field: "hm"}) == "hm"
    assert read_content({field: "hm"}) == ""
