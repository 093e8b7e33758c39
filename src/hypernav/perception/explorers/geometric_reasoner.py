"""Choice of a block without a model: by unexplored boundary and travel cost."""

import math

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block, BlockChoice, Overview
from hypernav.core.trace import Exchange, ExchangeLog


class GeometricConfig(RoomConfig):
    """Weights of the blocks. The paper always asks a model, so these values are ours.

    Attributes:
        min_frontier_cells: Length of unexplored boundary, cells, below which a block holds nothing
            new; with 0, a block without any may be visited as well, after all others.
        travel_scale_m: Length of path over which the value of a block falls to 1/e, metres.
        turn_cost_m: Cost of the first turn towards a block, metres of path per radian.
        gain_exponent: Exponent of the boundary's length in the value; 0 ignores the length.
    """

    min_frontier_cells: int = Field(default=6, ge=0, le=1_000_000)
    travel_scale_m: float = Field(default=3.0, ge=0.01, le=1000.0)
    turn_cost_m: float = Field(default=0.8, ge=0.0, le=1000.0)
    gain_exponent: float = Field(default=1.0, ge=0.0, le=10.0)


class GeometricReasoner:
    """Prefers long unexplored boundaries that are near; does not use the goal.

    The value of a block is ``gain**gain_exponent * exp(-cost / travel_scale)``, where the cost is
    the path there and a turn to begin with: the trade of information gain against travel cost of
    González-Baños and Latombe, "Navigation Strategies for Exploring Indoor Environments", 2002.
    """

    def __init__(self, log: ExchangeLog, config: GeometricConfig | None = None) -> None:
        """Create the reasoner.

        Args:
            log: Log of all choices, for the trace.
            config: Weights of the blocks.
        """
        self._log = log
        self._config = config or GeometricConfig()

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The most valuable block that can be reached; None if no boundary is left."""
        open_blocks = [
            block
            for block in overview.blocks
            if block.number not in excluded
            and block.frontier_cells >= self._config.min_frontier_cells
            and math.isfinite(block.travel_m)
        ]
        choice = self._best(open_blocks, overview.robot)
        self._log.record(
            Exchange(
                kind="choose block",
                asked="geometric",
                question="Which block has the most unexplored boundary for the way there?",
                answer=choice.reason,
                chosen=choice.number,
                excluded=sorted(excluded),
            )
        )
        return choice

    def _best(self, blocks: list[Block], robot: Pose2) -> BlockChoice:
        if not blocks:
            return BlockChoice(None, "no block has unexplored boundary that can be reached")
        best = max(blocks, key=lambda one: (self._value(one, robot), -one.travel_m, -one.number))
        reason = (
            f"block {best.number}: {best.frontier_cells} cells of unexplored boundary, "
            f"{best.travel_m:.1f} m away"
        )
        return BlockChoice(best.number, reason)

    def _value(self, block: Block, robot: Pose2) -> float:
        gain = block.frontier_cells**self._config.gain_exponent
        cost_m = block.travel_m
        if self._config.turn_cost_m > 0.0:
            cost_m += self._config.turn_cost_m * abs(robot.bearing_to(*block.destination))
        return gain * math.exp(-cost_m / self._config.travel_scale_m)
