"""What a checker found, and where it was when something was raised."""

from collections.abc import Sequence
from types import TracebackType
from typing import Literal

from hypernav.core.errors import ContractError


class Faults:
    """Collects what is wrong, so that everything is said at once."""

    def __init__(self) -> None:
        """Begin with nothing wrong."""
        self.found: list[str] = []

    def expect(self, holds: bool, fault: str) -> bool:
        """Note a fault unless something holds; returns whether it does."""
        if not holds and fault not in self.found:
            self.found.append(fault)
        return holds

    def raise_if_any(self, what: str) -> None:
        """Say all faults in one error.

        Raises:
            ContractError: There are any.
        """
        if self.found:
            raise ContractError(f"{what} breaks its contract: {_listed(self.found)}")


class While:
    """Adds to whatever is raised in the ``with`` block where that happened."""

    def __init__(self, where: str) -> None:
        """Say where."""
        self._where = where

    def __enter__(self) -> None:
        """Nothing to do."""

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
