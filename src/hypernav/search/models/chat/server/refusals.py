"""What a server's refusals teach about the fields of a request.

No server takes all fields of all others, and which one it is can't be told from its name: behind a
proxy stands any of them. So every field is sent as OpenAI's API has it, and what a refusal names is
sent otherwise from then on: under another name, with a smaller value, or not at all. A refusal that
names no field teaches only what further requests show (`Refusals.trials`).
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from hypernav.search.models.chat.server.reply_errors import CONTEXT

TOKEN_LIMIT = "max_tokens"
CONSTRAINTS = ("structured_outputs", "guided_choice", "regex", "response_format")
SWITCHES = (
    "chat_template_kwargs",
    "thinking_budget_tokens",
    "enable_thinking",
    "thinking",
    "reasoning",
    "reasoning_effort",
)
DECISION = "decision"
"""Stands for the optional endpoint that is asked instead, among the fields."""
STREAM = {"stream": True, "stream_options": {"include_usage": True}}
"""Fields that ask for an answer piece by piece, with the tokens counted at its end."""
PROGRESS = "return_progress"
OPTIONAL = (
    *(DECISION, PROGRESS, *SWITCHES, "top_logprobs", "logprobs", *CONSTRAINTS),
    *("seed", "temperature", *STREAM),
)
"""Fields that nothing depends on, in the order in which they go when a refusal names none."""
_TOGETHER = {
    **{"logprobs": "top_logprobs", "top_logprobs": "logprobs"},
    **{"stream": "stream_options", "stream_options": "stream"},
}
_NEWER_LIMITS = ("max_completion_tokens", "max_output_tokens", "max_new_tokens")
LIMIT_NAMES = frozenset({TOKEN_LIMIT, *_NEWER_LIMITS})
_EFFORTS = ("none", "minimal", "low")
_LEAST_TOKENS = 64

# Other words by which servers name a field.
_OTHER_WORDS = {
    TOKEN_LIMIT: r"max\w*tokens",
    "logprobs": r"\w*log_?probs",
    **dict.fromkeys(
        CONSTRAINTS,
        r"json_?schema|response_?schema|additionalProperties|structured outputs?|grammar",
    ),
    **dict.fromkeys(SWITCHES, r"enable_thinking|thinking|reasoning"),
}
_TOO_LARGE = re.compile(
    r"too (?:large|many|high|long|big)|exceed|(?:greater|more|less|larger) than|at most|maximum"
    r"|max allowed|between|range|<=|≤",
    re.I,
)
_TOO_SMALL = re.compile(r"below (?:the )?minimum|at least|>=|≥|greater than or equal", re.I)
UNKNOWN = re.compile(
    r"not support|unsupported|unknown|unrecogni[sz]ed|unexpected|not permitted|extra |instead", re.I
)
_ESSENTIAL = re.compile(r"(?<!\w)messages(?!\w)", re.I)
_ALONE_TOO_LONG = re.compile(r"exceeds? the available context size|prompt is too long", re.I)


@dataclass(frozen=True)
class Refusals:
    """What has been learned.

    Attributes:
        renamed: Name under which a field is sent.
        values: Largest number, or the word, with which a field is sent.
        least: Smallest number with which a field is sent.
        dropped: Fields that are not sent.
    """

    renamed: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, Any] = field(default_factory=dict)
    least: Mapping[str, int] = field(default_factory=dict)
    dropped: tuple[str, ...] = ()

    def fitted(self, body: Mapping[str, Any]) -> dict[str, Any]:
        """The body as this server takes it."""
        return {
            self.renamed.get(name, name): self._value(name, value)
            for name, value in body.items()
            if name not in self.dropped
        }

    def after(self, said: str, body: Mapping[str, Any]) -> "Refusals | None":
        """What is known after one more refusal; None if it names no field that can be changed.

        Args:
            said: Words of the server.
            body: The request before it was fitted, without what was never ours to change.
        """
        sent = [name for name in body if name not in self.dropped]
        name = self._named(said, sent)
        if not name:
            return None
        value = self._value(name, body[name])
        if name == TOKEN_LIMIT and value < _LEAST_TOKENS and _TOO_SMALL.search(said):
            return replace(self, least={**self.least, name: 2 * value})
        smaller = _smaller(name, value, said)
        if smaller is not None:
            return replace(self, values={**self.values, name: smaller})
        if name == TOKEN_LIMIT and _is_of_size(said):
            return None  # what is left would hold no answer
        if name == TOKEN_LIMIT and TOKEN_LIMIT not in self.renamed:
            return replace(self, renamed={**self.renamed, name: _other_name(said)})
        gone = {name, _TOGETHER.get(name, name)}
        return replace(self, dropped=(*self.dropped, *sorted(gone.difference(self.dropped))))

    def names(self, said: str, body: Mapping[str, Any]) -> bool:
        """Whether a reply names one of the fields that were sent and nothing depends on."""
        return self._first_named(said, [name for name in body if name not in self.dropped]) != ""

    def trials(self, fields: Iterable[str]) -> "list[Refusals]":
        """What to try after a refusal that names no field, in this order.

        The plain question shows whether any field is to blame, and all fields once more whether the
        refusal was a passing one. Then ever more fields are left out. Empty if all are already.

        Args:
            fields: Names of the fields that would be sent.
        """
        optional = [name for name in OPTIONAL if name in fields and name not in self.dropped]
        fewer = [
            replace(self, dropped=(*self.dropped, *optional[:count]))
            for count in range(len(optional) + 1)
        ]
        return [fewer[-1], *fewer[:-1]] if optional else []

    def _value(self, name: str, value: Any) -> Any:
        known = self.values.get(name)
        if isinstance(known, int) and isinstance(value, int):
            value = min(known, value)
        if name in self.least:
            value = max(self.least[name], value)
        return known if isinstance(known, str) else value

    def _named(self, said: str, sent: list[str]) -> str:
        """The field that a refusal is about; empty if it names none."""
        if CONTEXT.search(said):
            is_ours = TOKEN_LIMIT in sent and not _ALONE_TOO_LONG.search(said)
            return TOKEN_LIMIT if is_ours else ""
        named = self._first_named(said, sent)
        is_number = named == "logprobs" and "top_logprobs" in sent and _is_of_size(said)
        return "top_logprobs" if is_number else named

    def _first_named(self, said: str, sent: list[str]) -> str:
        """The field that is named first, by its own name if there is one; empty if none is."""
        changeable = [name for name in sent if name in OPTIONAL or name == TOKEN_LIMIT]
        for words in (lambda name: re.escape(self.renamed.get(name, name)), _OTHER_WORDS.get):
            found = {}
            for name in changeable:
                pattern = words(name)
                match = pattern and re.search(rf"(?<!\w)(?:{pattern})(?!\w)", said, re.I)
                if match:
                    found[name] = match.start()
            if found:
                return min(found, key=lambda name: found[name])
        return ""


def is_of_the_question(said: str) -> bool:
    """Whether a refusal that names no field is about the messages of the question or its size."""
    return bool(_ESSENTIAL.search(said) or CONTEXT.search(said))


def _smaller(name: str, value: Any, said: str) -> Any:
    """The next smaller value of a field whose value was refused; None if there is none."""
    if name == "reasoning_effort" and value in _EFFORTS[:-1]:
        after = _EFFORTS[_EFFORTS.index(value) + 1 :]
        offered = [word for word in after if re.search(rf"['\"`]{word}['\"`]", said)]
        refuses_the_value = re.search(r"value|one of|expected|enum|does not support '", said, re.I)
        return (offered or after)[0] if refuses_the_value else None
    if name not in {TOKEN_LIMIT, "top_logprobs"}:
        return None
    least = _LEAST_TOKENS if name == TOKEN_LIMIT else 1
    return max(value // 2, least) if _is_of_size(said) and value > least else None


def _is_of_size(said: str) -> bool:
    """Whether a refusal is about how much was asked for."""
    is_large = _TOO_LARGE.search(said) and not UNKNOWN.search(said)
    return bool(CONTEXT.search(said) or is_large)


def _other_name(said: str) -> str:
    """The name for the limit of tokens that a refusal of ours names, or the newer one."""
    named = (name for name in _NEWER_LIMITS if re.search(rf"(?<!\w){name}(?!\w)", said))
    return next(named, _NEWER_LIMITS[0])
