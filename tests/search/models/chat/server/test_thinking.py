"""Models that think before they answer, behind servers that show it in their own ways."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from chat_models import image
from hypernav.core.chat import Fault, Question
from hypernav.core.errors import ModelUnavailableError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.server.thinking import ROOMS, switches
from servers.faulty import Act, FaultyServer, Talk

QUICK = ChatConfig(timeout_s=5.0, patience_s=5.0, first_wait_s=0.01, longest_wait_s=0.05)
SEEN = Question("verify", "Is there a bed?", (image(),), ("yes", "no"), max_tokens=8)
BOXES = Question("ground", "Locate every bed", (image(),), max_tokens=300)
THOUGHT = "The user asks for [100, 200, 300, 400]. No, that is no bed. "

Show = Callable[[str, str], dict[str, Any]]


def apart(field: str) -> Show:
    """Thoughts in a field of their own."""
    return lambda thought, answer: {"content": answer or None, field: thought}


def in_tags(thought: str, answer: str) -> dict[str, Any]:
    return {"content": f"<think>{thought}" + (f"</think>{answer}" if answer else "")}


def prefilled(thought: str, answer: str) -> dict[str, Any]:
    """The chat template has written the opening tag."""
    return {"content": thought + (f"</think>{answer}" if answer else "")}


def hidden(_: str, answer: str) -> dict[str, Any]:
    """Only the count of tokens shows them."""
    return {"content": answer}


SHOWS: dict[str, Show] = {
    "reasoning": apart("reasoning"),
    "reasoning_content": apart("reasoning_content"),
    "tags": in_tags,
    "prefilled": prefilled,
    "hidden": hidden,
}


class Thinker:
    """A model that thinks for a number of tokens unless the field that stops it is there."""

    def __init__(
        self,
        show: Show,
        tokens: int = 500,
        stops: Callable[[dict[str, Any]], bool] = lambda body: False,
        answer: str = "yes",
    ) -> None:
        self.show, self.tokens, self.stops, self.answer = show, tokens, stops, answer
        self.bodies: list[dict[str, Any]] = []

    def __call__(self, talk: Talk) -> None:
        body = talk.body
        self.bodies.append(body)
        limit = body.get("max_tokens", 10**9)
        tokens = 0 if self.stops(body) else self.tokens
        is_cut = tokens >= limit
        if tokens:
            message = self.show(THOUGHT, "" if is_cut else self.answer)
        else:
            message = {"content": self.answer}
        written = min(tokens, limit) + (0 if is_cut else 5)
        usage = {
            "prompt_tokens": 100,
            "completion_tokens": written,
            "total_tokens": 100 + written,
            "completion_tokens_details": {"reasoning_tokens": min(tokens, limit)},
        }
        finish = "length" if is_cut else "stop"
        choice = {"message": {"role": "assistant", **message}, "finish_reason": finish}
        talk.reply({"choices": [choice], "usage": usage})


def asking(thinker: Act, server: FaultyServer, **config: Any) -> OpenAiChat:
    return OpenAiChat(server.url, None, QUICK.model_copy(update=config), environment={})


@pytest.mark.parametrize("name", SHOWS)
def test_a_model_that_thinks_gets_room_and_is_remembered(name: str):
    thinker = Thinker(SHOWS[name], tokens=1500)
    with FaultyServer(thinker) as server:
        chat = asking(thinker, server)
        assert chat.ask(SEEN).value == "yes"
        asked = len(thinker.bodies)
        assert chat.ask(SEEN).value == "yes"
    assert chat.thinking.is_seen
    assert chat.thinking.room == 4096
    assert asked <= 5
    assert len(thinker.bodies) == asked + 1


@pytest.mark.parametrize("name", SHOWS)
def test_no_box_that_was_only_thought_about_is_an_answer(name: str):
    thinker = Thinker(SHOWS[name], tokens=10**6, answer="[]")
    with FaultyServer(thinker) as server:
        chat = asking(thinker, server, thinking="auto")
        said = [chat.ask(BOXES) for _ in range(2)]
    if name == "prefilled":  # cut every time, it can't be told from an answer
        return
    assert all(answer.fault is not None and answer.value is None for answer in said)
    assert chat.thinking.is_endless
    assert len(thinker.bodies) == len(ROOMS) + 1


def test_once_seen_a_prefilled_tag_is_known_in_answers_that_are_cut():
    thinker = Thinker(prefilled, tokens=600, answer="[]")
    with FaultyServer(thinker) as server:
        chat = asking(thinker, server)
        assert chat.ask(BOXES).fault is None
        thinker.tokens = 10**6
        answer = chat.ask(BOXES)
    assert answer.fault is not None
    assert answer.text.startswith("<think>")


def template_off(body: dict[str, Any]) -> bool:
    return body.get("chat_template_kwargs", {}).get("enable_thinking") is False


OWN_SWITCH: dict[str, Callable[[dict[str, Any]], bool]] = {
    "vllm": template_off,
    "sglang": template_off,
    "llamacpp": lambda body: body.get("thinking_budget_tokens") == 0,
    "ollama": lambda body: body.get("reasoning_effort") == "none",
    "openai": lambda body: body.get("reasoning_effort") == "none",
    "OpenRouter": lambda body: body.get("reasoning", {}).get("effort") == "none",
    "DeepSeek": lambda body: body.get("thinking", {}).get("type") == "disabled",
    "DashScope": lambda body: body.get("enable_thinking") is False,
}


@pytest.mark.parametrize("show", ["reasoning", "tags", "prefilled", "hidden"])
@pytest.mark.parametrize("name", OWN_SWITCH)
def test_off_finds_the_switch_of_each_server_by_what_comes_back(name: str, show: str):
    thinker = Thinker(SHOWS[show], stops=OWN_SWITCH[name])
    dialect = name if name.islower() else "openai"
    with FaultyServer(thinker) as server:
        chat = asking(thinker, server, thinking="off", dialect=dialect)
        assert chat.ask(SEEN).value == "yes"
        asked = len(thinker.bodies)
        assert chat.ask(SEEN).value == "yes"
    assert not chat.thinking.is_seen
    assert OWN_SWITCH[name](thinker.bodies[-1])
    assert len(thinker.bodies) == asked + 1


def test_off_where_nothing_helps_gives_room_and_says_so():
    thinker = Thinker(apart("reasoning"))
    with FaultyServer(thinker) as server:
        chat = asking(thinker, server, thinking="off")
        assert chat.ask(SEEN).value == "yes"
    assert chat.thinking.is_seen
    assert chat.thinking.room == 1024
    assert thinker.bodies[-1]["reasoning_effort"] == "low"


def test_a_model_that_does_not_think_costs_no_second_question():
    thinker = Thinker(hidden, tokens=0)
    with FaultyServer(thinker) as server:
        for level in ("auto", "off", "low"):
            chat = asking(thinker, server, thinking=level)
            assert chat.ask(SEEN).value == "yes"
            assert not chat.thinking.is_seen
    assert [body["max_tokens"] for body in thinker.bodies] == [8, 8, 8]


def test_auto_asks_for_nothing_and_low_for_little():
    assert switches("auto", "vllm") == ({},)
    assert switches("low", "ollama") == ({"reasoning_effort": "low"},)
    assert all("reasoning_effort" in body for body in switches("low", "llamacpp"))


def test_a_switch_that_is_refused_is_left_out():
    def refuse(talk: Talk) -> None:
        if "chat_template_kwargs" in talk.body:
            talk.reply({"error": {"message": "extra_forbidden: chat_template_kwargs"}}, 422)
        else:
            talk.say("yes")

    with FaultyServer(refuse) as server:
        chat = asking(refuse, server, thinking="off")
        assert chat.ask(SEEN).value == "yes"
    assert chat.dropped == ("chat_template_kwargs",)


def test_a_talker_that_does_not_think_is_asked_at_length_only_once():
    texts = ["I see a room with a bed " * 3, "I see a room with a bed " * 90]

    def talk_on(talk: Talk) -> None:
        limit = talk.body["max_tokens"]
        asked.append(limit)
        cut = {"finish_reason": "length" if limit < 500 else "stop"}
        message = {"role": "assistant", "content": texts[limit >= 500]}
        talk.reply({"choices": [{"message": message, **cut}]})

    asked: list[int] = []
    with FaultyServer(talk_on) as server:
        chat = asking(talk_on, server)
        assert chat.ask(BOXES).text == texts[0]
        assert chat.ask(BOXES).text == texts[0]
    assert asked == [300, 1324, 300]


def test_a_model_that_only_repeats_itself_does_not_think():
    bodies = list[dict[str, Any]]()

    def babble(talk: Talk) -> None:
        bodies.append(talk.body)
        choice = {"message": {"content": "S 4 O " * talk.body["max_tokens"]}}
        talk.reply({"choices": [{**choice, "finish_reason": "length"}]})

    with FaultyServer(babble) as server:
        chat = asking(babble, server)
        assert chat.ask(SEEN).fault is Fault.UNPARSABLE
        asked = len(bodies)
        assert chat.ask(SEEN).fault is Fault.UNPARSABLE
    assert not chat.thinking.is_seen
    assert chat.thinking.room == 0
    assert [body["max_tokens"] <= 8 + 1024 for body in bodies] == [True] * (asked + 1)


def test_what_is_cut_at_any_length_is_no_answer():
    """A template that opens the thoughts, and thoughts that are longer than every probe."""
    asked = list[int]()

    def think_on(talk: Talk) -> None:
        asked.append(talk.body["max_tokens"])
        message = {"role": "assistant", "content": "Okay. The sofa: [100, 200, 600, 700]"}
        talk.reply({"choices": [{"message": message, "finish_reason": "length"}]})

    with FaultyServer(think_on) as server:
        assert asking(think_on, server).ask(BOXES).fault is Fault.CUT
    probes, rooms = [1024, 4096], [4096, 16384]  # with the last room the answer is given up
    assert asked == [300 + tokens for tokens in (0, *probes, *rooms)]


@pytest.mark.parametrize("kind", ["reasoning_text", "thought", "summary_text", "reasoning"])
def test_only_parts_that_are_text_are_an_answer(kind: str):
    def answer(talk: Talk) -> None:
        parts = [
            {"type": kind, "text": "perhaps [100, 200, 600, 700]"},
            {"type": "text", "text": "or [1, 2, 3, 4]", "thought": True},
            {"type": "output_text", "text": "[]"},
        ]
        talk.reply({"choices": [{"message": {"role": "assistant", "content": parts}}]})

    with FaultyServer(answer) as server:
        assert asking(answer, server).ask(BOXES).text == "[]"


@pytest.mark.parametrize("field", ["reasoning", "reasoning_content"])
def test_an_answer_in_the_field_of_thoughts_is_none(field: str):
    """vLLM's wrong parser puts the whole answer there (vllm-project/vllm#19222)."""

    def answer(talk: Talk) -> None:
        message = {"role": "assistant", "content": None, field: "hm</think>[/THINK]yes"}
        talk.reply({"choices": [{"message": message, "finish_reason": "stop"}]})

    with FaultyServer(answer) as server:
        assert asking(answer, server).ask(SEEN).fault is not None


def test_parts_of_a_message_that_are_thoughts_are_no_answer():
    parts = [
        {"type": "thinking", "thinking": [{"type": "text", "text": "no?"}]},
        {"type": "text", "text": "yes"},
    ]
    with FaultyServer(lambda talk: talk.say(parts)) as server:
        chat = asking(lambda talk: None, server)
        assert chat.ask(SEEN).value == "yes"
        assert chat.thinking.is_seen


def test_probabilities_are_those_of_the_answer_not_of_a_thought():
    def tokens(*texts: str) -> list[dict[str, Any]]:
        sure = [{"token": "no", "logprob": 0.0}, {"token": "yes", "logprob": math.log(0.2)}]
        last = [{"token": "no", "logprob": math.log(0.2)}, {"token": "yes", "logprob": -0.223}]
        return [
            {"token": text, "logprob": -0.2, "top_logprobs": sure if number == 0 else last}
            for number, text in enumerate(texts)
        ]

    def answer(talk: Talk) -> None:
        message = {"role": "assistant", "content": "\n\nyes", "reasoning": "no, or"}
        logprobs = {"content": tokens("no", ", or", "</think>", "\n\n", "yes")}
        talk.reply({"choices": [{"message": message, "logprobs": logprobs}]})

    with FaultyServer(answer) as server:
        told = asking(answer, server).ask(SEEN)
    assert told.value == "yes"
    assert told.probabilities["yes"] == pytest.approx(0.8, abs=0.01)


def test_no_time_for_thoughts_is_said():
    def think(talk: Talk) -> None:
        if talk.body["max_tokens"] > 100:
            talk.wait()
        message = {"role": "assistant", "content": None, "reasoning": THOUGHT}
        talk.reply({"choices": [{"message": message, "finish_reason": "length"}]})

    with FaultyServer(think) as server:
        chat = asking(think, server, timeout_s=0.2, patience_s=0.3)
        with pytest.raises(ModelUnavailableError, match=r"chat\.thinking=off"):
            chat.ask(SEEN)


def test_room_stays_within_what_the_server_has():
    def serve(talk: Talk) -> None:
        limit = talk.body["max_tokens"]
        if limit > 3000:
            said = f"max_tokens is too large: {limit}. This model supports at most 3000"
            talk.reply({"error": {"message": said}}, 400)
        else:
            thinker(talk)

    thinker = Thinker(apart("reasoning"), tokens=2000)
    with FaultyServer(serve) as server:
        assert asking(serve, server).ask(SEEN).value == "yes"


@pytest.mark.parametrize("begin", ["<think>", ""])
def test_the_answer_after_long_thoughts_is_reached(begin: str):
    text = f"{begin}{THOUGHT * 1000}</think>yes"
    with FaultyServer(lambda talk: talk.say(text)) as server:
        assert asking(lambda talk: None, server).ask(SEEN).value == "yes"
