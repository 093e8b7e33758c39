"""One search on the server: its observations, its answers and its end."""

import logging
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

from hypernav.core.errors import (
    HyPerNavError,
    ModelSetupError,
    ModelUnavailableError,
    RunFolderError,
    WireError,
)
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.bell import Bell
from hypernav.robot.server.decisions import Decisions
from hypernav.robot.server.state.journal import EndRecord, Journal, StepRecord
from hypernav.robot.server.state.views import Views
from hypernav.robot.server.turns import Turn, Turns
from hypernav.robot.server.worker import Worker
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding, SearchState, Status
from hypernav.robot.wire.requests import ObservationFacts

_LOG = logging.getLogger(__name__)


class Search:
    """A search, under way or finished. Thread-safe: the event loop asks, a worker thread decides.

    Attributes:
        record: What it was opened with.
        bell: Bell that rings at every change of the status.
        heard_s: Time of its robot's last message, or of its opening, on `time.monotonic`.
    """

    _decisions: Decisions  # set by `go_on`, before a worker uses it

    def __init__(self, journal: Journal) -> None:
        """Take up a search from its journal; `go_on` gives it an agent.

        Raises:
            RunFolderError: The journal is damaged.
        """
        self.record = journal.record
        self.bell = Bell()
        self.heard_s = time.monotonic()
        self._journal = journal
        self._lock = threading.RLock()
        self._version = 0
        self._worker: Worker | None = None
        self._is_resuming = False
        last = _last_observation(journal)
        self._views = Views(journal, last)
        end = journal.end
        self._is_end_kept = end is not None
        self._turns = Turns(None if last is None else _turn(last.header, journal), end)

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self._turns.end is not None

    @property
    def is_end_kept(self) -> bool:
        """Whether the search has ended and its end is on disk."""
        return self._is_end_kept

    @property
    def is_deciding(self) -> bool:
        """Whether the robot waits for an answer."""
        return self._state is SearchState.DECIDING

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        return self._views.grid

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        return self._views.colour

    def colour_of(self, sequence: int) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image; None before it has come."""
        return self._views.colour_of(sequence)

    def reading(self) -> AbstractContextManager[Journal]:
        """The journal, opened a second time, to read it during or after the search."""
        return self._views.reading()

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
        self.heard_s = time.monotonic()
        packed = unpack_observation(body)
        with self._lock:
            turn = self._turns.known(packed.header.sequence)
            if turn is not None:
                return turn
            turn = self._turns.begin(packed.header.sequence, packed.header.stamp_s)
            if self._worker is not None:
                self._worker.submit(lambda: self._take(turn, packed, body))
        self._note_change()
        return turn

    def turn(self, sequence: int) -> Turn:
        """The turn of the last observation, to ask for its answer again.

        Raises:
            RequestRefusedError: The number is not the last one.
        """
        self.heard_s = time.monotonic()
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
            self._journal.write_end(self._turns.end, self._views.unwritten_grid)
            self._is_end_kept = True
            self._views.forget()

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
                pose=self._views.pose,
                map=self._views.extent,
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

    def _take(self, turn: Turn, packed: PackedObservation, body: bytes) -> None:
        """Check, accept, decide and answer; runs in the worker."""
        with self._ending_at_errors():
            if not self._is_wanted():
                return
            try:
                observation = self._decisions.decode(packed)
                self._journal.add_observation(body)
            except (WireError, RunFolderError) as error:
                with self._lock:
                    self._turns.withdraw(turn, error)
                self._note_change()
                return
            with self._lock:
                self._turns.accept(turn)
                self._views.note_image(packed)
            self._note_change()
            self._answer(turn, self._decisions.decide(packed.header, observation))

    def _resume(self, last: Turn) -> None:
        """Give the agent the journal's observations again; runs in the worker."""
        with self._ending_at_errors():
            self._decisions.repeat(self._is_wanted)
            with self._lock:
                self._is_resuming = False
                self._views.note_map(self._decisions.grid)
            self._note_change()
            if last.reply is not None and last.reply.ending is not None:
                self._finish(last.reply.ending, last.reply.reason)
            elif not last.is_answered:
                packed = unpack_observation(self._journal.observation(last.sequence))
                observation = self._decisions.decode(packed)
                self._answer(last, self._decisions.decide(packed.header, observation))

    def _answer(self, turn: Turn, step: StepRecord) -> None:
        """Write a decision to disk and answer the robot, unless it was stopped meanwhile."""
        if not self._is_wanted():
            return
        self._journal.add_step(step)
        with self._lock:
            turn.reply = turn.reply or step.reply
            self._views.note_map(self._decisions.grid)
            if step.trace is not None:
                self._views.pose = step.trace.pose
        if step.reply.ending is not None:
            self._finish(step.reply.ending, step.reply.reason)
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
            except HyPerNavError as error:
                _LOG.error("search %s: %s", self.record.id, error)
                self._finish(SearchEnding.FAILED, str(error))
        except RunFolderError as error:
            _LOG.error("search %s: %s", self.record.id, error)


def _last_observation(journal: Journal) -> PackedObservation | None:
    last = journal.observation_count - 1
    return None if last < 0 else unpack_observation(journal.observation(last))


def _turn(facts: ObservationFacts, journal: Journal) -> Turn:
    """An observation, with its answer if it has one."""
    is_answered = journal.step_count > facts.sequence
    reply = journal.step(facts.sequence).reply if is_answered else None
    return Turn(facts.sequence, facts.stamp_s, reply)
