"""What the things around a remembered thing say about where it is: in which room, beside what.

A robot remembers a bathtub by its name alone. Whether it is "the bathtub beside the trash can", or
in the bedroom, is seen by the things that it remembers around it.
"""

from collections.abc import Sequence

import numpy as np

from hypernav.core.goal import Goal
from hypernav.core.labels import asked_place, canonical, same_name
from hypernav.mapping.memory.thing import Thing
from hypernav.mapping.sight_lines import lines_are_clear
from hypernav.mapping.top_down.top_down_map import TopDownMap

_TELL = {
    "kitchen": (
        "refrigerator",
        "stove",
        "oven",
        "dishwasher",
        "microwave",
        "range hood",
        "kitchen cabinet",
        "toaster",
    ),
    "bathroom": ("toilet", "bathtub", "shower", "bath mat"),
    "bedroom": ("bed", "nightstand", "wardrobe"),
    "living room": ("sofa", "tv", "coffee table", "armchair", "fireplace"),
    "dining room": ("dining table",),
    "office": ("desk", "office chair", "filing cabinet", "computer monitor"),
    "laundry": ("washing machine", "clothes dryer"),
}
"""Things by which people tell a room, by its name; general knowledge."""
_ROOM_OF = {canonical(name): room for room, names in _TELL.items() for name in names}
_SAME_ROOM = {"restroom": "bathroom", "toilet": "bathroom", "laundry room": "laundry"}
"""Other names of these rooms."""
_IN_ROOM_M = 4.0
"""Distance within which a thing tells the room of another that is in sight of it, metres."""
_BESIDE_M = 0.6
"""Gap between two things up to which one is beside the other, metres."""
_THERE, _DOUBTED = 2.0, 0.4
"""Weights of a thing that is, or is not, where the goal is said to be, as far as is known."""


def weights_of_place(
    things: Sequence[Thing], known: Sequence[Thing], goal: Goal, floor_map: TopDownMap
) -> list[float]:
    """How well the surroundings of each thing agree with the place that a goal's words tell.

    Args:
        things: Things that may be the goal.
        known: All things that are known of their floor.
        goal: Goal.
        floor_map: Map of the floor.

    Returns:
        A factor of the chance of each that it is the goal: more than 1 there, less elsewhere, 1
        where nothing is known or asked.
    """
    asked = asked_place(goal)
    if not (asked.room or asked.beside):
        return [1.0] * len(things)
    there = [one for one in known if not one.is_gone]
    return [
        _beside(one, there, asked.beside)
        if asked.beside
        else _in_room(one, there, asked.room, floor_map)
        for one in things
    ]


def _beside(thing: Thing, known: Sequence[Thing], name: str) -> float:
    """The weight of a thing that is said to be beside something of a name."""
    others = [one for one in known if same_name(one.label, name) and one.number != thing.number]
    if not others:
        return 1.0
    return _THERE if min(_gap_m(thing, one) for one in others) <= _BESIDE_M else _DOUBTED


def _in_room(thing: Thing, known: Sequence[Thing], room: str, floor_map: TopDownMap) -> float:
    """The weight of a thing that is said to be in a room, by the nearest things that tell it."""
    room = _SAME_ROOM.get(room, room)
    if room not in _TELL:
        return 1.0
    telling = [
        one
        for one in known
        if one.number != thing.number
        and canonical(one.label) in _ROOM_OF
        and _gap_m(thing, one) <= _IN_ROOM_M
    ]
    if not telling:
        return 1.0
    ends = np.array([np.clip(thing.position, one.low, one.high)[:2] for one in telling])
    starts = np.array([np.clip(one.position, thing.low, thing.high)[:2] for one in telling])
    own = np.concatenate([starts, ends])
    in_sight = lines_are_clear(floor_map.eye_level(own), starts, ends, through=own)
    votes = [
        (_ROOM_OF[canonical(one.label)] == room, 1.0 / (0.5 + _gap_m(thing, one)))
        for one, is_so in zip(telling, in_sight.tolist(), strict=True)
        if is_so
    ]
    if not votes:
        return 1.0
    share = sum(vote for is_so, vote in votes if is_so) / sum(vote for _, vote in votes)
    return _DOUBTED + (_THERE - _DOUBTED) * share


def _gap_m(a: Thing, b: Thing) -> float:
    """Distance between the boxes of two things, metres."""
    gap = np.maximum(np.subtract(a.low, b.high), np.subtract(b.low, a.high))
    return float(np.linalg.norm(np.maximum(gap, 0.0)))
