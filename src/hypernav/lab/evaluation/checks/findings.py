"""Findings of an examination of a model or of data."""

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """Result of a check."""

    GOOD = "good"
    NOTE = "note"
    FAULT = "fault"


@dataclass(frozen=True)
class Finding:
    """The finding of one check.

    Attributes:
        check: Name of the check.
        state: Result of the check.
        said: Description of the finding.
        remedy: Change that helps; empty if none is needed.
        setting: Value of the configuration to use from now on, as ``--set`` takes it.
    """

    check: str
    state: State
    said: str
    remedy: str = ""
    setting: str = ""
