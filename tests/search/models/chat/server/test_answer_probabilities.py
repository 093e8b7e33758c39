import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.search.models.chat.server.answer_probabilities import (
    TokenProbabilities,
    answer_probabilities,
    parse_logprobs,
)


def token(written: str, **probabilities: float) -> TokenProbabilities:
    return TokenProbabilities(written, probabilities or {written: 1.0})


def test_single_tokens():
    said = [TokenProbabilities("3", {"3": 0.6, "7": 0.3, "x": 0.1})]
    assert answer_probabilities(said, ["3", "7"]) == pytest.approx({"3": 2 / 3, "7": 1 / 3})


@pytest.mark.parametrize("written", ["The", "Answer", "Block"])
def test_what_might_have_begun_a_sentence_tells_nothing_of_its_end(written: str):
    said = [TokenProbabilities(written, {written: 0.5, "yes": 0.3, "no": 0.01})]
    rest = [token(word) for word in (" is", " no", ".")]
    assert answer_probabilities([*said, *rest], ["yes", "no"]) == {}


def test_answers_of_two_tokens_are_followed_along_what_was_written():
    said = [
        TokenProbabilities("1", {"1": 0.8, "2": 0.2}),
        TokenProbabilities("2", {"2": 0.75, "<|im_end|>": 0.25}),
    ]
    probabilities = answer_probabilities(said, ["1", "12", "2"])
    assert probabilities == pytest.approx({"1": 0.2, "12": 0.6, "2": 0.2})


def test_what_was_not_written_is_shared_equally():
    said = [TokenProbabilities("2", {"2": 0.5, "1": 0.5})]
    probabilities = answer_probabilities(said, ["2", "10", "11"])
    assert probabilities == pytest.approx({"2": 0.5, "10": 0.25, "11": 0.25})


def test_inside_json():
    said = [
        token('{"'),
        token("answer"),
        token('":'),
        token(' "'),
        TokenProbabilities("12", {"12": 0.7, "3": 0.3}),
        token('"}'),
    ]
    assert answer_probabilities(said, ["3", "12"], wrapped=True) == pytest.approx(
        {"3": 0.3, "12": 0.7}
    )


def test_quote_and_answer_in_one_token():
    said = [token('{"answer":'), TokenProbabilities(' "12', {' "12': 0.9, ' "3': 0.1}), token('"}')]
    assert answer_probabilities(said, ["3", "12"], wrapped=True) == pytest.approx(
        {"3": 0.1, "12": 0.9}
    )


def test_capital_letters_and_leading_spaces_do_not_matter():
    said = [TokenProbabilities(" Yes", {" Yes": 0.5, "yes": 0.25, "No": 0.25})]
    assert answer_probabilities(said, ["yes", "no"]) == pytest.approx({"yes": 0.75, "no": 0.25})


@pytest.mark.parametrize("said", [[], [token("x", x=1.0)], [TokenProbabilities("", {})]])
def test_nothing_to_tell(said: list[TokenProbabilities]):
    assert answer_probabilities(said, ["1", "2"]) == {}


@pytest.mark.parametrize(
    "content",
    [None, "x", [1], [{}], [{"token": 3}], {"token": "x"}],
)
def test_logprobs_that_are_none(content: object):
    assert parse_logprobs(content) == []


def test_reads_logprobs_of_the_openai_form():
    top = [{"token": "3", "logprob": math.log(0.5)}, {"token": "7", "logprob": math.log(0.25)}]
    content = [{"token": "3", "logprob": math.log(0.5), "top_logprobs": top}]
    assert parse_logprobs(content)[0].probabilities == pytest.approx({"3": 0.5, "7": 0.25})


numbers = st.from_regex(r"[1-9][0-9]?", fullmatch=True)
labels = st.lists(numbers, min_size=2, max_size=8, unique=True)
any_text = st.text(max_size=4)
any_tokens = st.tuples(any_text, st.dictionaries(any_text, st.floats(0, 1), max_size=4))


@given(labels, st.data())
def test_probabilities_sum_to_one_and_favour_the_certain(names: list[str], data: st.DataObject):
    chosen = data.draw(st.sampled_from(names))
    said = [TokenProbabilities(character, {character: 1.0}) for character in chosen]
    probabilities = answer_probabilities(said, names)
    assert set(probabilities) == set(names)
    assert sum(probabilities.values()) == pytest.approx(1.0)
    assert 0.9999 < probabilities[chosen] < 1.0  # the others were not reported as impossible


def test_an_answer_missing_among_the_alternatives_has_the_least_of_them_at_most():
    """As llama.cpp and vLLM report it: without the constraint, and 20 alternatives at most."""
    said = [TokenProbabilities("k", {"k": 0.4, "l": 0.3, "d": 0.02, "x": 0.02})]
    said.append(TokenProbabilities("itchen", {"now": 0.9, "itchen": 0.01}))
    shares = answer_probabilities(said, ["kitchen", "bedroom"])
    assert shares == pytest.approx({"kitchen": 0.4 / 0.42, "bedroom": 0.02 / 0.42})


def test_missing_answers_share_what_the_alternatives_leave():
    said = [TokenProbabilities("k", {"k": 0.9})]
    shares = answer_probabilities(said, ["kitchen", "bedroom", "hall"])
    assert shares == pytest.approx({"kitchen": 0.9, "bedroom": 0.05, "hall": 0.05})


def test_an_answer_less_probable_than_all_alternatives_tells_nothing_of_the_others():
    said = [TokenProbabilities("k", {"k": 0.05, "l": 0.3, "d": 0.2, "x": 0.2})]
    assert answer_probabilities(said, ["kitchen", "bedroom"]) == {}


@given(st.lists(any_tokens, max_size=5), labels, st.booleans())
def test_any_tokens_give_a_distribution_or_nothing(raw: list, names: list[str], wrapped: bool):
    tokens = [TokenProbabilities(text, probabilities) for text, probabilities in raw]
    probabilities = answer_probabilities(tokens, names, wrapped=wrapped)
    assert probabilities == {} or sum(probabilities.values()) == pytest.approx(1.0)
