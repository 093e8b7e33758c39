"""What a robot sends: the search that it opens, observations and stop; and its wait for a goal."""

import json
import math
import re
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, Field, model_validator

from hypernav.core.config import MOST_STEPS
from hypernav.core.embodiment import LEAST_HFOV_DEG, MOST_HFOV_DEG, Embodiment
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.goal import MAX_GOAL_LENGTH
from hypernav.core.naming.labels import ObjectLabel
from hypernav.robot.wire.values import LATEST_S, LONGEST_WAIT_S, Message, PlanarPose, RigidMatrix

_MOST_IMAGE_BYTES = 100_000_000
_MOST_REASON = 200


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


class ThingName(Message):
    """One thing of the server's memory.

    Attributes:
        floor: Number of its floor, from 1.
        number: Its number on that floor.
    """

    floor: int = Field(ge=1, le=1000)
    number: int = Field(ge=0, le=2**53)


class OpenSearch(Message):
    """The request for a search.

    Attributes:
        goal: What to find, as text.
        embodiment: Body, camera and actions of the robot; missing values are those of
            the preset ``default``.
        intrinsics: Calibration of the camera; None means square pixels, ``hfov_deg`` and a central
            principal point. With it, ``hfov_deg`` is calculated.
        preset: Values of the method; None takes the server's.
        agent: Name of an agent; None takes the server's.
        max_steps: Number of observations after which the search ends as given up; those of a turn
            that finds the start in the server's memory don't count.
        labels: Whether the observations bring true labels, as only a simulation can. Without them a
            search is refused where the server's detector reads labels.
        deadline_s: Longest wait for an answer before the reply says ``hold``, seconds.
        thing: The remembered thing to go to before all others, if the server has a memory.
        key: Word that the robot makes up for each search. Opening again with the same key gives the
            same search, so that a lost answer does not leave a second one behind.
    """

    goal: str = Field(min_length=1, max_length=MAX_GOAL_LENGTH)
    embodiment: Embodiment = Embodiment()
    intrinsics: Intrinsics | None = None
    preset: Literal["default", "paper"] | None = None
    agent: Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]{0,39}$")] | None = None
    max_steps: int = Field(default=500, ge=1, le=MOST_STEPS)
    labels: bool = False
    deadline_s: float = Field(default=1.0, ge=0.05, le=LONGEST_WAIT_S)
    thing: ThingName | None = None
    key: Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{8,64}$")] | None = None

    @model_validator(mode="after")
    def _field_of_view_is_possible(self) -> "OpenSearch":
        hfov_deg = math.degrees(self.camera.hfov)
        if not LEAST_HFOV_DEG <= hfov_deg <= MOST_HFOV_DEG:
            raise ValueError(
                f"the intrinsics mean a horizontal field of view of {hfov_deg:.1f} degrees, "
                f"expected hfov_deg from {LEAST_HFOV_DEG:.0f} to {MOST_HFOV_DEG:.0f}"
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
        """The robot, with the field of view that follows from its calibration."""
        if self.intrinsics is None:
            return self.embodiment
        values = self.embodiment.model_dump()
        values["camera"]["hfov_deg"] = math.degrees(self.camera.hfov)
        return Embodiment.model_validate(values)


class ObservationFacts(Message):
    """What an observation says besides its images.

    Attributes:
        sequence: Number of the observation in its search, from 0 without gaps.
        stamp_s: Time at which the images were taken, on the robot's clock, seconds; later than in
            the previous observation.
        base_to_odom: Pose of the robot in the frame of its odometry, which drifts but never jumps.
        odom_to_map: Pose of the odometry frame in the ``map`` frame, by localisation; may jump.
            Without localisation the two frames are the same.
        camera_to_base: Pose of the camera on the robot: the transform from the optical to the base
            frame. None takes height and pitch of the search's embodiment.
        blocked: Whether the robot reports that its last motion did not happen; noted in the trace.
    """

    sequence: int = Field(ge=0, le=MOST_STEPS, strict=True)
    stamp_s: float = Field(ge=0.0, le=LATEST_S)
    base_to_odom: PlanarPose
    odom_to_map: PlanarPose = PlanarPose()
    camera_to_base: RigidMatrix | None = None
    blocked: bool = False

    @property
    def base_to_map(self) -> Transform:
        """Pose of the robot in the ``map`` frame."""
        return self.odom_to_map.transform @ self.base_to_odom.transform

    def camera_pose(self, usual: Transform) -> Transform:
        """Pose of the camera on the robot.

        Args:
            usual: That of the search's embodiment.
        """
        matrix = self.camera_to_base
        return usual if matrix is None else Transform.from_matrix(np.array(matrix))


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


class StopRequest(BaseModel):
    """The stop button. Whatever is sent, even nothing, stops.

    Attributes:
        reason: Who pressed it, or why; shown to people. More than 200 characters are cut off.
    """

    reason: str = ""

    @staticmethod
    def of(body: bytes) -> "StopRequest":
        """What was meant by a body: its ``reason``, or itself if it is another text than JSON."""
        text = body.decode(errors="replace")
        try:
            said = json.loads(text)
        except (ValueError, RecursionError):
            said = text
        if isinstance(said, dict):
            said = said.get("reason", "")
        words = " ".join(said.split()) if isinstance(said, str) else ""
        written = words.encode(errors="replace").decode()  # JSON may hold half of a surrogate pair
        return StopRequest(reason=written[:_MOST_REASON])


class CloseRequest(Message):
    """The end of a search from the robot's side.

    Attributes:
        reason: Why; shown to the operator.
        failed: Whether the robot ended by an error; the ending is then ``robot failed``.
    """

    reason: str = Field(default="", max_length=1000)
    failed: bool = False


THINGS = "/v1/things"
"""Path of the things that the server's memory knows."""
ROBOTS = "/v1/robots"
"""Path of the robots that wait; that of one is ``ROBOTS/NAME``."""
STOP_ALL = "/v1/stop"
"""Path of the button that stops every robot."""
LONGEST_WAIT_FOR_GOAL_S = 10.0
"""Longest time that the server keeps a robot without a goal waiting, seconds."""
ROBOT_NAME = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$"
"""Names of robots: up to 40 letters, digits, ``_`` and ``-``."""


def is_robot_name(name: str) -> bool:
    """Whether a robot may have this name."""
    return re.fullmatch(ROBOT_NAME, name) is not None


class GoalRequest(Message):
    """What a robot is to find.

    Attributes:
        goal: What to find, as text.
        thing: The remembered thing that is meant; None if any will do.
    """

    goal: Annotated[str, Field(min_length=1, max_length=MAX_GOAL_LENGTH)]
    thing: ThingName | None = None


class GivenGoal(Message):
    """The answer to a robot that waits.

    Attributes:
        goal: What to find; None as long as no goal was given.
        key: The ``key`` to open the search with; it also tells the server which thing is meant.
    """

    goal: str | None = None
    key: str | None = None


class RememberedThing(Message):
    """A thing of the server's memory.

    Attributes:
        thing: Its name, to be given to a robot as a goal.
        label: The detector's word for it.
        position: Its middle ``(x, y, z)``, ``map`` frame, heights above the floor, metres.
        chance: Chance that it is what it was taken for and still there, 0 to 1.
        outline: Lowest and highest corner ``(x, y)`` of it seen from above, metres.
        has_image: Whether a key image shows it; ``THINGS/FLOOR/NUMBER/image`` is the part of it.
        no_way: That a robot on the floor where the last search ended knows no stairs to the floor
            of the thing, or climbs none, for people; else empty. No reason to refuse it as a goal:
            another robot, or one that was carried, may be on that floor. A server whose plan goes
            over no stairs (`search.use_stairs`) has no way to any other floor.
    """

    thing: ThingName
    label: str
    position: tuple[float, float, float]
    chance: float
    no_way: str = ""
    outline: tuple[tuple[float, float], tuple[float, float]] | None = None
    has_image: bool = False


class WaitingRobot(Message):
    """A robot that waits for a goal.

    Attributes:
        name: Name that the robot gave itself.
        given: Goal for which it has not opened a search yet, with its key.
        refused: Why the search for its last goal could not be opened, for people.
    """

    name: str
    given: GivenGoal | None = None
    refused: str = ""
