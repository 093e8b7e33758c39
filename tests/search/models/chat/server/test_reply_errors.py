"""What refusals mean, as real servers word them."""

import json
import re
from typing import Any

import pytest

from chat_models import image
from hypernav.core.chat import Question
from hypernav.core.errors import ModelRejectedError, ModelSetupError, ModelUnavailableError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.server.reply_errors import _MOST_LAYERS, _message
from servers.faulty import Act, FaultyServer, Talk
from servers.scripted import closed_port

QUICK = ChatConfig(timeout_s=2.0, patience_s=0.4, first_wait_s=0.01, longest_wait_s=0.05)
OPEN = Question("ground", "Locate every bed", (image(),))


def asked(act: Act, url: str = "", **environment: str) -> tuple[Exception | None, int]:
    """The error of a question and how often it was asked."""
    with FaultyServer(act) as server:
        chat = OpenAiChat(url or server.url, "m", QUICK, environment=environment)
        try:
            chat.ask(OPEN)
        except (ModelUnavailableError, ModelSetupError) as error:
            return error, server.questions
        return None, server.questions


LONG = "x" * 300

PERMANENT: dict[str, tuple[Any, type[Exception], str]] = {
    "LM Studio without vision (lmstudio-ai/lms#362)": (
        {
            "error": {"message": "ValueError: Vision add-on is not loaded, but images were given"},
            "message": "Error in iterating prediction stream",
        },
        ModelSetupError,
        "Vision add-on is not loaded.*cannot see",
    ),
    "a proxy whose provider refuses": (
        {"error": {"message": "Provider returned error", "code": 400}},
        ModelRejectedError,
        "answered 2.. with an error: Provider returned error",
    ),
    "the reason in OpenRouter's layers (open-webui/computer#293)": (
        {
            "error": {
                "message": "Provider returned error",
                "code": 400,
                "metadata": {"raw": '{"error": {"message": "image is too dark"}}'},
            }
        },
        ModelRejectedError,
        "image is too dark",
    ),
    "a key in the body of a good reply": (
        {"error": {"message": "No auth credentials found", "code": 401}},
        ModelSetupError,
        "HYPERNAV_API_KEY",
    ),
    "an error within the choice": (
        {"choices": [{"error": {"code": 403, "message": "flagged"}, "message": {"content": ""}}]},
        ModelSetupError,
        "flagged",
    ),
    "words alone": ({"error": "no such thing"}, ModelRejectedError, "no such thing"),
    "an old server": (
        {"object": "error", "message": "the image is broken", "code": 400},
        ModelRejectedError,
        "the image is broken",
    ),
    "a long message": (
        {"error": {"message": f"begin {LONG} middle {LONG} end"}},
        ModelRejectedError,
        f"begin {LONG} middle {LONG} end",
    ),
}


@pytest.mark.parametrize("status", [200, 299])
@pytest.mark.parametrize("name", PERMANENT)
def test_an_error_in_a_good_reply_is_said_at_once(name: str, status: int):
    body, kind, words = PERMANENT[name]
    limits = {"max_tokens": 5, "temperature": 0.0}
    with FaultyServer(lambda talk: talk.reply(body, status)) as server:
        config = QUICK.model_copy(
            update={"patience_s": 60.0, "temperature": None, "seed": None, "extra_body": limits}
        )
        with pytest.raises(kind, match=words):
            OpenAiChat(server.url, "m", config, environment={}).ask(OPEN)
        assert server.questions == 1


@pytest.mark.parametrize(
    "error",
    [
        {"message": "Provider returned error", "code": 502},
        {"message": "Rate limit exceeded", "code": 429},
        {"message": "Rate limit exceeded: free-models-per-min"},
        {"message": "Overloaded", "type": "overloaded_error"},
        "model is loading, please try again",
    ],
)
def test_a_passing_error_in_a_good_reply_is_asked_again(error: Any):
    def act(talk: Talk) -> None:
        if talk.number < 2:
            talk.reply({"error": error})
        else:
            talk.say("a bed")

    assert asked(act) == (None, 3)


def test_an_error_beside_an_empty_choice_is_an_error():
    """OpenRouter answers so where the model's server fails in the middle."""
    choice = {"message": {"role": "assistant", "content": ""}, "finish_reason": "error"}
    body = {"error": {"code": 502, "message": "Upstream CUDA OOM"}, "choices": [choice]}
    caught, times = asked(lambda talk: talk.reply(body))
    assert isinstance(caught, ModelUnavailableError)
    assert "Upstream CUDA OOM" in str(caught)
    assert times > 1


@pytest.mark.parametrize(
    "body",
    [
        {"code": 20012, "message": "Model does not exist", "data": None},
        {"errors": [{"message": "Model does not exist"}]},
        {"error": {"message": "Model does not exist", "retryable": False}},
    ],
)
def test_an_error_in_another_form_is_said_at_once(body: Any):
    caught, times = asked(lambda talk: talk.reply(body))
    assert "Model does not exist" in str(caught)
    assert not isinstance(caught, ModelUnavailableError) or isinstance(caught, ModelRejectedError)
    assert times == 1


KEY, MODEL, CREDIT = "HYPERNAV_API_KEY", "answered", "no credit"
ODD: list[tuple[Any, str]] = [
    ({"detail": "Invalid API key"}, KEY),
    ({"detail": {"error": "Unauthorized"}}, KEY),
    ({"error": "Incorrect API key provided: sk-1***"}, KEY),
    ({"message": "please log in", "code": 401}, KEY),
    ({"message": "please log in", "statusCode": 401}, KEY),
    ({"error": {"message": "no", "type": "invalid_request_error", "code": "invalid_api_key"}}, KEY),
    ({"error": '{"error": {"message": "no", "code": 401}}'}, KEY),
    ({"error_msg": "You didn't provide an API key", "error_code": 6}, KEY),
    ([{"error": {"message": "API key not valid. Please pass a valid API key."}}], KEY),
    (b"data: invalid key", KEY),
    (b"Unauthorized", KEY),
    ({"error": 'model "qwen2.5vl" not found, try pulling it first'}, MODEL),
    ({"message": "The model `Qwen/Qwen2.5-VL-7B` does not exist."}, MODEL),
    ({"error": {"message": "No channel for it", "code": "model_not_found"}}, MODEL),
    ({"detail": "No such model"}, MODEL),
    ({"success": False, "msg": "quota exhausted"}, CREDIT),
    (
        {"error": {"message": "You exceeded your current quota", "type": "insufficient_quota"}},
        CREDIT,
    ),
    ({"error": {"message": "Insufficient Balance"}}, CREDIT),
]


@pytest.mark.parametrize("status", [200, 500, 503])
@pytest.mark.parametrize(("body", "advice"), ODD, ids=[str(body)[:60] for body, _ in ODD])
def test_what_waiting_cannot_mend_is_said_at_once_in_any_form(body: Any, advice: str, status: int):
    caught, questions = asked(lambda talk: talk.reply(body, status))
    assert isinstance(caught, ModelSetupError)
    assert advice in str(caught)
    assert questions == 1


@pytest.mark.parametrize(
    "body",
    [
        {"detail": "Invalid state of the queue"},
        {"error": "the authentication service is unavailable"},
        {"error": {"message": "Quota exceeded for requests per minute", "code": 503}},
        {"error": {"message": "image preprocessing: file not found by the model runner"}},
        {"message": "Internal error", "code": 500},
        {"error": {"message": "invalid token id 32001"}},
        {"error": "Invalid key in the cache"},
        {"error": "Model not found on this replica (still loading), try again"},
        {"error": "GPU memory quota exceeded, temporarily unavailable"},
        {"error": "The model is overloaded. No credentials cached; try again later"},
    ],
)
def test_words_that_only_resemble_those_are_asked_again(body: Any):
    def act(talk: Talk) -> None:
        if talk.number < 1:
            talk.reply(body, 503)
        else:
            talk.say("a bed")

    assert asked(act) == (None, 2)


@pytest.mark.parametrize("status", [408, 429, 499])
def test_a_status_that_says_to_ask_again_counts_for_more_than_a_code_in_the_body(status: int):
    caught, _ = asked(lambda talk: talk.reply({"error": {"message": "no", "code": 401}}, status))
    assert isinstance(caught, ModelUnavailableError)


def test_an_answer_that_is_not_json_is_shown():
    caught, _ = asked(lambda talk: talk.reply(b"<html>Welcome to the guest network</html>"))
    assert "not JSON" in str(caught)
    assert "Welcome to the guest network" in str(caught)


def test_a_wrong_key_with_status_400_costs_one_request():
    """Gemini and xAI answer so."""
    said = "API key not valid. Please pass a valid API key."
    caught, questions = asked(lambda talk: talk.reply({"error": {"message": said}}, 400))
    assert isinstance(caught, ModelSetupError)
    assert "HYPERNAV_API_KEY" in str(caught)
    assert questions == 1


BY_STATUS = {
    402: ("This request requires more credits", "no credit.*add some"),
    407: ("Proxy Authentication Required", "http://NAME:PASSWORD@HOST:PORT"),
    404: ("No endpoints found for qwen/qwen2.5-vl-72b-instruct:free.", "choose another model"),
}


@pytest.mark.parametrize("status", BY_STATUS)
def test_advice_fits_the_status(status: int):
    said, advice = BY_STATUS[status]
    caught, questions = asked(lambda talk: talk.reply({"error": {"message": said}}, status))
    assert isinstance(caught, ModelSetupError)
    assert said in str(caught)
    assert re.search(advice, str(caught))
    assert questions == 1


@pytest.mark.parametrize("end", ["/chat/completions", "/chat/completions/", "/completions"])
def test_a_url_may_end_in_the_endpoint_that_is_asked(end: str):
    with FaultyServer(lambda talk: talk.say("a bed")) as server:
        chat = OpenAiChat(server.url + end, "m", QUICK, environment={})
        assert chat.ask(OPEN).value == "a bed"
        assert chat.url == server.url


def test_an_account_that_is_used_up_is_not_waited_for():
    error = {"message": "You exceeded your current quota", "code": "insufficient_quota"}
    caught, questions = asked(lambda talk: talk.reply({"error": error}, 429))
    assert isinstance(caught, ModelSetupError)
    assert questions == 1
    # Gemini says the same of a limit per minute, and means it.
    error = {"message": "You exceeded your current quota, please check your plan", "code": 429}
    _, questions = asked(lambda talk: talk.reply([{"error": error}], 429))
    assert questions > 1


ADVICE = {
    "the request exceeds the available context size (4096), try increasing it": r"-c 16384",
    "This model's maximum context length is 512 tokens": r"--max-model-len",
    "At most 1 image(s) may be provided in one prompt.": r"--limit-mm-per-prompt",
    "Missing required query parameter: api-version": r"/openai/v1",
}


@pytest.mark.parametrize("said", ADVICE)
def test_advice_fits_what_the_server_says(said: str):
    caught, _ = asked(lambda talk: talk.reply({"error": {"message": said}}, 400))
    assert isinstance(caught, ModelRejectedError)
    assert said in str(caught)
    with pytest.raises(ModelRejectedError, match=ADVICE[said]):
        raise caught


def test_no_endpoint_that_takes_images_is_a_model_that_cannot_see():
    said = {"error": {"message": "No endpoints found that support image input", "code": 404}}
    caught, _ = asked(lambda talk: talk.reply(said, 404))
    assert "cannot see" in str(caught)


def test_fastapi_names_the_field():
    detail = [{"loc": ["body", "messages", 0], "msg": "Field required", "input": {"a": 1}}]
    caught, _ = asked(lambda talk: talk.reply({"detail": detail}, 422))
    assert "body.messages.0: Field required" in str(caught)
    assert "input" not in str(caught)


def test_layers_without_end_are_no_trouble():
    body: Any = "deep"
    for _ in range(400):
        body = {"error": body}
    caught, _ = asked(lambda talk: talk.reply(body, 400))
    assert isinstance(caught, ModelRejectedError)


def test_the_key_does_not_show_in_any_layer():
    raw = '{"error": {"message": "bad key secret-9"}}'
    body = {"error": {"message": "secret-9", "code": 400, "metadata": {"raw": raw}}}
    for status in (200, 400):
        act: Act = lambda talk, status=status: talk.reply(body, status)  # noqa: E731
        caught, _ = asked(act, HYPERNAV_API_KEY="secret-9")
        assert "***" in str(caught)
        assert "secret-9" not in str(caught)


@pytest.mark.parametrize("slash", ["/", r"\/", r"\u002f"])
def test_an_answer_that_holds_the_key_is_kept_without_it(slash: str):
    choice = {"message": {"role": "assistant", "content": "no secret/9 here"}}
    body = json.dumps({"choices": [choice]}).replace("/", slash).encode()
    with FaultyServer(lambda talk: talk.reply(body)) as server:
        chat = OpenAiChat(server.url, "m", QUICK, environment={"HYPERNAV_API_KEY": "secret/9"})
        assert chat.ask(OPEN).text == "no *** here"


@pytest.mark.parametrize("coding", ["utf-16", "utf-16-le", "utf-32"])
def test_an_answer_in_another_coding_is_kept_without_the_key(coding: str):
    choice = {"message": {"role": "assistant", "content": "no secret-9 here"}}
    body = json.dumps({"choices": [choice]}).encode(coding)
    with FaultyServer(lambda talk: talk.reply(body)) as server:
        chat = OpenAiChat(server.url, "m", QUICK, environment={"HYPERNAV_API_KEY": "secret-9"})
        assert chat.ask(OPEN).text == "no *** here"


@pytest.mark.parametrize("key", ["null", "none", "10", "vllm"])
def test_a_placeholder_for_a_key_changes_no_answer(key: str):
    said = "none of 10 is null, says vllm"
    with FaultyServer(lambda talk: talk.say(said)) as server:
        chat = OpenAiChat(server.url, "m", QUICK, environment={"HYPERNAV_API_KEY": key})
        assert chat.ask(OPEN).text == said


def test_azures_version_is_sent_and_its_own_header():
    talks: list[Talk] = []

    def other(talk: Talk) -> None:
        talks.append(talk)
        if talk.method == "POST":
            talk.say("a bed")
        else:
            talk.reply({"error": {"code": "404", "message": "Resource not found"}}, 404)

    with FaultyServer(lambda talk: talk.reply({}, 500), other=other) as server:
        base = server.url.removesuffix("/v1")
        url = f"{base}/openai/deployments/gpt-4o?api-version=2024-10-21"
        chat = OpenAiChat(url, "gpt-4o", QUICK, environment={"HYPERNAV_API_KEY": "k"})
        assert chat.ask(OPEN).value == "a bed"
    posted = talks[-1]
    path = "/openai/deployments/gpt-4o/chat/completions?api-version=2024-10-21"
    assert posted.path == path
    assert posted.headers["api-key"] == "k"


@pytest.fixture
def proxied(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("no_proxy", "")
    monkeypatch.setenv("NO_PROXY", "")


@pytest.mark.usefixtures("proxied")
def test_a_server_on_this_machine_is_asked_without_a_proxy(monkeypatch: pytest.MonkeyPatch):
    with closed_port() as port:
        monkeypatch.setenv("http_proxy", f"http://127.0.0.1:{port}")
        assert asked(lambda talk: talk.say("a bed")) == (None, 1)


@pytest.mark.usefixtures("proxied")
def test_a_proxy_is_named_in_every_error(monkeypatch: pytest.MonkeyPatch):
    with FaultyServer(lambda talk: None, other=lambda talk: talk.reply(b"", 502)) as proxy:
        here = proxy.url.removesuffix("/v1")
        monkeypatch.setenv("http_proxy", here.replace("//", "//me:secret@"))
        caught, _ = asked(lambda talk: None, "http://lab.example/v1")
        assert f"through the proxy {here} answered 502" in str(caught)
        assert "secret" not in str(caught)
    with closed_port() as port:
        monkeypatch.setenv("http_proxy", f"http://127.0.0.1:{port}")
        caught, _ = asked(lambda talk: None, "http://lab.example/v1")
    assert f"through the proxy http://127.0.0.1:{port}: Connection refused" in str(caught)
    assert "no_proxy=lab.example" in str(caught)
    assert "is the server running" not in str(caught)


@pytest.mark.usefixtures("proxied")
@pytest.mark.parametrize("scheme", ["http", "https"])
@pytest.mark.parametrize(("status", "remedy"), [(407, "NAME:PASSWORD"), (403, "no_proxy=|KEY")])
def test_a_proxy_that_refuses_is_no_passing_fault(
    scheme: str, status: int, remedy: str, monkeypatch: pytest.MonkeyPatch
):
    seen: list[str] = []

    def refuse(talk: Talk) -> None:
        seen.append(talk.method)
        talk.reply(b"", status)

    with FaultyServer(refuse, other=refuse) as proxy:
        monkeypatch.setenv(f"{scheme}_proxy", proxy.url.removesuffix("/v1"))
        caught, _ = asked(lambda talk: None, f"{scheme}://lab.example/v1")
    assert isinstance(caught, ModelSetupError)
    assert re.search(remedy, caught.remedy)
    assert len(seen) == 1


@pytest.mark.usefixtures("proxied")
def test_a_proxy_that_cannot_be_used_is_no_passing_fault(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("http_proxy", "gopher://lab:70")
    caught, _ = asked(lambda talk: None, "http://lab.example/v1")
    assert isinstance(caught, ModelSetupError)


def test_words_are_looked_for_in_so_many_layers_only():
    """Each layer holds words, and the next one as OpenRouter's servers nest them."""

    def nested(kind: str) -> object:
        body: object = {"message": "innermost"}
        for number in reversed(range(100)):
            layers = {
                "raw": {"message": f"w{number}.", "metadata": {"raw": body}},
                "text": {"message": f"w{number}.", "metadata": {"raw": json.dumps(body)}},
                "error": {"error": body},
                "list": [{"error": body}],
            }
            body = layers["raw" if kind == "text" and number < 90 else kind]
        return body

    assert _message(nested("raw")).split(": ") == [f"w{k}." for k in range(_MOST_LAYERS - 1)]
    for kind in ("error", "list"):
        assert _message(nested(kind)) == ""
    assert "innermost" not in _message(nested("text"))
