"""Answers that come piece by piece: put together, waited for, and given up."""

import json
import time
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.chat import Question, Usage
from hypernav.core.errors import ModelRejectedError, ModelUnavailableError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.server.streamed import joined
from servers.faulty import FaultyServer, HungUpError, Talk

OPEN = Question("ground", "Where is the bed?")
CLOSED = Question("verify", "Is there a bed?", allowed=("yes", "no"), max_tokens=8)
HASTY = ChatConfig(timeout_s=0.5, patience_s=1.5, first_wait_s=0.01, longest_wait_s=0.05)
COUNTED = {"choices": [], "usage": {"prompt_tokens": 90, "completion_tokens": 3}}


def piece(content: str | None, finish: str | None = None, **more: Any) -> dict[str, Any]:
    delta = {"role": "assistant", "content": content}
    return {"choices": [{"index": 0, "delta": delta, "finish_reason": finish, **more}]}


def stream(*events: dict[str, Any]) -> list[bytes]:
    return [f"data: {json.dumps(event)}\n\n".encode() for event in events]


def begin(talk: Talk) -> None:
    talk.send(b"HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\n\r\n")


def say(talk: Talk, lines: list[bytes], every_s: float = 0.0) -> None:
    begin(talk)
    for line in lines:
        talk.send(line)
        talk.wait(every_s)
    talk.send(b"data: [DONE]\n\n")


def asker(server: FaultyServer, config: ChatConfig = HASTY) -> OpenAiChat:
    return OpenAiChat(server.url, None, config, environment={})


@given(st.lists(st.text()), st.booleans(), st.sampled_from(["\n\n", "\r\n\r\n", "\n: ping\n\n"]))
def test_a_stream_holds_what_its_pieces_hold(texts: list[str], is_finished: bool, between: str):
    events = [piece(text) for text in texts]
    events += [piece(None, "length"), COUNTED] if is_finished else [COUNTED]
    body = b"".join(line.strip() + between.encode() for line in stream(*events))
    whole = joined(body + b"data: [DONE]\n\n")
    assert "".join(one["message"]["content"] for one in whole["choices"]) == "".join(texts)
    assert whole["usage"] == COUNTED["usage"]


@pytest.mark.slow
def test_an_answer_that_comes_slowly_is_waited_for():
    slow = [piece(letter) for letter in "[1, 2, 34]"] + [piece(None, "stop"), COUNTED]
    with FaultyServer(lambda talk: say(talk, stream(*slow), every_s=0.2)) as server:
        answer = asker(server).ask(OPEN)
    assert (answer.value, answer.attempts, server.questions) == ("[1, 2, 34]", 1, 1)
    assert answer.usage == Usage(90, 3)
    assert answer.seconds > 1.5  # longer than the patience


def test_signs_of_life_before_the_first_token_are_work():
    def act(talk: Talk) -> None:
        begin(talk)
        for _ in range(10):
            talk.send(b": ping\n\n")
            talk.wait(0.2)
        for line in stream(piece("yes", "stop"), COUNTED):
            talk.send(line)

    with FaultyServer(act) as server:
        assert asker(server).ask(OPEN).value == "yes"
    assert server.questions == 1


def test_a_silent_stream_is_given_up_and_the_server_is_told():
    hung_up: list[bool] = []

    def act(talk: Talk) -> None:
        begin(talk)
        talk.send(stream(piece("I"))[0])
        try:
            hung_up.append(talk._connection.recv(1) == b"")
        except OSError:
            hung_up.append(True)
        raise HungUpError

    with FaultyServer(act) as server:
        begin_s = time.monotonic()
        with pytest.raises(ModelUnavailableError, match="1 attempt within a patience"):
            asker(server).ask(OPEN)
        while not hung_up and time.monotonic() < begin_s + 5.0:
            time.sleep(0.01)
    assert hung_up == [True]
    assert server.questions == 1


def test_half_a_stream_is_asked_for_again():
    def act(talk: Talk) -> None:
        if talk.number == 0:
            begin(talk)
            talk.send(stream(piece("ye"))[0])
        else:
            say(talk, stream(piece("yes", "stop"), COUNTED))

    with FaultyServer(act) as server:
        answer = asker(server).ask(OPEN)
    assert (answer.value, dict(answer.lost)) == ("yes", {"transport": 1})


def test_an_error_within_a_stream_is_the_servers_word():
    error = {"error": {"code": 400, "message": "this prompt exceeds the context size"}}
    with (
        FaultyServer(lambda talk: say(talk, stream(piece("I"), error))) as server,
        pytest.raises(ModelRejectedError, match="larger context"),
    ):
        asker(server).ask(OPEN)


def test_a_server_that_counts_only_whole_answers_is_asked_for_them():
    bodies: list[dict[str, Any]] = []

    def act(talk: Talk) -> None:
        bodies.append(talk.body)
        if talk.body.get("stream"):
            say(talk, stream(piece("yes", "stop")))
        else:
            talk.say("yes")

    with FaultyServer(act) as server:
        chat = asker(server)
        usages = [chat.ask(OPEN).usage for _ in range(2)]
    assert usages == [Usage(100, 5)] * 2
    assert [bool(body.get("stream")) for body in bodies] == [True, False, False]
    assert all("stream_options" not in body for body in bodies[1:])


@pytest.mark.parametrize("refused", ["stream", "stream_options"])
def test_a_server_that_refuses_streams_is_asked_for_whole_answers(refused: str):
    def act(talk: Talk) -> None:
        if refused in talk.body:
            talk.reply(
                {"error": {"message": "Extra inputs are not permitted", "param": refused}}, 400
            )
        else:
            talk.say("yes")

    with FaultyServer(act) as server:
        chat = asker(server)
        assert chat.ask(OPEN).value == "yes"
    assert set(chat.dropped) == {"stream", "stream_options"}


def test_probabilities_come_with_a_stream():
    top = [{"token": "yes", "logprob": -0.1}, {"token": "no", "logprob": -2.4}]
    logprobs = {"content": [{"token": "yes", "logprob": -0.1, "top_logprobs": top}]}
    events = stream(piece("yes", logprobs=logprobs), piece("", "stop"), COUNTED)
    with FaultyServer(lambda talk: say(talk, events)) as server:
        answer = asker(server).ask(CLOSED)
    assert answer.value == "yes"
    assert 0.85 < answer.probabilities["yes"] < 0.95
