"""Parts of the messages: their base class, poses, names and bounds."""

import json
from collections import Counter
from typing import Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from hypernav.core.geometry.transforms import Pose2, Transform

SEARCHES = "/v1/searches"
"""Path of all searches; that of one is ``SEARCHES/ID``."""
FARTHEST_M = 500.0
"""Largest coordinate of a pose, metres."""
MAP_REACH_M = 150.0
"""Largest coordinate of a robot in the ``map`` frame, metres: maps must fit into memory."""
LATEST_S = 1e12
"""Greatest time of an observation, seconds."""
LONGEST_WAIT_S = 30.0
"""Longest time that the server keeps a request waiting, seconds."""

_RIGID_TOLERANCE = 1e-3
_LARGEST_ROBOT_M = 10.0

Coordinate = Annotated[float, Field(ge=-FARTHEST_M, le=FARTHEST_M)]
InMap = Annotated[float, Field(ge=-MAP_REACH_M, le=MAP_REACH_M)]
Angle = Annotated[float, Field(ge=-1000.0, le=1000.0)]
SearchId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
"""Name of a search: 32 hexadecimal digits, so that it cannot be a path."""


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


def repeated_key(text: bytes) -> str | None:
    """A key that an object in a JSON text has twice; None if none has, or the text is no JSON."""
    repeated: list[str] = []

    def note(pairs: list[tuple[str, object]]) -> None:
        counts = Counter(key for key, _ in pairs)
        repeated.extend(key for key, count in counts.items() if count > 1)

    try:
        json.loads(text, object_pairs_hook=note)
    except (ValueError, RecursionError):
        return None
    return repeated[0] if repeated else None


class Message(BaseModel):
    """Base of all messages: frozen; unknown fields, NaN and infinity are errors."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False
    )


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
