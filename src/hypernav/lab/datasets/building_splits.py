"""The splits of the generated buildings: which buildings each has, and how many episodes.

Their episodes are files of this package (`shipped`), so that a run needs no generator before it
opens a building.
"""

import difflib
from dataclasses import dataclass
from typing import Literal

from hypernav.core.errors import EpisodeError
from hypernav.core.naming.words import is_whole_number

GoalStyle = Literal["categories", "phrases", "lives"]
"""What episodes ask for; the goals of a life are categories and phrases in turn."""
EPISODES_PER_HOUSE = 28
"""Greatest number of episodes of a building."""
LIVES_PER_BUILDING = 4
"""Greatest number of lives of a building."""
EXAM_BUILDINGS = {"val": range(9000, 9100), "train": range(7000, 7100)}
"""Buildings of the exam's banks, of every kind. No split may have those of val."""

EPISODES_PER_ROUND = 4
"""Number of consecutive episodes in the same building; of lives it is one."""

_MOST_HOUSES = 100_000


@dataclass(frozen=True)
class BuildingSplit:
    """Named set of buildings of one kind with episodes of one style.

    Attributes:
        name: Name of the split.
        kind: Kind of the buildings: "houses", "offices", "shops", "crowded" or
            "storeys".
        style: What the episodes ask for; "lives" for lives.
        numbers: Numbers of the buildings; for an open split the default ones.
        episodes: Number of episodes in these buildings, or of lives.
        is_open: Whether all buildings that belong to no other split, and not to the exam, may be
            used.
    """

    name: str
    kind: str
    style: GoalStyle
    numbers: range
    episodes: int
    is_open: bool = False

    @property
    def has_lives(self) -> bool:
        """Whether its episodes are goals of lives; then every count of this split is of lives."""
        return self.style == "lives"

    @property
    def per_round(self) -> int:
        """Number of consecutive episodes, or lives, in the same building."""
        return 1 if self.has_lives else EPISODES_PER_ROUND

    @property
    def per_building(self) -> int:
        """Greatest number of episodes, or lives, of a building."""
        return LIVES_PER_BUILDING if self.has_lives else EPISODES_PER_HOUSE

    def check(self, numbers: range) -> None:
        """Refuse buildings that don't belong to this split.

        Raises:
            EpisodeError: Some don't belong to it, or the range is empty.
        """
        said = f"{numbers.start}:{numbers.stop}"
        if len(numbers) > _MOST_HOUSES:
            raise EpisodeError(f"{self.kind} {said}: at most {_MOST_HOUSES:,} at once")
        if not numbers or numbers.step != 1 or numbers.start < 0:
            raise EpisodeError(
                f"{self.kind} {said}: expected FIRST:END with 0 <= FIRST < END, for example "
                f"{self.numbers.start}:{self.numbers.start + 4} (END is not included)"
            )
        if not self.is_open:
            if numbers.start < self.numbers.start or numbers.stop > self.numbers.stop:
                raise EpisodeError(
                    f"{self.kind} {said}: {self.name} has the {self.kind} "
                    f"{self.numbers.start}:{self.numbers.stop} (the end is not included)"
                )
            return
        exam = EXAM_BUILDINGS["val"]
        if _overlap(numbers, exam):
            raise EpisodeError(
                f"{self.kind} {said}: {exam.start}:{exam.stop} belong to hypernav exam, which "
                f"nothing is tuned on; choose others for {self.name}"
            )
        for other in SPLITS.values():
            closed = other.kind == self.kind and not other.is_open
            if closed and _overlap(numbers, other.numbers):
                raise EpisodeError(
                    f"{self.kind} {said}: {other.numbers.start}:{other.numbers.stop} belong to "
                    f"{other.name}; choose others for {self.name}"
                )


SPLITS = {
    split.name: split
    for split in (
        BuildingSplit("houses-val", "houses", "categories", range(1000, 1036), 1000),
        BuildingSplit("houses-ovon", "houses", "phrases", range(2000, 2036), 1000),
        BuildingSplit(
            "houses-train", "houses", "categories", range(3000, 3036), 1000, is_open=True
        ),
        BuildingSplit("offices-val", "offices", "categories", range(1000, 1025), 300),
        BuildingSplit(
            "offices-train", "offices", "categories", range(3000, 3025), 300, is_open=True
        ),
        BuildingSplit("shops-val", "shops", "categories", range(1000, 1025), 300),
        BuildingSplit("shops-train", "shops", "categories", range(3000, 3025), 300, is_open=True),
        BuildingSplit(
            "crowded-train", "crowded", "categories", range(3000, 3025), 300, is_open=True
        ),
        BuildingSplit("storeys-val", "storeys", "categories", range(1000, 1025), 300),
        BuildingSplit("storeys-test", "storeys", "categories", range(2000, 2025), 300),
        BuildingSplit(
            "storeys-train", "storeys", "categories", range(3000, 3025), 300, is_open=True
        ),
        *(
            BuildingSplit(f"{kind}-life-{name}", kind, "lives", range(first, first + 25), 100)
            for kind in ("houses", "offices", "storeys")
            for name, first in (("val", 4000), ("train", 5000))
        ),
    )
}
"""All splits by name."""


def split_named(name: str) -> BuildingSplit:
    """Split of a name.

    Raises:
        EpisodeError: There is none of this name.
    """
    if name not in SPLITS:
        near = difflib.get_close_matches(name, SPLITS, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(SPLITS)}"
        raise EpisodeError(f"unknown split '{name}'; {hint}")
    return SPLITS[name]


def numbers_of(split: str, part: str) -> range:
    """The buildings that a part of a split means, as in ``houses-train#3000:3004``.

    Args:
        split: Name of the split.
        part: ``FIRST:END``, or one number.

    Raises:
        EpisodeError: The text is neither.
    """
    first, colon, end = part.partition(":")
    if not is_whole_number(first) or (colon and not is_whole_number(end)):
        raise EpisodeError(
            f"{split}#{part:.40}: expected house numbers, for example {split}#3000:3004 (END is "
            f"not included) or {split}#3000"
        )
    return range(int(first), int(end) if colon else int(first) + 1)


def _overlap(a: range, b: range) -> bool:
    return a.start < b.stop and b.start < a.stop
