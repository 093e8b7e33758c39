"""Parsing of model answers: one of the allowed answers, a JSON form, or a fault.

Several servers accept a constraint and silently ignore it (``transformers serve`` logs a warning
and continues, Ollama's cloud drops JSON schemas), so every answer is checked here.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydantic import BaseModel, ValidationError

from hypernav.core.chat import Answer, Fault, Question, Usage
from hypernav.models.chat.unwrapping import CUT_IN_THINKING, unwrapped

_REFUSAL = re.compile(
    r"\s*(?:i['’]?m (?:very )?sorry|sorry\b|i (?:can ?not|can['’]t|am unable|'m unable|won['’]t)\b"
    r"|as an ai\b|unfortunately,? i (?:can ?not|can['’]t))",
    re.IGNORECASE,
)
# "Answer: block 3" says 3, but "I would not go to 3" does not.
_LEAD = re.compile(
    r"^\W{0,40}(?:(?:the|my|final|answer|choice|block|number|is)\b[\s:#*]{0,40})+", re.IGNORECASE
)
_NO_IDIOM = re.compile(
    r"no (?:doubt|question|problem|wonder|idea|clue|way|need|one|comment|response|answer|fewer|less"
    r"|image|picture|photo|information|input)s?\b"
)
_DENIAL = re.compile(
    r"(?<![a-z])(?:not?|non|absent|empty|missing|hidden|without|invisible|rejected|excluded|discarded"
    r"|ignored|avoid|blocked|unreachable|visited|explored|un(?:seen|likely|sure|certain)"
    r"|false|wrong)(?![a-z])|n['’]t\b",
    re.IGNORECASE,
)
_COUNTED = re.compile(r"(?:m|cm|met(?:er|re)s?|blocks|steps|times|%)(?!\w)")
_BULLET = re.compile(r"^(?:[-*•]\s+|[^\w\s\"'`({\[<-]\s+)+")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_FIRST_SENTENCE = re.compile(r"[^\W\d_][^.!:\n\[{]*")
_AT_LIMIT = (
    "the reply reached its limit of tokens: if the model thinks, switch thinking off "
    "(--set chat.thinking=off) or raise the limit"
)
_SHORT = 80
LONGEST_ANSWER = 32_768
"""Characters of an answer that are kept: 20 times the longest answer that is asked for."""


def parse_answer(
    question: Question,
    text: str,
    *,
    model: str,
    usage: Usage | None = None,
    seconds: float = 0.0,
    lost: Mapping[str, int] | None = None,
    probabilities: Mapping[str, float] | None = None,
    refused: bool = False,
    is_cut: bool = False,
) -> Answer:
    """Parse the text of a model and check it against the question.

    Args:
        question: Question that was asked.
        text: Text of the model.
        model: Name of the model.
        usage: Token usage.
        seconds: Duration of the request.
        lost: Number of failed attempts before this answer, by reason.
        probabilities: Probabilities of the allowed answers.
        refused: Whether the server reports that the model declined.
        is_cut: Whether the text ends because it reached the limit of tokens.
    """
    text = writable(text[:LONGEST_ANSWER])
    final = unwrapped(text)
    said = final.text
    answer = Answer(
        text=text,
        model=model,
        usage=usage or Usage(),
        seconds=seconds,
        lost=lost or {},
        probabilities=probabilities or {},
    )
    if refused:
        return _faulty(answer, Fault.REFUSED, f"declined: {shortened(said) or 'no reason given'}")
    if final.is_cut or (is_cut and question.at_once and _thinks_aloud(said)):
        return _faulty(answer, Fault.CUT, CUT_IN_THINKING)
    if not said:
        return _faulty(answer, Fault.UNPARSABLE, final.problem or "the answer is empty")
    if len(text) >= LONGEST_ANSWER:
        detail = f"the answer has {LONGEST_ANSWER:,} characters or more: '{shortened(said)}'"
        return _faulty(answer, Fault.UNPARSABLE, detail)
    if question.allowed:
        parsed = _parse_allowed(answer, said, question.allowed)
        hint = f"; {_AT_LIMIT}" if is_cut and parsed.fault is not None else ""
        return replace(parsed, detail=parsed.detail + hint)
    if question.form is not None:
        return _parse_form(answer, said, question.form)
    return replace(answer, value=said)


def writable(text: str) -> str:
    """The text without unpaired surrogates, which JSON may contain but no file can store."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def shortened(text: str, length: int = _SHORT) -> str:
    """Text as one line of limited length, for messages."""
    line = " ".join(writable(text[: 8 * length]).split())  # an answer may be long
    return line if len(line) <= length else line[: length - 1] + "…"


def denies(name: str) -> bool:
    """Whether a label or a key tells what is not there, as "not_visible" and "no bed" do."""
    return _DENIAL.search(_CAPITAL.sub(" ", name[:LONGEST_ANSWER])) is not None


def _thinks_aloud(said: str) -> bool:
    """Whether a text begins with prose, as thinking does whose begin is in the prompt."""
    sentence = _FIRST_SENTENCE.match(said)
    return sentence is not None and (len(sentence[0].split()) > 4 or len(sentence[0]) > 40)


def _faulty(answer: Answer, fault: Fault, detail: str) -> Answer:
    return replace(answer, fault=fault, detail=detail)


def _parse_allowed(answer: Answer, said: str, allowed: tuple[str, ...]) -> Answer:
    by_key = {_key(label): label for label in allowed}
    bare = _single(said)
    if _key(bare) in by_key:
        return replace(answer, value=by_key[_key(bare)])
    words = [_key(word) for word in _LEAD.sub("", bare, count=1).split()]
    mentioned = {by_key[word] for word in words if word in by_key}
    rest = " ".join(words[1:])
    # "Yes, but it is not a bed" and "Block 3 is excluded" take back what they say.
    is_taken_back = words[:1] != ["no"] and denies(rest)
    is_count = bool(words) and words[0].isdigit() and _COUNTED.match(rest)
    if _NO_IDIOM.match(" ".join(words)) or is_taken_back or is_count:
        mentioned.clear()
    if words and words[0] in by_key and len(mentioned) == 1:
        return replace(answer, value=by_key[words[0]])
    if _REFUSAL.match(said):
        return _faulty(answer, Fault.REFUSED, f"declined: {shortened(said)}")
    expected = ", ".join(allowed)
    if len(words) == 1:
        return _faulty(answer, Fault.INVALID, f"'{shortened(bare)}' is none of: {expected}")
    return _faulty(
        answer, Fault.UNPARSABLE, f"'{shortened(bare)}' does not name exactly one of: {expected}"
    )


def _key(text: str) -> str:
    return text.strip(" \t\r\n.,:;!?\"'`*()[]{}#").casefold()


def _single(said: str) -> str:
    """The text without a mark before it, and without the JSON object around a single answer."""
    value = _json_in(said)
    if isinstance(value, dict) and "answer" in value:  # perhaps with its confidence or reason
        value = value["answer"]
    elif isinstance(value, dict) and len(value) == 1:
        ((key, value),) = value.items()
        if denies(key):
            return said
    if isinstance(value, str | int) and not isinstance(value, bool):
        return str(value)
    return _BULLET.sub("", said)


def _json_in(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _parse_form(answer: Answer, said: str, form: type[BaseModel]) -> Answer:
    begin, end = said.find("{"), said.rfind("}")
    if begin < 0 or end < begin:
        fault = Fault.REFUSED if _REFUSAL.match(said) else Fault.UNPARSABLE
        return _faulty(answer, fault, f"no JSON object in '{shortened(said)}'")
    try:
        return replace(answer, value=form.model_validate_json(said[begin : end + 1]))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        broken = first["type"] == "json_invalid"
        where = ".".join(map(str, first["loc"])) or form.__name__
        return _faulty(
            answer,
            Fault.UNPARSABLE if broken else Fault.INVALID,
            f"{where}: {first['msg']} in '{shortened(said)}'",
        )
