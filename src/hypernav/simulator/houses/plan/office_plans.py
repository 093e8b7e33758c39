"""Random floor plans of offices, in five common layouts.

*Corridor*: rooms on one or both sides of a long corridor. *Open plan*: a hall of desks with rooms
at its sides. *Ring*: two corridors around a core without windows, joined at their ends. *Comb*:
wings with dead ends off a spine. *Courtyard*: a corridor around a yard.

In crowded offices the meeting rooms are open to the corridor by a wide passage at one end.
"""

from collections.abc import Sequence
from dataclasses import replace

from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Opening, Rect, Room
from hypernav.simulator.houses.plan.openings import CASING_M, collide
from hypernav.simulator.houses.plan.public_plans import (
    Cell,
    Circulation,
    Layout,
    PlanRules,
    StripProgram,
    Width,
    WindowRule,
    fill_strip,
    sample_public_plan,
    snapped,
)
from hypernav.simulator.houses.random_stream import RandomStream

_WIDTHS = {
    "office": Width(2.6, 3.3, 4.6),
    "open office": Width(6.5, 10.0, 17.0),
    "meeting room": Width(3.3, 4.2, 6.2),
    "conference room": Width(5.2, 6.6, 9.0),
    "restroom": Width(2.1, 2.6, 3.8),
    "pantry": Width(2.8, 3.8, 5.6),
    "copy room": Width(2.0, 2.5, 3.4),
    "storage": Width(1.9, 2.4, 3.8),
    "server room": Width(2.2, 2.7, 3.6),
    "lounge": Width(4.0, 5.2, 8.0),
}
_OUTER_FILLERS = (("office", 5.0), ("meeting room", 1.5), ("open office", 1.2))
_CORE_FILLERS = (("storage", 1.0), ("meeting room", 1.5), ("copy room", 1.0))
_CIRCULATION = Circulation(
    ("corridor", "reception", "open office"),
    {"meeting room": 0.4, "conference room": 0.6, "pantry": 0.5, "lounge": 0.6, "copy room": 0.3},
    ("reception", "corridor", "open office"),
)
_WINDOWS = {
    **dict.fromkeys(("office", "open office", "meeting room", "conference room"), WindowRule()),
    **dict.fromkeys(("pantry", "lounge", "reception"), WindowRule(2.4)),
    "corridor": WindowRule(3.5, 1.2),
}

MEETING_ROOMS = ("meeting room", "conference room")
_WIDE_M = 1.5


def _service(area: float) -> list[str]:
    """Rooms that an office of an area needs besides desks, the most important first."""
    kinds = ["restroom", "office", "pantry", "meeting room"]
    kinds += ["copy room"] if area > 110.0 else []
    kinds += ["storage"] if area > 150.0 else []
    kinds += ["server room", "conference room"] if area > 220.0 else []
    kinds += ["restroom", "lounge", "open office"] if area > 320.0 else []
    kinds += ["meeting room", "copy room", "open office"] if area > 450.0 else []
    return kinds


def _outer(rng: RandomStream, strip: Rect, along: str, wanted: list[str]) -> list[Cell]:
    return fill_strip(rng, strip, along, StripProgram(wanted, _OUTER_FILLERS, _WIDTHS))


def _complete(*strips: list[Cell]) -> list[Cell]:
    """Rooms of all strips; none if a strip has none."""
    return [cell for strip in strips for cell in strip] if all(strips) else []


def _corridor(rng: RandomStream, area: float) -> list[Cell]:
    """A reception at one end of a corridor with rooms on one or both sides."""
    one_sided = area < 100.0 or (area < 280.0 and rng.chance(0.2))
    wide = rng.uniform(1.6, 2.2, 0.05)
    north = rng.uniform(3.8, 5.4, 0.05)
    south = 0.0 if one_sided else rng.uniform(3.4, 5.4, 0.05)
    deep = snapped(south + wide + north)
    lobby = rng.uniform(3.6, 5.6, 0.05)
    long = snapped(max(area / deep, lobby + 7.0))
    middle, upper = snapped(south), snapped(south + wide)
    service = _service(area)
    cells: list[Cell] = [
        ("reception", Rect(0.0, 0.0, lobby, deep)),
        ("corridor", Rect(lobby, middle, long, upper)),
    ]
    row = Rect(lobby, upper, long, deep)
    if one_sided:
        return _complete(cells, _outer(rng, row, "x", service))
    return _complete(
        cells,
        _outer(rng, row, "x", service[::2]),
        _outer(rng, Rect(lobby, 0.0, long, middle), "x", service[1::2]),
    )


def _open_plan(rng: RandomStream, area: float) -> list[Cell]:
    """A hall of desks with a strip of rooms on one or two sides and a reception at its end."""
    two = area > 260.0 and rng.chance(0.6)
    north = rng.uniform(3.2, 4.6, 0.05)
    south = rng.uniform(3.2, 4.6, 0.05) if two else 0.0
    lobby = rng.uniform(3.6, 5.0, 0.05) if area > 110.0 else 0.0
    hall = snapped(min(max((0.55 * area) ** 0.5 * rng.uniform(0.6, 0.85), 4.5), 12.0))
    deep = snapped(south + hall + north)
    long = snapped(max(area / deep, lobby + 6.0))
    low, high = snapped(south), snapped(south + hall)
    service = _service(area)
    cells: list[Cell] = [("open office", Rect(lobby, low, long, high))]
    if lobby:
        cells.append(("reception", Rect(0.0, low, lobby, high)))
    fillers = (("meeting room", 2.0), ("office", 3.0), ("storage", 0.5))
    program = StripProgram(
        [k for k in service if k not in ("office", "open office")], fillers, _WIDTHS
    )
    rows = [fill_strip(rng, Rect(lobby, high, long, deep), "x", program)]
    if two:
        few = StripProgram(["meeting room", "lounge"], fillers, _WIDTHS)
        rows.append(fill_strip(rng, Rect(lobby, 0.0, long, low), "x", few))
    return _complete(cells, *rows)


def _ring(rng: RandomStream, area: float) -> list[Cell]:
    """Rooms at the outer walls, a core without windows, and a corridor around it."""
    wide = rng.uniform(1.6, 2.0, 0.05)
    south, north = rng.uniform(3.8, 5.4, 0.05), rng.uniform(3.8, 5.4, 0.05)
    core = rng.uniform(2.8, 4.6, 0.05)
    a, b = snapped(south), snapped(south + wide)
    c, d = snapped(south + wide + core), snapped(south + 2 * wide + core)
    deep = snapped(d + north)
    long = snapped(area / deep)
    if long < 2 * wide + 7.0:
        return []
    service = _service(area)
    inner = [k for k in service if k in ("restroom", "storage", "server room", "copy room")]
    rest = [k for k in service if k not in inner]
    lobby = rng.uniform(4.0, 6.0, 0.05)
    cells: list[Cell] = [
        ("corridor", Rect(0.0, a, long, b)),
        ("corridor", Rect(0.0, c, long, d)),
        ("corridor", Rect(0.0, b, wide, c)),
        ("corridor", Rect(snapped(long - wide), b, long, c)),
        ("reception", Rect(0.0, 0.0, lobby, a)),
    ]
    block = Rect(wide, b, snapped(long - wide), c)
    return _complete(
        cells,
        _outer(rng, Rect(lobby, 0.0, long, a), "x", rest[::2]),
        _outer(rng, Rect(0.0, d, long, deep), "x", rest[1::2]),
        fill_strip(rng, block, "x", StripProgram(inner, _CORE_FILLERS, _WIDTHS)),
    )


def _comb(rng: RandomStream, area: float) -> list[Cell]:
    """Wings with a corridor each, which ends at a window, off a spine with rooms."""
    wings = 2 if area < 420.0 else rng.choice((2, 3))
    wide, deep = rng.uniform(1.6, 2.0, 0.05), rng.uniform(3.2, 4.2, 0.05)
    south = rng.uniform(3.8, 5.0, 0.05)
    gap = rng.choice((0.0, 4.0, 5.0))
    wing = snapped(2 * deep + wide)
    long = snapped(wings * wing + (wings - 1) * gap)
    low, high = snapped(south), snapped(south + wide)
    top = snapped(high + (area - long * high) / (wings * wing))
    if not 6.5 <= top - high <= 26.0:
        return []
    service = _service(area)
    lobby = rng.uniform(4.0, 6.0, 0.05)
    cells: list[Cell] = [
        ("reception", Rect(0.0, 0.0, lobby, low)),
        ("corridor", Rect(0.0, low, long, high)),
    ]
    strips = [_outer(rng, Rect(lobby, 0.0, long, low), "x", service[:4])]
    for k in range(wings):
        x0 = snapped(k * (wing + gap))
        x1, x2, x3 = snapped(x0 + deep), snapped(x0 + deep + wide), snapped(x0 + wing)
        own = service[4 + k :: wings]
        cells.append(("corridor", Rect(x1, high, x2, top)))
        strips.append(_outer(rng, Rect(x0, high, x1, top), "y", own[::2]))
        strips.append(_outer(rng, Rect(x2, high, x3, top), "y", own[1::2]))
    return _complete(cells, *strips)


def _courtyard(rng: RandomStream, area: float) -> list[Cell]:
    """Rooms at the outer walls and a corridor inside them, with windows to a yard."""
    wide, deep = rng.uniform(1.6, 2.0, 0.05), rng.uniform(3.6, 4.8, 0.05)
    yard = rng.uniform(4.0, 8.0, 0.05)
    rim = snapped(deep + wide)
    high = snapped(2 * rim + yard)
    long = snapped((area - 2 * rim * yard) / (2 * rim))
    if long < 2 * rim + 4.0:
        return []
    a, b, c, d = (snapped(v) for v in (deep, rim, rim + yard, high - deep))
    x1, x2, x3, x4 = (snapped(v) for v in (deep, rim, long - rim, long - deep))
    service = _service(area)
    lobby = rng.uniform(4.0, 6.0, 0.05)
    cells: list[Cell] = [
        ("corridor", Rect(x1, a, x4, b)),
        ("corridor", Rect(x1, c, x4, d)),
        ("corridor", Rect(x1, b, x2, c)),
        ("corridor", Rect(x3, b, x4, c)),
        ("reception", Rect(x1, 0.0, snapped(x1 + lobby), a)),
    ]
    return _complete(
        cells,
        _outer(rng, Rect(snapped(x1 + lobby), 0.0, long, a), "x", service[::3]),
        _outer(rng, Rect(0.0, d, long, high), "x", service[1::3]),
        _outer(rng, Rect(0.0, 0.0, x1, d), "y", service[2::3]),
        _outer(rng, Rect(x4, a, long, d), "y", []),
    )


OFFICE_PLANS = PlanRules(
    (
        Layout(_corridor, 0.0, 3.0, _CIRCULATION),
        Layout(_open_plan, 0.0, 3.0, _CIRCULATION),
        Layout(_ring, 190.0, 2.5, _CIRCULATION),
        Layout(_comb, 250.0, 2.5, _CIRCULATION),
        Layout(_courtyard, 330.0, 2.5, _CIRCULATION),
    ),
    _WINDOWS,
    (2.6, 3.0),
)
"""Rules of the floor plans of offices."""


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
