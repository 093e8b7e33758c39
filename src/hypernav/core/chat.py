"""Questions to a model that reads images and writes text, and its answers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import UInt8
from pydantic import BaseModel

from hypernav.core.errors import (
    ConfigError,
    InvalidAnswerError,
    RefusalError,
    UnparsableAnswerError,
)

Image = UInt8[np.ndarray, "_ _ 3"]


@dataclass(frozen=True, eq=False)
class Question:
    """One question to a chat model.

    Attributes:
        kind: Purpose of the question (see `hypernav.core.trace.Exchange`); the ledger counts by it.
        text: Text of the prompt.
        images: RGB images that the text refers to, in order; sent as JPEG, quality 95 by default.
        allowed: The only possible answers; empty for an open question.
        form: Form of a JSON answer, as a pydantic model; None for an open question.
        max_tokens: Limit on the length of the answer, tokens.
        at_once: Whether the answer is asked for without reasoning before it: a reply that begins
            with prose, and is cut, may be nothing but thinking.
    """

    kind: str
    text: str
    images: tuple[Image, ...] = ()
    allowed: tuple[str, ...] = ()
    form: type[BaseModel] | None = None
    max_tokens: int = 256
    at_once: bool = False

    def __post_init__(self) -> None:
        """Reject a question that cannot be answered."""
        if self.allowed and self.form is not None:
            raise ConfigError("a question has either allowed answers or a form, not both")
        if len(set(self.allowed)) != len(self.allowed) or not all(map(str.strip, self.allowed)):
            raise ConfigError(f"allowed answers must be distinct and not blank: {self.allowed}")
        if self.max_tokens < 1:
            raise ConfigError(f"max_tokens must be at least 1, got {self.max_tokens}")


@dataclass(frozen=True)
class Usage:
    """Tokens of one exchange, as counted by the server; 0 if it does not say.

    Attributes:
        tokens_in: Tokens of the prompt, images included.
        tokens_out: Tokens of the answer, hidden reasoning included.
    """

    tokens_in: int = 0
    tokens_out: int = 0


class Fault(StrEnum):
    """Reasons why an answer cannot be used."""

    REFUSED = "refused"
    UNPARSABLE = "unparsable"
    INVALID = "invalid"
    CUT = "cut while thinking"


_FAULT_ERRORS = {
    Fault.REFUSED: RefusalError,
    Fault.UNPARSABLE: UnparsableAnswerError,
    Fault.INVALID: InvalidAnswerError,
    Fault.CUT: UnparsableAnswerError,
}


@dataclass(frozen=True)
class Answer:
    """The answer of a chat model.

    Attributes:
        text: Text of the answer, unchanged.
        model: Name of the model.
        value: One of the allowed answers, or an instance of the form, or the text of an open
            question; None if there is a fault.
        usage: Tokens of the exchange.
        seconds: Time from the question to the answer, waits between attempts included.
        probabilities: Probability of each allowed answer, if the model gives it; sums to 1.
        lost: Number of earlier attempts without an answer, by reason: "transport" or "timeout".
        fault: Reason why the text cannot be used; None if it can.
        detail: Description of the fault in words.
    """

    text: str
    model: str
    value: Any = None
    usage: Usage = Usage()
    seconds: float = 0.0
    probabilities: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    lost: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))
    fault: Fault | None = None
    detail: str = ""

    @property
    def attempts(self) -> int:
        """Number of times that the model was asked until it answered."""
        return 1 + sum(self.lost.values())

    def require(self) -> Any:
        """The value of the answer, if it can be used.

        Raises:
            RefusalError: The model declined.
            UnparsableAnswerError: The text is not of the kind that was asked for.
            InvalidAnswerError: The text is of that kind, but none of the possible answers.
        """
        if self.fault is not None:
            raise _FAULT_ERRORS[self.fault](f"{self.model}: {self.detail}")
        return self.value
