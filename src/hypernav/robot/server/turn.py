"""One observation and the answer to it."""

from dataclasses import dataclass

from hypernav.core.actions import Action
from hypernav.core.errors import RunFolderError, WireError
from hypernav.robot.server.state.journal import EndRecord
from hypernav.robot.wire.messages import Reply


@dataclass(eq=False)
class Turn:
    """An observation and the answer to it, which comes once and stays.

    Attributes:
        sequence: Number of the observation.
        reply: The answer; None before.
        error: Why the observation was not accepted: it is broken, or the disk full; None if it was.
    """

    sequence: int
    reply: Reply | None = None
    error: WireError | RunFolderError | None = None

    @property
    def is_answered(self) -> bool:
        """Whether there is nothing left to wait for."""
        return self.reply is not None or self.error is not None

    def result(self) -> Reply:
        """The answer; ``hold`` as long as there is none.

        Raises:
            WireError: The observation is broken.
            RunFolderError: It could not be written down.
        """
        if self.error is not None:
            raise self.error
        return self.reply or Reply(sequence=self.sequence, hold=True, reason="deciding")


def end_reply(sequence: int, end: EndRecord) -> Reply:
    """The answer to any observation once a search is over."""
    return Reply(
        sequence=sequence, action=Action.STOP, reason=end.detail, done=True, ending=end.ending
    )
