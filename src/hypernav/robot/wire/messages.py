"""The messages between a robot and its server, version 1.

A search reads as a short story:

1. ``POST /v1/searches`` with `OpenSearch` gives `SearchOpened`.
2. ``POST /v1/searches/ID/observations`` with an observation (`hypernav.robot.wire.frames`) gives a
   `Reply`. Observations are numbered 0, 1, 2, … by `ObservationFacts.sequence`. The same over one
   WebSocket, ``/v1/searches/ID/stream``: observations as binary messages, `StreamMessage` back.
3. The robot executes ``reply.action`` once, observes, and goes on with the next number, until
   ``reply.done``.

What the numbers mean:

- The number that is expected next is accepted and answered once.
- The number that was accepted last is a repetition: it gets the same answer and changes nothing,
  whatever is in its body.
- Every other number is refused: `ErrorBody` with ``error="sequence"`` and the ``expected`` one.
- If the answer takes longer than the deadline, the reply says ``hold``: stand still, and ask again,
  with the same number or by ``GET /v1/searches/ID/replies/SEQUENCE``. Over the WebSocket the answer
  follows on its own. The next number is refused for so long (``error="pending"``).

Stop always wins: from the moment of ``POST /v1/searches/ID/stop`` every observation of any number,
a pending one included, is answered by ``STOP``, ``done`` and the ending ``stopped``, for good; over
the WebSocket this reply is also pushed at once. ``POST /v1/searches/ID/close`` does the same for a
search that nobody needs any more. After any other end every observation but a repetition of the
last is answered by ``STOP``, ``done`` and the ending. None of these changes anything any more.

Everything is in metres, radians and seconds, frames as in REP 103 and 105: base x forward, y left,
z up; camera x right, y down, z forward; rotations counter-clockwise. Models are frozen; unknown
fields, NaN and infinity are errors.
"""

import math
from enum import StrEnum
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from hypernav.core.actions import Action
from hypernav.core.config import MOST_STEPS
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import MAX_GOAL_LENGTH
from hypernav.core.labels import ObjectLabel
from hypernav.core.trace import Mode

SEARCHES = "/v1/searches"
"""Path of all searches; that of one is ``SEARCHES/ID``."""
FARTHEST_M = 500.0
"""Largest coordinate of a pose, metres."""
MAP_REACH_M = 150.0
"""Largest coordinate of a robot in the ``map`` frame, metres: maps must fit into memory."""
LONGEST_WAIT_S = 30.0
"""Longest time that the server keeps a request waiting, seconds."""

_RIGID_TOLERANCE = 1e-3
_LARGEST_ROBOT_M = 10.0
_MOST_IMAGE_BYTES = 100_000_000

Coordinate = Annotated[float, Field(ge=-FARTHEST_M, le=FARTHEST_M)]
Angle = Annotated[float, Field(ge=-1000.0, le=1000.0)]
SearchId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
"""Name of a search: 32 hexadecimal digits, so that no path can be made of it."""


def _checked_rigid(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    matrix = np.array(rows)
    rotation = matrix[:3, :3]
    is_rotation = np.allclose(rotation @ rotation.T, np.eye(3), atol=_RIGID_TOLERANCE)
    if not is_rotation or np.linalg.det(rotation) < 0.0:
        raise ValueError("expected a rigid transform: its rotation is not orthonormal, or mirrors")
    if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise ValueError(f"expected a rigid transform with the last row 0 0 0 1, got {rows[3]}")
    if np.abs(matrix[:3, 3]).max() > _LARGEST_ROBOT_M:
        raise ValueError(f"expected a camera within {_LARGEST_ROBOT_M:g} m of the robot's base")
    return rows


_Row = tuple[Coordinate, Coordinate, Coordinate, Coordinate]
RigidMatrix = Annotated[tuple[_Row, _Row, _Row, _Row], AfterValidator(_checked_rigid)]
"""Homogeneous 4 × 4 matrix of a camera's pose on the robot, row by row."""


class Message(BaseModel):
    """Base of all messages: frozen; unknown fields, NaN and infinity are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class PlanarPose(Message):
    """Position and heading of a frame in another.

    Attributes:
        x: Position along the x axis, metres.
        y: Position along the y axis, metres.
        yaw: Heading, radians, counter-clockwise from the x axis.
        z: Height, metres; 0 on the floor of the start.
    """

    x: Coordinate = 0.0
    y: Coordinate = 0.0
    yaw: Angle = 0.0
    z: Coordinate = 0.0

    @property
    def transform(self) -> Transform:
        """The rigid transform from this pose's frame to the other."""
        return Pose2(self.x, self.y, self.yaw).to_transform(self.z)


class Intrinsics(Message):
    """Focal lengths and principal point of the camera, pixels; the image begins at (0, 0).

    Attributes:
        fx: Horizontal focal length.
        fy: Vertical focal length.
        cx: Column coordinate of the principal point.
        cy: Row coordinate of the principal point.
    """

    fx: float = Field(gt=1.0, le=1e5)
    fy: float = Field(gt=1.0, le=1e5)
    cx: float = Field(ge=-1e4, le=1e5)
    cy: float = Field(ge=-1e4, le=1e5)


class OpenSearch(Message):
    """The request for a search.

    Attributes:
        goal: What to find, as text.
        embodiment: Body, camera and actions of the robot; missing values are those of
            Habitat's HM3D robot.
        intrinsics: Calibration of the camera; None means square pixels, ``hfov_deg`` and a central
            principal point. With it, ``hfov_deg`` is calculated.
        preset: Values of the method; None takes the server's.
        agent: Name of an agent; None takes the server's.
        max_steps: Number of observations after which the search ends as given up.
        deadline_s: Longest wait for an answer before the reply says ``hold``, seconds.
        key: Word that the robot makes up once a search. Opening again with the same key gives the
            same search, so that a lost answer leaves no second one behind.
    """

    goal: str = Field(min_length=1, max_length=MAX_GOAL_LENGTH)
    embodiment: Embodiment = Embodiment()
    intrinsics: Intrinsics | None = None
    preset: Literal["default", "paper"] | None = None
    agent: Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]{0,39}$")] | None = None
    max_steps: int = Field(default=500, ge=1, le=MOST_STEPS)
    deadline_s: float = Field(default=1.0, ge=0.05, le=LONGEST_WAIT_S)
    key: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{8,64}$")] | None = None

    @model_validator(mode="after")
    def _field_of_view_is_possible(self) -> "OpenSearch":
        hfov_deg = math.degrees(self.camera.hfov)
        if not 1.0 <= hfov_deg <= 170.0:
            raise ValueError(
                f"the intrinsics mean a horizontal field of view of {hfov_deg:.1f} degrees, "
                "expected hfov_deg from 1 to 170"
            )
        return self

    @property
    def camera(self) -> PinholeCamera:
        """The camera model of the images to come."""
        camera = self.embodiment.camera
        if self.intrinsics is None:
            return camera.intrinsics
        return PinholeCamera(camera.width, camera.height, **self.intrinsics.model_dump())

    @property
    def robot(self) -> Embodiment:
        """The robot, with the field of view that its calibration means."""
        if self.intrinsics is None:
            return self.embodiment
        values = self.embodiment.model_dump()
        values["camera"]["hfov_deg"] = math.degrees(self.camera.hfov)
        return Embodiment.model_validate(values)


class SearchOpened(Message):
    """The answer to `OpenSearch`.

    Attributes:
        id: Name of the search, for all paths.
        next_sequence: Number of the observation that is expected next: 0 for a new search.
        version: Version of hypernav on the server.
        words: Detector and reasoner in use, for people.
    """

    id: SearchId
    next_sequence: int
    version: str
    words: str


class ObservationFacts(Message):
    """What an observation says beside its images.

    Attributes:
        sequence: Number of the observation in its search, from 0 without gaps.
        stamp_s: Time at which the images were taken, on the robot's clock, seconds.
        base_to_odom: Pose of the robot in the frame of its odometry, which drifts but never jumps.
        odom_to_map: Pose of the odometry frame in the ``map`` frame, by localisation; may jump.
            Without localisation both frames are one.
        camera_to_base: Pose of the camera on the robot: the transform from the optical to the base
            frame. None takes height and pitch of the search's embodiment.
        blocked: Whether the robot says that its last motion did not happen; noted in the trace.
    """

    sequence: int = Field(ge=0, le=MOST_STEPS)
    stamp_s: float = Field(ge=0.0, le=1e12)
    base_to_odom: PlanarPose
    odom_to_map: PlanarPose = PlanarPose()
    camera_to_base: RigidMatrix | None = None
    blocked: bool = False

    @property
    def base_to_map(self) -> Transform:
        """Pose of the robot in the ``map`` frame."""
        return self.odom_to_map.transform @ self.base_to_odom.transform


class ColourPart(Message):
    """The colour image: format, and number of bytes after the header."""

    format: Literal["jpeg", "png"]
    bytes: int = Field(ge=1, le=_MOST_IMAGE_BYTES)


class DepthPart(Message):
    """The depth image, of the same size and seen by the same camera.

    ``png-mm`` is a 16-bit grey PNG in millimetres, ``float32`` little-endian metres row by row; 0,
    and in the latter NaN, where there is no return.
    """

    format: Literal["png-mm", "float32"]
    bytes: int = Field(ge=1, le=_MOST_IMAGE_BYTES)


class LabelsPart(Message):
    """True labels, which a simulated robot may add for a server without a model.

    Attributes:
        bytes: Size of a 16-bit grey PNG: numbers of instances plus 1, 0 where there is none.
        names: Labels of the instances.
    """

    bytes: int = Field(ge=1, le=_MOST_IMAGE_BYTES)
    names: dict[Annotated[int, Field(ge=0, le=65_534)], ObjectLabel] = Field(max_length=2000)


class ObservationHeader(ObservationFacts):
    """The first line of an observation: facts, and which images follow in this order.

    Attributes:
        colour: The colour image.
        depth: The depth image.
        labels: True labels, in simulation only.
    """

    colour: ColourPart
    depth: DepthPart
    labels: LabelsPart | None = None


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


class Reply(Message):
    """The answer to an observation.

    Attributes:
        sequence: Number of the observation.
        hold: Whether the decision is still pending: stand still, and ask again.
        action: What to do, once; STOP when the search is over, None while it is on hold.
        destination: Position ``(x, y)`` that the robot is going to, ``map`` frame, metres.
        path: Rest of the path there, from the robot on, ``map`` frame, metres.
        clearance_m: Distance from the robot to the nearest obstacle on the map, metres; None if
            there is none within 3 m.
        velocity: Suggestion for continuous driving at the pose of the observation.
        mode: What the agent is about.
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


class Status(Message):
    """The present state of a search.

    Attributes:
        id: Name of the search.
        version: Number of the state, another one after every change; with
            ``GET …/ID?after=VERSION&wait_s=20`` the next change is waited for.
        goal: What is searched for.
        words: Detector and reasoner in use, for people.
        opened_s: Time of opening, seconds since 1970.
        state: What the search is waiting for.
        next_sequence: Number of the observation that is expected next.
        last: The last answer; None before the first.
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame.
        map: Extent of the map; None before the first answer.
        ending: How the search ended; None as long as it goes on.
        detail: Why it was stopped or failed, for people.
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
    map: MapExtent | None = None
    ending: SearchEnding | None = None
    detail: str = ""


class Health(Message):
    """That the server is there.

    Attributes:
        version: Version of hypernav on the server.
    """

    version: str


class StopRequest(Message):
    """The stop button.

    Attributes:
        reason: Who pressed it, or why; shown to people.
    """

    reason: str = Field(default="", max_length=200)


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
