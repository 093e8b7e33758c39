"""The floors of a search and the stairs between them, read from its trace."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

from hypernav.core.events import Event
from hypernav.core.trace import Mode, StepTrace, floor_of
from hypernav.search.drawing.map_painter import StairsMark

_SAME_STAIRS_M = 1.0
"""Distance between two ends of stairs on a floor, metres, that count as the same."""
_SAME_HEIGHT_M = 0.5
"""Difference between the heights of two floors, metres, below which none is the upper one."""


@dataclass(frozen=True)
class Climb:
    """One attempt to get to another floor over stairs.

    Attributes:
        first: Index in the trace of its first step.
        last: Index of its last step so far.
        floor: Number of the floor that the robot came from.
        other_floor: Number of the floor that it came to; None if it did not get to one.
        given_up: Whether it gave the stairs up.
        ends: Positions ``(x, y)`` at which it began and ended, ``map`` frame, metres.
        heights_m: Heights there, or of the other floor once the robot is on it.
    """

    first: int
    last: int
    floor: int
    other_floor: int | None
    given_up: bool
    ends: tuple[tuple[float, float], tuple[float, float]]
    heights_m: tuple[float, float] = (0.0, 0.0)


def climbs(steps: Iterable[StepTrace]) -> list[Climb]:
    """All attempts to use stairs, in order; the last one may be under way."""
    made = list[Climb]()
    for made in _climbs_by_step(steps):  # noqa: B007
        pass
    return made


def _climbs_by_step(steps: Iterable[StepTrace]) -> Iterator[list[Climb]]:
    """The attempts up to each step: one list, of which the next step changes the last one."""
    made, climbed = list[Climb](), False
    for number, step in enumerate(steps):
        floor, climbs_now = floor_of(step), step.mode is Mode.CLIMB
        gives_up, goes_on = Event.STAIRS_GIVEN_UP in step.events, False
        if climbed:
            last = made[-1]
            other = None if floor == last.floor else floor
            goes_on = climbs_now and other is None
            made[-1] = replace(
                last,
                last=number if goes_on else last.last,
                other_floor=other,
                given_up=other is None and (last.given_up or gives_up),
                ends=(last.ends[0], step.pose[:2]) if goes_on else last.ends,
                heights_m=(last.heights_m[0], step.z),
            )
        if climbs_now and not goes_on:
            ends = (step.pose[:2], step.pose[:2])
            made.append(Climb(number, number, floor, None, gives_up, ends, (step.z, step.z)))
        climbed = climbs_now
        yield made


def stairs_on(floor: int, made: Iterable[Climb]) -> list[StairsMark]:
    """The ends of the stairs on a floor that were taken or tried.

    Stairs that were taken once lead there, whatever became of later attempts. Two flights may begin
    at one landing.
    """
    marks = list[tuple[StairsMark, int | None]]()
    for one in sorted(made, key=lambda climb: climb.other_floor is not None):
        if one.floor == floor:
            to, words = one.other_floor, "no way" if one.given_up else "stairs"
            if to is not None:
                words = _leads_to(to, *one.heights_m)
            mark = StairsMark(one.ends[0], words)
        elif one.other_floor == floor:
            to = one.floor
            mark = StairsMark(one.ends[1], _leads_to(to, *reversed(one.heights_m)))
        else:
            continue
        marks = [pair for pair in marks if not _is_replaced(pair, by=(mark, to))]
        marks.append((mark, to))
    return [mark for mark, _ in marks]


def _leads_to(floor: int, from_m: float, to_m: float) -> str:
    return f"{_direction(to_m - from_m, 'up ', 'down ', '')}to floor {floor}"


def _direction(rise_m: float, up: str, down: str, level: str) -> str:
    """The word for a difference of heights."""
    return level if abs(rise_m) < _SAME_HEIGHT_M else up if rise_m > 0.0 else down


def _is_replaced(one: tuple[StairsMark, int | None], *, by: tuple[StairsMark, int | None]) -> bool:
    """Whether a later mark tells of the same stairs; one that tells of another floor doesn't."""
    (mark, to), (later, later_to) = one, by
    is_near = math.dist(mark.position, later.position) <= _SAME_STAIRS_M
    return is_near and to in (None, later_to)


def stairs_by_step(steps: Iterable[StepTrace]) -> dict[int, dict[int, list[StairsMark]]]:
    """The stairs on every floor from each step on at which they changed, by its index.

    Args:
        steps: The steps of a search so far.
    """
    changes, stairs = dict[int, dict[int, list[StairsMark]]](), dict[int, list[StairsMark]]()
    known = list[tuple[int, int | None, bool]]()
    for last, made in enumerate(_climbs_by_step(steps)):
        ends = [(one.floor, one.other_floor, one.given_up) for one in made]
        if ends == known:
            continue
        known, before = ends, stairs
        floors = {floor for one in ends for floor in one[:2] if floor is not None}
        stairs = {floor: stairs_on(floor, made) for floor in sorted(floors)}
        if stairs != before:
            changes[last] = stairs
    return changes


def names_floors(steps: Iterable[StepTrace]) -> bool:
    """Whether a search knew of more than one floor, or was on stairs."""
    return any(step.floor is not None or step.mode is Mode.CLIMB for step in steps)


def whereabouts(steps: Sequence[StepTrace]) -> list[str]:
    """Where the robot was in each step, for people: on a floor, or on stairs between two.

    Empty texts for a search that knew of one floor only and was on no stairs.

    Args:
        steps: The steps of a search; those on the way to a floor name it if it was reached.
    """
    if not names_floors(steps):
        return [""] * len(steps)
    where = [f"on floor {floor_of(step)}" for step in steps]
    for climb in climbs(steps):
        words = f"on the stairs from floor {climb.floor}"
        if climb.other_floor is not None:
            words += f" to floor {climb.other_floor}"
        where[climb.first : climb.last + 1] = [words] * (climb.last + 1 - climb.first)
    return where


def typical_steps(steps: Iterable[StepTrace]) -> dict[int, int]:
    """For every floor the number of a step on it, the middle one of those off the stairs.

    The robot's height in it is that of the floor.
    """
    numbers = dict[int, list[int]]()
    for step in steps:
        if step.mode is not Mode.CLIMB:
            numbers.setdefault(floor_of(step), []).append(step.step)
    return {floor: on_it[len(on_it) // 2] for floor, on_it in numbers.items()}


def floor_heights_m(steps: Iterable[StepTrace]) -> dict[int, float]:
    """Heights of the floors on which the robot was off the stairs, metres, by number."""
    seen = dict[int, list[float]]()
    for step in steps:
        if step.mode is not Mode.CLIMB:
            seen.setdefault(floor_of(step), []).append(step.z)
    return {floor: median(heights) for floor, heights in seen.items()}


def floor_words(floor: int, start: int, heights_m: Mapping[int, float]) -> str:
    """A floor for people, with its height beside that of the floor where the search began.

    Args:
        floor: Number of the floor.
        start: Number of the floor where the search began; with a memory it may be any.
        heights_m: Heights of the floors, metres; some or all may be missing.
    """
    name = f"Floor {floor}"
    if floor == start:
        return f"{name} (start)"
    if not {start, floor} <= heights_m.keys():
        return name
    above = heights_m[floor] - heights_m[start]
    if abs(above) < _SAME_HEIGHT_M:
        return name
    return f"{name} ({abs(above):.1f} m {'above' if above > 0.0 else 'below'} the start)"


def climb_words(climb: Climb, start: int, heights_m: Mapping[int, float]) -> str:
    """A climb for people.

    Args:
        climb: The climb.
        start: Number of the floor where the search began.
        heights_m: Heights of the floors, metres; some or all may be missing.
    """
    if climb.given_up:
        return "Stairs tried in vain: no way to another floor was found there"
    if climb.other_floor is None:
        return f"Onto stairs from floor {climb.floor}"
    direction = "Over"
    if {climb.floor, climb.other_floor} <= heights_m.keys():
        rise = heights_m[climb.other_floor] - heights_m[climb.floor]
        direction = _direction(rise, "Up", "Down", "Over")
    to = floor_words(climb.other_floor, start, heights_m)
    return f"{direction} the stairs from floor {climb.floor} to f{to[1:]}"
