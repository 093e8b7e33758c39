"""The faults that a checker finds, and notes on errors that a call raises."""

from collections.abc import Sequence
from types import TracebackType
from typing import Literal

from hypernav.core.errors import ContractError


class Faults:
    """Collects faults, so that one error lists them all."""

    def __init__(self) -> None:
        """Begin without faults."""
        self.found: list[str] = []

    def expect(self, holds: bool, fault: str) -> bool:
        """Add a fault unless a condition holds; return whether it holds."""
        if not holds and fault not in self.found:
            self.found.append(fault)
        return holds

    def raise_if_any(self, what: str) -> None:
        """Raise one error that lists all faults.

        Raises:
            ContractError: There are faults.
        """
        if self.found:
            raise ContractError(f"{what} breaks its contract: {_listed(self.found)}")


class While:
    """Adds a note to an error raised in the ``with`` block: what the checker was doing."""

    def __init__(self, where: str) -> None:
        """Say what the checker does in the block, for example "called reset(goal)"."""
        self._where = where

    def __enter__(self) -> None:
        """Enter the block."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        """Add the note."""
        if error is not None:
            error.add_note(f"raised while the checker {self._where}")
        return False


def _listed(faults: Sequence[str]) -> str:
    if len(faults) == 1:
        return faults[0]
    return "".join(f"\n  {number}. {fault}" for number, fault in enumerate(faults, 1))
