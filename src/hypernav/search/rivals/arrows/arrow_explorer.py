"""Exploration by one arrow after the other (VLMnav, and in DyNaVLM's style).

In DyNaVLM's style a graph holds things and which are near each other. We could not find DyNaVLM's
thresholds and prompts published: all of the graph is ours.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import ClassVar

import numpy as np

from hypernav.core.components.protocols import ArrowReasoner
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.guidance import TURN_AROUND
from hypernav.core.exploring.insight import RememberedThing, ThingGraph
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import normalise, same_name
from hypernav.search.drawing.shapes import ArrowStyle
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.rivals.arrows.arrow_sight import ArrowSight
from hypernav.search.rivals.arrows.proposals import (
    DEFAULT_MOVES,
    FreeDirections,
    Move,
    biased_moves,
    spatial_moves,
)
from hypernav.search.rivals.config import ArrowsConfig
from hypernav.search.rivals.room_table import room_table

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


@dataclass(frozen=True, eq=False)
class ArrowExplorer(ABC):
    """Draws moves into the image, asks for one of them, makes it, and asks again.

    Attributes:
        arrow_reasoner: Reasoner that chooses among the moves.
        embodiment: Camera, step and turn of the robot.
        mapping: Cells of the map.
        clearances_m: Distances of the ends of moves from obstacles, metres; only the first is used.
        config: Configuration of the arrows and of the question.
        style: Style of the arrows.
        wants_named_things: Whether the reasoner is told of the things that were seen; see
            `hypernav.core.components.abilities.wants_named_things`.
        marks_may_overlap: Whether all moves are marked, however near each other they end.
    """

    arrow_reasoner: ArrowReasoner
    embodiment: Embodiment
    mapping: MappingConfig
    clearances_m: tuple[float, ...]
    config: ArrowsConfig = field(default_factory=ArrowsConfig)

    style: ClassVar[ArrowStyle] = ArrowStyle()
    wants_named_things: ClassVar[bool] = False
    marks_may_overlap: ClassVar[bool] = True

    @abstractmethod
    def _proposed(
        self, directions: FreeDirections, view: ExplorationView, *, may_turn: bool
    ) -> list[Move]:
        """The moves to choose from, in the order of their numbers."""

    def next_destination(self, view: ExplorationView) -> Destination:
        """The end of the next move.

        Raises:
            ModelUnavailableError: The reasoner's model did not answer.
        """
        graph = ObjectGraph(view.things) if self.wants_named_things else None
        destination = self._next_move(view, graph)
        insight = destination.insight
        if graph is None or insight is None:
            return destination
        shown = graph.shown(view.goal, view.robot)
        return replace(destination, insight=insight.model_copy(update={"graph": shown}))

    def _next_move(self, view: ExplorationView, graph: ObjectGraph | None) -> Destination:
        robot = view.robot
        sight = ArrowSight(view, self.embodiment, self.config, self.style)
        directions, may_turn = sight.look(), sight.may_turn
        if view.may_be_here:
            may_turn, moves = False, list(DEFAULT_MOVES)
        else:
            moves = self._proposed(directions, view, may_turn=may_turn)
        arrows = sight.marked(moves, directions, may_overlap=self.marks_may_overlap)
        if not arrows:
            why = "no arrow fits into the image"
            return sight.around(why) if may_turn else sight.step_ahead(why)
        facts = () if graph is None else graph.retrieve(view.goal, robot)
        question = sight.view(arrows, may_turn=may_turn, facts=facts)
        choice = self.arrow_reasoner.choose(question, view.goal)
        if not choice.numbers:
            return sight.step_ahead(f"a step ahead: {choice.reason}")
        if choice.numbers[0] == TURN_AROUND:
            return sight.around(choice.reason)
        return sight.along(question.arrow(choice.numbers[0]), choice.reason)


class VlmnavExplorer(ArrowExplorer):
    """VLMnav's exploration: arrows into the unexplored, by depth.

    Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models",
    2024.
    """

    def _proposed(
        self, directions: FreeDirections, view: ExplorationView, *, may_turn: bool
    ) -> list[Move]:
        return biased_moves(
            directions, may_turn=may_turn, space_explored=self.config.space_explored
        )


class DynavlmStyleExplorer(ArrowExplorer):
    """Exploration in DyNaVLM's style: points of free space, and a memory of things.

    Not a reproduction: we could find neither code nor thresholds nor prompts of DyNaVLM published.
    Things come from the detector that all agents share, so the model is asked once a move, not
    twice.

    Source: digests of "DyNaVLM", arXiv 2506.15096, 2025.
    """

    style = ArrowStyle(shafts=False)
    wants_named_things = True
    marks_may_overlap = False

    def _proposed(
        self, directions: FreeDirections, view: ExplorationView, *, may_turn: bool
    ) -> list[Move]:
        @cache
        def area() -> ReachableArea:
            return ReachableArea.of(view.grid, view.robot, self.mapping, self.clearances_m[0])

        def is_open(x: float, y: float) -> bool:
            reach = area()
            row, column = reach.grid.cell_of(x, y)
            return reach.grid.inside(row, column) and math.isfinite(reach.travel_m[row, column])

        return spatial_moves(directions, view.robot, is_open)
