"""Prefetching: the next map question is asked while the robot is still driving."""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

from pydantic import Field

from hypernav.core.components.protocols import Explorer
from hypernav.core.config import MOST_STEPS, RoomConfig
from hypernav.core.destination import Destination
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog


class PrefetchConfig(RoomConfig):
    """Time of the next map question. The paper asks it when the robot has arrived; this is ours.

    Attributes:
        enabled: Whether to ask on the way to the present destination.
        within_m: Straight distance to the present destination at which to ask, metres.
        good_for_steps: Age up to which an answer is used, steps.
    """

    enabled: bool = False
    within_m: float = Field(default=1.5, gt=0.0, le=100.0)
    good_for_steps: int = Field(default=12, ge=1, le=MOST_STEPS)


@dataclass(frozen=True, eq=False)
class _Pending:
    """A question under way.

    Attributes:
        answer: Destination to come.
        step: Number of the step in which it was asked.
    """

    answer: "Future[Destination | None]"
    step: int


class PrefetchingExplorer:
    """Lets an explorer choose the next destination in a thread of its own.

    When an answer is used depends on the steps of the robot only, never on how fast the model is,
    so that a replayed search takes the same path. `close` ends the thread.
    """

    def __init__(
        self, explorer: Explorer, own_log: ExchangeLog, log: ExchangeLog, config: PrefetchConfig
    ) -> None:
        """Create it.

        Args:
            explorer: Explorer that chooses.
            own_log: Log that only the explorer's reasoner writes into.
            log: Log of the agent; exchanges are moved into it when an answer is used or dropped.
            config: Time of the questions.
        """
        self._own_log = own_log
        self._explorer = explorer
        self._log = log
        self._config = config
        self._pending: _Pending | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="hypernav-prefetch")

    def reset(self, goal: Goal) -> None:
        """Forget all visits and whatever is under way."""
        if self._pending is not None:
            # The thread may still be at work on the last search, whose exchanges are dropped.
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
            grid: The map, which is copied.
            robot: Pose of the robot.
            trajectory: Positions of the robot so far, one a step.
            destination: Present destination.
        """
        near = robot.distance_to(*destination.xy) <= self._config.within_m
        if self._pending is not None or not near or destination.is_sighting:
            return
        self._explorer.remember_visit(*destination.xy)
        still = replace(grid, cells=grid.cells.copy())
        positions = list(trajectory)
        answer = self._pool.submit(self._explorer.next_destination, still, robot, positions)
        self._pending = _Pending(answer, len(positions))

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """The prefetched answer, if it is still good; else the answer to a new question."""
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
        """Move the explorer's exchanges into the agent's log."""
        for exchange in self._own_log.drain():
            remarks = [*exchange.remarks, remark] if remark else exchange.remarks
            self._log.record(exchange.model_copy(update={"remarks": remarks}))

    @staticmethod
    def _is_free(grid: OccupancyGrid, destination: Destination) -> bool:
        return grid.state_at(*destination.xy) is Cell.FREE
