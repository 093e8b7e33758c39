"""Opens a chat model from its specification: ``openai:URL#MODEL``, ``local:ID`` and so on."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ConfigError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.recording import ReplayChat

_FORMS = "openai:http://localhost:8000/v1#MODEL, local:PATH_OR_ID or replay:FILE"


@dataclass(frozen=True)
class VlmSpec:
    """Which chat model to open.

    Attributes:
        kind: Kind of backend.
        target: URL, path or id.
        model: Name of the model on the server; None if it has only one.
    """

    kind: Literal["openai", "local", "replay"]
    target: str
    model: str | None = None


def parse_vlm_spec(text: str) -> VlmSpec:
    """Read ``openai:URL[#MODEL]``, ``local:PATH_OR_ID`` or ``replay:FILE``.

    Raises:
        ConfigError: It has another form; the message shows the nearest correct one.
    """
    kind, colon, target = text.strip().partition(":")
    if kind in {"http", "https"}:
        raise ConfigError(f"'{text}' names no backend; write openai:{text}")
    if not colon or not target.strip() or kind not in {"openai", "local", "replay"}:
        raise ConfigError(f"'{text}' is not a model; expected {_FORMS}")
    if kind == "openai":
        url, _, model = target.partition("#")
        scheme, separator, rest = url.partition("://")
        if separator and scheme not in {"http", "https"}:
            raise ConfigError(
                f"'{url}' begins with {scheme}://, but model servers speak http:// or https://; "
                f"write openai:http://{rest.lstrip('/') or 'localhost:8000/v1'}"
            )
        if not separator:
            raise ConfigError(f"'{url}' is not a server's URL; write openai:http://{url}")
        return VlmSpec("openai", url, model or None)
    return VlmSpec("local" if kind == "local" else "replay", target)


def open_chat(spec: VlmSpec | str, config: ChatConfig | None = None) -> ChatModel:
    """Open a chat model. A server is first contacted with the first question.

    Raises:
        ConfigError: The specification is malformed.
        MissingExtraError: A model in this process needs packages that are not installed.
        ModelError: Its weights are not there.
        RecordingError: The recording is missing or broken.
    """
    spec = parse_vlm_spec(spec) if isinstance(spec, str) else spec
    config = config or ChatConfig()
    # Each backend is imported when it is used: torch and transformers take seconds to load.
    match spec.kind:
        case "openai":
            from hypernav.search.models.chat.server.openai_chat import OpenAiChat

            return OpenAiChat(spec.target, spec.model, config)
        case "local":
            if config.thinking != "auto" or config.extra_body:
                raise ConfigError(
                    "chat.thinking and chat.extra_body are sent to servers, and local: asks none; "
                    "serve the model (openai:URL), or leave them out"
                )
            from hypernav.search.models.chat.local_chat import LocalChat

            return LocalChat(spec.target, config)
        case "replay":
            return ReplayChat(Path(spec.target).expanduser())
