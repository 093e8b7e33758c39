"""What a refusal names is sent otherwise from then on; replies as real servers word them."""

from contextlib import suppress
from itertools import pairwise
from typing import Any

import pytest

from chat_models import image
from hypernav.core.chat import Question
from hypernav.core.errors import ModelRejectedError, ModelUnavailableError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.server.refusals import Refusals
from servers.faulty import Act, FaultyServer, Talk, list_models

QUICK = ChatConfig(timeout_s=5.0, patience_s=5.0, first_wait_s=0.01, longest_wait_s=0.05)
SEEN = Question("verify", "Is there a bed?", (image(),), ("yes", "no"), max_tokens=8)

BODY: dict[str, Any] = {
    "model": "m",
    "messages": [],
    "max_tokens": 300,
    "response_format": {"type": "json_schema"},
    "temperature": 0.0,
    "seed": 0,
    "logprobs": True,
    "top_logprobs": 20,
    "reasoning_effort": "none",
}

AZURE = (
    "Unsupported parameter: 'max_tokens' is not supported with this model. Use "
    "'max_completion_tokens' instead."
)
LITELLM = (
    "litellm.UnsupportedParamsError: ollama_chat does not support parameters: ['logprobs'], for "
    "model=llama3.1:70b. To drop these, set `litellm.drop_params=True`"
)


@pytest.mark.parametrize(
    ("said", "gone", "changed"),
    [
        (AZURE, ["max_tokens"], {"max_completion_tokens": 300}),
        ("Unrecognized request argument supplied: max_tokens", ["max_tokens"], {}),
        (
            "Unsupported value: 'temperature' does not support 0 with this model. Only the default "
            "(1) value is supported.",
            ["temperature"],
            {},
        ),
        ("`temperature` is deprecated for this model.", ["temperature"], {}),
        ("Invalid key in body: temperature", ["temperature"], {}),
        (LITELLM, ["logprobs", "top_logprobs"], {}),
        ("Logprobs is not supported for the current model.", ["logprobs", "top_logprobs"], {}),
        (
            "Requested sample logprobs of 20, which is greater than max allowed: 5",
            [],
            {"top_logprobs": 10},
        ),
        ("body.seed: Extra inputs are not permitted", ["seed"], {}),
        ("'response_format.type' must be 'json_object' or 'text'", ["response_format"], {}),
        ('Invalid JSON payload: Unknown name "additionalProperties"', ["response_format"], {}),
        ("Structured outputs are not available", ["response_format"], {}),
        ('"llama3.1:8b" does not support thinking', ["reasoning_effort"], {}),
        (
            "Unsupported value: 'reasoning_effort' does not support 'none' with this model. "
            "Supported values are: 'minimal', 'low', 'medium', and 'high'.",
            [],
            {"reasoning_effort": "minimal"},
        ),
        (
            "Unsupported value: 'reasoning_effort' does not support 'none' with this model. "
            "Supported values are: 'low', 'medium', and 'high'.",
            [],
            {"reasoning_effort": "low"},
        ),
        (
            "'max_tokens' or 'max_completion_tokens' is too large: 300. This model's maximum "
            "context length is 512 tokens and your request has 290 input tokens",
            [],
            {"max_tokens": 150},
        ),
        (
            "This model's maximum context length is 512 tokens. However, you requested 600 tokens",
            [],
            {"max_tokens": 150},
        ),
    ],
)
def test_only_what_is_named_is_sent_otherwise(said: str, gone: list[str], changed: dict[str, Any]):
    learned = Refusals().after(said, BODY)
    assert learned is not None
    sent = learned.fitted(BODY)
    assert sorted(BODY.keys() - sent.keys()) == gone
    assert {name: sent[name] for name in changed} == changed
    kept = BODY.keys() - set(gone) - changed.keys()
    assert all(sent[name] == BODY[name] for name in kept)


@pytest.mark.parametrize(
    "said",
    [
        "messages[0].content: image_url is malformed",
        "Bad Request",
        "the request exceeds the available context size (4096 tokens), try increasing it",
        "qwen/nonsense is not a valid model ID",
    ],
)
def test_what_no_field_can_mend_teaches_nothing(said: str):
    assert Refusals().after(said, BODY) is None


def test_after_a_refusal_that_names_nothing_ever_more_fields_are_left_out():
    plain, same, *fewer = Refusals(dropped=("seed",)).trials(BODY)
    assert plain.fitted(BODY).keys() == {"model", "messages", "max_tokens"}
    assert same == Refusals(dropped=("seed",))
    left = [len(one.fitted(BODY)) for one in (same, *fewer, plain)]
    assert [before - after for before, after in pairwise(left)] == [1] * len(fewer) + [1]
    assert plain.trials(BODY) == []


def test_a_limit_that_is_too_small_grows_and_never_without_end():
    small = BODY | {"max_tokens": 8}
    said = "Invalid 'max_output_tokens': integer below minimum value. Expected a value >= 16"
    learned = Refusals().after(said, small)
    assert learned is not None
    assert learned.fitted(small)["max_tokens"] == 16
    assert learned.fitted(BODY)["max_tokens"] == 300


def test_no_limit_shrinks_until_nothing_can_be_said():
    known, asked = Refusals(), 0
    while (after := known.after("max_tokens is too large", BODY)) is not None:
        known, asked = after, asked + 1
    assert known.fitted(BODY)["max_tokens"] >= 32
    assert asked <= 5


class Picky:
    """A server that refuses as told until the request suits it, and keeps all requests."""

    def __init__(self, *rules: tuple[str, str], status: int = 400) -> None:
        self.rules, self.status, self.bodies = rules, status, list[dict[str, Any]]()

    def __call__(self, talk: Talk) -> None:
        self.bodies.append(talk.body)
        for field, said in self.rules:
            if field in talk.body:
                talk.reply({"error": {"message": said, "param": field}}, self.status)
                return
        talk.say("yes")


@pytest.mark.parametrize("status", [400, 422, 500, 501, 200])
def test_a_server_behind_which_gpt5_stands(status: int):
    picky = Picky(
        ("max_tokens", AZURE),
        ("temperature", "Unsupported value: 'temperature' does not support 0 with this model."),
        ("top_logprobs", "Unsupported parameter: 'top_logprobs' is not supported"),
        status=status,
    )
    with FaultyServer(picky) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        assert chat.ask(SEEN).value == "yes"
        refused = len(picky.bodies) - 1
        assert chat.ask(SEEN).value == "yes"
    assert (refused, len(picky.bodies)) == (3, 5)
    assert picky.bodies[-1]["max_completion_tokens"] == 8
    assert not {"max_tokens", "temperature", "logprobs", "top_logprobs"} & picky.bodies[-1].keys()
    assert picky.bodies[-1]["structured_outputs"] == {"choice": ["yes", "no"]}
    assert picky.bodies[-1]["seed"] == 0
    assert set(chat.dropped) == {"temperature", "logprobs", "top_logprobs"}


def nameless(*fields: str, times: int = 10**6) -> tuple[Act, list[dict[str, Any]]]:
    """A server that refuses these fields, or everything if none is given, and says no reason."""
    bodies: list[dict[str, Any]] = []

    def act(talk: Talk) -> None:
        bodies.append(talk.body)
        if len(bodies) <= times and (not fields or set(fields) & talk.body.keys()):
            talk.reply({"error": {"message": "Bad Request"}}, 400)
        else:
            talk.say("yes")

    return act, bodies


def test_what_is_refused_in_vain_is_forgotten():
    act, bodies = nameless()
    with FaultyServer(act) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        with pytest.raises(ModelRejectedError, match="Bad Request"):
            chat.ask(SEEN)
    assert chat.dropped == ()
    assert len(bodies) == 2  # once in full, once without what is optional


@pytest.mark.parametrize("times", [1, 2])
def test_a_lone_refusal_without_a_reason_costs_no_field(times: int):
    act, bodies = nameless(times=times)
    with FaultyServer(act) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        for _ in range(3):
            with suppress(ModelRejectedError):  # refused twice is refused
                chat.ask(SEEN)
        assert chat.ask(SEEN).value == "yes"
    assert chat.dropped == ()
    assert bodies[-1] == bodies[0]


def test_a_field_that_is_always_refused_without_a_reason_is_found_once():
    act, bodies = nameless("top_logprobs")
    with FaultyServer(act) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        assert chat.ask(SEEN).value == "yes"
        asked = len(bodies)
        assert chat.ask(SEEN).value == "yes"
    assert chat.dropped == ("top_logprobs",)
    assert (asked, len(bodies)) == (4, 5)
    assert bodies[0].keys() - bodies[-1].keys() == {"top_logprobs"}


def test_a_refused_question_takes_no_decisions_away():
    refused: list[str] = []

    def other(talk: Talk) -> None:
        if talk.path != "/v1/systemone" or not talk.body:
            talk.reply({"detail": "no question"}, 422)
        elif not refused:
            refused.append(talk.path)
            talk.reply({"detail": "Bad Request"}, 400)
        else:
            answer = {"type": "choice", "choice": "yes", "probabilities": {"yes": 0.9, "no": 0.1}}
            talk.reply({"answers": {"question": answer}})

    def models(talk: Talk) -> None:
        talk.reply({"data": [{"id": "m", "owned_by": "somebody"}]})

    with FaultyServer(lambda talk: talk.say("no"), models=models, other=other) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        answers = [chat.ask(SEEN).value for _ in range(2)]
    assert answers == ["yes", "yes"]
    assert chat.dropped == ()


def test_a_decision_endpoint_that_answers_501_is_none():
    """vLLM behind a proxy that renames ``owned_by``: it refuses an empty question with 422."""
    paths: list[str] = []

    def other(talk: Talk) -> None:
        paths.append(talk.path)
        error = {"code": 501, "message": "this model is not a decision model; try again later"}
        talk.reply({"error": error}, 501 if talk.body else 422)

    def models(talk: Talk) -> None:
        talk.reply({"data": [{"id": "m", "owned_by": "somebody"}]})

    picky = Picky(("no_such_field", ""))
    with FaultyServer(picky, models=models, other=other) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        answers = [chat.ask(SEEN).attempts for _ in range(2)]
    assert answers == [1, 1]
    assert paths == ["/v1/systemone"] * 2
    assert all("response_format" in body for body in picky.bodies)


def test_a_timeout_after_a_refusal_keeps_its_words():
    def act(talk: Talk) -> None:
        if talk.number == 0:
            talk.reply({"error": {"message": "Bad Request number 7"}}, 400)
        talk.wait()

    with FaultyServer(act) as server:
        config = QUICK.model_copy(update={"timeout_s": 0.2, "patience_s": 0.1})
        with pytest.raises(ModelUnavailableError, match=r"no answer within.*Bad Request number 7"):
            OpenAiChat(server.url, "m", config, environment={}).ask(SEEN)


def test_fields_of_ones_own_are_sent_and_never_left_out():
    picky = Picky(("top_k", "Extra inputs are not permitted: top_k"))
    own = {"top_k": 1, "temperature": 0.7, "max_completion_tokens": 99}
    with FaultyServer(picky) as server:
        config = QUICK.model_copy(update={"extra_body": own})
        with pytest.raises(ModelUnavailableError, match=r"'top_k' comes from chat\.extra_body"):
            OpenAiChat(server.url, None, config, environment={}).ask(SEEN)
    assert len(picky.bodies) == 1
    assert {name: picky.bodies[0][name] for name in own} == own
    assert "max_tokens" not in picky.bodies[0]


def test_a_server_that_answers_everything_with_an_error_has_no_decisions():
    """LM Studio answers 200 to addresses that it doesn't have."""

    def other(talk: Talk) -> None:
        talk.reply({"error": f"Unexpected endpoint or method. ({talk.method} {talk.path})"})

    def models(talk: Talk) -> None:
        talk.reply({"data": [{"id": "gemma-4", "owned_by": "organization_owner"}]})

    with FaultyServer(lambda talk: talk.say("yes"), models=models, other=other) as server:
        chat = OpenAiChat(server.url, None, QUICK, environment={})
        assert chat.ask(SEEN).value == "yes"
        assert chat.server().dialect.name == "openai"
    with FaultyServer(lambda talk: talk.say("yes"), models=list_models) as server:
        assert OpenAiChat(server.url, None, QUICK, environment={}).ask(SEEN).value == "yes"
