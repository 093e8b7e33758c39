"""The order of the observations: each is accepted once and answered once."""

from dataclasses import dataclass

from hypernav.core.actions import Action
from hypernav.core.errors import RequestRefusedError, RunFolderError, WireError
from hypernav.robot.server.state.journal import EndRecord
from hypernav.robot.wire.replies import Reply


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


class Turns:
    """Decides whether a number is the next one, a repetition or a mistake. Not thread-safe.

    Attributes:
        next_sequence: Number of the observation that is expected next.
        last: The last observation, accepted or being checked; None before the first.
        end: End of the search; None as long as it goes on.
    """

    def __init__(self, last: Turn | None, end: EndRecord | None) -> None:
        """Begin after an observation that was accepted, or before the first.

        Args:
            last: The last observation.
            end: End of the search.
        """
        self.next_sequence = 0 if last is None else last.sequence + 1
        self.last = last
        self.end = end
        self._before: Turn | None = None
        if end is not None and last is not None and last.reply is None:
            last.reply = _end_reply(last.sequence, end)

    @property
    def pending(self) -> Turn | None:
        """The last observation, if it has no answer yet."""
        return None if self.last is None or self.last.is_answered else self.last

    @property
    def end_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        last = max(self.next_sequence - 1, 0)
        return None if self.end is None else _end_reply(last, self.end)

    def known(self, sequence: int) -> Turn | None:
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
        if self.pending is not None:
            raise _refused(
                "pending",
                f"observation {self.pending.sequence} is not answered yet; ask for its answer "
                f"before observation {sequence}",
                self.pending.sequence,
            )
        if sequence != self.next_sequence:
            message = f"expected observation {self.next_sequence}, got {sequence}"
            raise _refused("sequence", message, self.next_sequence)
        return None

    def asked_again(self, sequence: int) -> Turn:
        """The turn of an observation whose answer is asked for again.

        Raises:
            RequestRefusedError: It is not the last one.
        """
        turn = self.known(sequence)
        if turn is None:
            message = f"observation {sequence} has not come yet; send it first"
            raise _refused("sequence", message, self.next_sequence)
        return turn

    def begin(self, sequence: int) -> Turn:
        """Begin to check the next observation."""
        self._before, self.last = self.last, Turn(sequence)
        return self.last

    def accept(self, turn: Turn) -> None:
        """Accept the observation that is being checked."""
        self.next_sequence = turn.sequence + 1

    def withdraw(self, turn: Turn, error: WireError | RunFolderError) -> None:
        """Discard the observation that is being checked."""
        if not turn.is_answered:
            turn.error, self.last = error, self._before

    def finish(self, end: EndRecord) -> None:
        """End the search, which also answers a pending observation."""
        self.end = end
        if self.pending is not None:
            self.pending.reply = _end_reply(self.pending.sequence, end)


def _end_reply(sequence: int, end: EndRecord) -> Reply:
    """The answer to an observation once a search is over."""
    return Reply(
        sequence=sequence, action=Action.STOP, reason=end.detail, done=True, ending=end.ending
    )


def _refused(error: str, message: str, expected: int) -> RequestRefusedError:
    return RequestRefusedError(message, error=error, status=409, expected=expected)
