import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.chat import Fault, Question
from hypernav.search.models.chat.answer_parsing import (
    CUT_IN_THINKING,
    SEVERAL_ANSWERS,
    end_of_thinking,
    final_answer,
    parse_answer,
    unwrapped,
)

MARKS = [
    *("<think>", "</think>", "<thinking>", "</thinking>", "[THINK]", "[/THINK]", "◁think▷"),
    *("◁/think▷", "<|channel|>analysis<|message|>", "<|channel|>final<|message|>", "<|end|>"),
    *("<|channel>thought\n", "<channel|>", "<answer>", "</answer>", "<|begin_of_box|>"),
    *("<|end_of_box|>", "\\boxed{", "}", "{", "**", "```", "```json\n", "<|im_end|>", "</s>"),
    *("analysis", "assistantfinal", '"', "`", "$", "yes", "no", "3", "[1, 2, 3, 4]", " ", "\n"),
]
texts = st.lists(st.sampled_from(MARKS), max_size=14).map("".join) | st.text(max_size=60)


@given(texts)
def test_unwrapping_twice_is_unwrapping_once(text: str):
    once = unwrapped(text)
    again = unwrapped(once.text)
    assert (again.text, again.removed, again.problem) == (once.text, (), "")


@given(st.text(alphabet="abc yes NO 123 [],.{}:'-\n", max_size=80))
def test_a_plain_text_is_unchanged(text: str):
    assert unwrapped(text).text == text.strip()
    assert unwrapped(text).removed == ()


@given(texts, st.sampled_from(["yes", "Answer: 3", "[10, 20, 30, 40]", "left"]))
def test_only_what_follows_the_thinking_counts(thought: str, answer: str):
    """Whatever is thought, also in tags and with answers of its own."""
    thought = thought.replace("<|im_end|>", "").replace("</s>", "").replace("<|end|>", "")
    for text in (f"<think>{thought}\n</think>\n{answer}", f"{thought}\n</think>\n{answer}"):
        assert final_answer(text) == answer


@given(texts)
def test_thinking_without_an_end_is_no_answer(thought: str):
    begun = unwrapped("<think> " + "".join(c for c in thought if c not in "<>[]◁▷|"))
    assert begun.text == ""


@pytest.mark.parametrize("mention", ['"<think>"', "'</think>'", "`<answer>`", "“<|im_end|>”"])
def test_a_mark_between_quotes_is_a_mention(mention: str):
    text = f"The sign says {mention} in red"
    assert unwrapped(text).text == text


@pytest.mark.parametrize(
    "before", ["", "a", " ", "(", "a ", ' "', '"', '("', "=“", '""', 'a"', '."']
)
@pytest.mark.parametrize("after", ["", "a", " ", '"', "”)"])
def test_a_mark_is_mentioned_only_if_a_quote_opens_before_it_and_another_follows(
    before: str, after: str
):
    is_mention = before in {' "', '"', '("', "=“", '""'} and after in {'"', "”)"}
    assert (end_of_thinking(f"{before}</think>{after}") is None) == is_mention


def test_says_what_is_wrong_and_what_was_taken_off():
    assert unwrapped("<think>yes").problem == CUT_IN_THINKING
    assert "chat.thinking" in CUT_IN_THINKING
    assert unwrapped("<answer>yes</answer><answer>no</answer>").problem == SEVERAL_ANSWERS
    whole = unwrapped("<think>no</think><answer>\\boxed{**yes**}</answer><|im_end|>")
    assert whole.text == "yes"
    assert whole.removed == ("turn tokens", "<think>", "<answer>", "\\boxed", "emphasis")


@pytest.mark.parametrize(
    "text",
    [
        *("<think>" * 5_000, "</think>" * 5_000, "<answer>" * 5_000, "\\boxed{" * 5_000),
        *("**" * 16_000, "```" * 10_000, "<|im_end|>" * 3_000, "<think " * 5_000),
        *("$" * 32_767, "x" + " " * 32_000 + "x"),
        *("\\boxed{" * 2_000 + "}" * 2_000, "<answer>" * 2_000 + "x" + "</answer>" * 2_000),
    ],
)
def test_monstrous_texts_hang_nothing(text: str):
    begin = time.monotonic()
    unwrapped(text)
    assert time.monotonic() - begin < 5.0


@pytest.mark.parametrize(
    ("text", "is_thought"),
    [
        ("So the user wants every sofa. I see one at [100, 200, 300, 400], but", True),
        ("The sofa on the left might be [100, 200, 300, 400]. Is it", True),
        (
            "我们需要在图片中找到所有的沙发，然后给出它们的位置和坐标，左边有一个灰色的沙发看起来比较像，让我再看一下",
            True,
        ),
        ('[{"bbox_2d": [100, 200, 300, 400], "label": "sofa"}, {"bbox', False),
        ('Here are the boxes:\n[{"bbox_2d": [100, 200, 300, 400]', False),
        ("Left. The hallway leads to", False),
    ],
)
def test_prose_that_reached_the_limit_may_be_thinking_that_the_prompt_began(
    text: str, is_thought: bool
):
    """Its boxes are not read; whoever asks for reasoning first takes a cut answer as it is."""
    boxes = Question("ground", "Where?", at_once=True)
    cut = parse_answer(boxes, text, model="m", is_cut=True)
    assert (cut.fault is Fault.CUT) == is_thought
    assert parse_answer(boxes, text, model="m").fault is None
    assert parse_answer(Question("choose block", "?"), text, model="m", is_cut=True).fault is None


def test_a_cut_reply_without_an_allowed_answer_says_that_it_reached_its_limit():
    question = Question("verify", "Is it there?", allowed=("yes", "no"), max_tokens=8)
    text = "Okay, let's see. The image shows"
    assert "limit of tokens" in parse_answer(question, text, model="m", is_cut=True).detail
    assert "limit of tokens" not in parse_answer(question, text, model="m").detail
    assert parse_answer(question, "yes", model="m", is_cut=True).detail == ""
