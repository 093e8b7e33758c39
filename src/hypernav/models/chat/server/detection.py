"""Detection of a server's kind and of its models.

What ``GET /models`` says in ``owned_by``: vLLM "vllm", SGLang "sglang", llama.cpp "llamacpp",
Ollama "library". A server that says none of these is asked whether it has a decision endpoint,
which ``transformers serve`` has.
"""

import difflib
import logging
import re
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit, urlunsplit

from hypernav.core.errors import ModelRejectedError
from hypernav.models.chat.config import ChatConfig
from hypernav.models.chat.server.dialects import ServerDialect, dialect_named
from hypernav.models.chat.server.http_client import BadRequestError, HttpClient
from hypernav.models.chat.server.retry import RetryLaterError

_OWNERS = {"vllm": "vllm", "sglang": "sglang", "llamacpp": "llamacpp", "library": "ollama"}
_STRUCTURED_SINCE = (0, 11)
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ServerInfo:
    """Model, models and dialect of a server.

    Attributes:
        model: Name of the model in use.
        models: Names of all models it offers; empty if it does not say.
        dialect: API dialect that it speaks.
    """

    model: str
    models: tuple[str, ...]
    dialect: ServerDialect


def detect_server(
    client: HttpClient, model: str | None, config: ChatConfig, *, limit_s: float
) -> ServerInfo:
    """Detect a server's dialect and model.

    Args:
        client: HTTP client of the server.
        model: Name of the wanted model; None takes the only one.
        config: Configuration; a dialect named there is not detected.
        limit_s: Time limit of each of up to three requests, seconds.

    Raises:
        ModelRejectedError: It has several models or none, and none was named.
        ChatTransportError: It cannot be reached.
        ChatTimeoutError: It does not answer.
    """
    entries = _models(client, model, limit_s)
    names = tuple(entry["id"] for entry in entries)
    chosen = model or _only(names, client)
    if config.dialect != "auto":
        return ServerInfo(chosen, names, dialect_named(config.dialect))
    owners = {str(entry.get("owned_by", "")).lower() for entry in entries}
    return ServerInfo(chosen, names, _dialect(client, chosen, owners, limit_s))


def with_known_models(
    error: ModelRejectedError, server: ServerInfo, url: str
) -> ModelRejectedError:
    """The same error, with the models that the server does have."""
    if len(server.models) == 0 or server.model in server.models:
        return error
    close = difflib.get_close_matches(server.model, server.models, 3, 0.3) or server.models[:3]
    return ModelRejectedError(
        f"{error}; the server has no model '{server.model}', try openai:{url}#{close[0]}"
        + (f" (or {', '.join(close[1:])})" if len(close) > 1 else "")
    )


def _models(client: HttpClient, model: str | None, limit_s: float) -> list[dict[str, Any]]:
    try:
        reply = client.get("/models", limit_s=limit_s)
    except ModelRejectedError as error:
        if model is not None and "answered 404" in str(error):
            return []
        if "answered 404" in str(error) and not urlsplit(client.url).path.rstrip("/"):
            raise ModelRejectedError(f"{error}; try openai:{client.url}/v1") from error
        raise
    except RetryLaterError as error:
        # A broken list, as `transformers serve` has without a cache folder, is no reason to stop.
        if model is not None and error.status == 500:
            return []
        raise
    data = reply.get("data") if isinstance(reply, dict) else None
    entries = data if isinstance(data, list) else []
    return [one for one in entries if isinstance(one, dict) and isinstance(one.get("id"), str)]


def _only(names: tuple[str, ...], client: HttpClient) -> str:
    if len(names) == 0:
        raise ModelRejectedError(f"{client.url} lists no model; name it: openai:{client.url}#MODEL")
    if len(names) == 1:
        return names[0]
    some = ", ".join(names[:5]) + (", …" if len(names) > 5 else "")
    raise ModelRejectedError(
        f"{client.url} has several models ({some}); name one: openai:{client.url}#{names[0]}"
    )


def _dialect(client: HttpClient, model: str, owners: set[str], limit_s: float) -> ServerDialect:
    name = next((_OWNERS[owner] for owner in sorted(owners) if owner in _OWNERS), "openai")
    if name == "vllm" and _vllm_version(client, limit_s) < _STRUCTURED_SINCE:
        name = "vllm-guided"
    if name == "openai" and urlsplit(client.url).hostname == "api.openai.com":
        known = dialect_named("openai")
        return ServerDialect(
            "openai", known.choice, known.form, known.logprobs, token_limit="max_completion_tokens"
        )
    if name == "openai" and _has_systemone(client, limit_s):
        name = "transformers"
    _log.info("%s: model %s, dialect %s", client.url, model, name)
    return dialect_named(name)


def _vllm_version(client: HttpClient, limit_s: float) -> tuple[int, ...]:
    """From ``GET /version``, which lies beside the API; new if it does not say."""
    parts = urlsplit(client.url)
    try:
        root = urlunsplit((parts.scheme, parts.netloc, "/version", "", ""))
        version = str(client.get(root, limit_s=limit_s).get("version", ""))
    except ModelRejectedError:
        version = ""
    numbers = re.match(r"(\d+)\.(\d+)", version)
    return (int(numbers[1]), int(numbers[2])) if numbers else _STRUCTURED_SINCE


def _has_systemone(client: HttpClient, limit_s: float) -> bool:
    """An empty request is refused for its content where the endpoint exists, else not found."""
    try:
        client.post("/systemone", {}, limit_s=limit_s)
    except ModelRejectedError as error:
        return isinstance(error, BadRequestError)
    except RetryLaterError as error:
        if error.status != 500:
            raise
    return False
