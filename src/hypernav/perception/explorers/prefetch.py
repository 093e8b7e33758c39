"""Asking the map question while the robot is still driving, so that it need not wait for it."""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.destination import Destination
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.protocols import Explorer
from hypernav.core.trace import ExchangeLog


class PrefetchConfig(RoomConfig):
    """When the next map question is asked. The paper asks it when the robot has arrived.

    Attributes:
        enabled: Ask it on the way.
        within_m: So near to the present destination, in a straight line.
        good_for_steps: An answer that is older is not used.
    """

    enabled: bool = False
    within_m: float = Field(default=1.5, gt=0.0)
    good_for_steps: int = Field(default=12, ge=1)


@dataclass(frozen=True, eq=False)
class _Pending:
    """A question under way.

    Attributes:
        answer: To come.
        step: When it was asked.
    """

    answer: "Future[Destination | None]"
    step: int


class PrefetchingExplorer:
    """Lets an explorer choose the next destination in a thread of its own.

    When an answer is used depends on the steps of the robot only, never on how fast the model is,
    so that a replayed search takes the same way. `close` it to end the thread.
    """

    def __init__(
        self, explorer: Explorer, own_log: ExchangeLog, log: ExchangeLog, config: PrefetchConfig
    ) -> None:
        """Create it.

        Args:
            explorer: Chooses.
            own_log: Which the explorer's reasoner, and nobody else, writes into.
            log: The agent's; exchanges come into it when an answer is used or dropped.
            config: When to ask.
        """
        self._own_log = own_log
        self._explorer = explorer
        self._log = log
        self._config = config
        self._pending: _Pending | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="hypernav-ask-ahead")

    def reset(self, goal: Goal) -> None:
        """Forget all visits and whatever is under way."""
        if self._pending is not None:
            # The thread may still be at work on the last search; its words belong to nobody.
            self._pending.answer.exception()
            self._pending = None
        self._own_log.drain()
        self._explorer.reset(goal)

    def close(self) -> None:
        """Wait for what is under way, and end the thread."""
        self._pool.shutdown()

    def remember_visit(self, x: float, y: float) -> None:
        """Note a destination that was reached or given up."""
        if self._pending is not None:
            self._pending.answer.exception()
        self._explorer.remember_visit(x, y)

    def prefetch(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        trajectory: Sequence[tuple[float, float]],
        destination: Destination,
    ) -> None:
        """Ask where to go after the present destination, if it is near and nothing was asked yet.

        Args:
            grid: The map; copied.
            robot: Where the robot is.
            trajectory: Where it has been, a place a step.
            destination: Where it is going.
        """
        near = robot.distance_to(*destination.xy) <= self._config.within_m
        if self._pending is not None or not near or destination.is_sighting:
            return
        self._explorer.remember_visit(*destination.xy)
        still = replace(grid, cells=grid.cells.copy())
        places = list(trajectory)
        answer = self._pool.submit(self._explorer.next_destination, still, robot, places)
        self._pending = _Pending(answer, len(places))

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """The answer that was asked for ahead, if it is still good; else one that is asked now."""
        pending, self._pending = self._pending, None
        if pending is None:
            return self._asked_now(grid, robot, trajectory)
        ahead = pending.answer.result()
        fresh = len(trajectory) - pending.step <= self._config.good_for_steps
        used = fresh and ahead is not None and self._is_free(grid, ahead)
        self._tell("asked ahead" if used else "asked ahead, not used")
        return ahead if used else self._asked_now(grid, robot, trajectory)

    def _asked_now(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        destination = self._explorer.next_destination(grid, robot, trajectory)
        self._tell()
        return destination

    def _tell(self, remark: str = "") -> None:
        """Move what was asked into the agent's log."""
        for exchange in self._own_log.drain():
            remarks = [*exchange.remarks, remark] if remark else exchange.remarks
            self._log.record(exchange.model_copy(update={"remarks": remarks}))

    @staticmethod
    def _is_free(grid: OccupancyGrid, destination: Destination) -> bool:
        return grid.state_at(*destination.xy) is Cell.FREE
