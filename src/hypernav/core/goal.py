"""The goal of a search."""

import re
import unicodedata
from dataclasses import dataclass

from hypernav.core.errors import GoalError
from hypernav.core.naming.words import composed, without_lead_in

MAX_GOAL_LENGTH = 500
"""Maximum length of a goal, characters: several sentences, short enough for every prompt."""

_ARTICLE = re.compile(r"^(the|an?) ", re.IGNORECASE)
_VOWEL = re.compile(
    r"(?!uni|use|uti|euro|one\b|one-)[aeiou]|hour|honest|heir|[fhlmnrsx]-", re.IGNORECASE
)
_WITHOUT_ARTICLE = re.compile(r"(?:equipment|furniture|clothes|food|water|[^su]s)$", re.IGNORECASE)
_SENTENCE = re.compile(r"[.!?;:](?: |$)|\b(?:is|are|was|were)\b")
"""An end of a sentence, or the verb of most descriptions: "The couch is near the window"."""
_VISIBLE = set("LNS")
"""Unicode's letters, numbers and symbols: a goal without any of them names nothing."""
_UNPRINTABLE = {"Cc": "a control character", "Cs": "half a character, which is no valid UTF-8"}


@dataclass(frozen=True)
class Goal:
    """A target in a person's words: "bed", "L-shaped sofa", "the chair in the office".

    Its text is kept in composed form, so that equal goals are equal texts in files and memories.
    """

    text: str

    def __post_init__(self) -> None:
        """Reject a goal that names nothing or cannot be read.

        Raises:
            GoalError: The text is empty, too long, or holds control characters or broken UTF-8.
        """
        object.__setattr__(self, "text", composed(self.text))
        if not self.text.strip():
            raise GoalError("the goal is empty; say what to find, for example: bed")
        if len(self.text) > MAX_GOAL_LENGTH:
            raise GoalError(
                f"the goal has {len(self.text)} characters, at most {MAX_GOAL_LENGTH} are read; "
                f"it begins with {self.text[:40]!r}"
            )
        for character in self.text:
            if kind := _UNPRINTABLE.get(unicodedata.category(character)):
                raise GoalError(
                    f"the goal holds {kind} (U+{ord(character):04X}); write it in plain text"
                )
        if not any(unicodedata.category(character)[0] in _VISIBLE for character in self.text):
            raise GoalError(f"the goal {self.text!a} names nothing; for example: bed")

    @property
    def thing(self) -> str:
        """The text without a leading article, for sentences about "the …"."""
        return _ARTICLE.sub("", self.text.strip())

    @property
    def in_sentence(self) -> str:
        """The goal within a sentence: "the bed", or in quotation marks if it is one itself."""
        thing = self.thing
        if _SENTENCE.search(thing) or without_lead_in(thing.lower()) != thing.lower():
            return f"“{self.text.strip()}”"
        return f"the {thing}"

    @property
    def with_article(self) -> str:
        """The thing with the right article: "a bed", "an umbrella", "stairs"."""
        if _WITHOUT_ARTICLE.search(self.thing):
            return self.thing
        return f"{'an' if _VOWEL.match(self.thing) else 'a'} {self.thing}"

    def named_in(self, text: str) -> str:
        """A text with the goal for ``{goal}``, and with its right article for ``a {goal}``."""
        return text.replace("a {goal}", self.with_article).replace("{goal}", self.thing)
