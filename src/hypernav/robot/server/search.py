"""One search on the server: the way of an observation from the message to the reply."""

import logging
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from time import monotonic

from hypernav.core.errors import (
    ComponentError,
    HyPerNavError,
    ModelSetupError,
    ModelUnavailableError,
    RunFolderError,
    SensorError,
    WireError,
)
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.bell import Bell
from hypernav.robot.server.conversation import Conversation, Turn
from hypernav.robot.server.decisions import Decisions
from hypernav.robot.server.pace import Pace
from hypernav.robot.server.state.journal import EndRecord, Journal, StepRecord
from hypernav.robot.server.state.view import View, image_of
from hypernav.robot.server.worker import Worker
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding, Status

_LOG = logging.getLogger(__name__)
_OUR_ERROR = "an error of the server, whose log says more"


class Search:
    """A search, under way or finished. Thread-safe: the event loop asks, a worker thread decides.

    Attributes:
        record: What it was opened with.
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
        self._journal = journal
        self._pace = pace
        self._lock = threading.Lock()
        self._worker: Worker | None = None
        self._is_end_kept = journal.end is not None
        self._talk = Conversation(_last_turn(journal), journal.end, View.of(journal))

    @property
    def bell(self) -> Bell:
        """Bell that rings at every change of the status."""
        return self._talk.bell

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self._talk.end is not None

    @property
    def is_end_kept(self) -> bool:
        """Whether the search has ended and its end is on disk."""
        return self._is_end_kept

    @property
    def silent_s(self) -> float:
        """Time since the robot's last message, seconds; 0 while it waits for an answer."""
        return self._talk.silent_s

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        return self._talk.end_reply

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        grid = self._talk.view.grid
        return self._journal.read_map() if grid is None and self._is_end_kept else grid

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        colour = self._talk.view.colour
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

    def status(self) -> Status:
        """The present state."""
        return self._talk.status(self.record)

    def go_on(self, decisions: Decisions) -> None:
        """Begin to decide, after the agent was given the journal's observations again.

        Args:
            decisions: Agent that has its goal and has seen nothing.
        """
        self._decisions = decisions
        self._worker = Worker(f"search {self.record.id[:8]}", self._fail)
        if (last := self._talk.last) is not None:
            self._talk.resume(None, is_done=False)
            self._worker.submit(lambda: self._resume(last))

    def offer(self, body: bytes) -> Turn:
        """Accept an observation, or recognise one that was accepted before.

        Returns:
            The turn that answers it; the same one for a repetition.

        Raises:
            WireError: The observation is broken.
            RequestRefusedError: Another number is expected.
        """
        offered_s = monotonic()
        try:
            packed = unpack_observation(body)
        except WireError:
            if (end := self.end_reply) is None:
                raise
            return Turn(end.sequence, reply=end)  # over is over, whatever the robot sends
        with self._lock:  # `halt` and `stop` end the worker after this job
            turn, is_new = self._talk.offer(packed.header.sequence)
            if is_new and self._worker is not None:
                self._worker.submit(lambda: self._take(turn, packed, body, offered_s))
        return turn

    def turn(self, sequence: int) -> Turn:
        """The turn of the last observation, to ask for its answer again.

        Raises:
            RequestRefusedError: The number is not the last one.
        """
        return self._talk.asked_again(sequence)

    def stop(self, reason: str, ending: SearchEnding = SearchEnding.STOPPED) -> None:
        """End the search from outside, at once; `write_end` writes that to disk.

        Args:
            reason: Who stops it, or why.
            ending: Kind of ending.
        """
        if self._talk.finish(EndRecord(ending=ending, detail=reason)):
            self.halt()

    def write_end(self) -> None:
        """Write the end of the search to disk, if it is over.

        Raises:
            RunFolderError: It cannot be written; the robot is stopped all the same.
        """
        talk = self._talk
        if talk.end is not None:
            self._journal.write_end(talk.end, talk.view.grid)
            self._is_end_kept = True
            talk.view = talk.view.kept_on(self._journal)

    def halt(self) -> Worker | None:
        """Release everything; a search that is not over can be taken up again.

        Returns:
            The worker, which ends after its present job; None if there is none.
        """
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.submit(self._release)
            worker.end()
        return worker

    def _take(self, turn: Turn, packed: PackedObservation, body: bytes, offered_s: float) -> None:
        """The way of an observation from the message to the reply; runs in the worker."""
        with self._ending_at_errors():
            if not self._is_wanted():
                return
            try:
                seen = self._decisions.check(packed)
                self._journal.add_observation(body)
            except (WireError, RunFolderError) as error:
                self._talk.withdraw(turn, error)
                return
            self._talk.accept(turn, packed)
            step = self._decisions.decide(packed, seen)
            self._answer(turn, step)
            self._pace.note(step.trace, offered_s)

    def _answer(self, turn: Turn, step: StepRecord) -> None:
        """Write a decision to disk and answer the robot, unless it was stopped meanwhile."""
        if not self._is_wanted():
            return
        self._journal.add_step(step)
        self._talk.answer(turn, step, self._decisions.grid)
        if step.reply.ending is not None:
            self._finish(step.reply.ending, step.reply.reason)

    def _resume(self, last: Turn) -> None:
        """Give the agent the journal's observations again; runs in the worker."""
        with self._ending_at_errors():
            self._decisions.repeat(self._journal, self._is_wanted)
            self._talk.resume(self._decisions.grid, is_done=True)
            if last.reply is not None and last.reply.ending is not None:
                self._finish(last.reply.ending, last.reply.reason)
            elif not last.is_answered:
                packed = unpack_observation(self._journal.observation(last.sequence))
                self._answer(last, self._decisions.decide(packed, self._decisions.check(packed)))

    def _is_wanted(self) -> bool:
        """Whether the search still goes on, on this server."""
        return not self.is_over and self._worker is not None

    def _finish(self, ending: SearchEnding, detail: str) -> None:
        self.stop(detail, ending)
        self.write_end()

    def _fail(self) -> None:
        """End the search after an error of the server, so that no robot waits in vain."""
        with self._ending_at_errors():
            self._finish(SearchEnding.FAILED, _OUR_ERROR)
        self._release()

    def _release(self) -> None:
        """Release the agent, which uses most of the memory, and the files."""
        self._decisions.close()
        self._journal.close()
        del self._decisions

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
            except ComponentError as error:
                _LOG.error("search %s: %s\n%s", self.record.id, error, error.details)
                self._finish(SearchEnding.FAILED, _OUR_ERROR)
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
