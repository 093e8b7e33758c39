"""The classic baseline of exploration: the nearest frontier."""

from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.trace import Exchange, ExchangeLog
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.frontiers import nearest_frontier


class NearestFrontierExplorer:
    """Drives to the nearest frontier (Yamauchi, 1997), the paper's real-world baseline."""

    def __init__(
        self,
        log: ExchangeLog,
        mapping: MappingConfig,
        clearances_m: tuple[float, ...],
        *,
        visited_radius_m: float = 0.5,
    ) -> None:
        """Create it.

        Args:
            log: Log of all choices, for the trace.
            mapping: Length of the shortest frontier.
            clearances_m: Distances of destinations from obstacles, in the order to try, metres.
            visited_radius_m: Distance from a visited position, metres, within which frontiers are
                passed over.
        """
        self._log = log
        self._mapping = mapping
        self._clearances_m = clearances_m
        self._visited_radius_m = visited_radius_m

    def next_destination(self, view: ExplorationView) -> Destination | None:
        """The nearest frontier by travel distance; None if all is explored."""
        nearest = nearest_frontier(
            view.grid,
            view.robot,
            self._mapping,
            self._clearances_m,
            visits=view.visits,
            visited_radius_m=self._visited_radius_m,
        )
        reason = "no frontier is left that can be reached"
        if nearest is not None:
            reason = f"nearest frontier: {nearest.size_m:.1f} m long, {nearest.travel_m:.1f} m away"
        self._log.record(
            Exchange(
                kind="choose frontier",
                asked="geometric",
                question="Which frontier is nearest?",
                answer=reason,
            )
        )
        return None if nearest is None else Destination(*nearest.destination, reason=reason)
