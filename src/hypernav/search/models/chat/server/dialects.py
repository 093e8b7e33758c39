"""API dialects: how each kind of server constrains an answer, and which kind a server is.

Sources, all of them the servers' own pages:

- vLLM, "Structured Outputs": ``structured_outputs: {"choice": […]}``; the ``guided_*`` fields that
  older servers want were removed in v0.12.0. docs.vllm.ai/en/latest/features/structured_outputs
- SGLang, "Structured Outputs": ``regex`` and ``response_format`` with a JSON schema; one
  constraint a request. docs.sglang.io/docs/advanced_features/structured_outputs
- Ollama and llama.cpp: ``response_format`` with a JSON schema on the OpenAI route, turned into a
  grammar (ollama docs/openai.md, llama.cpp tools/server/README.md).
- ``transformers serve``: ignores ``response_format`` and ``logprobs`` with a warning
  (``UNUSED_CHAT_COMPLETION_FIELDS``), but has ``/v1/systemone``, which answers closed questions
  with a probability for every option. huggingface.co/docs/transformers/main/serve-cli/serving
- OpenAI and servers like it: ``response_format`` with a strict JSON schema; "decisions" stands for
  those that have OpenAI's ``/decisions`` as well.

How a server is recognised: values of ``owned_by`` in the reply to ``GET /models``: vLLM "vllm",
SGLang "sglang", llama.cpp "llamacpp", Ollama "library". With any other value the server is asked
whether it has a decision endpoint, as ``transformers serve`` does.
"""

import difflib
import json
import logging
import re
from dataclasses import dataclass
from typing import Any, Literal
from urllib.parse import urlsplit

from hypernav.core.chat import Question
from hypernav.core.errors import ConfigError, ModelRejectedError, ModelSetupError
from hypernav.io.bounded_http import Deadline
from hypernav.search.models.chat.config import ChatConfig, DialectName
from hypernav.search.models.chat.server.http_client import HttpClient
from hypernav.search.models.chat.server.reply_errors import (
    NotFoundError,
    RefusedError,
    RetryLaterError,
)

ANSWER_KEY = "answer"
_WRAPPING_TOKENS = 24

_OWNERS = {"vllm": "vllm", "sglang": "sglang", "llamacpp": "llamacpp", "library": "ollama"}
_STRUCTURED_SINCE = (0, 11)
_MOST_MODELS = 1000
_LONGEST_NAME = 200
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ServerDialect:
    """Abilities of one kind of server.

    Attributes:
        name: Name in configuration and reports.
        choice: Mechanism that enforces one of the allowed answers.
        form: Mechanism that enforces a JSON form.
        logprobs: Number of alternatives per token that the server reports; 0 for none.
        decision: Name of the decision endpoint; empty if it has none.
        streams: Whether an answer can come piece by piece, with its tokens counted.
    """

    name: DialectName
    choice: Literal["none", "structured_outputs", "guided_choice", "regex", "json"]
    form: Literal["none", "json"]
    logprobs: int = 20
    decision: Literal["", "systemone", "decisions"] = ""
    streams: bool = True


DIALECTS: dict[str, ServerDialect] = {
    dialect.name: dialect
    for dialect in (
        ServerDialect("vllm", choice="structured_outputs", form="json"),
        ServerDialect("vllm-guided", choice="guided_choice", form="json"),
        ServerDialect("sglang", choice="regex", form="json"),
        ServerDialect("ollama", choice="json", form="json"),
        ServerDialect("llamacpp", choice="json", form="json"),
        ServerDialect("openai", choice="json", form="json"),
        ServerDialect(
            "transformers",
            choice="none",
            form="none",
            logprobs=0,
            decision="systemone",
            streams=False,
        ),
        ServerDialect("decisions", choice="json", form="json", decision="decisions"),
        ServerDialect("plain", choice="none", form="none", logprobs=0),
    )
}


@dataclass(frozen=True)
class Constraint:
    """Constraint on an answer that a dialect adds to a request.

    Attributes:
        fields: Fields of the request body.
        note: Addition to the prompt: servers recommend that the prompt asks for JSON, too.
        extra_tokens: Tokens of the JSON around the answer.
        wrapped: Whether the answer comes inside a JSON object.
    """

    fields: dict[str, Any]
    note: str = ""
    extra_tokens: int = 0
    wrapped: bool = False


def constraint_for(dialect: ServerDialect, question: Question) -> Constraint:
    """Constraint that restricts the answer on a server of this dialect."""
    if question.allowed:
        return _choice(dialect, question.allowed)
    if question.form is not None and dialect.form == "json":
        schema = question.form.model_json_schema()
        note = f"Answer with JSON of this schema: {json.dumps(schema, separators=(',', ':'))}"
        return Constraint(_response_format(question.form.__name__, schema), note)
    return Constraint({})


def _choice(dialect: ServerDialect, allowed: tuple[str, ...]) -> Constraint:
    match dialect.choice:
        case "none":
            return Constraint({})
        case "structured_outputs":
            return Constraint({"structured_outputs": {"choice": list(allowed)}})
        case "guided_choice":
            return Constraint({"guided_choice": list(allowed)})
        case "regex":
            return Constraint({"regex": f"({'|'.join(map(re.escape, allowed))})"})
        case "json":
            schema = {
                "type": "object",
                "properties": {ANSWER_KEY: {"type": "string", "enum": list(allowed)}},
                "required": [ANSWER_KEY],
                "additionalProperties": False,
            }
            note = f'Answer with JSON: {{"{ANSWER_KEY}": "…"}}, one of: {", ".join(allowed)}.'
            fields = _response_format("choice", schema)
            return Constraint(fields, note, _WRAPPING_TOKENS, wrapped=True)


def _response_format(name: str, schema: dict[str, Any]) -> dict[str, Any]:
    return {
        "response_format": {
            "type": "json_schema",
            "json_schema": {"name": name.lstrip("_"), "schema": schema, "strict": True},
        }
    }


def without_decision(dialect: ServerDialect) -> ServerDialect:
    """The dialect of a server whose decision endpoint turns out to be missing."""
    return DIALECTS["openai"] if dialect.decision else dialect


def dialect_named(name: str) -> ServerDialect:
    """A dialect by its name.

    Raises:
        ConfigError: There is none; the message lists those that exist.
    """
    if name not in DIALECTS:
        raise ConfigError(f"there is no dialect '{name}'; choose auto or {', '.join(DIALECTS)}")
    return DIALECTS[name]


@dataclass(frozen=True)
class ServerInfo:
    """Model, models and dialect of a server.

    Attributes:
        model: Name of the model in use.
        models: Names of all models it offers; empty if it does not say.
        dialect: API dialect that it speaks.
        list_fault: Reason why its list of models could not be read; empty if it could.
        aliases: Other names of its models.
    """

    model: str
    models: tuple[str, ...]
    dialect: ServerDialect
    list_fault: str = ""
    aliases: tuple[str, ...] = ()

    @property
    def is_listed(self) -> bool:
        """Whether the server lists the model, or lists none at all."""
        listed = self.models + self.aliases
        return not self.models or any(_is_same(self.model, one) for one in listed)


def _is_same(name: str, listed: str) -> bool:
    """Whether a name is a listed one: in any case, without a file's folder and ending, or a tag."""
    same = {listed, _short(listed), f"{_short(listed)}.gguf", listed.removesuffix(":latest")}
    return name.casefold() in {one.casefold() for one in same}


def _short(listed: str) -> str:
    """The name of a listed file of weights, as llama.cpp lists them; any other name as it is."""
    file = re.fullmatch(r"(?:.*[/\\])?(.+)\.gguf", listed)
    return file[1] if file else listed


def detect_server(
    client: HttpClient, model: str | None, config: ChatConfig, deadline: Deadline
) -> ServerInfo:
    """Detect a server's dialect and model.

    Args:
        client: HTTP client of the server.
        model: Name of the wanted model; None takes the only one.
        config: Configuration; a dialect named there is not detected.
        deadline: Moment at which all requests, up to three, have to be over.

    Raises:
        ModelSetupError: It has several models or none, and none was named.
        ChatTransportError: It cannot be reached.
        ChatTimeoutError: It does not answer.
    """
    entries, list_fault = _models(client, model, deadline)
    names = tuple(entry["id"] for entry in entries)
    chosen = model or _only(names, client)
    aliases = tuple(alias for entry in entries for alias in _aliases(entry))
    owners = {str(entry.get("owned_by", "")).lower() for entry in entries}
    named = config.dialect
    dialect = (
        _dialect(client, chosen, owners, deadline) if named == "auto" else dialect_named(named)
    )
    server = ServerInfo(chosen, names, dialect, list_fault, aliases)
    if not server.is_listed:
        listed = ", ".join(names[:5])
        _log.warning("%s lists no model '%s' (it has %s)", client.url, chosen, listed)
    return server


def _aliases(entry: dict[str, Any]) -> list[str]:
    aliases = entry.get("aliases")  # llama.cpp's
    return [one for one in aliases if _is_name(one)] if isinstance(aliases, list) else []


def check_name(server: ServerInfo, url: str) -> None:
    """Refuse a name that llama.cpp's server would answer to all the same, as the model it has.

    The name tells in which coordinates a model answers. Other servers refuse wrong names
    themselves, or take names that they don't list.

    Raises:
        ModelSetupError: The name is not listed.
    """
    if server.dialect.name == "llamacpp" and len(server.models) == 1 and not server.is_listed:
        own = _short(server.models[0])
        raise ModelSetupError(
            f"{url} has no model '{server.model}', and would answer as '{own}'",
            remedy=f"write its own name: openai:{url}#{own}",
        )


def with_known_models(
    error: ModelRejectedError | ModelSetupError, server: ServerInfo, url: str
) -> ModelRejectedError | ModelSetupError:
    """The same error, or what is wrong: the path, or the model if the server has only others."""
    if server.list_fault and isinstance(error, NotFoundError):
        return _with_path(error, url, f"#{server.model}")
    if len(server.models) == 0 or server.model in server.models:
        return error
    named = re.search(rf"(?<!\w){re.escape(server.model)}(?!\w)", str(error))
    if named is None and not isinstance(error, NotFoundError):
        return error
    close = difflib.get_close_matches(server.model, server.models, 3, 0.3) or list(
        server.models[:3]
    )
    others = f" (or {', '.join(close[1:])})" if len(close) > 1 else ""
    return ModelSetupError(
        f"{error}; the server has no model '{server.model}'",
        remedy=f"try openai:{url}#{close[0]}{others}",
    )


def _with_path(error: NotFoundError, url: str, model: str = "") -> ModelSetupError:
    """The same error; without any path in the URL, with the usual one as the remedy."""
    if error.remedy or urlsplit(url).path.rstrip("/"):
        return error
    return ModelSetupError(str(error), remedy=f"try openai:{url}/v1{model}")


def _models(
    client: HttpClient, model: str | None, deadline: Deadline
) -> tuple[list[dict[str, Any]], str]:
    """Entries of the list of models, and why it could not be read, if so."""
    try:
        reply = client.get("models", deadline)
    except NotFoundError as error:
        if model is not None:
            return [], str(error)
        raise _with_path(error, client.url) from error
    except RetryLaterError as error:
        # A broken list, as from `transformers serve` without a cache folder, is not an error here.
        if model is not None and error.status == 500:
            return [], str(error)
        raise
    data = reply.get("data")
    entries = data[:_MOST_MODELS] if isinstance(data, list) else []
    return [one for one in entries if isinstance(one, dict) and _is_name(one.get("id"))], ""


def _is_name(value: object) -> bool:
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_NAME and value.isprintable()


def _only(names: tuple[str, ...], client: HttpClient) -> str:
    if len(names) == 0:
        remedy = f"name it: openai:{client.url}#MODEL"
        raise ModelSetupError(f"{client.url} lists no model", remedy=remedy)
    if len(names) == 1:
        return names[0]
    some = ", ".join(names[:5]) + (", …" if len(names) > 5 else "")
    raise ModelSetupError(
        f"{client.url} has several models ({some})",
        remedy=f"name one: openai:{client.url}#{names[0]}",
    )


def _dialect(client: HttpClient, model: str, owners: set[str], deadline: Deadline) -> ServerDialect:
    name = next((_OWNERS[owner] for owner in sorted(owners) if owner in _OWNERS), "openai")
    if name == "vllm" and _vllm_version(client, deadline) < _STRUCTURED_SINCE:
        name = "vllm-guided"
    if name == "openai" and _has_systemone(client, deadline):
        name = "transformers"
    _log.info("%s: model %s, dialect %s", client.url, model, name)
    return dialect_named(name)


def _vllm_version(client: HttpClient, deadline: Deadline) -> tuple[int, ...]:
    """The version by ``GET /version``, beside the API's path; a new one if it is not given."""
    try:
        version = str(client.get("/version", deadline).get("version", ""))
    except (ModelRejectedError, ModelSetupError):
        version = ""
    numbers = re.match(r"(\d{1,9})\.(\d{1,9})", version)
    return (int(numbers[1]), int(numbers[2])) if numbers else _STRUCTURED_SINCE


def _has_systemone(client: HttpClient, deadline: Deadline) -> bool:
    """An empty request is refused for its content if the endpoint exists, else not found."""
    try:
        client.post("systemone", {}, deadline)
    except (ModelRejectedError, ModelSetupError) as error:
        return isinstance(error, RefusedError) and error.status in {400, 422}
    except RetryLaterError as error:
        if error.status != 500:
            raise
    return False
