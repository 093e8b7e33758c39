"""All that the program asks, asked of llama.cpp's own server with a Qwen2.5-VL of random weights.

What it says is nonsense; what is tested is that the two understand each other.
"""

import json
import logging
import re
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from forwarder import Forwarder

from chat_models import image
from hypernav.app.cli.main import main
from hypernav.core.chat import Question
from hypernav.core.errors import (
    ModelRejectedError,
    ModelSetupError,
    ModelUnavailableError,
)
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.io.bounded_http import Deadline
from hypernav.lab.exam import bank
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.message_parts import jpeg_data_url
from hypernav.search.models.chat.server.http_client import HttpClient
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.server.reply_errors import RefusedError
from hypernav.search.perception.config import VlmDetectorConfig
from hypernav.search.perception.local.vlm_detector import VlmDetector

SMALL = (
    *("embodiment.camera.width=160", "embodiment.camera.height=120"),
    *("grounding.max_tokens=16", "block_choice.max_tokens=16"),
)
STEPS = 20
ROOM = Question("other", "Which room is this?", (image(),), ("kitchen", "bedroom", "hall"))
LONG = Question("other", "Tell me all.", (image(0, 480, 640),), max_tokens=7000)
QUOTAS = {
    **{("block", "map"): 4, ("boxes", "near"): 4, ("boxes", "absent"): 2},
    **{("presence", "there"): 2, ("presence", "not there"): 2},
    **{("near", "near"): 1, ("near", "far"): 1, ("arrow", "view"): 1, ("direction", "view"): 1},
    **{("images", "shown"): 1, ("images", "none"): 1},
}


def asker(url: str, name: str | None = None, **changes: Any) -> OpenAiChat:
    return OpenAiChat(url, name, ChatConfig(**changes), environment={})


def run(*command: str) -> int:
    with pytest.raises(SystemExit) as stop:
        main(list(command))
    return int(stop.value.code or 0)


def is_busy(root: str) -> bool:
    with urllib.request.urlopen(f"{root}/slots") as reply:
        return any(slot["is_processing"] for slot in json.load(reply))


def until(is_so: Callable[[], bool], limit_s: float = 10.0) -> bool:
    end = time.monotonic() + limit_s
    while not (so := is_so()) and time.monotonic() < end:
        time.sleep(0.02)
    return so


def test_doctor_says_what_it_is_and_that_it_sees_nothing(
    llamacpp, capsys: pytest.CaptureFixture[str]
):
    assert run("doctor", "--vlm", llamacpp.spec) == 1
    said = capsys.readouterr().out
    assert "speaks the dialect 'llamacpp'" in said
    assert re.search(r"ok    model name: .*Qwen2\.5-VL-random.gguf answers", said)
    assert "no vision: asked about plain colours" in said
    assert "ok    constraints:             only what is allowed comes back" in said
    assert "fields" not in said  # it takes all that is sent


def test_a_search_asks_nothing_twice_and_ends_honestly(llamacpp, tmp_path: Path):
    out = tmp_path / "out"
    with Forwarder(llamacpp.root) as between:
        command = ("find", "bed", "--seed", "2", "--vlm", f"openai:{between.url}")
        settings = ("--max-steps", str(STEPS), "--out", str(out), "--quiet", "--set", *SMALL)
        assert run(*command, *settings) == 1
        asked = len(between.questions)
        assert between.paths.count("/v1/models") == 1
    result = json.loads((out / "result.json").read_text())
    total = result["ledger"]["total"]
    assert (result["outcome"], result["steps"]) == ("not_found", STEPS)
    assert total["calls"] == asked >= STEPS
    assert total["retries"] == 0
    assert total["tokens_in"] > 20 * STEPS


def test_an_exam(llamacpp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bank, "QUICK", QUOTAS)
    who = ("--vlm", llamacpp.spec, "--bank", "train", "--predict", "0", "--out", str(tmp_path))
    assert run("exam", *who, "--set", *SMALL, "block_choice.mode=constrained") == 0
    result = json.loads((tmp_path / "exam.json").read_text())
    assert result["count"] == result["wanted"] == 20
    marks = {one["kind"]: one for one in result["types"]}
    assert set(marks) == {"block", "boxes", "presence", "near", "arrow", "direction", "images"}
    assert not marks["block"]["unusable"]


def test_a_constraint_holds_and_no_probability_is_invented(llamacpp):
    """Its probabilities are those before the constraint, of 20 tokens."""
    chat = asker(llamacpp.url)
    for labels in (ROOM.allowed, ("yes", "no"), tuple(map(str, range(1, 13)))):
        answer = chat.ask(Question("other", "Which?", ROOM.images, labels, max_tokens=8))
        assert answer.value in labels
        assert all(0.0 < share < 1.0 for share in answer.probabilities.values())
    assert chat.dropped == ()


def test_several_images_are_all_seen(llamacpp):
    chat = asker(llamacpp.url)

    def tokens(count: int) -> int:
        images = tuple(image(seed, 112, 168) for seed in range(count))
        return chat.ask(Question("other", "Which?", images, max_tokens=2)).usage.tokens_in

    each = 112 // 28 * 168 // 28 + 2  # with the marks of its begin and end
    counted = [tokens(count) for count in (0, 1, 2, 6)]
    assert np.diff(counted).tolist() == [each, each, 4 * each]


@pytest.mark.parametrize(("least", "sent"), [((), (644, 476)), (("1024",), (1064, 784))])
def test_boxes_are_read_at_the_size_at_which_the_model_saw_the_image(
    start_llamacpp, least: tuple[str, ...], sent: tuple[int, int]
):
    """``--image-min-tokens``, as the server asks for itself in its log, enlarges images."""
    with start_llamacpp(*least) as server:
        server.wait()
        with Forwarder(server.root) as between:
            log = ExchangeLog()
            config = VlmDetectorConfig(max_tokens=16, family="qwen2.5-vl")
            detector = VlmDetector(asker(between.url), log, config)
            camera = PinholeCamera.from_hfov(640, 480, 79.0)
            depth = np.ones((480, 640), np.float32)
            where = (Transform.identity(), Pose2(0.0, 0.0, 0.0))
            seen = Observation(image(0, 480, 640), depth, camera, *where)
            for _ in range(2):
                detector.detect(seen, Goal("bed"))
        assert detector.family.sent_size(640, 480) == sent
        grounded = [one for one in log.drain() if one.kind == "ground"]
        assert len(grounded) == (3 if least else 2)
        first, second = sorted(one.tokens_in for one in grounded)[-2:]
        assert first == second  # sent as large as the server would make it, it stays as it is


def test_a_prompt_that_is_too_long_is_refused_at_once(llamacpp):
    with pytest.raises(ModelRejectedError, match=r"larger context than the server has"):
        asker(llamacpp.url).ask(Question("other", "word " * 3000))


@pytest.mark.parametrize("name", ["foo", "Qwen3-VL-8B"])
def test_a_wrong_name_is_refused_since_the_server_takes_any(llamacpp, name: str):
    with pytest.raises(ModelSetupError, match=r"would answer as 'Qwen2\.5-VL-random'"):
        asker(llamacpp.url, name).ask(ROOM)
    for right in ("Qwen2.5-VL-random.gguf", "qwen2.5-vl-random"):
        assert asker(llamacpp.url, right).ask(ROOM).fault is None


def test_a_broken_image_is_refused(llamacpp):
    client = HttpClient(llamacpp.url, ChatConfig(), {})
    broken = {"type": "image_url", "image_url": {"url": jpeg_data_url(image())[:60]}}
    body = {"messages": [{"role": "user", "content": [broken]}], "max_tokens": 2}
    with pytest.raises(RefusedError, match="Failed to load image"):
        client.post("chat/completions", body, Deadline(10.0))


def test_501_means_that_there_is_no_such_endpoint(llamacpp):
    client = HttpClient(llamacpp.url, ChatConfig(), {})
    with pytest.raises(RefusedError, match="answered 501: This model is not a decision model"):
        client.post("systemone", {}, Deadline(10.0))
    with Forwarder(llamacpp.root, owner="acme") as between:
        chat = asker(between.url)
        answer = chat.ask(ROOM)
        assert (answer.fault, answer.attempts) == (None, 1)
        assert chat.server().dialect.name == "openai"
        assert between.paths == ["/v1/models", "/v1/systemone", "/v1/chat/completions"]


def test_a_server_that_loads_its_model_is_waited_for(
    start_llamacpp, caplog: pytest.LogCaptureFixture
):
    caplog.set_level(logging.WARNING)
    with start_llamacpp() as server:
        chat = asker(server.url, first_wait_s=0.01, longest_wait_s=0.02, patience_s=60.0)
        assert chat.ask(ROOM).fault is None
    assert "answered 503: Loading model; wait: the server is up" in caplog.text


def test_an_abandoned_answer_is_cancelled_and_not_asked_again(llamacpp):
    """This dialect doesn't stream, so that a long answer is a long silence."""
    chat = asker(llamacpp.url, timeout_s=0.5, patience_s=1.5, dialect="transformers")
    chat.server()
    cancelled = llamacpp.said().count("cancel task")
    with pytest.raises(ModelUnavailableError, match="in 1 attempt within a patience"):
        chat.ask(Question("other", "Tell me all.", max_tokens=8000))
    assert until(lambda: llamacpp.said().count("cancel task") == cancelled + 1)
    assert until(lambda: not is_busy(llamacpp.root))


def test_a_server_that_is_killed_in_the_middle(start_llamacpp):
    with start_llamacpp() as server:
        server.wait()
        chat = asker(server.url, patience_s=1.0)
        assert chat.ask(ROOM).fault is None

        def kill() -> None:
            until(lambda: is_busy(server.root))
            server.process.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        with pytest.raises(ModelUnavailableError, match="gave no answer"):
            chat.ask(LONG)
        killer.join()


def test_ctrl_c_in_the_middle_leaves_what_was_done_and_stops_the_server(llamacpp, tmp_path: Path):
    out = tmp_path / "out"
    command = ("find", "bed", "--seed", "2", "--vlm", llamacpp.spec, "--out", str(out))
    code = "import sys; from hypernav.app.cli.main import main; main(sys.argv[1:])"
    search = subprocess.Popen(
        [sys.executable, "-c", code, *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        # A shell that runs tests in the background hands down SIGINT as ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert until(lambda: is_busy(llamacpp.root), 180.0)
    search.send_signal(signal.SIGINT)
    search.communicate(timeout=60.0)
    assert search.returncode == 130
    assert json.loads((out / "result.json").read_text())["outcome"] == "interrupted"
    assert until(lambda: not is_busy(llamacpp.root))
