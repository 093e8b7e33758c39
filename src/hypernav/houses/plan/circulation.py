"""Doors and windows of public buildings, whose rooms open off corridors and halls."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hypernav.houses.plan.doors import (
    CASING_M,
    SharedWall,
    collide,
    hang_door,
    shared_walls,
)
from hypernav.houses.plan.shapes import WALL_M, Opening, Room
from hypernav.houses.plan.windows import is_free, outer_walls
from hypernav.houses.random_stream import RandomStream

_SPINES = {"corridor", "arcade"}
_PASSAGE_TOP_M = 2.25
_SECOND_ENTRY_M = 8.0
"""Least length of a wall between two public rooms that gets two passages, metres."""


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


def sample_doors(
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
            passage = Opening(
                "passage",
                wall.along,
                wall.at,
                start,
                round(start + wide, 3),
                0.0,
                _PASSAGE_TOP_M,
                (wall.low, wall.high),
            )
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


def sample_windows(
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
        for along, at, start, end, side in outer_walls(rooms, number):
            low, high = start + WALL_M, end - WALL_M
            count = int((high - low - 0.3) / rule.every_m + 0.5)
            for k in range(count):
                wide = min(rule.wide, (high - low) / count - 0.3) - 0.1 * rng.integer(0, 2)
                first = round(low + (high - low) * (k + 0.5) / count - wide / 2.0, 3)
                window = Opening(
                    "window",
                    along,
                    at,
                    first,
                    round(first + wide, 3),
                    rule.sill,
                    min(2.3, height - 0.3),
                    (-1, number) if side < 0 else (number, -1),
                )
                if wide > 0.5 and is_free(window, (*openings, *windows)):
                    windows.append(window)
    return windows
