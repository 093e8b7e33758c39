"""What the doctor says of servers that refuse, and of models that think before they answer."""

from collections.abc import Callable
from typing import Any

import pytest

from hypernav.app.cli.main import main
from servers.eyes import SeeingBrain
from servers.faulty import FaultyServer, Talk
from servers.scripted import Asked, ScriptedServer, _read_chat


def examine(capsys: pytest.CaptureFixture[str], spec: str, *options: str) -> tuple[int, list[str]]:
    """Exit status and the lines that doctor prints."""
    with pytest.raises(SystemExit) as stop:
        main(["doctor", "--vlm", spec, *options])
    said = capsys.readouterr()
    return int(stop.value.code or 0), (said.out or said.err).splitlines()


class ThinkingEyes:
    """A seeing model that thinks 400 tokens long unless told not to by its template."""

    def __init__(self, family: str = "qwen2.5-vl", *, can_stop: bool = True) -> None:
        self.brain, self.can_stop = SeeingBrain(family), can_stop
        self.bodies: list[dict[str, Any]] = []

    def __call__(self, talk: Talk) -> None:
        body = talk.body
        self.bodies.append(body)
        is_off = body.get("chat_template_kwargs", {}).get("enable_thinking") is False
        thinks = not (is_off and self.can_stop)
        is_cut = thinks and body["max_tokens"] <= 400
        asked = _read_chat(body)
        answer = "ready" if asked.text.startswith("Answer with") else self._answer(asked)
        message = {"role": "assistant", "content": None if is_cut else answer}
        if thinks:
            message["reasoning"] = "It may be anything."
        tokens = body["max_tokens"] if is_cut else 5 + 400 * thinks
        choice = {"message": message, "finish_reason": "length" if is_cut else "stop"}
        usage = {"prompt_tokens": 100, "completion_tokens": tokens}
        talk.reply({"choices": [choice], "usage": usage})

    def _answer(self, asked: Asked) -> str:
        return str(self.brain(asked)) if asked.images else asked.allowed[0]


def test_a_model_that_thinks_is_examined_with_its_switch(capsys: pytest.CaptureFixture[str]):
    eyes = ThinkingEyes()
    with FaultyServer(eyes) as server:
        status, lines = examine(capsys, f"openai:{server.url}")
        spec = f"openai:{server.url}"
    assert (status, lines[-1]) == (0, "all is well")
    (thinking,) = [line for line in lines if " thinking:" in line]
    assert thinking.startswith("note")
    assert "405 tokens for one word; with chat.thinking=off it answers at once" in thinking
    assert f"use it with: --vlm {spec} --set chat.thinking=off" in lines
    first_off = next(n for n, body in enumerate(eyes.bodies) if "chat_template_kwargs" in body)
    assert all("chat_template_kwargs" in body for body in eyes.bodies[first_off:])


def test_the_line_to_use_holds_switch_and_coordinates(capsys: pytest.CaptureFixture[str]):
    with FaultyServer(ThinkingEyes("qwen3-vl")) as server:
        status, lines = examine(capsys, f"openai:{server.url}")
    assert status == 1
    (line,) = [line for line in lines if line.startswith("use it with:")]
    assert line.endswith("--set chat.thinking=off grounding.family=thousandths")


def test_a_model_that_cannot_stop_is_well_with_room(capsys: pytest.CaptureFixture[str]):
    with FaultyServer(ThinkingEyes(can_stop=False)) as server:
        status, lines = examine(capsys, f"openai:{server.url}")
    assert (status, lines[-1]) == (0, "all is well")
    (thinking,) = [line for line in lines if " thinking:" in line]
    assert "also when told not to; each answer gets 1,024 tokens more" in thinking


def test_one_that_thinks_without_end_is_a_fault(capsys: pytest.CaptureFixture[str]):
    def think(talk: Talk) -> None:
        message = {"role": "assistant", "content": None, "reasoning": "And on."}
        talk.reply({"choices": [{"message": message, "finish_reason": "length"}]})

    with FaultyServer(think) as server:
        status, lines = examine(capsys, f"openai:{server.url}")
    assert status == 1
    assert any("thinking took all of 16,384 tokens" in line for line in lines)


REFUSALS: dict[str, tuple[int, str, str]] = {
    "context": (400, "the request exceeds the available context size (512)", "-c 16384"),
    "key": (401, "Incorrect API key provided", "HYPERNAV_API_KEY"),
    "version": (400, "Missing required query parameter: api-version", "/openai/v1"),
    "words": (400, "The model is on holiday", "what the server says tells"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_the_remedy_is_of_what_the_server_said(name: str, capsys: pytest.CaptureFixture[str]):
    status, said, advice = REFUSALS[name]
    act: Callable[[Talk], None] = lambda talk: talk.reply({"error": {"message": said}}, status)  # noqa: E731
    with FaultyServer(act) as server:
        code, lines = examine(capsys, f"openai:{server.url}")
    assert code == 1
    assert any(said in line for line in lines)
    begin = lines.index("what to change:")
    assert advice in "\n".join(lines[begin:])
    assert "name one of the server's models" not in "\n".join(lines)


def test_fields_that_are_left_out_are_named(capsys: pytest.CaptureFixture[str]):
    with ScriptedServer(SeeingBrain()) as server:
        server.personality.rejects = ("temperature",)
        status, lines = examine(capsys, server.spec)
    assert status == 0
    assert any("the server refuses temperature" in line for line in lines)
