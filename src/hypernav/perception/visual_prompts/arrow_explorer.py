"""Exploration by one arrow after the other (VLMnav, and in DyNaVLM's style)."""

import math
from dataclasses import replace
from functools import cache

from hypernav.core.components.protocols import ArrowReasoner
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.arrows import TURN_AROUND
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.perception.visual_prompts.arrow_sight import ArrowSight
from hypernav.perception.visual_prompts.config import ArrowsConfig
from hypernav.perception.visual_prompts.object_graph import ObjectGraph
from hypernav.perception.visual_prompts.proposals import (
    DEFAULT_MOVES,
    BiasedProposer,
    IsOpen,
    Proposer,
    SpatialProposer,
)
from hypernav.show.drawing.arrows import ArrowStyle


class ArrowExplorer:
    """Draws moves into the image, asks for one of them, makes it, and asks again."""

    def __init__(
        self,
        embodiment: Embodiment,
        config: ArrowsConfig,
        style: ArrowStyle,
        proposer: Proposer,
        reasoner: ArrowReasoner,
        mapping: MappingConfig,
        clearance_m: float,
        *,
        remembers: bool = False,
    ) -> None:
        """Put it together; `vlmnav` and `dynavlm_style` do.

        Args:
            embodiment: Camera, step and turn of the robot.
            config: What arrows are like.
            style: Style of the arrows.
            proposer: Proposer of the moves.
            reasoner: Reasoner that chooses among them.
            mapping: Cells of the map.
            clearance_m: Distance of the ends of moves from obstacles, metres.
            remembers: Whether the reasoner is told of the things that were seen.
        """
        self._embodiment = embodiment
        self._config = config
        self._style = style
        self._proposer = proposer
        self._reasoner = reasoner
        self._mapping = mapping
        self._clearance_m = clearance_m
        self._remembers = remembers

    @property
    def wants_named_things(self) -> bool:
        """See `hypernav.core.components.abilities.wants_named_things`."""
        return self._remembers

    def next_destination(self, view: ExplorationView) -> Destination:
        """The end of the next move.

        Raises:
            ModelUnavailableError: The reasoner's model did not answer.
        """
        graph = ObjectGraph(view.things) if self._remembers else None
        destination = self._next_move(view, graph)
        insight = destination.insight
        if graph is None or insight is None:
            return destination
        shown = graph.shown(view.goal, view.robot)
        return replace(destination, insight=insight.model_copy(update={"graph": shown}))

    def _next_move(self, view: ExplorationView, graph: ObjectGraph | None) -> Destination:
        robot = view.robot
        sight = ArrowSight(view, self._embodiment, self._config, self._style)
        directions, may_turn = sight.look(), sight.may_turn
        if view.may_be_here:
            may_turn, moves = False, list(DEFAULT_MOVES)
        else:
            is_open = self._open_around(view.grid, robot)
            moves = self._proposer.propose(directions, robot, is_open, may_turn=may_turn)
        arrows = sight.marked(moves, directions)
        if not arrows:
            why = "no arrow fits into the image"
            return sight.around(why) if may_turn else sight.step_ahead(why)
        known = () if graph is None else graph.retrieve(view.goal, robot)
        facts = tuple(fact.words for fact in known)
        question = sight.view(arrows, may_turn=may_turn, facts=facts)
        choice = self._reasoner.choose(question, view.goal)
        if not choice.numbers:
            return sight.step_ahead(f"a step ahead: {choice.reason}")
        if choice.numbers[0] == TURN_AROUND:
            return sight.around(choice.reason)
        return sight.along(question.arrow(choice.numbers[0]), choice.reason)

    def _open_around(self, grid: OccupancyGrid, robot: Pose2) -> IsOpen:
        """Whether a position can be reached, found out when it is first asked."""

        @cache
        def area() -> ReachableArea:
            return ReachableArea.of(grid, robot, self._mapping, self._clearance_m)

        def is_open(x: float, y: float) -> bool:
            reach = area()
            row, column = reach.grid.cell_of(x, y)
            return reach.grid.inside(row, column) and math.isfinite(reach.travel_m[row, column])

        return is_open


def vlmnav(
    arrow_reasoner: ArrowReasoner,
    embodiment: Embodiment,
    mapping: MappingConfig,
    clearances_m: tuple[float, ...],
    config: ArrowsConfig | None = None,
) -> ArrowExplorer:
    """VLMnav's exploration: arrows into the unexplored, by depth.

    Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models",
    2024.

    Args:
        arrow_reasoner: Reasoner that chooses an arrow.
        embodiment: Camera, step and turn of the robot.
        mapping: Cells of the map.
        clearances_m: Distances from obstacles, metres.
        config: What arrows are like.
    """
    config = config or ArrowsConfig()
    return ArrowExplorer(
        embodiment,
        config,
        ArrowStyle(),
        BiasedProposer(space_explored=config.space_explored),
        arrow_reasoner,
        mapping,
        clearances_m[0],
    )


def dynavlm_style(
    arrow_reasoner: ArrowReasoner,
    embodiment: Embodiment,
    mapping: MappingConfig,
    clearances_m: tuple[float, ...],
    config: ArrowsConfig | None = None,
) -> ArrowExplorer:
    """Exploration in DyNaVLM's style: points of free space, and a memory of things.

    Never a reproduction: neither code nor thresholds nor prompts of DyNaVLM were published where we
    could read them. Things come from the detector that all agents share, so the model is asked once
    a move, not twice.

    Source: digests of "DyNaVLM", arXiv 2506.15096, 2025.

    Args:
        arrow_reasoner: Reasoner that chooses a point.
        embodiment: Camera, step and turn of the robot.
        mapping: Cells of the map.
        clearances_m: Distances from obstacles, metres.
        config: What arrows are like.
    """
    config = config or ArrowsConfig()
    return ArrowExplorer(
        embodiment,
        config,
        ArrowStyle(shafts=False),
        SpatialProposer(),
        arrow_reasoner,
        mapping,
        clearances_m[0],
        remembers=True,
    )
