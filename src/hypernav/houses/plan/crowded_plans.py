"""Offices whose meeting rooms are open to the corridor by a wide passage at one end."""

from collections.abc import Sequence
from dataclasses import replace

from hypernav.houses.plan.doors import CASING_M, collide
from hypernav.houses.plan.office_plans import OFFICE_PLANS
from hypernav.houses.plan.public_plans import sample_public_plan
from hypernav.houses.plan.shapes import FloorPlan, Opening, Room
from hypernav.houses.random_stream import RandomStream

MEETING_ROOMS = ("meeting room", "conference room")
_WIDE_M = 1.5


def crowded_plan(rng: RandomStream, _number: int) -> FloorPlan:
    """Random floor plan of an office with open meeting rooms."""
    plan = sample_public_plan(rng, OFFICE_PLANS)
    openings = list(plan.openings)
    for number, room in enumerate(plan.rooms):
        if room.kind in MEETING_ROOMS:
            openings = _opened(rng, plan, number, openings)
    return replace(plan, openings=tuple(openings))


def wide_opening(openings: Sequence[Opening]) -> Opening | None:
    """The passage into a meeting room with only this entry; None for other rooms."""
    entries = [one for one in openings if one.is_passable]
    return entries[0] if len(entries) == 1 and entries[0].kind == "passage" else None


def screen_side(room: Room, opening: Opening) -> str:
    """Side of a room opposite an opening."""
    if opening.along == "x":
        return "north" if opening.at < room.cell.centre[1] else "south"
    return "east" if opening.at < room.cell.centre[0] else "west"


def _opened(
    rng: RandomStream, plan: FloorPlan, number: int, openings: list[Opening]
) -> list[Opening]:
    """The openings with the only door of a room made a passage at one end of its wall.

    The wall opposite loses its windows, for the screen.
    """
    own = [one for one in openings if number in one.rooms]
    doors = [one for one in own if one.is_passable]
    if len(doors) != 1:
        return openings
    door = doors[0]
    cells = [plan.rooms[k].cell for k in door.rooms]
    ends = [(c.x0, c.x1) if door.along == "x" else (c.y0, c.y1) for c in cells]
    low = max(end[0] for end in ends) + CASING_M + 0.06
    high = min(end[1] for end in ends) - CASING_M - 0.06
    if high - low < _WIDE_M:
        return openings
    start = low if rng.chance(0.5) else high - _WIDE_M
    passage = replace(
        door, kind="passage", start=round(start, 3), end=round(start + _WIDE_M, 3), leaf_room=-1
    )
    others = [one for one in openings if one is not door]
    if any(collide(passage, one) for one in others if one.is_passable):
        return openings

    def is_in_screens_wall(one: Opening) -> bool:
        across = one.along == passage.along and abs(one.at - passage.at) > 1.0
        return number in one.rooms and one.kind == "window" and across

    return [passage, *(one for one in others if not is_in_screens_wall(one))]
