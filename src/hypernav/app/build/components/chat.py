"""The chat model of ``--vlm``, with its ledger and recording."""

from collections.abc import Callable
from pathlib import Path

from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ConfigError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.ledger import Ledger, LedgerChat
from hypernav.search.models.chat.recording import RecordingChat, ResumingChat
from hypernav.search.models.chat.vlm_spec import VlmSpec, open_chat, parse_vlm_spec


def wrap_chat(
    vlm: str | None,
    config: ChatConfig,
    ledger: Ledger,
    record: Path | None,
    *,
    resume: bool = False,
) -> tuple[ChatModel | None, RecordingChat | ResumingChat | None]:
    """The chat model with its ledger, and the recording if there is one.

    Args:
        vlm: Specification of the model; None for no model.
        config: Connection, retries and sampling.
        ledger: Ledger of the questions.
        record: File of the recording; None records nothing.
        resume: Whether to answer recorded questions from that file.

    Raises:
        ConfigError: There is nothing to record.
        ModelError: A model in this process has no weights here.
        RecordingError: A recording is missing or broken, or a file with its name exists.
        MissingExtraError: The model needs packages that are not installed.
    """
    if vlm is None:
        if record is not None:
            raise ConfigError(f"--record {record} has nothing to record; name a model with --vlm")
        return None, None
    spec = parse_vlm_spec(vlm)
    if spec.kind == "replay" and record is not None:
        raise ConfigError(
            f"--record {record} would only copy the recording {spec.target}; drop --record"
        )
    chat, recording = open_chat(spec, config), None
    if record is not None:
        chat = recording = ResumingChat(chat, record) if resume else RecordingChat(chat, record)
    return LedgerChat(chat, ledger), recording


def is_named(vlm: str) -> bool:
    """Whether the model's name is known without asking a server that may not be up yet."""
    spec = parse_vlm_spec(vlm)
    return spec.kind != "openai" or spec.model is not None


def model_words(vlm: str, identify: Callable[[], str]) -> str:
    """The model's name for people, as far as it is known."""
    spec: VlmSpec = parse_vlm_spec(vlm)
    match spec.kind:
        case "openai":
            return spec.model or f"the model at {spec.target}"
        case "local":
            path = Path(spec.target).expanduser()
            return path.name if path.is_dir() else spec.target
        case "replay":
            return f"{identify()} (replayed)"
