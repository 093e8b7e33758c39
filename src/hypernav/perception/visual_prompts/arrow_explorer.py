"""Exploration by one arrow after the other (VLMnav, and in DyNaVLM's style)."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import cache
from typing import ClassVar

from hypernav.core.components.protocols import ArrowReasoner
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.arrows import TURN_AROUND
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.perception.visual_prompts.arrow_sight import ArrowSight
from hypernav.perception.visual_prompts.config import ArrowsConfig
from hypernav.perception.visual_prompts.object_graph import ObjectGraph
from hypernav.perception.visual_prompts.proposals import (
    DEFAULT_MOVES,
    FreeDirections,
    Move,
    biased_moves,
    spatial_moves,
)
from hypernav.show.drawing.shapes import ArrowStyle


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
