"""How well remembered things fit a goal's words: its name, and what is said of its place.

A robot remembers a bathtub by its name alone. Whether it is "the bathtub beside the trash can", or
in the bedroom, is seen by the things that it remembers around it.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, asked_place, canonical, same_name
from hypernav.search.mapping.sight_lines import lines_are_clear
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.thing import Thing, fit

LIKELY = 0.25
"""Chance to be the goal from which a thing is gone to before anything is explored."""
_AS_IF_ALONE = 5
"""Number of things that lack a word of the goal up to which each is as likely as one alone."""

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


def chances_by_name(things: Sequence[Thing], goal: Goal) -> list[tuple[Thing, float]]:
    """Those of some things that may be a goal by their names, each with the chance that it is.

    Where one that is likely has the goal's own name, or more words of it than others, other things
    of its kind are no candidates yet: a table lamp comes before a ceiling lamp. Of many that lack a
    word of it, each is the less likely: of twelve desks hardly any is the reception desk.

    Args:
        things: Things of the goal's kind, as far as their labels tell.
        goal: Goal.
    """
    lacking = {one.label for one in things if _lacks_a_word(one.label, goal)}
    count = sum(one.label in lacking for one in things)
    share = min(1.0, _AS_IF_ALONE / max(count, 1))
    chances = [
        (one, one.chance * one.fits(goal) * (share if one.label in lacking else 1.0))
        for one in things
    ]
    named = {one.number: _named_as(one.label, goal) for one in things}
    most = max((named[one.number] for one, chance in chances if chance >= LIKELY), default=None)
    return [pair for pair in chances if most is None or named[pair[0].number] >= most]


@lru_cache(maxsize=4096)
def _named_as(label: str, goal: Goal) -> tuple[float, int, bool]:
    """How well a label fits a goal, how many of its words name it, and whether as its own name.

    More is nearer: an armchair is called a chair only where there is no chair.
    """
    one = ObjectLabel(label)
    words = one.named_words(goal)
    return fit(label, goal), words, one.has_own_name_in(goal)


@lru_cache(maxsize=4096)
def _lacks_a_word(label: str, goal: Goal) -> bool:
    """Whether a goal's words, its place aside, say more than the kind that a label shares."""
    return 0 < ObjectLabel(label).named_words(goal) < len(asked_place(goal).before.split())


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
