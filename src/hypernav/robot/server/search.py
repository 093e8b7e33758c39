"""One search on the server: its observations, its answers and its end."""

import logging
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from time import monotonic

from hypernav.core.errors import (
    HyPerNavError,
    ModelSetupError,
    ModelUnavailableError,
    RunFolderError,
    SensorError,
    WireError,
)
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.bell import Bell
from hypernav.robot.server.decisions import Decisions
from hypernav.robot.server.pace import Pace
from hypernav.robot.server.state.journal import EndRecord, Journal, StepRecord
from hypernav.robot.server.state.view import View, image_of
from hypernav.robot.server.turns import Turn, Turns
from hypernav.robot.server.worker import Worker
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding, SearchState, Status

_LOG = logging.getLogger(__name__)


class Search:
    """A search, under way or finished. Thread-safe: the event loop asks, a worker thread decides.

    Attributes:
        record: What it was opened with.
        bell: Bell that rings at every change of the status.
    """

    _decisions: Decisions  # set by `go_on`, before a worker uses it

    def __init__(self, journal: Journal, pace: Pace) -> None:
        """Take up a search from its journal; `go_on` gives it an agent.

        Args:
            journal: The journal.
            pace: Counts the time that answers take.

        Raises:
            RunFolderError: The journal is damaged.
        """
        self.record = journal.record
        self.bell = Bell()
        self._heard_s = monotonic()
        self._journal = journal
        self._pace = pace
        self._lock = threading.RLock()
        self._version = 0
        self._worker: Worker | None = None
        self._is_resuming = False
        self._view = View.of(journal)
        self._is_end_kept = journal.end is not None
        self._turns = Turns(_last_turn(journal), journal.end)

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self._turns.end is not None

    @property
    def is_end_kept(self) -> bool:
        """Whether the search has ended and its end is on disk."""
        return self._is_end_kept

    @property
    def silent_s(self) -> float:
        """Time since the robot's last message, seconds; 0 while it waits for an answer."""
        if self._state is not SearchState.WAITING:
            return 0.0
        return max(monotonic() - self._heard_s, 0.0)

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        grid = self._view.grid
        return self._journal.read_map() if grid is None and self._is_end_kept else grid

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        colour = self._view.colour
        return self.colour_of(None) if colour is None and self._is_end_kept else colour

    def colour_of(self, sequence: int | None) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image, the last one's if None.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        with self.reading() as journal:
            return image_of(journal, sequence)

    def reading(self) -> AbstractContextManager[Journal]:
        """The journal, opened a second time, to read it during or after the search."""
        return closing(Journal(self._journal.folder, to_read=True))

    def go_on(self, decisions: Decisions) -> None:
        """Begin to decide, after the agent was given the journal's observations again.

        Args:
            decisions: Agent that has its goal and has seen nothing.
        """
        self._decisions = decisions
        self._worker = Worker(f"search {self.record.id[:8]}", self._fail)
        if (last := self._turns.last) is not None:
            self._is_resuming = True
            self._worker.submit(lambda: self._resume(last))

    def offer(self, body: bytes) -> Turn:
        """Accept an observation, or recognise one that was accepted before.

        Returns:
            The turn that answers it; the same one for a repetition.

        Raises:
            WireError: The observation is broken.
            RequestRefusedError: Another number is expected.
        """
        offered_s = self._heard_s = monotonic()
        packed = unpack_observation(body)
        with self._lock:
            turn = self._turns.known(packed.header.sequence)
            if turn is None:
                turn = begun = self._turns.begin(packed.header.sequence)
                if self._worker is not None:
                    self._worker.submit(lambda: self._take(begun, packed, body, offered_s))
        return turn

    def turn(self, sequence: int) -> Turn:
        """The turn of the last observation, to ask for its answer again.

        Raises:
            RequestRefusedError: The number is not the last one.
        """
        self._heard_s = monotonic()
        with self._lock:
            return self._turns.asked_again(sequence)

    def stop(self, reason: str, ending: SearchEnding = SearchEnding.STOPPED) -> None:
        """End the search from outside, at once; `write_end` writes that to disk.

        Args:
            reason: Who stops it, or why.
            ending: Kind of ending.
        """
        with self._lock:
            if self.is_over:
                return
            self._turns.finish(EndRecord(ending=ending, detail=reason))
            worker, self._worker = self._worker, None
        self._note_change()
        if worker is not None:
            worker.submit(self._release)
            worker.end()

    def write_end(self) -> None:
        """Write the end of the search to disk, if it is over.

        Raises:
            RunFolderError: It cannot be written; the robot is stopped all the same.
        """
        if self._turns.end is not None:
            self._journal.write_end(self._turns.end, self._view.grid)
            self._is_end_kept = True
            self._view = self._view.kept_on(self._journal)

    def halt(self) -> Worker | None:
        """Release everything; the search is not over, and can be taken up again.

        Returns:
            The worker, which ends after its present job; None if there is none.
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
            turns = self._turns
            return Status(
                id=self.record.id,
                version=self._version,
                goal=self.record.request.goal,
                words=self.record.words,
                opened_s=self.record.opened_s,
                state=self._state,
                next_sequence=turns.next_sequence,
                last=None if turns.last is None else turns.last.reply,
                pose=self._view.pose,
                map=self._view.extent,
                silent_s=None if self.is_over else round(self.silent_s, 3),
                ending=None if turns.end is None else turns.end.ending,
                detail="" if turns.end is None else turns.end.detail,
            )

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        return self._turns.end_reply

    @property
    def _state(self) -> SearchState:
        if self.is_over:
            return SearchState.ENDED
        if self._is_resuming:
            return SearchState.RESUMING
        return SearchState.WAITING if self._turns.pending is None else SearchState.DECIDING

    def _take(self, turn: Turn, packed: PackedObservation, body: bytes, offered_s: float) -> None:
        """The way of an observation from the message to the reply; runs in the worker."""
        with self._ending_at_errors():
            if not self._is_wanted():
                return
            try:
                seen = self._decisions.check(packed)
                self._journal.add_observation(body)
            except (WireError, RunFolderError) as error:
                with self._lock:
                    self._turns.withdraw(turn, error)
                self._note_change()
                return
            with self._lock:
                self._turns.accept(turn)
                self._view = self._view.with_image(packed)
            self._note_change()
            step = self._decisions.decide(packed, seen)
            self._answer(turn, step)
            self._pace.note(step.trace, offered_s)

    def _resume(self, last: Turn) -> None:
        """Give the agent the journal's observations again; runs in the worker."""
        with self._ending_at_errors():
            self._decisions.repeat(self._journal, self._is_wanted)
            with self._lock:
                self._is_resuming = False
                self._view = self._view.with_step(None, self._decisions.grid)
            self._note_change()
            if last.reply is not None and last.reply.ending is not None:
                self._finish(last.reply.ending, last.reply.reason)
            elif not last.is_answered:
                packed = unpack_observation(self._journal.observation(last.sequence))
                self._answer(last, self._decisions.decide(packed, self._decisions.check(packed)))

    def _answer(self, turn: Turn, step: StepRecord) -> None:
        """Write a decision to disk and answer the robot, unless it was stopped meanwhile."""
        if not self._is_wanted():
            return
        self._journal.add_step(step)
        with self._lock:
            if not self.is_over:
                turn.reply = step.reply
                self._view = self._view.with_step(step.trace, self._decisions.grid)
        if step.reply.ending is not None:
            self._finish(step.reply.ending, step.reply.reason)
        else:
            self._note_change()

    def _is_wanted(self) -> bool:
        """Whether the search still goes on, on this server."""
        return not self.is_over and self._worker is not None

    def _finish(self, ending: SearchEnding, detail: str) -> None:
        self.stop(detail, ending)
        self.write_end()

    def _fail(self) -> None:
        """End the search after an error of the server, so that no robot waits in vain."""
        with self._ending_at_errors():
            self._finish(SearchEnding.FAILED, "an error of the server, whose log says more")
        self._release()

    def _release(self) -> None:
        """Release the agent, which uses most of the memory, and the files."""
        self._decisions.close()
        self._journal.close()
        del self._decisions

    def _note_change(self) -> None:
        with self._lock:
            self._version += 1
        self.bell.ring()

    @contextmanager
    def _ending_at_errors(self) -> Iterator[None]:
        """End the search if the block raises an error whose message says the reason."""
        try:
            try:
                yield
            except (ModelUnavailableError, ModelSetupError) as error:
                self._finish(SearchEnding.MODEL_UNAVAILABLE, str(error))
            except SensorError as error:
                self._finish(SearchEnding.ROBOT_FAILED, str(error))
            except HyPerNavError as error:
                _LOG.error("search %s: %s", self.record.id, error)
                self._finish(SearchEnding.FAILED, str(error))
        except RunFolderError as error:
            _LOG.error("search %s: %s", self.record.id, error)


def _last_turn(journal: Journal) -> Turn | None:
    """The last observation, with its answer if it has one; None before the first."""
    last = journal.observation_count - 1
    if last < 0:
        return None
    return Turn(last, journal.step(last).reply if journal.step_count > last else None)
