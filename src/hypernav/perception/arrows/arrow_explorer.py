"""Exploration by one arrow after the other (VLMnav, and in DyNaVLM's style)."""

import math
from collections.abc import Sequence
from functools import cache

from hypernav.core.arrows import TURN_AROUND
from hypernav.core.components.protocols import ArrowReasoner
from hypernav.core.destination import Destination
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.insight import Insight
from hypernav.core.sightings import Sightings
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.perception.arrows.arrow_sight import ArrowSight, MoveExplorer
from hypernav.perception.arrows.config import ArrowsConfig
from hypernav.perception.arrows.object_graph import ObjectGraph
from hypernav.perception.arrows.proposals import (
    DEFAULT_MOVES,
    BiasedProposer,
    IsOpen,
    Proposer,
    SpatialProposer,
)
from hypernav.show.drawing.arrows import ArrowStyle


class ArrowExplorer(MoveExplorer):
    """Draws moves into the image, asks for one of them, makes it, and asks again."""

    def __init__(
        self,
        sight: ArrowSight,
        proposer: Proposer,
        reasoner: ArrowReasoner,
        mapping: MappingConfig,
        clearance_m: float,
        memory: ObjectGraph | None = None,
        sightings: Sightings | None = None,
    ) -> None:
        """Put it together; `vlmnav` and `dynavlm_style` do.

        Args:
            sight: Images, and moves in them.
            proposer: Proposer of the moves.
            reasoner: Reasoner that chooses among them.
            mapping: Cells of the map.
            clearance_m: Distance of the ends of moves from obstacles, metres.
            memory: Memory of things, which the reasoner is told of; None for none.
            sightings: What was seen besides the goal, for the memory.
        """
        super().__init__(sight)
        self._proposer = proposer
        self._reasoner = reasoner
        self._mapping = mapping
        self._clearance_m = clearance_m
        self._memory = memory
        self._sightings = sightings
        self.reset(Goal("nothing yet"))

    def reset(self, goal: Goal) -> None:
        """Forget everything."""
        self._goal = goal
        self._only_defaults = False
        self._sight.reset()
        if self._memory is not None:
            self._memory.forget()

    def take_insight(self) -> Insight | None:
        """The arrows of the latest choice, and what is remembered."""
        insight = super().take_insight()
        if insight is None or self._memory is None:
            return insight
        graph = self._memory.shown(self._goal, self._sight.observation.robot)
        return insight.model_copy(update={"graph": graph})

    def offer_default_moves(self) -> None:
        """Offer nothing but the default moves at the next choice: the goal may be right here."""
        self._only_defaults = True

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination:
        """The end of the next move.

        Raises:
            ModelUnavailableError: The reasoner's model did not answer.
        """
        sight = self._sight
        directions, may_turn = sight.look(), sight.may_turn
        only_defaults, self._only_defaults = self._only_defaults, False
        if only_defaults:
            may_turn, moves = False, list(DEFAULT_MOVES)
        else:
            is_open = self._open_around(grid, robot)
            moves = self._proposer.propose(directions, robot, is_open, may_turn=may_turn)
        arrows = sight.marked(moves, directions)
        if not arrows:
            why = "no arrow fits into the image"
            return sight.around(why) if may_turn else sight.step_ahead(why)
        view = sight.view(arrows, may_turn=may_turn, facts=self._facts(robot))
        choice = self._reasoner.choose(view, self._goal)
        if not choice.numbers:
            return sight.step_ahead(f"a step ahead: {choice.reason}")
        if choice.numbers[0] == TURN_AROUND:
            return sight.around(choice.reason)
        return sight.along(view.arrow(choice.numbers[0]), choice.reason)

    def _facts(self, robot: Pose2) -> tuple[str, ...]:
        if self._memory is None or self._sightings is None:
            return ()
        self._memory.add_all(self._sightings.things)
        return tuple(fact.words for fact in self._memory.retrieve(self._goal, robot))

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
        ArrowSight(embodiment, config, ArrowStyle()),
        BiasedProposer(space_explored=config.space_explored),
        arrow_reasoner,
        mapping,
        clearances_m[0],
    )


def dynavlm_style(
    arrow_reasoner: ArrowReasoner,
    sightings: Sightings | None,
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
        sightings: What was seen besides the goal.
        embodiment: Camera, step and turn of the robot.
        mapping: Cells of the map.
        clearances_m: Distances from obstacles, metres.
        config: What arrows are like.
    """
    config = config or ArrowsConfig()
    return ArrowExplorer(
        ArrowSight(embodiment, config, ArrowStyle(shafts=False)),
        SpatialProposer(),
        arrow_reasoner,
        mapping,
        clearances_m[0],
        ObjectGraph(),
        sightings,
    )
