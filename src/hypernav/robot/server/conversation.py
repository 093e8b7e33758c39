"""Who is told what in one search: each observation is accepted once and answered once."""

import threading
from dataclasses import dataclass
from time import monotonic

from hypernav.core.actions import Action
from hypernav.core.errors import RequestRefusedError, RunFolderError, WireError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.bell import Bell
from hypernav.robot.server.state.journal import EndRecord, SearchRecord, StepRecord
from hypernav.robot.server.state.view import View
from hypernav.robot.wire.frames import PackedObservation
from hypernav.robot.wire.replies import Reply, SearchState, Status


@dataclass(eq=False)
class Turn:
    """An observation and the answer to it, which never changes once given.

    Attributes:
        sequence: Number of the observation.
        reply: The answer; None before.
        error: Why the observation was not accepted (it is broken, or the disk is full); else None.
    """

    sequence: int
    reply: Reply | None = None
    error: WireError | RunFolderError | None = None

    @property
    def is_answered(self) -> bool:
        """Whether there is an answer or an error."""
        return self.reply is not None or self.error is not None

    def result(self) -> Reply:
        """The answer; ``hold`` as long as there is none.

        Raises:
            WireError: The observation is broken.
            RunFolderError: It could not be written to disk.
        """
        if self.error is not None:
            raise self.error
        return self.reply or Reply(sequence=self.sequence, hold=True, reason="deciding")


class Conversation:
    """Numbers, answers, the end, and what people see. Thread-safe; every change rings a bell.

    Attributes:
        bell: Bell that rings at every change of the status.
        last: The last observation, accepted or being checked; None before the first.
        end: End of the search; None as long as it goes on.
        view: Map, image and pose.
    """

    def __init__(self, last: Turn | None, end: EndRecord | None, view: View) -> None:
        """Begin after an observation that was accepted, or before the first.

        Args:
            last: The last observation.
            end: End of the search.
            view: What people see.
        """
        self.bell = Bell()
        self.last = last
        self.end = end
        self.view = view
        self._lock = threading.RLock()
        self._heard_s = monotonic()
        self._version = 0
        self._next_sequence = 0 if last is None else last.sequence + 1
        self._before: Turn | None = None
        self._is_resuming = False
        if end is not None and last is not None and last.reply is None:
            last.reply = _end_reply(last.sequence, end)

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        last = max(self._next_sequence - 1, 0)
        return None if self.end is None else _end_reply(last, self.end)

    @property
    def silent_s(self) -> float:
        """Time since the robot's last message, seconds; 0 while it waits for an answer."""
        is_silent = self._state is SearchState.WAITING
        return max(monotonic() - self._heard_s, 0.0) if is_silent else 0.0

    def offer(self, sequence: int) -> tuple[Turn, bool]:
        """The turn of an observation that has come, and whether that has just begun.

        Raises:
            RequestRefusedError: Another number is expected.
        """
        with self._lock:
            self._heard_s = monotonic()
            if (known := self._known(sequence)) is not None:
                return known, False
            self._before, self.last = self.last, Turn(sequence)
            return self.last, True

    def asked_again(self, sequence: int) -> Turn:
        """The turn of an observation whose answer is asked for again.

        Raises:
            RequestRefusedError: It is not the last one.
        """
        with self._lock:
            self._heard_s = monotonic()
            turn = self._known(sequence)
        if turn is None:
            message = f"observation {sequence} has not come yet; send it first"
            raise _refused("sequence", message, self._next_sequence)
        return turn

    def withdraw(self, turn: Turn, error: WireError | RunFolderError) -> None:
        """Discard the observation that is being checked."""
        with self._lock:
            if not turn.is_answered:
                turn.error, self.last = error, self._before
        self._note_change()

    def accept(self, turn: Turn, packed: PackedObservation) -> None:
        """Accept the observation that was checked, and show its image."""
        with self._lock:
            self._next_sequence = turn.sequence + 1
            if self.end is None:
                self.view = self.view.with_image(packed)
        self._note_change()

    def answer(self, turn: Turn, step: StepRecord, grid: OccupancyGrid | None) -> None:
        """Answer an observation, and show the decision, unless the search ended meanwhile."""
        with self._lock:
            if self.end is None:
                turn.reply = step.reply
                self.view = self.view.with_step(step.trace, grid)
        if step.reply.ending is None:  # else the end follows at once
            self._note_change()

    def resume(self, grid: OccupancyGrid | None, *, is_done: bool) -> None:
        """Say that the search is taken up again, or was; the robot waits meanwhile."""
        with self._lock:
            self._is_resuming = not is_done
            if self.end is None:
                self.view = self.view.with_step(None, grid)
        self._note_change()

    def finish(self, end: EndRecord) -> bool:
        """End the search, which also answers a pending observation.

        Returns:
            Whether it wasn't over already.
        """
        with self._lock:
            if self.end is not None:
                return False
            self.end = end
            if self._pending is not None:
                self._pending.reply = _end_reply(self._pending.sequence, end)
        self._note_change()
        return True

    def status(self, record: SearchRecord) -> Status:
        """The present state.

        Args:
            record: What the search was opened with.
        """
        with self._lock:
            last, end = self.last, self.end
            return Status(
                id=record.id,
                version=self._version,
                goal=record.request.goal,
                words=record.words,
                opened_s=record.opened_s,
                state=self._state,
                next_sequence=self._next_sequence,
                last=None if last is None else last.reply,
                pose=self.view.pose,
                map=self.view.extent,
                silent_s=round(self.silent_s, 3) if end is None else None,
                ending=None if end is None else end.ending,
                detail="" if end is None else end.detail,
            )

    @property
    def _pending(self) -> Turn | None:
        """The last observation, if it has no answer yet."""
        return None if self.last is None or self.last.is_answered else self.last

    @property
    def _state(self) -> SearchState:
        if self.end is not None:
            return SearchState.ENDED
        if self._is_resuming:
            return SearchState.RESUMING
        return SearchState.WAITING if self._pending is None else SearchState.DECIDING

    def _known(self, sequence: int) -> Turn | None:
        """The turn of an observation that is not new; None if it is the next.

        Raises:
            RequestRefusedError: It is neither.
        """
        last = self.last
        final = last.reply if last is not None and last.reply is not None else None
        is_final = final is not None and final.done
        if last is not None and last.sequence == sequence and (self.end is None or is_final):
            return last
        if self.end is not None:
            return Turn(sequence, reply=_end_reply(sequence, self.end))
        if final is not None and is_final:
            return Turn(sequence, reply=final.model_copy(update={"sequence": sequence}))
        if self._pending is not None:
            raise _refused(
                "pending",
                f"observation {self._pending.sequence} is not answered yet; ask for its answer "
                f"before observation {sequence}",
                self._pending.sequence,
            )
        if sequence != self._next_sequence:
            message = f"expected observation {self._next_sequence}, got {sequence}"
            raise _refused("sequence", message, self._next_sequence)
        return None

    def _note_change(self) -> None:
        with self._lock:
            self._version += 1
        self.bell.ring()


def _end_reply(sequence: int, end: EndRecord) -> Reply:
    """The answer to an observation once a search is over."""
    return Reply(
        sequence=sequence, action=Action.STOP, reason=end.detail, done=True, ending=end.ending
    )


def _refused(error: str, message: str, expected: int) -> RequestRefusedError:
    return RequestRefusedError(message, error=error, status=409, expected=expected)
