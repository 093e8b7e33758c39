"""What the server sends: replies to observations, the state of a search, refusals."""

from enum import StrEnum

from hypernav.core.embodiment import Action
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.trace import Mode
from hypernav.robot.wire.values import Message, SearchId


class SearchOpened(Message):
    """The answer to `OpenSearch`.

    Attributes:
        id: Name of the search, for all paths.
        next_sequence: Number of the observation that is expected next: 0 for a new search.
        version: Version of hypernav on the server.
        words: Detector and reasoner in use, for people.
        earlier_searches: Number of searches that the server's memory knows, before this one; left
            out, so that older robots understand the answer, where the server has no memory or is
            older.
    """

    id: SearchId
    next_sequence: int
    version: str
    words: str
    earlier_searches: int | None = None

    @property
    def detector_and_reasoner(self) -> tuple[str, str]:
        """The two parts of ``words``, such as "detector ground truth, reasoner geometric"."""
        detector, _, reasoner = self.words.removeprefix("detector ").partition(", reasoner ")
        return detector, reasoner


class Velocity(Message):
    """A suggestion for a robot that drives continuously, in its base frame (REP 103).

    Attributes:
        linear_m_s: Speed forward, metres a second.
        angular_rad_s: Rotation to the left, radians a second.
    """

    linear_m_s: float
    angular_rad_s: float


class SearchEnding(StrEnum):
    """Endings of a search."""

    FOUND = "found"
    """The agent says that the goal is here."""
    GAVE_UP = "gave up"
    """The agent knows of nothing left to try, or the steps ran out."""
    STOPPED = "stopped"
    """Someone pressed stop."""
    MODEL_UNAVAILABLE = "model unavailable"
    """A model did not answer; this says nothing about the search."""
    FAILED = "failed"
    """The server could not go on; its log says why."""
    CLOSED = "closed"
    """The search was closed before its end."""
    ROBOT_FAILED = "robot failed"
    """What the robot sent cannot be right, it ended by an error, or it fell silent."""


class Reply(Message):
    """The answer to an observation.

    Attributes:
        sequence: Number of the observation.
        hold: Whether the decision is still pending: stand still, and ask again.
        action: What to do, once; STOP when the search is over, None while it is on hold.
        destination: Position ``(x, y)`` that the robot is going to, metres, in the frame of the
            robot's poses: its ``map`` frame, which is that of the search unless the server finds
            the start (`StartInMemory`).
        path: Remaining path there, from the robot on, in the same frame, metres.
        clearance_m: Distance from the robot to the nearest obstacle on the map, metres; None if
            there is none within 3 m.
        velocity: Suggestion for continuous driving at the pose of the observation.
        mode: What the agent is doing.
        reason: Reason for the action, in one short sentence for people.
        done: Whether the search is over.
        ending: How it ended.
    """

    sequence: int
    hold: bool = False
    action: Action | None = None
    destination: tuple[float, float] | None = None
    path: tuple[tuple[float, float], ...] = ()
    clearance_m: float | None = None
    velocity: Velocity | None = None
    mode: Mode | None = None
    reason: str = ""
    done: bool = False
    ending: SearchEnding | None = None


class MapExtent(Message):
    """Where the present map lies: cell (0, 0) is the lower left, and the PNG's last row."""

    rows: int
    columns: int
    resolution_m: float
    origin: tuple[float, float]

    @staticmethod
    def of(grid: OccupancyGrid) -> "MapExtent":
        """Where a map lies."""
        rows, columns = grid.cells.shape
        x, y = (round(value, 6) for value in grid.origin)
        return MapExtent(rows=rows, columns=columns, resolution_m=grid.resolution_m, origin=(x, y))


class SearchState(StrEnum):
    """States of a search."""

    RESUMING = "resuming"
    """The server was restarted and repeats what it has seen."""
    WAITING = "waiting"
    """The robot is to send the next observation."""
    DECIDING = "deciding"
    """The last observation is not answered yet."""
    ENDED = "ended"
    """The search is over."""


class StartInMemory(Message):
    """Where a robot that doesn't know its start is in the server's memory, by its first turn.

    Attributes:
        sure: Whether the place is sure. If not, the search goes on with a new memory, which is not
            kept, and the server's memory stays as it was.
        doubt: The reason why it isn't, for people; empty if it is.
        turns: Number of turns that it took.
        robot_frame: Pose ``(x, y, yaw)`` at which the frame of the robot's poses begins, in the
            ``map`` frame of the search: the memory's, or one that begins where the robot stood.
        robot_frame_z: Height of that frame there, metres.
        floor: Number of the likeliest floor, from 1; None if there was nothing to compare.
        evidence: What speaks for the place, at most 1.
        rival: What speaks for the best other place, as a share of that.
    """

    sure: bool
    doubt: str
    turns: int
    robot_frame: tuple[float, float, float]
    robot_frame_z: float
    floor: int | None = None
    evidence: float | None = None
    rival: float | None = None

    @property
    def words(self) -> str:
        """What became of it, for people."""
        if self.sure:
            return f"found on floor {self.floor} of the memory by one turn"
        return f"not found in the memory: {self.doubt}; the search began anew"

    @property
    def robot_to_map(self) -> Transform:
        """The transform from the frame of the robot's poses to the ``map`` frame of the search."""
        return Pose2(*self.robot_frame).to_transform(self.robot_frame_z)


class Status(Message):
    """The present state of a search.

    Attributes:
        id: Name of the search.
        version: Number of the state, which changes with the state;
            ``GET …/ID?after=VERSION&wait_s=20`` waits for the next change.
        goal: What is searched for.
        words: Detector and reasoner in use, for people.
        opened_s: Time of opening, seconds since 1970.
        state: What the search is waiting for.
        next_sequence: Number of the observation that is expected next.
        last: The last answer; None before the first.
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame of the search.
        start: Where the robot is in the server's memory; None if it knew, or still turns.
        doubts: What the robot sends that is plausible but may be misread, each with its evidence.
        map: Extent of the map; None before the first answer.
        silent_s: Time since the robot's last message, seconds; 0 while it waits for an answer, None
            once the search is over.
        ending: How the search ended; None as long as it goes on.
        detail: Why it was stopped or failed, or that it is paused, for people.
    """

    id: SearchId
    version: int
    goal: str
    words: str
    opened_s: float
    state: SearchState
    next_sequence: int
    last: Reply | None = None
    pose: tuple[float, float, float] | None = None
    start: StartInMemory | None = None
    doubts: tuple[str, ...] = ()
    map: MapExtent | None = None
    silent_s: float | None = None
    ending: SearchEnding | None = None
    detail: str = ""


class Health(Message):
    """Says that the server is running.

    Attributes:
        version: Version of hypernav on the server.
    """

    version: str


class ErrorBody(Message):
    """The body of every refusal, whatever its HTTP status.

    Attributes:
        error: Kind of the refusal, one word: "sequence", "pending", "invalid", "unknown",
            "too-large", "busy", "unauthorised", "forbidden", "storage", "internal", …
        message: What was expected, what was found and what to do, for people.
        expected: Sequence number that is expected, where a number was refused.
    """

    error: str
    message: str
    expected: int | None = None


class StreamMessage(Message):
    """A text message of the server over the WebSocket: a reply or a refusal.

    Attributes:
        reply: Answer to an observation; also pushed, unasked, when someone presses stop.
        error: Refusal of the latest message.
        status: HTTP status that goes with the refusal.
    """

    reply: Reply | None = None
    error: ErrorBody | None = None
    status: int = 200
