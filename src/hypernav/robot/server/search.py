"""One search on the server: which observation is next, who waits for which answer, and its end."""

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from hypernav.core.errors import (
    HyPerNavError,
    ModelSetupError,
    ModelUnavailableError,
    RequestRefusedError,
    RunFolderError,
    WireError,
)
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.bell import Bell
from hypernav.robot.server.decisions import Decisions
from hypernav.robot.server.state.journal import EndRecord, Journal, StepRecord
from hypernav.robot.server.turn import Turn, end_reply
from hypernav.robot.server.worker import Worker
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.messages import MapExtent, Reply, SearchEnding, SearchState, Status

_LOG = logging.getLogger(__name__)


class Search:
    """A search, under way or finished. Thread-safe: the server's loop asks, a worker decides.

    Attributes:
        record: What it was opened with.
        bell: Bell that rings at every change of the status.
        grid: Map after the last decision; None before the first.
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame; None before the first.
        colour: Format and bytes of the last colour image; None before the first.
    """

    def __init__(self, journal: Journal) -> None:
        """Take up a search as its journal has it; `go_on` gives it an agent.

        Raises:
            RunFolderError: The journal is damaged.
        """
        self.record = journal.record
        self.bell = Bell()
        self.grid: OccupancyGrid | None = None
        self.pose: tuple[float, float, float] | None = None
        self.colour: tuple[str, bytes] | None = None
        self._journal = journal
        self._lock = threading.RLock()
        self._version = 0
        self._worker: Worker | None = None
        self._is_resuming = False
        self._next = journal.observation_count
        self._turn: Turn | None = None
        self._end = journal.end
        self._recall()
        if self._end is not None:
            self.grid = journal.read_map()

    def _recall(self) -> None:
        """Take the last answer, pose and image from the journal."""
        if self._next == 0:
            return
        header = unpack_observation(self._journal.observation(self._next - 1))
        self.colour = (header.header.colour.format, header.colour)
        self._turn = Turn(self._next - 1)
        steps = self._journal.step_count
        if steps > 0:
            step = self._journal.step(steps - 1)
            self.pose = None if step.trace is None else step.trace.pose
            if steps == self._next:
                self._turn.reply = step.reply
        if self._end is not None and self._turn.reply is None:
            self._turn.reply = end_reply(self._turn.sequence, self._end)

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self._end is not None

    def go_on(self, decisions: Decisions) -> None:
        """Begin to decide, after the agent has seen again what the journal holds.

        Args:
            decisions: Agent that has its goal and has seen nothing.
        """
        self._worker = Worker(f"search {self.record.id[:8]}")
        self._decisions = decisions
        if self._next > 0:
            self._is_resuming = True
            self._worker.submit(self._resume)

    def offer(self, body: bytes) -> Turn:
        """Take an observation, or recognise one that was taken.

        Returns:
            The turn that answers it; the same one for a repetition.

        Raises:
            WireError: The observation is broken.
            RequestRefusedError: Another number is expected.
        """
        packed = unpack_observation(body)
        with self._lock:
            before = self._turn
            turn = self._known(packed.header.sequence)
            if turn is not None:
                return turn
            turn = self._turn = Turn(packed.header.sequence)
            if self._worker is not None:
                self._worker.submit(lambda: self._take(turn, before, packed, body))
        self._note_change()
        return turn

    def turn(self, sequence: int) -> Turn:
        """The turn of the last observation, to ask for its answer again.

        Raises:
            RequestRefusedError: The number is not the last one.
        """
        with self._lock:
            turn = self._known(sequence)
            if turn is None:
                raise RequestRefusedError(
                    f"observation {sequence} has not come yet; send it first",
                    error="sequence",
                    status=409,
                    expected=self._next,
                )
            return turn

    def stop(self, reason: str, ending: SearchEnding = SearchEnding.STOPPED) -> None:
        """End the search from outside, at once; `write_end` makes it last.

        Args:
            reason: Who stops it, or why.
            ending: Kind of the end.
        """
        with self._lock:
            if self._end is not None:
                return
            self._end = EndRecord(ending=ending, detail=reason)
            if self._turn is not None and not self._turn.is_answered:
                self._turn.reply = end_reply(self._turn.sequence, self._end)
            worker, self._worker = self._worker, None
        self._note_change()
        if worker is not None:
            worker.submit(self._release)
            worker.end()

    def write_end(self) -> None:
        """Write the end of the search down, if it is over.

        Raises:
            RunFolderError: It cannot be written; the robot is stopped all the same.
        """
        if self._end is not None:
            self._journal.write_end(self._end, self.grid)

    def halt(self) -> Worker | None:
        """Let go of everything; the search is not over, and can be taken up again.

        Returns:
            The worker, which ends after what it does just now; None if there is none.
        """
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.submit(self._release)
            worker.end()
        return worker

    def status(self) -> Status:
        """The present state."""
        with self._lock:
            turn, grid, end = self._turn, self.grid, self._end
            return Status(
                id=self.record.id,
                version=self._version,
                goal=self.record.request.goal,
                words=self.record.words,
                opened_s=self.record.opened_s,
                state=self._state,
                next_sequence=self._next,
                last=None if turn is None else turn.reply,
                pose=self.pose,
                map=None if grid is None else _extent(grid),
                ending=None if end is None else end.ending,
                detail="" if end is None else end.detail,
            )

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        with self._lock:
            sequence = max(self._next - 1, 0)
            return None if self._end is None else end_reply(sequence, self._end)

    @contextmanager
    def reading(self) -> Iterator[Journal]:
        """The journal; that of a search that is over is opened for the block only."""
        if self._end is None:
            yield self._journal
            return
        journal = Journal(self._journal.folder, to_read=True)
        try:
            yield journal
        finally:
            journal.close()

    @property
    def _state(self) -> SearchState:
        if self._end is not None:
            return SearchState.ENDED
        if self._is_resuming:
            return SearchState.RESUMING
        is_waiting = self._turn is None or self._turn.is_answered
        return SearchState.WAITING if is_waiting else SearchState.DECIDING

    def _known(self, sequence: int) -> Turn | None:
        """The turn of an observation that is not new; None if it is the one to come.

        Raises:
            RequestRefusedError: It is neither.
        """
        turn = self._turn
        is_last = turn is not None and turn.sequence == sequence
        if is_last and turn is not None and (self._end is None or _ends(turn)):
            return turn
        if self._end is not None:
            return Turn(sequence, end_reply(sequence, self._end))
        if turn is not None and _ends(turn):  # about to be ended
            return Turn(sequence, turn.reply)
        if turn is not None and not turn.is_answered:
            raise RequestRefusedError(
                f"observation {turn.sequence} is not answered yet; ask for its answer before "
                f"observation {sequence}",
                error="pending",
                status=409,
                expected=turn.sequence,
            )
        if sequence != self._next:
            raise RequestRefusedError(
                f"expected observation {self._next}, got {sequence}",
                error="sequence",
                status=409,
                expected=self._next,
            )
        return None

    def _take(
        self, turn: Turn, before: Turn | None, packed: PackedObservation, body: bytes
    ) -> None:
        """Check, accept, decide and answer; runs in the worker."""
        with self._ending_at_errors():
            if not self._is_wanted():
                return
            try:
                observation = self._decisions.decode(packed)
                self._journal.add_observation(body)
            except (WireError, RunFolderError) as error:
                with self._lock:
                    if not turn.is_answered:
                        turn.error, self._turn = error, before
                self._note_change()
                return
            with self._lock:
                self._next = turn.sequence + 1
                self.colour = (packed.header.colour.format, packed.colour)
            self._note_change()
            self._answer(turn, self._decisions.decide(packed.header, observation))

    def _resume(self) -> None:
        """Let the agent see again what the journal holds; runs in the worker."""
        with self._ending_at_errors():
            self._decisions.repeat(self._is_wanted)
            with self._lock:
                self._is_resuming = False
                self.grid = self._decisions.grid
                turn = self._turn
            self._note_change()
            if turn is None or turn.sequence >= self._next:
                return
            if turn.reply is not None and turn.reply.ending is not None:
                self._finish(turn.reply.ending, turn.reply.reason)
            elif not turn.is_answered:
                packed = unpack_observation(self._journal.observation(turn.sequence))
                observation = self._decisions.decode(packed)
                self._answer(turn, self._decisions.decide(packed.header, observation))

    def _answer(self, turn: Turn, step: StepRecord) -> None:
        """Write a decision down and let the robot have it, unless it was stopped meanwhile."""
        if not self._is_wanted():
            return
        self._journal.add_step(step)
        with self._lock:
            turn.reply = turn.reply or step.reply
            self.grid = self._decisions.grid
            if step.trace is not None:
                self.pose = step.trace.pose
        if step.reply.ending is not None:
            self._finish(step.reply.ending, step.reply.reason)
        self._note_change()

    def _is_wanted(self) -> bool:
        """Whether the search still goes on, and here."""
        return self._end is None and self._worker is not None

    def _finish(self, ending: SearchEnding, detail: str) -> None:
        self.stop(detail, ending)
        self.write_end()

    def _release(self) -> None:
        self._decisions.close()
        self._journal.close()

    def _note_change(self) -> None:
        with self._lock:
            self._version += 1
        self.bell.ring()

    @contextmanager
    def _ending_at_errors(self) -> Iterator[None]:
        """End the search if the block fails: no robot waits for an answer that never comes."""
        try:
            try:
                yield
            except (ModelUnavailableError, ModelSetupError) as error:
                self._finish(SearchEnding.MODEL_UNAVAILABLE, str(error))
            except HyPerNavError as error:
                _LOG.error("search %s: %s", self.record.id, error)
                self._finish(SearchEnding.FAILED, str(error))
            except Exception:  # a fault of ours; the robot is told, and the log has the traceback
                _LOG.exception("search %s failed", self.record.id)
                self._finish(SearchEnding.FAILED, "an error of the server, whose log says more")
        except RunFolderError as error:
            _LOG.error("search %s: %s", self.record.id, error)


def _ends(turn: Turn) -> bool:
    return turn.reply is not None and turn.reply.done


def _extent(grid: OccupancyGrid) -> MapExtent:
    rows, columns = grid.cells.shape
    x, y = (round(value, 6) for value in grid.origin)
    return MapExtent(rows=rows, columns=columns, resolution_m=grid.resolution_m, origin=(x, y))
