"""A start that a robot doesn't know, as one turn around shows it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hypernav.core.observation import Observation
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.relocalization import Relocalization, relocalized


@dataclass(frozen=True)
class FoundStart:
    """Where a robot took itself to be in its memory.

    Attributes:
        place: The likeliest place; None if there was nothing to compare.
        turns: Number of turns that it took to look around; they are no steps of the search.
        is_refused: Whether what it sees contradicts the map at that place.
    """

    place: Relocalization | None
    turns: int
    is_refused: bool = False

    @property
    def doubt(self) -> str:
        """The reason why the place may be wrong, for people; empty if it is sure."""
        if self.place is None:
            return "there is no obstacle to compare"
        if self.is_refused:
            return "what the robot sees contradicts the map at the likeliest place"
        return self.place.doubt

    def as_dict(self) -> dict[str, Any]:
        """Values for ``result.json``; floors count from 1."""
        place = self.place
        known = (
            {}
            if place is None
            else {
                "floor": place.floor + 1,
                "evidence": round(place.evidence, 3),
                "rival": round(place.rival, 3),
            }
        )
        return {"sure": not self.doubt, "doubt": self.doubt, "turns": self.turns, **known}


def found_by_turn(memory: Memory, frames: Sequence[Observation]) -> FoundStart:
    """Where a robot is in its memory, by what a turn on the spot shows.

    Args:
        memory: What is known of the building; it is not changed.
        frames: The frames before, between and after the turns, at least one, in an upright frame
            of the robot's own.
    """
    return FoundStart(relocalized(memory, frames), turns=len(frames) - 1)
