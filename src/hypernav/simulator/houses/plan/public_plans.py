"""Random floor plans of public buildings, whose rooms open off corridors and halls."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

from hypernav.simulator.houses.plan.floor_plan import (
    WALL_M,
    FloorPlan,
    Opening,
    Rect,
    Room,
    named_rooms,
)
from hypernav.simulator.houses.plan.home_plans import centred
from hypernav.simulator.houses.plan.openings import (
    CASING_M,
    PASSAGE_TOP_M,
    SharedWall,
    collide,
    hang_door,
    is_free,
    outer_walls,
    sample_entrance,
    shared_walls,
)
from hypernav.simulator.houses.random_stream import RandomStream

STEP_M = 0.05
"""Raster of all walls, metres."""

Cell = tuple[str, Rect]
"""Kind of a room, and its floor up to the centre lines of its walls."""

_SPINES = {"corridor", "arcade"}
_SECOND_ENTRY_M = 8.0
"""Least length of a wall between two public rooms that gets two passages, metres."""

LEAST_M2, MOST_M2 = 60.0, 800.0
"""Least and greatest area of all rooms of a public building, walls included."""

_ATTEMPTS = 60
"""Number of attempts with one layout before the simplest replaces it."""


@dataclass(frozen=True)
class Width:
    """Width of a kind of room along its strip, metres."""

    least: float
    usual: float
    most: float


@dataclass(frozen=True)
class StripProgram:
    """The rooms of a strip.

    Attributes:
        wanted: Kinds of the rooms that it should hold; those that find no space are left out.
        fillers: Kinds that fill the rest, with their weights.
        widths: Width of every kind.
    """

    wanted: Sequence[str]
    fillers: Sequence[tuple[str, float]]
    widths: Mapping[str, Width]


def snapped(value: float) -> float:
    """Length on the raster of walls."""
    return round(round(value / STEP_M) * STEP_M, 4)


def fill_strip(rng: RandomStream, strip: Rect, along: str, program: StripProgram) -> list[Cell]:
    """Rooms side by side that fill a strip, in random order.

    Args:
        rng: Source of randomness.
        strip: Floor of the strip.
        along: Axis that the rooms follow each other on, "x" or "y".
        program: What it holds.

    Returns:
        The rooms; empty if none of the program's rooms fits.
    """
    length = strip.width if along == "x" else strip.depth
    widths = program.widths
    kinds: list[str] = []
    for kind in program.wanted:
        if sum(widths[k].least for k in (*kinds, kind)) <= length:
            kinds.append(kind)
    for _ in range(60):
        if kinds and sum(widths[k].usual for k in kinds) > 0.9 * length:
            break
        kind = rng.weighted(program.fillers)
        if sum(widths[k].least for k in (*kinds, kind)) <= length:
            kinds.append(kind)
    if sum(widths[k].most for k in kinds) < length:
        return []
    kinds = rng.shuffled(kinds)
    edges = [snapped(e) for e in accumulate(_fitted([widths[k] for k in kinds], length))]
    edges[-1] = length
    cells = []
    start = 0.0
    for kind, end in zip(kinds, edges, strict=True):
        cells.append((kind, _slice(strip, along, start, end)))
        start = end
    return cells


def _fitted(widths: Sequence[Width], length: float) -> list[float]:
    """Widths within their limits that add up to a length, in proportion to the usual ones."""
    low, high = 0.0, length / min(w.least for w in widths)
    for _ in range(40):
        factor = (low + high) / 2.0
        if sum(_limited(w, factor) for w in widths) < length:
            low = factor
        else:
            high = factor
    return [_limited(w, high) for w in widths]


def _limited(width: Width, factor: float) -> float:
    return min(max(width.usual * factor, width.least), width.most)


def _slice(strip: Rect, along: str, start: float, end: float) -> Rect:
    if along == "x":
        return Rect(round(strip.x0 + start, 4), strip.y0, round(strip.x0 + end, 4), strip.y1)
    return Rect(strip.x0, round(strip.y0 + start, 4), strip.x1, round(strip.y0 + end, 4))


@dataclass(frozen=True)
class Circulation:
    """How people walk through a building.

    Attributes:
        hubs: Kinds of rooms that others open off, those to prefer first.
        second_doors: Kinds of rooms that may have a door to each of two hubs, with the probability.
        entrances: Kinds of rooms that may have the front door, those to prefer first.
        joined: Probability of passages between two halls side by side; corridors and arcades are
            always open to all hubs.
    """

    hubs: Sequence[str]
    second_doors: Mapping[str, float]
    entrances: Sequence[str]
    joined: float = 1.0


@dataclass(frozen=True)
class WindowRule:
    """Windows of a kind of room: one in every ``every_m`` metres of outer wall, from a sill up."""

    every_m: float = 2.6
    wide: float = 1.6
    sill: float = 0.9


def sample_hub_doors(
    rng: RandomStream, rooms: Sequence[Room], rules: Circulation
) -> list[Opening] | None:
    """Random doors by which every room is reached through hubs only; None if there are none."""
    rank = {kind: number for number, kind in enumerate(rules.hubs)}
    walls = [w for w in shared_walls(rooms) if w.end - w.start > 0.9 + 2 * CASING_M + 0.04]
    openings: list[Opening] = []
    for wall in walls:
        kinds = {rooms[wall.low].kind, rooms[wall.high].kind}
        if kinds <= rank.keys() and (kinds & _SPINES or rng.chance(rules.joined)):
            openings += _passages(rng, wall, openings)
    for number, room in enumerate(rooms):
        if room.kind in rank:
            continue
        own = [w for w in walls if number in (w.low, w.high) and _other(w, number, rooms) in rank]
        own.sort(key=lambda w: rank[_other(w, number, rooms)])
        doors: list[Opening] = []
        for wall in own:
            if doors and not (
                _is_elsewhere(wall, doors) and rng.chance(rules.second_doors.get(room.kind, 0.0))
            ):
                continue
            leaf = number if rng.chance(0.8) else -1
            door = hang_door(rng, rooms, wall, 0.9, leaf, [*openings, *doors])
            if door is not None:
                doors.append(door)
        openings += doors
    return openings if _reaches_all(rooms, openings, rules) else None


def _other(wall: SharedWall, number: int, rooms: Sequence[Room]) -> str:
    return rooms[wall.high if wall.low == number else wall.low].kind


def _is_elsewhere(wall: SharedWall, doors: Sequence[Opening]) -> bool:
    """Whether a wall leads to another room than the existing doors."""
    return all(set(door.rooms) != {wall.low, wall.high} for door in doors)


def _passages(rng: RandomStream, wall: SharedWall, others: Sequence[Opening]) -> list[Opening]:
    """Wide openings between two hubs: one, or two far apart in a long wall."""
    length = wall.end - wall.start
    ends = ((0.0, 0.35), (0.65, 1.0)) if length > _SECOND_ENTRY_M else ((0.2, 0.8),)
    found: list[Opening] = []
    for low, high in ends:
        wide = min(rng.uniform(1.3, 2.2, 0.05), length - 2 * CASING_M)
        for _ in range(8):
            free = length - wide - 2 * CASING_M
            start = round(wall.start + CASING_M + free * rng.uniform(low, high), 3)
            passage = wall.opening("passage", start, wide, PASSAGE_TOP_M)
            if not any(collide(passage, other) for other in (*others, *found)):
                found.append(passage)
                break
    return found


def _reaches_all(rooms: Sequence[Room], openings: Sequence[Opening], rules: Circulation) -> bool:
    seen = {next(k for k, r in enumerate(rooms) if r.kind in rules.hubs)}
    todo = list(seen)
    while todo:
        here = todo.pop()
        if rooms[here].kind not in rules.hubs:
            continue
        for opening in openings:
            for room in set(opening.rooms) - seen if here in opening.rooms else ():
                seen.add(room)
                todo.append(room)
    return len(seen) == len(rooms)


def sample_window_rows(
    rng: RandomStream,
    rooms: Sequence[Room],
    openings: Sequence[Opening],
    height: float,
    rules: Mapping[str, WindowRule],
) -> list[Opening]:
    """Windows in rows along the outer walls of all rooms that have a rule for them."""
    windows: list[Opening] = []
    for number, room in enumerate(rooms):
        if room.kind not in rules:
            continue
        rule = rules[room.kind]
        for wall in outer_walls(rooms, number):
            low, high = wall.start + WALL_M, wall.end - WALL_M
            count = int((high - low - 0.3) / rule.every_m + 0.5)
            for k in range(count):
                wide = min(rule.wide, (high - low) / count - 0.3) - 0.1 * rng.integer(0, 2)
                first = round(low + (high - low) * (k + 0.5) / count - wide / 2.0, 3)
                top = min(2.3, height - 0.3)
                window = wall.opening("window", number, first, wide, rule.sill, top)
                if wide > 0.5 and is_free(window, (*openings, *windows)):
                    windows.append(window)
    return windows


@dataclass(frozen=True)
class Layout:
    """One way to arrange the rooms of a kind of building.

    Attributes:
        sample_cells: Gives rooms of about an area in square metres; none if they don't fit.
        least_m2: Least area that the layout needs.
        weight: How often it is taken, in proportion to the others that fit.
        circulation: How people walk through it.
    """

    sample_cells: Callable[[RandomStream, float], list[Cell]]
    least_m2: float
    weight: float
    circulation: Circulation


@dataclass(frozen=True)
class PlanRules:
    """Rules of the floor plans of a kind of public building.

    Attributes:
        layouts: Its layouts; the first fits at every area.
        windows: Windows by kind of room.
        heights: Least and greatest height of the rooms, metres.
    """

    layouts: Sequence[Layout]
    windows: Mapping[str, WindowRule]
    heights: tuple[float, float]


def sample_public_plan(rng: RandomStream, rules: PlanRules) -> FloorPlan:
    """Random floor plan of 60 to 800 square metres."""
    wanted = LEAST_M2 + 10.0 + (MOST_M2 - LEAST_M2 - 40.0) * rng.unit() ** 1.4
    layout = rng.weighted([(one, one.weight) for one in rules.layouts if wanted > one.least_m2])
    for attempt in range(1000):
        chosen = layout if attempt < _ATTEMPTS else rules.layouts[0]
        plan = _attempt(rng.fork("plan", attempt), wanted, chosen, rules)
        if plan is not None:
            return plan
    raise AssertionError("the first layout fits at every area")


def _attempt(
    rng: RandomStream, wanted: float, layout: Layout, rules: PlanRules
) -> FloorPlan | None:
    cells = layout.sample_cells(rng.fork("rooms"), wanted)
    if not cells or not LEAST_M2 <= sum(rect.area for _, rect in cells) <= MOST_M2:
        return None
    rooms = named_rooms(cells)
    doors = sample_hub_doors(rng.fork("doors"), rooms, layout.circulation)
    if doors is None:
        return None
    entrances = layout.circulation.entrances
    entrance = sample_entrance(rng.fork("entrance"), rooms, doors, entrances)
    if entrance is None:
        return None
    height = rng.uniform(*rules.heights, 0.05)
    openings = [*doors, entrance]
    openings += sample_window_rows(rng.fork("windows"), rooms, openings, height, rules.windows)
    return centred(FloorPlan(rooms, tuple(openings), height))
