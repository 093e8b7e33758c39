"""From the probabilities of tokens to the probabilities of allowed answers.

A server tells, for each token that it wrote, how likely that token and some alternatives were.
An answer may take several tokens ("1" then "2"), so the alternatives are followed along the tokens
that were written. Where an alternative that was not written could have become several answers
("1" for 10, 11 and 12), its probability is shared equally among them: nothing more is known.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

_LEAST_MASS = 0.01
_BEFORE = " \t\r\n\"'"


@dataclass(frozen=True)
class TokenChances:
    """One token of an answer and what could have stood there.

    Attributes:
        token: What was written.
        chances: Probability by text, the written token included.
    """

    token: str
    chances: dict[str, float]


def read_logprobs(content: object) -> list[TokenChances]:
    """Read ``choices[0].logprobs.content`` of an OpenAI-compatible answer; empty if it is none."""
    if not isinstance(content, list):
        return []
    tokens = []
    for entry in content:
        if not isinstance(entry, dict) or not isinstance(entry.get("token"), str):
            return []
        top = entry.get("top_logprobs")
        chances: dict[str, float] = {}
        for one in [entry, *(top if isinstance(top, list) else [])]:
            text, logprob = one.get("token"), one.get("logprob")
            if isinstance(text, str) and isinstance(logprob, int | float) and text not in chances:
                chances[text] = math.exp(min(float(logprob), 0.0))
        tokens.append(TokenChances(entry["token"], chances))
    return tokens


def label_probabilities(
    tokens: Sequence[TokenChances], labels: Sequence[str], *, wrapped: bool = False
) -> dict[str, float]:
    """How likely each label was.

    Args:
        tokens: Of the whole answer.
        labels: The allowed answers.
        wrapped: The answer is the value of a one-entry JSON object.

    Returns:
        Probabilities that sum to 1, for all labels; empty if the tokens do not tell.
    """
    begin = _value_begin("".join(one.token for one in tokens), wrapped)
    offset = 0
    for index, one in enumerate(tokens):
        if offset + len(one.token) > begin:
            chances = dict.fromkeys((label.casefold() for label in labels), 0.0)
            _follow(tokens[index:], one.token[: begin - offset], "", 1.0, chances)
            total = sum(chances.values())
            if total < _LEAST_MASS:
                return {}
            return {label: chances[label.casefold()] / total for label in labels}
        offset += len(one.token)
    return {}


def _value_begin(text: str, wrapped: bool) -> int:
    if wrapped:
        match = re.search(r'\{\s*"[^"]*"\s*:\s*"?', text)
        return match.end() if match else len(text)
    return len(text) - len(text.lstrip(_BEFORE))


def _follow(
    tokens: Sequence[TokenChances], lead: str, said: str, mass: float, chances: dict[str, float]
) -> None:
    """Hand the mass of this position to the labels that each alternative leads to.

    Args:
        tokens: From this position on.
        lead: What the first token holds before the answer begins (a quote, a space).
        said: The part of the answer before this position.
        mass: How likely it was to come here.
        chances: By label; added to.
    """
    open_labels = [label for label in chances if label.startswith(said)]
    if not tokens:
        if said in chances:
            chances[said] += mass
        return
    for text, chance in tokens[0].chances.items():
        added = text.casefold()
        if not said:  # spaces and quotes before the answer may differ between alternatives
            added = added.removeprefix(lead.casefold()).lstrip(_BEFORE)
        longer = [label for label in open_labels if added and label.startswith(said + added)]
        ended = _ended_label(said + added, open_labels)
        if text == tokens[0].token and longer:
            _follow(tokens[1:], "", said + added, mass * chance, chances)
        elif longer:
            for label in longer:
                chances[label] += mass * chance / len(longer)
        elif ended is not None:
            chances[ended] += mass * chance


def _ended_label(text: str, labels: Sequence[str]) -> str | None:
    """The longest label that the text begins with and does not continue as a word."""
    fitting = [
        label
        for label in labels
        if text.startswith(label) and not text[len(label) : len(label) + 1].isalnum()
    ]
    return max(fitting, key=len, default=None)
