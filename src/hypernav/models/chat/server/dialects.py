"""API dialects: how each kind of server constrains an answer. One small adapter per dialect.

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
"""

import json
import re
from dataclasses import dataclass
from typing import Any, Literal

from hypernav.core.chat import Question
from hypernav.core.errors import ConfigError
from hypernav.models.chat.config import DialectName

ANSWER_KEY = "answer"
_WRAPPING_TOKENS = 24


@dataclass(frozen=True)
class ServerDialect:
    """Abilities of one kind of server.

    Attributes:
        name: Name in configuration and reports.
        choice: Mechanism that enforces one of the allowed answers.
        form: Mechanism that enforces a JSON form.
        logprobs: Number of alternatives per token that the server reports; 0 for none.
        decision: Name of the decision endpoint; empty if it has none.
    """

    name: DialectName
    choice: Literal["none", "structured_outputs", "guided_choice", "regex", "json"]
    form: Literal["none", "json"]
    logprobs: int = 20
    decision: Literal["", "systemone", "decisions"] = ""


DIALECTS: dict[str, ServerDialect] = {
    dialect.name: dialect
    for dialect in (
        ServerDialect("vllm", choice="structured_outputs", form="json"),
        ServerDialect("vllm-guided", choice="guided_choice", form="json"),
        ServerDialect("sglang", choice="regex", form="json"),
        ServerDialect("ollama", choice="json", form="json"),
        ServerDialect("llamacpp", choice="json", form="json"),
        ServerDialect("openai", choice="json", form="json"),
        ServerDialect("transformers", choice="none", form="none", logprobs=0, decision="systemone"),
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


def dialect_named(name: str) -> ServerDialect:
    """A dialect by its name.

    Raises:
        ConfigError: There is none; the message lists those that exist.
    """
    if name not in DIALECTS:
        raise ConfigError(f"there is no dialect '{name}'; choose auto or {', '.join(DIALECTS)}")
    return DIALECTS[name]
