"""Probabilities of allowed answers, by the log-probabilities of tokens or a decision endpoint.

A server reports, for each generated token, the probability of that token and of some alternatives.
An answer may take several tokens ("1" then "2"), so the alternatives are followed along the
generated tokens. If an alternative that was not generated could have become several answers ("1"
for 10, 11 and 12), its probability is shared equally among them, since nothing more is known.

llama.cpp and vLLM report what the model would have said without the constraint, so that an allowed
answer may be missing among the alternatives. It is at most as probable as the least of them and has
its share of what they leave, and gets that much; where all such answers together could outweigh
what was reported, nothing is known.

A decision endpoint generates no text: it answers a closed question with a probability for every
allowed answer, by the scores of the answers' labels in one forward pass. Two forms exist: System
One (``POST /v1/systemone``; ``transformers serve``, see ``transformers/cli/serving/systemone.py``)
and OpenAI's Decisions (``POST /v1/decisions``; see ``openai/types/decision_create_params.py``; also
SGLang and LiteLLM).
"""

import math
import re
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hypernav.core.chat import Question, Usage
from hypernav.core.errors import ChatTransportError
from hypernav.search.models.chat.message_parts import (
    finite_number,
    jpeg_base64,
    jpeg_data_url,
    read_usage,
)

_MIN_MASS = 0.01
_LEAST = 1e-6
"""Probability of an answer that the alternatives leave no room for, as rounded numbers do."""
_MOST_ALTERNATIVES = 100
_BEFORE = " \t\r\n\"'"

_QUESTION = "question"
_SYSTEMONE_LIMIT = 26
_SYSTEMONE_IMAGES = 4
_DECISIONS_LIMIT = 255


@dataclass(frozen=True)
class TokenProbabilities:
    """One generated token and its alternatives.

    Attributes:
        token: Generated text.
        probabilities: Probability of each candidate text, the generated token included.
    """

    token: str
    probabilities: dict[str, float]


def parse_logprobs(content: object) -> list[TokenProbabilities]:
    """Read ``choices[0].logprobs.content`` of an OpenAI-compatible answer; empty if it has none."""
    if not isinstance(content, list):
        return []
    tokens = []
    for entry in content:
        if not isinstance(entry, dict) or not isinstance(entry.get("token"), str):
            return []
        top = entry.get("top_logprobs")
        probabilities: dict[str, float] = {}
        for one in [entry, *(top[:_MOST_ALTERNATIVES] if isinstance(top, list) else [])]:
            text = one.get("token") if isinstance(one, dict) else None
            logprob = finite_number(one.get("logprob")) if isinstance(one, dict) else None
            if isinstance(text, str) and logprob is not None and text not in probabilities:
                probabilities[text] = math.exp(min(logprob, 0.0))
        tokens.append(TokenProbabilities(entry["token"], probabilities))
    return tokens


def tokens_of_answer(tokens: Sequence[TokenProbabilities], answer: str) -> list[TokenProbabilities]:
    """The tokens from where the answer begins, without thoughts and wrappings before it.

    Args:
        tokens: Tokens of all that was written.
        answer: The final answer.

    Returns:
        The tokens; none where the answer isn't found among them.
    """
    begin = "".join(one.token for one in tokens).rfind(answer.strip())
    offset = 0
    for index, one in enumerate(tokens):
        offset += len(one.token)
        if answer.strip() and begin >= 0 and offset > begin:
            return list(tokens[index:])
    return []


def answer_probabilities(
    tokens: Sequence[TokenProbabilities], labels: Sequence[str], *, wrapped: bool = False
) -> dict[str, float]:
    """Probability of each label.

    Args:
        tokens: Tokens of the whole answer.
        labels: The allowed answers.
        wrapped: Whether the answer is the value of a one-entry JSON object.

    Returns:
        Probabilities that sum to 1, for all labels; empty if the tokens do not determine them.
    """
    begin = _value_begin("".join(one.token for one in tokens), wrapped)
    offset = 0
    for index, one in enumerate(tokens):
        if offset + len(one.token) > begin:
            reported = dict.fromkeys((label.casefold() for label in labels), 0.0)
            if not _may_begin(one.token[begin - offset :], list(reported)):
                return {}  # a sentence: its first word's alternatives tell nothing of the answer
            missing = dict(reported)
            _follow(tokens[index:], one.token[: begin - offset], "", 1.0, reported, missing)
            if sum(reported.values()) < max(_MIN_MASS, sum(missing.values())):
                return {}
            shares = {label: reported[label] or max(missing[label], _LEAST) for label in reported}
            total = sum(shares.values())
            return {label: shares[label.casefold()] / total for label in labels}
        offset += len(one.token)
    return {}


def _may_begin(token: str, labels: Sequence[str]) -> bool:
    """Whether a label can begin with a generated token, or the token with a label."""
    said = token.casefold().strip(_BEFORE)
    return any(label.startswith(said) for label in labels) or _ended_label(said, labels) is not None


def _value_begin(text: str, wrapped: bool) -> int:
    if wrapped:
        match = re.search(r'\{\s*"[^"]*"\s*:\s*"?', text)
        return match.end() if match else len(text)
    return len(text) - len(text.lstrip(_BEFORE))


def _follow(
    tokens: Sequence[TokenProbabilities],
    lead: str,
    said: str,
    mass: float,
    reported: dict[str, float],
    missing: dict[str, float],
) -> None:
    """Distribute the probability mass of this position over the labels it can still become.

    Args:
        tokens: Tokens from this position on.
        lead: Part of the first token before the answer begins (a quote, a space).
        said: The part of the answer before this position.
        mass: Probability of the tokens before this position.
        reported: Probability of each label so far; added to in place.
        missing: What a label has at most that no alternative of a position leads to; likewise.
    """
    open_labels = [label for label in reported if label.startswith(said)]
    if not tokens or open_labels == [said]:
        if said in reported:
            reported[said] += mass
        return
    unled = set(open_labels)
    for text, probability in tokens[0].probabilities.items():
        added = text.casefold()
        if not said:  # spaces and quotes before the answer may differ between alternatives
            added = added.removeprefix(lead.casefold()).lstrip(_BEFORE)
        longer = [label for label in open_labels if added and label.startswith(said + added)]
        ended = _ended_label(said + added, open_labels)
        if text == tokens[0].token and len(longer) > 1:
            _follow(tokens[1:], "", said + added, mass * probability, reported, missing)
        elif longer:  # a constraint leaves a single one no choice, whatever its next tokens have
            for label in longer:
                reported[label] += mass * probability / len(longer)
        elif ended is not None:
            reported[ended] += mass * probability
        unled.difference_update([*longer, ended])
    told = tokens[0].probabilities
    # The generated token is reported even where it is less probable than what is left out.
    least = min((one for text, one in told.items() if text != tokens[0].token), default=1.0)
    for label in unled:
        missing[label] += mass * min(least, max(1.0 - sum(told.values()), 0.0) / len(unled))


def _ended_label(text: str, labels: Sequence[str]) -> str | None:
    """The longest label that the text begins with and does not continue as a word."""
    fitting = [
        label
        for label in labels
        if text.startswith(label) and not text[len(label) : len(label) + 1].isalnum()
    ]
    return max(fitting, key=len, default=None)


def accepts_question(endpoint: str, question: Question) -> bool:
    """Whether the question is closed and within the endpoint's limits of answers and images."""
    answers = len(question.allowed)
    if endpoint == "systemone":
        return 2 <= answers <= _SYSTEMONE_LIMIT and len(question.images) <= _SYSTEMONE_IMAGES
    return endpoint == "decisions" and 2 <= answers <= _DECISIONS_LIMIT


def decision_request(
    endpoint: str, model: str, question: Question, *, quality: int
) -> dict[str, Any]:
    """Request body for a closed question.

    Args:
        endpoint: "systemone" or "decisions".
        model: Name of the model on the server.
        question: Closed question, accepted by `accepts_question`.
        quality: JPEG quality of the images, 1 to 100.
    """
    if endpoint == "systemone":
        assets = {
            f"<picture-{number}>": {
                "type": "image",
                "format": "jpeg",
                "data_base64": jpeg_base64(image, quality=quality),
            }
            for number, image in enumerate(question.images, start=1)
        }
        choice = {
            "type": "choice",
            "instructions": question.text,
            "criteria": dict.fromkeys(question.allowed),
        }
        state = "\n".join(assets)
        return {"model": model, "state": state, "questions": {_QUESTION: choice}, "assets": assets}
    images = [
        {"type": "input_image", "image_url": jpeg_data_url(image, quality=quality)}
        for image in question.images
    ]
    content = [*images, {"type": "input_text", "text": question.text}]
    return {
        "model": model,
        "input": [{"type": "message", "role": "user", "content": content}],
        "questions": [
            {
                "type": "choice",
                "name": _QUESTION,
                "instructions": question.text,
                "choices": [{"value": answer} for answer in question.allowed],
            }
        ],
    }


def parse_decision(
    endpoint: str, reply: dict[str, Any], question: Question
) -> tuple[str, dict[str, float], Usage, bool]:
    """Chosen answer, probabilities of the allowed answers, token usage, and whether it was refused.

    Raises:
        ChatTransportError: The reply does not have the endpoint's form.
    """
    answers = reply.get("answers")
    answer = answers.get(_QUESTION) if isinstance(answers, dict) else None
    if isinstance(answers, list) and answers:
        answer = answers[0]
    if not isinstance(answer, dict):
        raise ChatTransportError(f"the {endpoint} endpoint sent no answer: {reprlib.repr(reply)}")
    usage = read_usage(reply.get("usage"))
    if answer.get("type") == "refusal":
        return "", {}, usage, True
    probabilities = _probabilities(answer.get("probabilities"), question.allowed)
    chosen = answer.get("choice")
    if not isinstance(chosen, str) or not probabilities:
        raise ChatTransportError(f"the {endpoint} endpoint sent no choice: {reprlib.repr(answer)}")
    return chosen, probabilities, usage, False


def _probabilities(value: object, allowed: tuple[str, ...]) -> dict[str, float]:
    """Probabilities of all allowed answers; empty if one is missing or none is above 0."""
    if isinstance(value, list):
        entries = [entry for entry in value if isinstance(entry, dict)]
        value = {str(entry.get("value")): entry.get("probability") for entry in entries}
    if not isinstance(value, dict):
        return {}
    shares = [finite_number(value.get(answer)) for answer in allowed]
    known = [share for share in shares if share is not None and 0.0 <= share <= 1.0]
    total = sum(known)
    if len(known) < len(allowed) or total <= 0.0:
        return {}
    return {answer: share / total for answer, share in zip(allowed, known, strict=True)}
