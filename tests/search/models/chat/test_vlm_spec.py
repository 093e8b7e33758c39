from importlib.util import find_spec
from pathlib import Path

import pytest

from hypernav.core.errors import ConfigError, MissingExtraError, RecordingError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from hypernav.search.models.chat.vlm_spec import VlmSpec, open_chat, parse_vlm_spec


@pytest.mark.parametrize(
    ("text", "spec"),
    [
        (
            "openai:http://localhost:8000/v1#Qwen/Qwen2.5-VL-7B-Instruct",
            VlmSpec("openai", "http://localhost:8000/v1", "Qwen/Qwen2.5-VL-7B-Instruct"),
        ),
        ("openai:https://api.openai.com/v1", VlmSpec("openai", "https://api.openai.com/v1")),
        ("local:Qwen/Qwen3-VL-8B", VlmSpec("local", "Qwen/Qwen3-VL-8B")),
        ("replay:run.jsonl", VlmSpec("replay", "run.jsonl")),
        ("openai:http://h/v1#qwen2.5vl:7b", VlmSpec("openai", "http://h/v1", "qwen2.5vl:7b")),
    ],
)
def test_reads(text: str, spec: VlmSpec):
    assert parse_vlm_spec(text) == spec


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("http://localhost:8000/v1", "write openai:http://localhost:8000/v1"),
        ("openai:localhost:8000/v1", "write openai:http://localhost:8000/v1"),
        ("openai:", "expected openai:http"),
        ("gpt-6", "expected openai:http"),
        ("", "expected openai:http"),
        ("vllm:http://x", "expected openai:http"),
    ],
)
def test_says_how_to_write_it(text: str, hint: str):
    with pytest.raises(ConfigError, match=hint) as caught:
        parse_vlm_spec(text)
    assert "\n" not in str(caught.value)


def test_opens_a_server_without_speaking_to_it():
    chat = open_chat("openai:http://127.0.0.1:9/v1#m")
    assert isinstance(chat, OpenAiChat)
    assert chat.identify() == "m"


def test_opens_a_recording(tmp_path: Path):
    with pytest.raises(RecordingError):
        open_chat(f"replay:{tmp_path / 'none.jsonl'}")


def test_a_model_in_this_process_needs_its_extra():
    if find_spec("torch") is None:
        with pytest.raises(MissingExtraError, match=r"hypernav\[local-vlm\]"):
            open_chat("local:Qwen/Qwen2.5-VL-3B-Instruct")


@pytest.mark.parametrize("config", [ChatConfig(thinking="off"), ChatConfig(extra_body={"a": 1})])
def test_what_only_a_server_can_be_told_is_refused_in_this_process(config: ChatConfig):
    with pytest.raises(ConfigError, match=r"chat\.thinking and chat\.extra_body"):
        open_chat("local:nowhere", config)
