"""A graph of things and which are near each other, as DyNaVLM is described to keep one.

We could not find DyNaVLM's thresholds and prompts published: all here is ours.
"""

import math
from collections.abc import Iterable

import numpy as np

from hypernav.core.exploring.insight import RememberedThing, ThingGraph
from hypernav.core.exploring.sightings import SeenThing
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.labels import normalise, same_name
from hypernav.perception.room_kinds.room_table import room_table

_SAME_WITHIN_M = 1.0
"""Distance within which two things of one name are the same, metres."""
_NEAR_M = 2.0
"""Distance below which two things are near each other, metres."""
_MOST_FACTS = 10
"""Largest number of things that a prompt names."""


class ObjectGraph:
    """Things as nodes, and edges between those that are near each other."""

    def __init__(self, things: Iterable[SeenThing] = ()) -> None:
        """Build the graph.

        Args:
            things: Things in the order in which they were seen, with repetitions.
        """
        self._things: list[SeenThing] = []
        self._near: list[set[int]] = []
        for thing in things:
            self._add(thing)

    def _add(self, thing: SeenThing) -> None:
        """Add a thing, unless one of its name is right there."""
        for known in self._things:
            away_m = math.dist(known.position, thing.position)
            if away_m <= _SAME_WITHIN_M and same_name(known.label, thing.label):
                return
        number = len(self._things)
        self._things.append(thing)
        self._near.append(set())
        for other, known in enumerate(self._things[:-1]):
            if math.dist(known.position, thing.position) < _NEAR_M:
                self._near[number].add(other)
                self._near[other].add(number)

    def retrieve(self, goal: Goal, robot: Pose2) -> tuple[str, ...]:
        """Facts for a prompt about the at most ten things nearest in meaning to the goal.

        Of equal ones those nearest to the robot come first. A fact reads "bed, 3.2 m, 40° to the
        left, near nightstand".
        """
        return tuple(self._fact(number, robot) for number in self._closest_in_meaning(goal, robot))

    def shown(self, goal: Goal, robot: Pose2) -> ThingGraph:
        """The whole graph, for people, with the things that `retrieve` names marked."""
        told = set(self._closest_in_meaning(goal, robot))
        return ThingGraph(
            things=[
                RememberedThing(label=one.label, position=one.position, told=number in told)
                for number, one in enumerate(self._things)
            ],
            near=[(a, b) for a, others in enumerate(self._near) for b in sorted(others) if a < b],
        )

    def _closest_in_meaning(self, goal: Goal, robot: Pose2) -> list[int]:
        """Numbers of the things that a prompt names, the closest in meaning first."""
        order = sorted(
            range(len(self._things)),
            key=lambda k: (
                -_likeness(goal, self._things[k].label),
                robot.distance_to(*self._things[k].position),
            ),
        )
        return order[:_MOST_FACTS]

    def _fact(self, number: int, robot: Pose2) -> str:
        thing = self._things[number]
        degrees = round(math.degrees(robot.bearing_to(*thing.position)))
        side = f"{abs(degrees)}° to the {'left' if degrees > 0 else 'right'}"
        where = side if degrees else "straight ahead"
        others = sorted({self._things[other].label for other in self._near[number]})
        near = f", near {', '.join(others)}" if others else ""
        return f"{thing.label}, {robot.distance_to(*thing.position):.1f} m, {where}{near}"


def _likeness(goal: Goal, name: str) -> float:
    """How near a name is in meaning: common words first, then standing in the same rooms."""
    common = set(normalise(goal.text).split()) & set(normalise(name).split())
    if common:
        return 1.0 + len(common)
    table = room_table()
    a, b = table.of_thing(goal.text), table.of_thing(name)
    if a is None or b is None:
        return 0.0
    first, second = table.chances[a], table.chances[b]
    return float(first @ second / (np.linalg.norm(first) * np.linalg.norm(second)))
