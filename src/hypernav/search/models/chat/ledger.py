"""Ledger of model calls: tokens, seconds and retries by kind of question."""

import threading
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from hypernav.core.chat import Answer, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ModelUnavailableError


@dataclass
class LedgerRow:
    """Sums over the questions of one kind.

    Attributes:
        calls: Questions asked.
        tokens_in: Prompt tokens.
        tokens_out: Answer tokens.
        seconds: Time spent waiting; questions that overlapped count in full.
        retries: Attempts beyond the first.
        lost: Number of failed attempts by reason, "transport" or "timeout".
        faults: Unusable answers and given-up questions, by their reason.
    """

    calls: int = 0
    tokens_in: int = 0
    tokens_out: int = 0
    seconds: float = 0.0
    retries: int = 0
    lost: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)

    def add(self, other: "LedgerRow") -> None:
        """Add another row's sums."""
        self.calls += other.calls
        self.tokens_in += other.tokens_in
        self.tokens_out += other.tokens_out
        self.seconds += other.seconds
        self.retries += other.retries
        self.lost.update(other.lost)
        self.faults.update(other.faults)

    def as_dict(self) -> dict[str, Any]:
        """Sums as JSON values."""
        return {
            "calls": self.calls,
            "tokens_in": self.tokens_in,
            "tokens_out": self.tokens_out,
            "seconds": self.seconds,
            "retries": self.retries,
            "lost": dict(sorted(self.lost.items())),
            "faults": dict(sorted(self.faults.items())),
        }


class Ledger:
    """Counts questions and their costs. Safe to share between threads."""

    def __init__(self) -> None:
        """Begin at zero."""
        self._rows: dict[str, LedgerRow] = {}
        self._lock = threading.Lock()

    def record(self, question: Question, answer: Answer) -> None:
        """Count one answered question."""
        row = LedgerRow(
            calls=1,
            tokens_in=answer.usage.tokens_in,
            tokens_out=answer.usage.tokens_out,
            seconds=answer.seconds,
            retries=answer.attempts - 1,
            lost=Counter(answer.lost),
        )
        if answer.fault is not None:
            row.faults[answer.fault.value] += 1
        self._add(question.kind, row)

    def record_unavailable(self, question: Question) -> None:
        """Count a question that was given up."""
        self._add(question.kind, LedgerRow(calls=1, faults=Counter(unavailable=1)))

    def clear(self) -> None:
        """Reset all counts."""
        with self._lock:
            self._rows.clear()

    @property
    def total(self) -> LedgerRow:
        """The sums over all kinds."""
        total = LedgerRow()
        with self._lock:
            for row in self._rows.values():
                total.add(row)
        return total

    def as_dict(
        self,
        *,
        price_in_per_million: float | None = None,
        price_out_per_million: float | None = None,
    ) -> dict[str, Any]:
        """Ledger as JSON values, for ``result.json``.

        Args:
            price_in_per_million: Price of a million prompt tokens, in any currency.
            price_out_per_million: Price of a million answer tokens.

        Returns:
            ``total``, ``kinds`` and, if a price is given, ``cost`` in the price's currency.
        """
        total = self.total
        with self._lock:
            kinds = {kind: row.as_dict() for kind, row in sorted(self._rows.items())}
        result: dict[str, Any] = {"total": total.as_dict(), "kinds": kinds}
        if price_in_per_million is not None or price_out_per_million is not None:
            result["cost"] = (
                total.tokens_in * (price_in_per_million or 0.0)
                + total.tokens_out * (price_out_per_million or 0.0)
            ) / 1e6
        return result

    def _add(self, kind: str, row: LedgerRow) -> None:
        with self._lock:
            self._rows.setdefault(kind, LedgerRow()).add(row)


class LedgerChat:
    """A chat model whose questions are counted in a ledger."""

    def __init__(self, model: ChatModel, ledger: Ledger) -> None:
        """Create it around a model."""
        self._model = model
        self.ledger = ledger

    def identify(self) -> str:
        """The model's name."""
        return self._model.identify()

    def ask(self, question: Question) -> Answer:
        """Ask the model and count."""
        try:
            answer = self._model.ask(question)
        except ModelUnavailableError:
            self.ledger.record_unavailable(question)
            raise
        self.ledger.record(question, answer)
        return answer
