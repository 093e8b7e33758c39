"""Choice of a block without a model: by what it would show, and travel cost."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hypernav.core.exploring.overview import (
    Block,
    BlockChoice,
    Overview,
    Prospects,
    prospects_of_boundaries,
    straight_legs_m,
)
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.blocks import CLIMB_M, FLOOR_SHARE
from hypernav.search.perception.config import GeometricConfig
from hypernav.search.perception.explorers.tour_kernels import soonest_tour, unseen_after

_NEVER_SEEN_M2 = 1e-3
"""Area that always counts as unseen, m²: of tours that show equally much, the shortest is best."""
_TOUR_STOPS = 10
"""Largest number of blocks on a tour."""
_WHOLE_VIEW_M2 = 12.0
"""Area in view, m², from which what a block shows counts in full; less in proportion below.

What is left behind furniture and in corners takes many steps and hardly ever shows a goal.
"""
_TRAVEL_SCALE_M = 3.0
"""Length of path over which the value of a block falls to 1/e."""
_TURN_COST_M = 0.8
"""Cost of the first turn towards a block, metres of path per radian, where order is "greedy".

A tour counts metres only; else every turn on the spot could change it.
"""
_SHOWN_M2 = 2.0
"""Unknown floor that a metre of exploring shows, m²: 2.2 in 14 searches of training buildings."""


@dataclass(frozen=True, eq=False)
class GeometricReasoner:
    """Prefers blocks that are near and would show much of the unknown; does not use the goal.

    The value of a block is ``gain * exp(-cost / travel scale)``, where the cost is the path there,
    and if "greedy" the first turn: the trade of information gain against travel cost of
    González-Baños and Latombe, "Navigation Strategies for Exploring Indoor Environments", 2002.

    A tour shows the gains of its blocks as soon as possible: it is the shortest one if every metre
    is weighted by what is unseen then (the travelling deliveryman problem, posed for search by
    Kulich, Přeučil and Miranda Bront, "On Multi-Robot Search for a Stationary Object", 2017).
    What two blocks would show both counts once, and less where both show little. A block of another
    floor comes before all where exploring that floor shows more for each metre of the path.

    Attributes:
        log: Log of all choices, for the trace.
        config: What a block is worth, and which one comes next.
        answers_at_once: See `hypernav.core.components.abilities.answers_at_once`.
    """

    log: ExchangeLog
    config: GeometricConfig = field(default_factory=GeometricConfig)

    answers_at_once = True

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The block to go to; None if no boundary is left that can be reached."""
        choice = self._choice(self._open(overview.blocks, excluded), overview, excluded)
        self.log.note(
            "choose block",
            "geometric",
            self._question,
            choice.reason,
            chosen=choice.number,
            excluded=excluded,
        )
        return choice

    def _choice(
        self, here: list[Block], overview: Overview, excluded: frozenset[int]
    ) -> BlockChoice:
        if not here:
            return BlockChoice(None, "no block has unexplored boundary that can be reached")
        if self.config.gain == "boundary":
            shown = counted = prospects_of_boundaries(here)
        else:
            shown = overview.prospects(here)
            counted = _discounted(shown)
            elsewhere = self._elsewhere(here, counted, overview, excluded)
            if elsewhere is not None:
                return elsewhere
        best = self._best(here, counted, overview)
        reason = self._reason(here[best], float(shown.gains_m2[best]))
        return BlockChoice(here[best].number, reason)

    def _open(self, blocks: Sequence[Block], excluded: frozenset[int]) -> list[Block]:
        """The blocks with unexplored boundary that can be reached, the nearest first."""
        found = [
            block
            for block in blocks
            if block.number not in excluded
            and block.frontier_cells >= self.config.min_frontier_cells
            and math.isfinite(block.travel_m)
        ]
        return sorted(found, key=lambda one: (one.travel_m, one.number))

    def _elsewhere(
        self, here: list[Block], shown: Prospects, overview: Overview, excluded: frozenset[int]
    ) -> BlockChoice | None:
        """A block of another floor, if exploring that one shows more a metre; else None.

        A place is left when others yield more for the time, the path there included: the marginal
        value theorem of Charnov, "Optimal Foraging, the Marginal Value Theorem", 1976. A floor of
        which less was seen than is expected of an unseen one is not left.
        """
        if not overview.elsewhere:
            return None
        largest_m2 = max(floor.known.grid.free_m2 for floor in overview.elsewhere)
        if overview.seen_m2 < FLOOR_SHARE * largest_m2:
            return None
        most, choice = _shown_a_metre(here, shown), None
        for floor in overview.elsewhere:
            there = self._open(floor.blocks, excluded | floor.visited)
            if floor.known.was_explored:
                there = [block for block in there if block.connector is not None]
            if not there:
                continue
            its = _discounted(floor.prospects(there))
            a_metre = _shown_a_metre(there, its)
            if a_metre > most:
                values = _values(its, [_path_m(block) for block in there])
                best = there[int(np.argmax(values))]
                more = f"more is left for the way on {floor.known.words}"
                reason = f"block {best.number}: {more}, {best.travel_m:.1f} m away"
                most, choice = a_metre, BlockChoice(best.number, reason)
        return choice

    @property
    def _question(self) -> str:
        gain = "unexplored boundary" if self.config.gain == "boundary" else "unknown floor"
        if self.config.order == "greedy":
            return f"Which block shows the most {gain} for the way there?"
        return f"Which block comes first, so that the most {gain} is seen soon?"

    def _best(self, blocks: list[Block], shown: Prospects, overview: Overview) -> int:
        """Index of the block that comes next."""
        costs = [self._cost_m(block, overview.robot) for block in blocks]
        values = _values(shown, costs)
        best_first = sorted(range(len(blocks)), key=lambda k: -values[k])  # the nearer of equals
        if self.config.order == "greedy":
            return best_first[0]
        stairs_first = sorted(best_first, key=lambda k: blocks[k].connector is None)
        stops = stairs_first[:_TOUR_STOPS]
        legs_of = overview.legs_m if self.config.gain == "view" else straight_legs_m
        unseen = unseen_after(shown.areas_m2, shown.shows[stops]) + _NEVER_SEEN_M2
        costs_m = np.array([costs[k] for k in stops])
        return stops[soonest_tour(costs_m, legs_of([blocks[k] for k in stops]), unseen)[0]]

    def _cost_m(self, block: Block, robot: Pose2) -> float:
        if self.config.order == "tour":
            return _path_m(block)
        return _path_m(block) + _TURN_COST_M * abs(robot.bearing_to(*block.destination))

    def _reason(self, block: Block, gain: float) -> str:
        if block.connector is not None:
            by_view = self.config.gain == "view"
            worth = f"about {gain:.0f} m² of another floor" if by_view else "another floor"
            return f"block {block.number}: {block.words}, {worth}, {block.travel_m:.1f} m away"
        if block.words:
            away = f"{block.travel_m:.1f} m away"
            return f"block {block.number}: {block.words} there, stairs down may begin, {away}"
        worth = f"{gain:.1f} m² of the unknown in view"
        if self.config.gain == "boundary":
            worth = f"{block.frontier_cells} cells of unexplored boundary"
        return f"block {block.number}: {worth}, {block.travel_m:.1f} m away"


def _path_m(block: Block) -> float:
    """Length of the path to a block, and over the stairs that begin there, metres."""
    return block.travel_m + (0.0 if block.connector is None else CLIMB_M)


def _values(prospects: Prospects, costs_m: Sequence[float]) -> list[float]:
    """What each block is worth: what it would show, and less the farther away it is."""
    return [
        gain * math.exp(-cost_m / _TRAVEL_SCALE_M)
        for gain, cost_m in zip(prospects.gains_m2.tolist(), costs_m, strict=True)
    ]


def _shown_a_metre(blocks: list[Block], shown: Prospects) -> float:
    """What some blocks would show for each metre of path, the path to the nearest included, m²."""
    left_m2 = float(shown.areas_m2.sum())
    path_m = min(_path_m(block) for block in blocks) + left_m2 / _SHOWN_M2
    return left_m2 / path_m if path_m > 0.0 else 0.0


def _discounted(prospects: Prospects) -> Prospects:
    """Prospects where what only small views show counts less than its area."""
    most_m2 = (prospects.shows * prospects.gains_m2[:, None]).max(axis=0)
    share = np.minimum(most_m2 / _WHOLE_VIEW_M2, 1.0)
    return replace(prospects, areas_m2=share * prospects.areas_m2)
