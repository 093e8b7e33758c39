"""The bank of questions: which buildings and searches they come from, and how many of each.

No file holds the questions: they are made again, always the same, from the buildings' numbers.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from hypernav.core.goal import Goal
from hypernav.lab.datasets.building_splits import EXAM_BUILDINGS
from hypernav.lab.exam.questions import ExamQuestion, Kind

BankName = Literal["val", "train"]
ExamSize = Literal["quick", "full"]

BANK_VERSION = 3
"""Increased whenever the same numbers give other questions."""

_BUILDINGS = ("houses", "offices", "shops")
_MOST_SHEETS = 40
"""Largest number of sheets of a quick exam; if they give too few questions, fewer are asked."""

QUICK: dict[tuple[Kind, str], int] = {
    ("block", "map"): 60,
    ("boxes", "near"): 20,
    ("boxes", "far"): 15,
    ("boxes", "absent"): 15,
    ("boxes", "look-alike"): 15,
    ("presence", "there"): 15,
    ("presence", "not there"): 8,
    ("presence", "look-alike"): 7,
    ("near", "near"): 8,
    ("near", "far"): 8,
    ("arrow", "view"): 8,
    ("direction", "view"): 8,
    ("images", "shown"): 8,
    ("images", "none"): 8,
}
"""Questions of a quick exam by type and stratum, 203 in all; a full one has five times as many."""
_FULL = 5
VIEWS = 2
"""Number of questions about one goal that a sheet may give before those about another."""


@dataclass(frozen=True)
class Sheet:
    """One search in one building and views around it, the source of some of the questions.

    Attributes:
        number: Number in the bank, from 0.
        scene: Building, as ``hypernav find --scene`` understands it.
    """

    number: int
    scene: str

    def question_id(self, number: int, kind: Kind, stratum: str, goal: Goal) -> str:
        """Name of a question of this sheet, unique in the bank; `number` is a step's or thing's."""
        return f"{self.scene}/{self.number}/{kind}/{stratum}/{goal.text}/{number}"


@dataclass(frozen=True)
class Bank:
    """A bank of questions.

    Attributes:
        name: "val", which nothing is tuned on, or "train", for work on prompts.
        size: "quick", 203 questions, or "full", 1,015; masks are asked for besides.
        kinds: Types that are asked.
        quotas: Number of questions of a quick exam by type and stratum; None takes `QUICK`.
    """

    name: BankName
    size: ExamSize
    kinds: tuple[Kind, ...]
    quotas: dict[tuple[Kind, str], int] | None = None

    @property
    def wanted(self) -> dict[tuple[Kind, str], int]:
        """Number of questions by type and stratum; of masks as many as of near boxes."""
        factor = 1 if self.size == "quick" else _FULL
        quotas = dict(QUICK if self.quotas is None else self.quotas)
        quotas["mask", "near"] = quotas.get(("boxes", "near"), 0)
        return {key: factor * n for key, n in quotas.items() if key[0] in self.kinds and n}

    @property
    def count(self) -> int:
        """Number of questions."""
        return sum(self.wanted.values())

    def sheets(self) -> Iterator[Sheet]:
        """The sheets; houses, offices and shops take turns."""
        buildings, factor = EXAM_BUILDINGS[self.name], 1 if self.size == "quick" else _FULL
        for number in range(_MOST_SHEETS * factor):
            kind = _BUILDINGS[number % len(_BUILDINGS)]
            yield Sheet(number, f"{kind}:{buildings[number // len(_BUILDINGS)]}")

    def choose(
        self, found: Sequence[ExamQuestion], taken: Counter[tuple[Kind, str]]
    ) -> list[ExamQuestion]:
        """The questions of a sheet that are asked: at most a 15th of a quick exam's, by stratum.

        Of questions for boxes it is at least two, so that there are two views of one thing.

        Args:
            found: All questions of the sheet.
            taken: Number of questions of the sheets before, by type and stratum.
        """
        chosen: list[ExamQuestion] = []
        factor = 1 if self.size == "quick" else _FULL
        for key, wanted in self.wanted.items():
            least = VIEWS if key[0] == "boxes" else 1
            share = max(-(-wanted // (15 * factor)), least)
            room = min(share, wanted - taken[key])
            chosen += [one for one in found if (one.kind, one.stratum) == key][: max(room, 0)]
        return chosen


Gather = Callable[[Sheet], list[ExamQuestion]]
"""Makes all questions of a sheet."""
