"""The goal of a search."""

import re
from dataclasses import dataclass

from hypernav.core.errors import GoalError

_ARTICLE = re.compile(r"^(the|an?) ", re.IGNORECASE)


@dataclass(frozen=True)
class Goal:
    """A target, named as a person would: "bed", "L-shaped sofa", "the chair in the office"."""

    text: str

    def __post_init__(self) -> None:
        """Reject a goal that names nothing."""
        if not self.text.strip():
            raise GoalError("the goal is empty; say what to find, for example: bed")

    @property
    def thing(self) -> str:
        """The text without a leading article, for sentences about "the …"."""
        return _ARTICLE.sub("", self.text.strip())
