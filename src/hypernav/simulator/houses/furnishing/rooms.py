"""Furnishing of all rooms of a building, one after the other."""

from collections.abc import Callable
from dataclasses import dataclass

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.hidden_objects import remove_hidden
from hypernav.simulator.houses.furnishing.room_layout import RoomLayout
from hypernav.simulator.houses.modelling.materials import Palette, vary
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.houses.random_stream import RandomStream

_ATTEMPTS = 12

RequiredGroups = tuple[tuple[str, ...], ...]
"""Categories that a room must hold: at least one of each group."""


@dataclass(frozen=True)
class Furnishing:
    """Rules by which the rooms of one kind of building are furnished.

    Attributes:
        required: Gives the groups of categories that the room with an index must hold.
        furnish: Furnishes an empty room by its kind.
        dress: Adds what hangs on walls and ceilings of a furnished room.
    """

    required: Callable[[FloorPlan, int], RequiredGroups]
    furnish: Callable[[RoomLayout], None]
    dress: Callable[[RoomLayout], None]


def furnish_rooms(
    plan: FloorPlan, rules: Furnishing, palette: Palette, rng: RandomStream
) -> list[PlacedModel]:
    """Random furniture and other objects of all rooms."""
    pieces: list[PlacedModel] = []
    for number, room in enumerate(plan.rooms):
        if plan.stairwell is not None and number == plan.stairwell.room:
            continue
        own = rng.fork("room", number)
        layout = _best_layout(plan, number, rules, own, vary(palette, own.fork("taste")))
        if not room.is_outside:
            rules.dress(layout)
        remove_hidden(layout)
        pieces += layout.placed
    return pieces


def _best_layout(
    plan: FloorPlan, number: int, rules: Furnishing, rng: RandomStream, palette: Palette
) -> RoomLayout:
    """Layout of a room with all required objects, or the best of several attempts."""
    required = rules.required(plan, number)
    best: tuple[int, RoomLayout] | None = None
    for attempt in range(_ATTEMPTS):
        layout = RoomLayout(plan, number, rng.fork("attempt", attempt), palette)
        rules.furnish(layout)
        there = {p.model.category for p in layout.placed}
        score = sum(any(name in there for name in group) for group in required)
        if best is None or score > best[0]:
            best = (score, layout)
        if score == len(required):
            break
    assert best is not None
    return best[1]
