"""Exploration of the nearest frontier, the baseline ``frontier``."""

from dataclasses import dataclass

from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import fresh_frontiers

_VISITED_RADIUS_M = 0.5
"""Distance from a destination reached or given up within which frontiers are passed over."""


@dataclass(frozen=True, eq=False)
class NearestFrontierExplorer:
    """Drives to the nearest frontier (Yamauchi, 1997), the paper's real-world baseline.

    Attributes:
        log: Log of all choices, for the trace.
        mapping: Length of the shortest frontier.
        clearances_m: Distances of destinations from obstacles, in the order to try, metres.
    """

    log: ExchangeLog
    mapping: MappingConfig
    clearances_m: tuple[float, ...]

    def next_destination(self, view: ExplorationView) -> Destination | None:
        """The nearest frontier by travel distance; None if no unvisited one can be reached."""
        fresh = fresh_frontiers(
            view.grid,
            view.robot,
            self.mapping,
            self.clearances_m,
            visits=view.visits,
            visited_radius_m=_VISITED_RADIUS_M,
        )
        nearest = min(fresh, key=lambda one: one.travel_m, default=None)
        reason = "no frontier is left that can be reached"
        if nearest is not None:
            reason = f"nearest frontier: {nearest.size_m:.1f} m long, {nearest.travel_m:.1f} m away"
        self.log.note("choose frontier", "geometric", "Which frontier is nearest?", reason)
        return None if nearest is None else Destination(*nearest.destination, reason=reason)
