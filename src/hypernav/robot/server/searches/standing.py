"""Where one search stands: what has come, what was answered, how it ended, what people see."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from hypernav.core.embodiment import Action
from hypernav.core.errors import RequestRefusedError, RunFolderError, WireError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import floor_of
from hypernav.robot.server.searches.journal import EndRecord, Journal, SearchRecord, StepRecord
from hypernav.robot.wire.frames import PackedObservation
from hypernav.robot.wire.replies import MapExtent, Reply, SearchState, StartInMemory, Status

PAUSED = "paused by the operator"
"""Detail of a search under way that people keep waiting."""


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


@dataclass(frozen=True, eq=False)
class Standing:
    """A value that is replaced at every change.

    After the end of a search its maps and image are on the disk and no longer in here, because a
    server keeps many searches.

    Attributes:
        version: Number of changes that people were told of.
        last: The last observation, accepted or being checked; None before the first.
        before: The one before it.
        next_sequence: Number of the observation that is expected next.
        is_paused: Whether people keep the robot waiting for its next decision.
        is_resuming: Whether the agent is given again what came before a restart.
        end: End of the search; None as long as it goes on.
        start: Where the robot is in the server's memory; None if it knew, or still turns.
        doubts: What the robot sends that may be misread, as told so far.
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame; None before the first decision.
        floor: Number of the floor that it is on.
        extent: Where the map of that floor lies; None before the first decision.
        maps: Last map of every floor, by its number; empty before the first decision, and after
            the end.
        colour: Format and bytes of the last colour image; None before the first, and after the end.
    """

    version: int = 0
    last: Turn | None = None
    before: Turn | None = None
    next_sequence: int = 0
    is_paused: bool = False
    is_resuming: bool = False
    end: EndRecord | None = None
    start: StartInMemory | None = None
    doubts: tuple[str, ...] = ()
    pose: tuple[float, float, float] | None = None
    floor: int = 1
    extent: MapExtent | None = None
    maps: Mapping[int, OccupancyGrid] = field(default_factory=dict)
    colour: tuple[str, bytes] | None = None

    @staticmethod
    def of(journal: Journal) -> "Standing":
        """Where a search stands by its journal.

        Raises:
            HyPerNavError: The journal is damaged.
        """
        end, count, decided = journal.end, journal.observation_count, journal.step_count
        step = journal.step(decided - 1) if decided > 0 else None
        trace = None if step is None else step.trace
        last = Turn(count - 1) if count > 0 else None
        if last is not None:
            if step is not None and decided == count:
                last.reply = step.reply
            elif end is not None:
                last.reply = end_reply(last.sequence, end)
        now = Standing(last=last, next_sequence=count, end=end, is_paused=journal.is_paused)
        if end is None:
            return replace(now, colour=journal.image_of(count - 1)).showing(step, {})
        floor = 1 if trace is None else floor_of(trace)
        grid = journal.read_map(floor, floor)
        return now.showing(step, {} if grid is None else {floor: grid}).kept_on(journal)

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first, and after the end."""
        return self.maps.get(self.floor)

    @property
    def pending(self) -> Turn | None:
        """The last observation, if it has no answer yet."""
        return None if self.last is None or self.last.is_answered else self.last

    @property
    def state(self) -> SearchState:
        """The state that a status names."""
        if self.end is not None:
            return SearchState.ENDED
        if self.is_resuming:
            return SearchState.RESUMING
        return SearchState.WAITING if self.pending is None else SearchState.DECIDING

    @property
    def final_reply(self) -> Reply | None:
        """The answer to any further observation once the search is over; None before."""
        return None if self.end is None else end_reply(max(self.next_sequence - 1, 0), self.end)

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
            return Turn(sequence, reply=end_reply(sequence, self.end))
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

    def offered(self, turn: Turn) -> "Standing":
        """With a new observation, which is to be checked."""
        return replace(self, last=turn, before=self.last)

    def withdrawn(self) -> "Standing":
        """Without the observation that was checked."""
        return replace(self, last=self.before)

    def accepted(self, packed: PackedObservation) -> "Standing":
        """With the observation that was checked, and its image."""
        now = replace(self, next_sequence=packed.header.sequence + 1)
        if self.end is not None:
            return now
        return replace(now, colour=(packed.header.colour.format, packed.colour))

    def showing(self, step: StepRecord | None, maps: Mapping[int, OccupancyGrid]) -> "Standing":
        """With start, pose and maps after a decision; what there is none of leaves the old."""
        now = replace(self, maps={**self.maps, **maps})
        if step is not None:
            now = replace(now, start=step.start or now.start, doubts=step.doubts)
        if step is not None and step.trace is not None:
            now = replace(now, pose=step.trace.pose, floor=floor_of(step.trace))
        return now if now.grid is None else replace(now, extent=MapExtent.of(now.grid))

    def kept_on(self, journal: Journal) -> "Standing":
        """Without image and maps, once the journal has them."""
        return replace(self, colour=None, maps={} if journal.has_map else self.maps)

    def status(self, record: SearchRecord, silent_s: float) -> Status:
        """What people are told.

        Args:
            record: What the search was opened with.
            silent_s: Time since the robot's last message, seconds.
        """
        return Status(
            id=record.id,
            version=self.version,
            goal=record.request.goal,
            words=record.words,
            opened_s=record.opened_s,
            state=self.state,
            next_sequence=self.next_sequence,
            last=None if self.last is None else self.last.reply,
            pose=self.pose,
            start=self.start,
            doubts=self.doubts,
            map=self.extent,
            silent_s=round(silent_s, 3) if self.end is None else None,
            ending=None if self.end is None else self.end.ending,
            detail=(PAUSED if self.is_paused else "") if self.end is None else self.end.detail,
        )


def end_reply(sequence: int, end: EndRecord) -> Reply:
    """The answer to an observation once a search is over.

    Args:
        sequence: Number of the observation.
        end: How the search ended.
    """
    return Reply(
        sequence=sequence, action=Action.STOP, reason=end.detail, done=True, ending=end.ending
    )


def _refused(error: str, message: str, expected: int) -> RequestRefusedError:
    return RequestRefusedError(message, error=error, status=409, expected=expected)
