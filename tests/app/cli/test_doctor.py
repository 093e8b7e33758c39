import re
from collections.abc import Iterator

import pytest

from hypernav.app.cli.main import main
from servers.eyes import SeeingBrain
from servers.faulty import Act, FaultyServer, Talk
from servers.scripted import Asked, ScriptedServer, closed_port


@pytest.fixture(scope="module")
def one_server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server:
        yield server


@pytest.fixture
def server(one_server: ScriptedServer) -> ScriptedServer:
    one_server.reset()
    one_server.brain = SeeingBrain()
    return one_server


def examine(capsys: pytest.CaptureFixture[str], spec: str, *options: str) -> tuple[int, list[str]]:
    """Exit status and the lines that doctor prints."""
    with pytest.raises(SystemExit) as stop:
        main(["doctor", "--vlm", spec, *options])
    said = capsys.readouterr()
    return int(stop.value.code or 0), (said.out or said.err).splitlines()


def faults(lines: list[str]) -> list[str]:
    return [line for line in lines if line.startswith("FAULT")]


def test_a_healthy_server_is_well(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    status, lines = examine(capsys, server.spec)
    assert (status, lines[-1]) == (0, "all is well")
    for word in ("server", "model name", "images", "coordinates", "constraints"):
        assert any(line.startswith(f"ok    {word}:") for line in lines)
    timed = [line for line in lines if "tokens in" in line]
    assert [kind for line in timed for kind in ("ground", "choose block", "verify") if kind in line]
    assert len(timed) == 3
    for word in ("maps", "presence"):
        assert any(line.startswith(f"ok    {word}:") for line in lines)
    pace = next(line for line in lines if line.startswith("ok    pace:"))
    assert re.search(r"an answer takes .* search of about 53 questions", pace)


@pytest.mark.parametrize(
    "options",
    [
        ("block_choice.mode=paper", "overview.strong_colors=false", "overview.draw_frontier=false"),
        ("block_choice.mode=constrained", "overview.clear_numbers=false"),
    ],
)
def test_the_questions_of_other_configurations_are_asked(
    server: ScriptedServer, options: tuple[str, ...], capsys: pytest.CaptureFixture[str]
):
    assert examine(capsys, server.spec, "--set", *options)[0] == 0


class Blind(SeeingBrain):
    """Guesses colours."""

    def __call__(self, asked: Asked) -> str:
        return "Green" if asked.text.startswith("What colour") else super().__call__(asked)


class MapBlind(SeeingBrain):
    """Always goes to the second block."""

    def __call__(self, asked: Asked) -> str:
        is_map = asked.kind == "choose block"
        return "It looks promising.\nAnswer: 2" if is_map else super().__call__(asked)


class AlwaysYes(SeeingBrain):
    """Sees whatever it is asked about."""

    def __call__(self, asked: Asked) -> str:
        return "yes" if asked.kind == "verify" else super().__call__(asked)


class Talkative(SeeingBrain):
    """Answers what it likes where only some answers are allowed."""

    def __call__(self, asked: Asked) -> str:
        return "That depends on how one looks at it." if asked.allowed else super().__call__(asked)


@pytest.mark.parametrize(
    ("brain", "check", "honours"),
    [
        (Blind(), "images", True),
        (MapBlind(), "maps", True),
        (AlwaysYes(), "presence", True),
        (SeeingBrain(scale=0.6), "coordinates", True),
        (Talkative(), "constraints", False),
    ],
    ids=["blind", "cannot read maps", "always yes", "wrong coordinates", "ignores what is allowed"],
)
def test_bad_models_are_found_out(
    server: ScriptedServer,
    brain: SeeingBrain,
    check: str,
    honours: bool,
    capsys: pytest.CaptureFixture[str],
):
    server.brain = brain
    if not honours:
        server.personality.honours = ()
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert check in faults(lines)[0].split(":")[0]


def test_broken_1_wrong_url(capsys: pytest.CaptureFixture[str]):
    with closed_port() as port:
        status, lines = examine(capsys, f"openai:http://127.0.0.1:{port}/v1")
    assert status == 1
    (fault,) = faults(lines)
    assert "server:" in fault
    assert "Connection refused" in fault
    assert "Errno" not in fault
    assert "correct the URL" in lines[-1]


def test_a_url_without_its_path(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    status, lines = examine(capsys, server.spec.removesuffix("/v1"))
    assert status == 1
    assert f"try {server.spec}" in faults(lines)[0]


def test_broken_2_wrong_model_name(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    status, lines = examine(capsys, f"{server.spec}#scripted/Qwen2-VL-7B")
    assert status == 1
    (fault,) = faults(lines)
    assert "model name:" in fault
    assert f"try {server.spec}#scripted/Qwen2.5-VL-7B" in fault


def test_broken_3_no_vision(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.personality.sees = False
    status, lines = examine(capsys, server.spec)
    assert status == 1
    (fault,) = faults(lines)
    assert "images:" in fault
    assert "no vision" in fault


def test_images_that_are_dropped_silently(
    server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    eyes = SeeingBrain()
    server.brain = lambda asked: "I see no picture." if asked.images else eyes(asked)
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert "blue is 'I see no picture.'" in faults(lines)[0]


@pytest.mark.parametrize("family", ["thousandths", "unit", "gemini"])
def test_broken_4_wrong_coordinate_space(
    server: ScriptedServer, family: str, capsys: pytest.CaptureFixture[str]
):
    server.brain = SeeingBrain(family)
    status, lines = examine(capsys, server.spec)
    assert status == 1
    (fault,) = faults(lines)
    assert "coordinates:" in fault
    assert "wrong when read as 'qwen2.5-vl'" in fault
    remedy = lines[-1].rpartition("--set ")[2]
    assert examine(capsys, server.spec, "--set", remedy)[0] == 0


def test_a_server_that_shrinks_images(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.brain = SeeingBrain(scale=0.5)
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert "0.50 times" in faults(lines)[0]
    assert "limit of pixels" in lines[-1]


def test_a_model_of_an_unknown_family(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.personality.models = ("wise-owl",)
    server.brain = SeeingBrain("thousandths")
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert "the name 'wise-owl' does not tell" in faults(lines)[0]
    assert "grounding.family=" in lines[-1]


def test_broken_5_ignores_constraints(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.personality.honours = ()
    status, lines = examine(capsys, server.spec)
    assert status == 1
    (fault,) = faults(lines)
    assert "constraints:" in fault
    assert "ignores constraints" in fault
    assert "--set chat.dialect=" in lines[-1]


def test_a_server_that_rejects_constraints(
    server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    server.personality.rejects = ("structured_outputs", "logprobs")
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert "rejects constraints" in faults(lines)[0]


def test_a_server_that_loads_its_model_is_waited_for(capsys: pytest.CaptureFixture[str]):
    def models(talk: Talk) -> None:
        error = {"code": 503, "message": "Loading model", "type": "unavailable_error"}
        talk.reply({"error": error}, 503)

    with FaultyServer(lambda talk: talk.say("ready"), models=models) as loading:
        status, lines = examine(capsys, f"openai:{loading.url}")
    assert status == 1
    assert "Loading model" in faults(lines)[0]
    assert any(line.startswith("  server: wait") for line in lines)
    assert not any("start the server" in line for line in lines)


def test_a_name_that_is_not_on_the_servers_list(
    server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    def models(owner: str) -> Act:
        entry = {"id": "/models/Qwen.gguf", "aliases": ["qwen"], "owned_by": owner}
        return lambda talk: talk.reply({"data": [entry]})

    for owner, name, expected in (
        ("llamacpp", "foo", "FAULT model name:"),
        ("llamacpp", "Qwen", "ok    model name:"),
        ("llamacpp", "qwen", "ok    model name:"),
        ("somebody", "foo", "note  model name:"),
    ):
        with FaultyServer(lambda talk: talk.say("ready"), models=models(owner)) as named:
            _, lines = examine(capsys, f"openai:{named.url}#{name}")
        assert any(line.startswith(expected) for line in lines), (owner, name, lines)


def test_a_hanging_server_is_given_up(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.plan.append("hang")
    status, lines = examine(capsys, server.spec, "--set", "chat.timeout_s=0.2")
    assert status == 1
    told = re.search(r": no answer within ([0-9.]+) s$", faults(lines)[0])
    assert told
    assert 0.2 <= float(told[1]) < 10.0  # what it waited, which a busy machine prolongs


def broken_list(talk: Talk) -> None:
    talk.reply({"error": "no cache folder"}, 500)


def test_a_broken_list_of_models_is_told(capsys: pytest.CaptureFixture[str]):
    with FaultyServer(lambda talk: talk.say("ready"), models=broken_list) as server:
        _, lines = examine(capsys, f"openai:{server.url}#m/Qwen2.5-VL")
    (told,) = [line for line in lines if " server: " in line]
    assert told.startswith("note")
    assert "answered 500: no cache folder" in told


def test_an_answer_without_words_is_not_blamed_on_the_eyes(capsys: pytest.CaptureFixture[str]):
    with FaultyServer(lambda talk: talk.say(None)) as server:
        status, lines = examine(capsys, f"openai:{server.url}")
    assert status == 1
    assert "answers, but the answer is empty" in faults(lines)[0]
    assert "whether it sees cannot be told" in faults(lines)[1]
    assert not any("no vision" in line for line in lines)


def test_content_in_parts_is_seen(capsys: pytest.CaptureFixture[str]):
    eyes = iter(["ready", "blue", "green"])

    def say(talk: Talk) -> None:
        talk.say([{"type": "text", "text": next(eyes, "[]")}])

    with FaultyServer(say) as server:
        _, lines = examine(capsys, f"openai:{server.url}")
    assert any("it tells blue from green" in line for line in lines)


def test_a_missing_key_is_named(server: ScriptedServer, capsys: pytest.CaptureFixture[str]):
    server.personality.key = "secret"
    status, lines = examine(capsys, server.spec)
    assert status == 1
    assert "HYPERNAV_API_KEY" in faults(lines)[0]


@pytest.mark.parametrize("spec", ["http://localhost/v1", "replay:a.jsonl"])
def test_bad_usage_is_exit_status_2(spec: str, capsys: pytest.CaptureFixture[str]):
    assert examine(capsys, spec)[0] == 2
