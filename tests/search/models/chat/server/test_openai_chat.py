import logging
import threading
import time

import numpy as np
import pytest

from chat_models import image
from hypernav.core.chat import Fault, Question, Usage
from hypernav.core.errors import (
    ConfigError,
    ModelRejectedError,
    ModelSetupError,
    ModelUnavailableError,
)
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.recording import RecordingChat, ReplayChat
from hypernav.search.models.chat.server.dialects import DIALECTS
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from servers.faulty import Act, FaultyServer, Talk, list_models
from servers.scripted import (
    TRANSPORT_FAILURES,
    Failure,
    Personality,
    Said,
    ScriptedServer,
    closed_port,
)

QUICK = ChatConfig(timeout_s=2.0, patience_s=5.0, first_wait_s=0.01, longest_wait_s=0.05)
WHICH = Question(
    "choose block", "Which numbered block?", (image(),), ("3", "7", "12"), max_tokens=8
)
OPEN = Question("ground", "Locate every bed", (image(1),))


def chat(server: ScriptedServer, config: ChatConfig = QUICK, **environment: str) -> OpenAiChat:
    return OpenAiChat(server.url, None, config, environment=environment)


def test_asks_and_counts(server: ScriptedServer):
    server.brain = lambda asked: "a bed in the corner"
    answer = chat(server).ask(OPEN)
    assert (answer.text, answer.value, answer.model) == (
        "a bed in the corner",
        "a bed in the corner",
        "scripted/Qwen2.5-VL-7B",
    )
    assert answer.usage.tokens_in > 0
    assert answer.usage.tokens_out == 5
    assert answer.attempts == 1
    assert answer.seconds > 0.0


@pytest.mark.parametrize("name", sorted(DIALECTS))
def test_an_answer_is_asked_for_piece_by_piece_where_the_server_can_send_it_so(
    server: ScriptedServer, name: str
):
    chat(server, QUICK.model_copy(update={"dialect": name})).ask(OPEN)
    assert bool(server.requests[0].body.get("stream")) == (name != "transformers")


def test_the_server_sees_the_image_in_its_size_and_nearly_its_colours(server: ScriptedServer):
    smooth = np.linspace(0, 255, 64 * 48 * 3).reshape(48, 64, 3).astype(np.uint8)
    chat(server).ask(Question("ground", "Locate", (smooth, image(2, 28, 56))))
    sent, other = server.requests[0].images
    assert sent.shape == (48, 64, 3)
    assert other.shape == (28, 56, 3)
    assert np.abs(sent.astype(int) - smooth).mean() < 2.0


@pytest.mark.parametrize("name", sorted(DIALECTS))
def test_every_dialect_gets_an_allowed_answer_from_its_server(server: ScriptedServer, name: str):
    dialect = DIALECTS[name]
    field = {"json": "response_format", "none": ""}.get(dialect.choice, dialect.choice)
    server.personality = Personality(
        owned_by="somebody",
        honours=(field,) if field else (),
        systemone=dialect.decision == "systemone",
        decisions=dialect.decision == "decisions",
    )
    server.brain = lambda asked: "7" if not field else "Let me see. I would go to 7 I think"
    answer = chat(server, QUICK.model_copy(update={"dialect": name})).ask(WHICH)
    assert answer.value == "7" if not dialect.decision else answer.value in WHICH.allowed
    assert answer.fault is None


@pytest.mark.parametrize(
    ("personality", "dialect"),
    [
        (Personality("vllm", version="0.12.1"), "vllm"),
        (Personality("vllm", version="0.9.2"), "vllm-guided"),
        (Personality("vllm", version=""), "vllm"),
        (Personality("sglang"), "sglang"),
        (Personality("llamacpp"), "llamacpp"),
        (Personality("library"), "ollama"),
        (Personality("organization_owner"), "openai"),
        (Personality("Qwen", systemone=True), "transformers"),
    ],
)
def test_finds_out_what_the_server_is(
    server: ScriptedServer, personality: Personality, dialect: str
):
    server.personality = personality
    found = chat(server).server()
    assert found.dialect.name == dialect
    assert found.model == "scripted/Qwen2.5-VL-7B"


@pytest.mark.parametrize(
    "personality",
    [
        Personality("vllm"),
        Personality("library"),
        Personality("Qwen", honours=(), systemone=True),
    ],
)
def test_probabilities_of_allowed_answers(server: ScriptedServer, personality: Personality):
    server.personality = personality
    server.brain = lambda asked: Said("12", {"3": 0.25, "7": 0.125, "12": 0.625})
    answer = chat(server).ask(WHICH)
    assert answer.value == "12"
    assert dict(answer.probabilities) == pytest.approx({"3": 0.25, "7": 0.125, "12": 0.625})


def test_decisions_of_the_openai_form(server: ScriptedServer):
    server.personality = Personality("openai", decisions=True)
    server.brain = lambda asked: Said("3", {"3": 0.5, "7": 0.25, "12": 0.25})
    answer = chat(server, QUICK.model_copy(update={"dialect": "decisions"})).ask(WHICH)
    assert (answer.value, answer.usage) == ("3", Usage(90, 0))
    assert answer.probabilities["7"] == pytest.approx(0.25)
    assert len(server.requests[0].images) == 1


def test_a_server_that_ignores_constraints_is_found_out(server: ScriptedServer):
    server.personality = Personality("vllm", honours=())
    server.brain = lambda asked: "The robot could go to 3 or perhaps to 7."
    assert chat(server).ask(WHICH).fault is Fault.UNPARSABLE
    server.brain = lambda asked: "99"
    assert chat(server).ask(WHICH).fault is Fault.INVALID


@pytest.mark.parametrize(
    "rejects", [("structured_outputs",), ("logprobs",), ("seed",), ("logprobs", "temperature")]
)
def test_fields_that_a_server_rejects_are_left_out_from_then_on(
    server: ScriptedServer, rejects: tuple[str, ...]
):
    server.personality = Personality(rejects=rejects)
    server.brain = lambda asked: "7"
    asker = chat(server)
    assert asker.ask(WHICH).value == "7"
    assert asker.dropped
    before = len(server.failures)
    assert asker.ask(WHICH).value == "7"
    assert len(server.failures) == before + 1


def test_a_request_that_is_wrong_anyway_loses_no_fields(server: ScriptedServer):
    server.personality = Personality(rejects=("messages",))
    asker = chat(server)
    with pytest.raises(ModelRejectedError, match="unknown field: messages"):
        asker.ask(WHICH)
    assert asker.dropped == ()


@pytest.mark.parametrize("failure", TRANSPORT_FAILURES)
def test_what_gets_lost_is_asked_again(server: ScriptedServer, failure: Failure):
    server.brain = lambda asked: "7"
    asker = chat(server)
    asker.server()
    server.plan.extend([failure, failure])
    answer = asker.ask(WHICH)
    assert (answer.value, answer.attempts) == ("7", 3)
    assert server.failures == [failure, failure, "ok"]


def test_a_hanging_server_is_asked_again_after_the_timeout(server: ScriptedServer):
    server.brain = lambda asked: "7"
    server.plan.append("hang")
    asker = chat(server, QUICK.model_copy(update={"timeout_s": 0.3}))
    answer = asker.ask(WHICH)
    assert (answer.value, answer.attempts) == ("7", 2)


def test_a_slow_answer_is_not_asked_for_twice_while_the_server_is_there(server: ScriptedServer):
    server.brain = lambda asked: "7"
    server.delay_s = 1.0
    answer = chat(server, QUICK.model_copy(update={"timeout_s": 0.2})).ask(WHICH)
    assert (answer.value, answer.attempts, len(server.requests)) == ("7", 1, 1)


@pytest.mark.parametrize("failure", [*TRANSPORT_FAILURES, "hang"])
def test_a_model_that_stays_away_is_unavailable(server: ScriptedServer, failure: Failure):
    server.rates = {failure: 1.0}
    asker = chat(server, QUICK.model_copy(update={"patience_s": 1.5, "timeout_s": 0.3}))
    asker.server()
    with pytest.raises(ModelUnavailableError, match=r"within a patience of 1\.5 s"):
        asker.ask(WHICH)
    assert len(server.failures) >= 2


def test_a_server_that_is_not_there():
    with closed_port() as port:
        asker = OpenAiChat(f"http://127.0.0.1:{port}/v1", "m", ChatConfig(patience_s=0.0))
        with pytest.raises(ModelUnavailableError, match="is the server running"):
            asker.ask(OPEN)


def test_a_server_that_comes_back_within_the_patience_loses_nothing():
    with ScriptedServer(lambda asked: "7") as server:
        asker = chat(server, QUICK.model_copy(update={"patience_s": 20.0}))
        assert asker.ask(WHICH).value == "7"
        server.stop()
        back = threading.Timer(0.5, server.start)
        back.start()
        try:
            answer = asker.ask(WHICH)
        finally:
            back.join()
        assert answer.value == "7"
        assert answer.attempts > 1


def test_a_refusal_is_a_fault_not_an_error(server: ScriptedServer):
    server.plan.append("refuse")
    answer = chat(server).ask(OPEN)
    assert answer.fault is Fault.REFUSED
    assert "I must not look" in answer.detail


def test_wrong_model_name_names_the_right_one(server: ScriptedServer):
    asker = OpenAiChat(server.url, "Qwen2.5-VL-7B-Instruct", QUICK, environment={})
    with pytest.raises(ModelSetupError, match=r"try openai:.*#scripted/Qwen2\.5-VL-7B"):
        asker.ask(OPEN)


def test_several_models_need_a_name(server: ScriptedServer):
    server.personality = Personality(models=("a", "b"))
    with pytest.raises(ModelSetupError, match=r"several models \(a, b\); name one"):
        chat(server).ask(OPEN)
    for unnamed in ((), ("",)):
        server.personality = Personality(models=unnamed)
        with pytest.raises(ModelSetupError, match="lists no model"):
            chat(server).ask(OPEN)


@pytest.mark.parametrize("status", [301, 307, 401, 402, 403, 404, 405, 410, 451])
def test_a_wrong_url_or_key_is_said_at_once(status: int):
    with FaultyServer(lambda talk: talk.reply({"error": "no"}, status)) as server:
        with pytest.raises(ModelSetupError, match=rf"answered {status}: ") as caught:
            OpenAiChat(server.url, None, QUICK, environment={}).ask(OPEN)
        assert server.questions == 1
    assert ("HYPERNAV_API_KEY" in str(caught.value)) == (status in {401, 403})


@pytest.mark.parametrize("status", [404, 500])
def test_a_named_model_needs_no_list(status: int):
    no_list: Act = lambda talk: talk.reply({"error": "broken"}, status)  # noqa: E731
    with FaultyServer(lambda talk: talk.say("a bed"), models=no_list) as server:
        asker = OpenAiChat(server.url, "m", QUICK, environment={})
        assert asker.ask(OPEN).value == "a bed"
        assert f"answered {status}: broken" in asker.server().list_fault


@pytest.mark.parametrize(
    "retry_after", ["nan", "inf", "-5", "0", "1e999", "9" * 400, "soon", "Wed, 21 Oct 2015"]
)
def test_no_retry_after_makes_us_ask_too_often_or_never(retry_after: str):
    def busy(talk: Talk) -> None:
        if talk.number < 3:
            talk.reply({"error": "busy"}, 429, retry_after=retry_after)
        else:
            talk.say("a bed")

    waits: list[float] = []
    with FaultyServer(busy) as server:
        asker = OpenAiChat(server.url, None, ChatConfig(), environment={}, sleep=waits.append)
        assert asker.ask(OPEN).value == "a bed"
    assert all(0.5 <= wait <= 8.0 for wait in waits)
    assert waits == sorted(waits)


def test_detection_and_question_share_one_patience():
    def late(talk: Talk) -> None:
        talk.wait(0.6)
        list_models(talk)

    config = QUICK.model_copy(update={"patience_s": 1.0})
    with FaultyServer(lambda talk: talk.wait(), models=late) as server:
        begin = time.monotonic()
        with pytest.raises(ModelUnavailableError, match="patience of 1 s"):
            OpenAiChat(server.url, None, config, environment={}).ask(OPEN)
        assert time.monotonic() - begin < 1.5


def test_nesting_that_no_parser_follows_is_a_broken_answer():
    with FaultyServer(lambda talk: talk.reply(b"[" * 200_000)) as server:
        asker = OpenAiChat(server.url, None, ChatConfig(patience_s=0.0), environment={})
        with pytest.raises(ModelUnavailableError, match="not JSON"):
            asker.ask(OPEN)


@pytest.mark.parametrize("model", [None, "scripted/Qwen2.5-VL-7B"])
def test_forgotten_version_in_the_url(server: ScriptedServer, model: str | None):
    asker = OpenAiChat(server.url.removesuffix("/v1"), model, QUICK, environment={})
    end = f"#{model}" if model else ""
    with pytest.raises(ModelSetupError, match=rf"try openai:{server.url}{end}$"):
        asker.ask(OPEN)


def test_a_model_without_eyes(server: ScriptedServer):
    server.personality = Personality("llamacpp", sees=False)
    with pytest.raises(ModelSetupError, match="cannot see"):
        chat(server).ask(OPEN)


def test_the_key_comes_from_the_environment(server: ScriptedServer):
    server.personality = Personality(key="secret-1")
    server.brain = lambda asked: "7"
    assert chat(server, HYPERNAV_API_KEY="secret-1").ask(WHICH).value == "7"
    assert chat(server, OPENAI_API_KEY="secret-1").ask(WHICH).value == "7"
    both = chat(server, HYPERNAV_API_KEY="secret-1", OPENAI_API_KEY="other")
    assert both.ask(WHICH).value == "7"


@pytest.mark.parametrize("key", ["line\n", "Schlüssel", "\udcff"])
def test_a_key_that_no_request_can_carry_is_refused_and_not_shown(key: str):
    with pytest.raises(ConfigError, match="characters that HTTP does not allow") as caught:
        OpenAiChat("http://localhost:1/v1", "m", environment={"HYPERNAV_API_KEY": key})
    assert key not in str(caught.value)


def test_the_key_never_shows(server: ScriptedServer, caplog: pytest.LogCaptureFixture):
    caplog.set_level(logging.DEBUG)
    server.personality = Personality(key="right")
    asker = chat(server, HYPERNAV_API_KEY="secret-2")
    with pytest.raises(ModelSetupError, match="HYPERNAV_API_KEY") as caught:
        asker.ask(OPEN)
    assert "Incorrect key: ***" in str(caught.value)
    server.personality = Personality()
    server.plan.extend(["500", "429", "reset"])
    asker.ask(OPEN)
    assert "secret-2" not in caplog.text
    assert "secret-2" not in str(caught.value)


def test_an_openai_key_is_not_sent_in_the_clear_to_strangers():
    environment = {"OPENAI_API_KEY": "secret-3"}
    for url, sent in [
        ("http://lab:8000/v1", ""),
        ("https://lab/v1", "secret-3"),
        ("http://localhost:1/v1", "secret-3"),
    ]:
        assert OpenAiChat(url, "m", environment=environment)._client._key == sent


@pytest.mark.parametrize(
    ("url", "hint"),
    [
        ("localhost:8000", "not a server's URL"),
        ("ftp://lab/v1", "not a server's URL"),
        ("http://", "not a server's URL"),
        ("http://lab:99999/v1", "not a server's URL"),
        ("http://me:secret@lab/v1", "HYPERNAV_API_KEY"),
        ("http://lab/v1?key=secret", "HYPERNAV_API_KEY"),
    ],
)
def test_urls_that_cannot_be_used(url: str, hint: str):
    with pytest.raises(ConfigError, match=hint) as caught:
        OpenAiChat(url)
    assert "me:secret" not in str(caught.value)


@pytest.mark.slow
def test_ten_percent_faults_lose_no_question(server: ScriptedServer):
    server.brain = lambda asked: "7"
    server.rates = {"429": 0.03, "500": 0.03, "reset": 0.02, "half": 0.01, "broken json": 0.01}
    asker = chat(server)
    answers = [asker.ask(WHICH) for _ in range(150)]
    assert all(answer.value == "7" for answer in answers)
    assert sum(answer.attempts for answer in answers) == len(server.failures)
    assert len(server.failures) > 150


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("<|begin_of_box|>yes<|end_of_box|>", "yes"),
        ("Is it there? No. Wait,</think>\n\nyes", "yes"),
        ("<answer>no</answer>", "no"),
    ],
)
def test_an_answer_is_read_without_its_wrappings(server: ScriptedServer, said: str, value: str):
    server.brain = lambda asked: Said(said, {"no": 0.9, "yes": 0.1})
    config = QUICK.model_copy(update={"dialect": "plain"})
    answer = chat(server, config).ask(
        Question("verify", "Is it there?", allowed=("yes", "no"), max_tokens=64)
    )
    assert (answer.value, answer.fault) == (value, None)
    assert answer.probabilities.get(value, 1.0) > 0.5


def test_thinking_that_the_prompt_began_and_the_limit_ended_is_no_answer(
    server: ScriptedServer, tmp_path
):
    """Nothing in the text says that it is thinking; also when it is replayed."""
    server.brain = lambda asked: (
        "I have to find every bed. The thing at [1, 2, 30, 40] is" + "." * 99
    )
    question = Question("ground", "Locate every bed", (image(1),), max_tokens=20, at_once=True)
    path = tmp_path / "a.jsonl"
    recording = RecordingChat(chat(server), path)
    recording.identify()
    first = recording.ask(question)
    recording.close()
    for answer in (first, ReplayChat(path).ask(question)):
        assert answer.fault is Fault.CUT
        assert "chat.thinking" in answer.detail
