"""The package's own HTTP client against ``transformers serve`` with a tiny Qwen2.5-VL."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from certainty import certain
from chat_models import image
from hypernav.core.chat import Fault, Image, Question
from hypernav.core.errors import ModelRejectedError, ModelUnavailableError
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.ledger import Ledger, LedgerChat
from hypernav.search.models.chat.local_chat import LocalChat
from hypernav.search.models.chat.recording import RecordingChat, ReplayChat
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.vlm_families import smart_resize
from hypernav.search.models.chat.vlm_spec import open_chat, parse_vlm_spec
from hypernav.search.perception.config import VlmDetectorConfig, VlmReasonerConfig
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import VlmReasoner
from hypernav.search.perception.local.vlm_detector import VlmDetector, grounding_question
from hypernav.search.perception.local.yes_no_checks import VlmPresenceCheck

VIEW = image(0, 480, 640)
QWEN = VlmDetectorConfig(family="qwen2.5-vl", max_tokens=24)


@pytest.fixture(scope="module")
def chat(transformers_server: str) -> OpenAiChat:
    spec = parse_vlm_spec(transformers_server)
    return OpenAiChat(spec.target, spec.model, ChatConfig(patience_s=60.0), environment={})


@pytest.fixture
def observation() -> Observation:
    camera = PinholeCamera.from_hfov(640, 480, 79.0)
    depth = np.ones((480, 640), np.float32)
    return Observation(VIEW, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


class _Noise(Overview):
    def draw(self, shown, hatched) -> Image:
        return image(1, 768, 768)


@pytest.fixture
def overview() -> Overview:
    blocks = tuple(Block(n, float(n), 0.0, 2.0, 100, 20, (n + 1.0, 1.0), 3.0) for n in range(1, 6))
    return _Noise(blocks, Pose2(0.0, 0.0, 0.0))


def test_the_server_is_recognised_and_its_decisions_are_used(chat: OpenAiChat):
    assert chat.server().dialect.name == "transformers"
    answer = chat.ask(Question("verify", "Is there a bed?", (VIEW,), ("yes", "no")))
    assert answer.value in {"yes", "no"}
    assert sum(answer.probabilities.values()) == pytest.approx(1.0)
    assert answer.usage.tokens_in > 391
    assert chat.dropped == ()


def test_ignored_constraints_are_found_out(transformers_server: str):
    """Without its decision endpoint this server ignores what is allowed; its words are nonsense."""
    spec = parse_vlm_spec(transformers_server)
    plain = OpenAiChat(spec.target, spec.model, ChatConfig(dialect="openai"), environment={})
    answer = plain.ask(Question("verify", "Is there a bed?", (VIEW,), ("yes", "no")))
    assert answer.fault in {Fault.UNPARSABLE, Fault.INVALID}


def test_the_server_and_this_process_say_the_same(
    chat: OpenAiChat, tiny: Callable[[str], Path], observation: Observation
):
    """The image travels as a JPEG, so it is made one here as well."""
    import cv2

    from hypernav.search.models.chat.message_parts import jpeg_bytes

    family = VlmDetector(chat, ExchangeLog(), QWEN).family
    sent = grounding_question(QWEN, family, observation.rgb, Goal("bed"))
    data = np.frombuffer(jpeg_bytes(sent.images[0]), np.uint8)
    decoded = certain(cv2.imdecode(data, cv2.IMREAD_COLOR))[..., ::-1]
    local = LocalChat(str(tiny("qwen25_vl")), ChatConfig(device="cpu"))
    here = local.ask(Question("ground", sent.text, (np.ascontiguousarray(decoded),), max_tokens=24))
    there = chat.ask(sent)
    assert there.usage == here.usage
    assert there.text == here.text


def test_the_whole_perception_lives_on_nonsense(
    chat: OpenAiChat, observation: Observation, overview: Overview
):
    log, goal = ExchangeLog(), Goal("bed")
    book = LedgerChat(chat, Ledger())
    detector = VlmDetector(book, log, QWEN)
    assert isinstance(detector.detect(observation, goal), list)
    assert isinstance(VlmPresenceCheck(book, log).is_present(observation, goal), bool)
    for mode in ("paper", "constrained"):
        config = VlmReasonerConfig(mode=mode, max_tokens=16)
        reasoner = VlmReasoner(book, log, GeometricReasoner(log), config)
        choice = reasoner.choose(overview, goal, frozenset({2}))
        assert choice.number in {1, 3, 4, 5}
    exchanges = [exchange for exchange in log.drain() if exchange.asked != "geometric"]
    total = book.ledger.total
    assert total.calls == len(exchanges)
    assert total.tokens_in == sum(exchange.tokens_in for exchange in exchanges)
    assert total.seconds == pytest.approx(sum(exchange.seconds for exchange in exchanges))


def test_a_recording_replays_without_the_server(
    chat: OpenAiChat, observation: Observation, tmp_path: Path
):
    logs = []
    recorder = RecordingChat(chat, tmp_path / "r.jsonl")
    for model in (recorder, None):
        log = ExchangeLog()
        asked = model or ReplayChat(tmp_path / "r.jsonl")
        VlmDetector(asked, log, QWEN).detect(observation, Goal("bed"))
        VlmPresenceCheck(asked, log).is_present(observation, Goal("bed"))
        logs.append([exchange.model_dump_json() for exchange in log.drain()])
        recorder.close()
    assert logs[0] == logs[1]


def test_a_wrong_model_name_is_a_clear_error(transformers_server: str):
    url = parse_vlm_spec(transformers_server).target
    wrong = open_chat(f"openai:{url}#Qwen/Qwen9", ChatConfig(patience_s=2.0))
    with pytest.raises(ModelUnavailableError, match="Qwen9") as caught:
        wrong.ask(Question("ground", "Locate", (VIEW,), max_tokens=2))
    assert isinstance(caught.value, ModelRejectedError)


def test_a_timeout_is_kept(transformers_server: str):
    spec = parse_vlm_spec(transformers_server)
    hasty = ChatConfig(timeout_s=0.05, patience_s=0.3, first_wait_s=0.01, dialect="transformers")
    chat = OpenAiChat(spec.target, spec.model, hasty, environment={})
    with pytest.raises(ModelUnavailableError, match="patience"):
        chat.ask(Question("ground", "Locate", (image(0, 980, 980),), max_tokens=512))


@settings(deadline=None)
@given(st.integers(28, 3000), st.integers(28, 3000))
def test_our_resizing_is_qwens(width: int, height: int):
    from transformers.models.qwen2_vl.image_processing_qwen2_vl import smart_resize as qwens

    bounds = {"min_pixels": 56 * 56, "max_pixels": 28 * 28 * 1280}
    if max(width, height) > 100 * min(width, height):
        return
    ours = smart_resize(width, height, multiple=28, **bounds)
    assert ours == tuple(qwens(height, width, factor=28, **bounds))[::-1]
