import pickle
from typing import Any

import pytest

from hypernav.app.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.search.models.chat.server.reply_errors import RefusedError


def test_an_extra_body_is_written_as_json():
    text = 'chat.extra_body={"top_k": 1, "chat_template_kwargs": {"enable_thinking": false}}'
    config = layered(preset("default"), environment={}, assignments=[text])
    expected = {"top_k": 1, "chat_template_kwargs": {"enable_thinking": False}}
    assert config.chat.extra_body == expected


@pytest.mark.parametrize(
    ("value", "why"),
    [
        ("[1]", "dictionary"),
        ("high", "dictionary"),
        ('{"messages": []}', "'messages' is set by the question"),
        ('{"stream": true}', "'stream' is set by the question"),
        ('{"a": .nan}', "JSON"),
        ('{"a": 2026-01-01}', "JSON"),
        ('{"a": "' + "x" * 10_001 + '"}', "at most 10,000"),
    ],
)
def test_what_is_no_body_is_refused(value: str, why: str):
    with pytest.raises(ConfigError, match=why):
        layered(preset("default"), environment={}, assignments=[f"chat.extra_body={value}"])


@pytest.mark.parametrize("level", ["on", "none", "1"])
def test_thinking_is_off_low_or_auto(level: Any):
    with pytest.raises(ConfigError, match=r"chat\.thinking"):
        layered(preset("default"), environment={}, assignments=[f"chat.thinking={level}"])


def test_off_is_a_word_on_the_command_line():
    """YAML reads it as false."""
    config = layered(preset("default"), environment={}, assignments=["chat.thinking=off"])
    assert config.chat.thinking == "off"


def test_refusals_pass_between_processes():
    error = pickle.loads(pickle.dumps(RefusedError("no", status=422, remedy="ask otherwise")))
    assert (str(error), error.remedy, error.status) == ("no; ask otherwise", "ask otherwise", 422)
