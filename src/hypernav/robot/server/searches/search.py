"""One search on the server: the line of an observation from the message to the reply.

`Search.offer` takes the message and finds its turn; in the worker `Search._take` checks it, writes
it to disk, decides, writes the decision to disk, and answers.
"""

import logging
import threading
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, closing, contextmanager
from dataclasses import replace
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
from hypernav.core.exploring.operator_place import OperatorPlace
from hypernav.core.geometry.closed_area import ClosedArea
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import floor_of
from hypernav.robot.server.limits import Pace
from hypernav.robot.server.searches.decisions import Decisions
from hypernav.robot.server.searches.journal import EndRecord, Journal, StepRecord
from hypernav.robot.server.searches.map_places import (
    added,
    check_heeded,
    removed,
    with_outcome,
    with_place,
    without_place,
)
from hypernav.robot.server.searches.spans import ClosedSpans, SentSpans
from hypernav.robot.server.searches.standing import Standing, Turn, end_reply
from hypernav.robot.server.searches.threads import Bell, Worker
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.places import (
    GO_TO,
    NO_ENTRY,
    GoToPlace,
    GoToRequest,
    NoEntryArea,
    NoEntryRequest,
)
from hypernav.robot.wire.replies import Reply, SearchEnding, SearchState, Status

_LOG = logging.getLogger(__name__)
_OUR_ERROR = "an error of the server, whose log says more"


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
            HyPerNavError: The journal is damaged.
        """
        self.record = journal.record
        self.bell = Bell()
        self._journal = journal
        self._pace = pace
        self._lock = threading.Lock()
        self._now = Standing.of(journal)
        self._heard_s = monotonic()
        self._worker: Worker | None = None
        self._last_worker: Worker | None = None  # it may still save what the search learned
        self._is_end_kept = journal.end is not None
        self._closed, self._sent = journal.closed, journal.sent
        self._next_decision = journal.step_count
        self._closing = threading.Lock()  # its own, so that STOP never waits for the disk
        self._keeps_out = self._goes_where_sent = False
        self._may_decide = threading.Event()
        if not journal.is_paused:
            self._may_decide.set()

    @property
    def is_over(self) -> bool:
        """Whether the search has ended."""
        return self._now.end is not None

    @property
    def is_end_kept(self) -> bool:
        """Whether the search has ended and its end is on disk."""
        return self._is_end_kept

    @property
    def has_memory(self) -> bool:
        """Whether the search goes on with its server's memory.

        One whose robot doesn't know where it is there leaves the memory to others.
        """
        start = self._now.start
        return not self.is_over and self.record.memory is not None and (start is None or start.sure)

    @property
    def has_memory_frame(self) -> bool:
        """Whether its map and that of the server's memory lie in one frame, also once it is over.

        A robot that doesn't know where it is in the memory shows so only once it was found there.
        """
        start = self._now.start
        is_known = not self.record.relocalize if start is None else start.sure
        return self.record.memory is not None and is_known

    @property
    def silent_s(self) -> float:
        """Time since the robot's last message, seconds; 0 while it waits for an answer."""
        is_silent = self._now.state is SearchState.WAITING
        return max(monotonic() - self._heard_s, 0.0) if is_silent else 0.0

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        return self._now.final_reply

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        return self.map_of(self._now.floor)

    @property
    def maps(self) -> Mapping[int, OccupancyGrid]:
        """Last map of every floor, by its number; empty before the first decision.

        Raises:
            HyPerNavError: One is damaged on the disk.
        """
        now = self._now
        return now.maps or (self._journal.read_maps(now.floor) if self._is_end_kept else {})

    def map_of(self, floor: int) -> OccupancyGrid | None:
        """Last map of a floor; None if there is none.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        now = self._now
        grid = now.maps.get(floor)
        is_on_disk = grid is None and self._is_end_kept
        return self._journal.read_map(floor, now.floor) if is_on_disk else grid

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        colour = self._now.colour
        return self.colour_of(None) if colour is None and self._is_end_kept else colour

    def colour_of(self, sequence: int | None) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image, the last one's if None.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        with self.reading() as journal:
            return journal.image_of(journal.observation_count - 1 if sequence is None else sequence)

    def reading(self) -> AbstractContextManager[Journal]:
        """The journal, opened a second time, to read it during or after the search."""
        return closing(Journal(self._journal.folder, to_read=True))

    def status(self) -> Status:
        """The present state."""
        return self._now.status(self.record, self.silent_s)

    def go_on(self, decisions: Decisions) -> None:
        """Begin to decide, after the agent was given the journal's observations again.

        Args:
            decisions: Agent that has its goal and has seen nothing.
        """
        self._decisions = decisions
        self._keeps_out = decisions.keeps_out
        self._goes_where_sent = decisions.goes_where_sent
        self._worker = Worker(f"search {self.record.id[:8]}", self._fail)
        if (last := self._now.last) is not None:
            with self._lock:
                self._tell(replace(self._now, is_resuming=True))
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
            self._heard_s = monotonic()
            if (known := self._now.known(packed.header.sequence)) is not None:
                return known
            turn = Turn(packed.header.sequence)
            self._now = self._now.offered(turn)
            if self._worker is not None:
                self._worker.submit(lambda: self._take(turn, packed, body, offered_s))
        return turn

    def turn(self, sequence: int) -> Turn:
        """The turn of the last observation, to ask for its answer again.

        Raises:
            RequestRefusedError: The number is not the last one.
        """
        with self._lock:
            self._heard_s = monotonic()
            return self._now.asked_again(sequence)

    async def answer_of(self, turn: Turn) -> Reply:
        """The answer to an observation; ``hold`` if it takes longer than the robot waits.

        Raises:
            WireError: The observation is broken.
            RunFolderError: It could not be written to disk.
        """
        await self.bell.until(lambda: turn.is_answered, self.record.request.deadline_s)
        return turn.result()

    def stop(self, reason: str, ending: SearchEnding = SearchEnding.STOPPED) -> None:
        """End the search from outside, at once; `write_end` writes that to disk.

        Args:
            reason: Who stops it, or why.
            ending: Kind of ending.
        """
        with self._lock:
            if self._now.end is not None:
                return
            end, pending = EndRecord(ending=ending, detail=reason), self._now.pending
            if pending is not None:
                pending.reply = end_reply(pending.sequence, end)
            self._tell(replace(self._now, end=end))
        self.halt()

    def pause(self, *, is_paused: bool) -> None:
        """Keep the robot waiting for its next decision, or go on; nothing once it is over.

        A robot that waits stands still after its present action. STOP ends a paused search, too.

        Raises:
            RunFolderError: It cannot be noted on disk; nothing has changed.
        """
        with self._lock:
            if self._now.end is not None:
                return
            self._journal.write_paused(is_paused)
            self._tell(replace(self._now, is_paused=is_paused))
            if is_paused:
                self._may_decide.clear()
            else:
                self._may_decide.set()

    @property
    def closed(self) -> tuple[NoEntryArea, ...]:
        """The places that the robot is not to enter."""
        return self._closed.now

    def close_area(self, request: NoEntryRequest) -> NoEntryArea:
        """Close a place to the robot, from its next decision on.

        Raises:
            RequestRefusedError: The search is over, its agent can't keep out of places, the place
                is not on the map or the robot stands in it, or there are too many.
            RunFolderError: It cannot be noted on disk; nothing has changed.
        """
        with self._closing:
            check_heeded(self._now, NO_ENTRY, agent_can=self._keeps_out)
            self._keep(added(self._closed, request, self._now, self._next_decision))
            return self._closed.spans[-1].area

    def open_area(self, number: int) -> tuple[NoEntryArea, ...]:
        """Let the robot enter a place again, from its next decision on.

        Returns:
            The places that stay closed.

        Raises:
            RequestRefusedError: There is none of this number, or the search is over.
            RunFolderError: It cannot be noted on disk; nothing has changed.
        """
        with self._closing:
            check_heeded(self._now, NO_ENTRY, agent_can=self._keeps_out)
            self._keep(removed(self._closed, number, self._next_decision))
            return self._closed.now

    @property
    def going_to(self) -> GoToPlace | None:
        """The last place that the robot was sent to; None without one, and if it was cancelled."""
        return self._sent.latest

    def go_to(self, request: GoToRequest) -> GoToPlace:
        """Send the robot to a place, from its next decision on, and to no other.

        Raises:
            RequestRefusedError: The search is over, its agent can't be sent to places, the place is
                not on the map of the robot's floor or is closed, or there are too many.
            RunFolderError: It cannot be noted on disk; nothing has changed.
        """
        with self._closing:
            check_heeded(self._now, GO_TO, agent_can=self._goes_where_sent)
            at = self._next_decision
            self._keep(with_place(self._sent, request, self._now, self._closed, at))
            return self._sent.spans[-1].place

    def cancel_go_to(self) -> None:
        """Let the robot search by itself again, from its next decision on.

        Raises:
            RequestRefusedError: It is on its way to no place, or the search is over.
            RunFolderError: It cannot be noted on disk; nothing has changed.
        """
        with self._closing:
            check_heeded(self._now, GO_TO, agent_can=self._goes_where_sent)
            self._keep(without_place(self._sent, self._next_decision))

    def _keep(self, changed: ClosedSpans | SentSpans) -> None:
        """Note a change on disk before it counts, with the lock of the chosen places held."""
        if isinstance(changed, ClosedSpans):
            self._journal.write_closed(changed)
            self._closed = changed
        else:
            self._journal.write_sent(changed)
            self._sent = changed
        with self._lock:
            self._tell(self._now)

    def _heeded(self, turn: Turn) -> tuple[tuple[ClosedArea, ...], OperatorPlace | None]:
        """What the decision about an observation heeds; later changes count for the next one."""
        with self._closing:
            self._next_decision = turn.sequence + 1
            return self._closed.at(turn.sequence), self._sent.at(turn.sequence)

    def write_end(self) -> None:
        """Write the end of the search to disk, if it is over.

        Raises:
            RunFolderError: It cannot be written; the robot is stopped all the same.
        """
        now = self._now
        if now.end is None:
            return
        self._journal.write_end(now.end, now.maps, now.floor)
        self._is_end_kept = True
        with self._lock:
            self._now = self._now.kept_on(self._journal)

    def halt(self) -> Worker | None:
        """Release everything; a search that is not over can be taken up again.

        Returns:
            The worker, which ends after its present job, if it has not ended; None if there never
            was one.
        """
        with self._lock:
            worker, self._worker = self._worker, None
            self._may_decide.set()  # so that a worker that waits can end
            self._last_worker = worker or self._last_worker
        if worker is not None:
            worker.submit(self._release)
            worker.end()
        return self._last_worker

    def _tell(self, now: Standing) -> None:
        """Replace where the search stands, with the lock held, and let people know."""
        self._now = replace(now, version=now.version + 1)
        self.bell.ring()

    def _take(self, turn: Turn, packed: PackedObservation, body: bytes, offered_s: float) -> None:
        """The line of an observation from the message to the reply; runs in the worker."""
        with self._ending_at_errors():
            if not self._is_wanted():
                return
            try:
                seen = self._decisions.check(packed)
                self._journal.add_observation(body)
            except (WireError, RunFolderError) as error:
                self._withdraw(turn, error)
                return
            with self._lock:
                self._tell(self._now.accepted(packed))
            if not self._may_decide.is_set():
                self._may_decide.wait()
                offered_s = monotonic()  # the pause is nobody's delay
                if not self._is_wanted():
                    return
            step, grid = self._decisions.decide(packed, seen, *self._heeded(turn))
            self._answer(turn, step, grid)
            self._pace.note(step.trace, offered_s)

    def _withdraw(self, turn: Turn, error: WireError | RunFolderError) -> None:
        """Refuse the observation that was checked; the robot may send that number again."""
        with self._lock:
            if not turn.is_answered:  # by the end of the search
                turn.error, self._now = error, self._now.withdrawn()
            self._tell(self._now)

    def _answer(self, turn: Turn, step: StepRecord, grid: OccupancyGrid | None) -> None:
        """Write a decision to disk and answer the robot, unless it was stopped meanwhile."""
        if not self._is_wanted():
            return
        with self._closing:  # before the decision: one that was not written is made again
            sent = with_outcome(self._sent, step, turn.sequence)
            if sent is not self._sent:
                self._keep(sent)
        self._journal.add_step(step)
        maps = {} if grid is None or step.trace is None else {floor_of(step.trace): grid}
        with self._lock:
            if self._now.end is None:
                turn.reply, self._now = step.reply, self._now.showing(step, maps)
            if step.reply.ending is None:  # else the end follows at once
                self._tell(self._now)
        if step.reply.ending is not None:
            self._finish(step.reply.ending, step.reply.reason)

    def _resume(self, last: Turn) -> None:
        """Give the agent the journal's observations again; runs in the worker."""
        with self._ending_at_errors():
            maps = self._decisions.repeat(self._journal, self._is_wanted)
            with self._lock:
                now = self._now if self.is_over else self._now.showing(None, maps)
                self._tell(replace(now, is_resuming=False))
            if last.reply is not None and last.reply.ending is not None:
                self._finish(last.reply.ending, last.reply.reason)
            elif not last.is_answered:
                self._may_decide.wait()
                if not self._is_wanted():
                    return
                packed = unpack_observation(self._journal.observation(last.sequence))
                seen = self._decisions.check(packed)
                step, grid = self._decisions.decide(packed, seen, *self._heeded(last))
                self._answer(last, step, grid)

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
        self._decisions.close(self._now.end)
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
