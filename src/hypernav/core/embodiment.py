"""The robot, described once: its body, its camera, its actions and what they do."""

import math
from enum import IntEnum

import numpy as np
from pydantic import Field, model_validator

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Transform
from hypernav.core.naming.words import megabytes

_BYTES_PER_PIXEL = 200
"""Memory per pixel: its ray, colours, depth, instance and point, bytes."""
MOST_PIXELS = 5_000_000
"""The largest image of a camera."""
LEAST_HFOV_DEG, MOST_HFOV_DEG = 5.0, 170.0
"""The narrowest and the widest horizontal field of view of a camera, degrees."""

STAIR_CLIMB_M = 0.2
"""Height of steps, metres, from which a robot climbs stairs: Habitat's."""


class Action(IntEnum):
    """Discrete actions with Habitat's numbers."""

    STOP = 0
    MOVE_FORWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3


class BodyConfig(RoomConfig):
    """The robot's body: a cylinder.

    The defaults are those of Habitat's HM3D robot, with the height that its navigation mesh really
    uses: Recast rounds 0.88 m up to its voxels of 0.2 m. The step is half of Habitat's 0.2 m, which
    a wheeled robot can take; stairs (0.17 m and more a step) are therefore not walkable, and a
    robot can reach only one storey.

    Attributes:
        radius_m: Radius of the cylinder, metres.
        height_m: Height of the cylinder, the room that it needs above the floor, metres.
        max_step_m: Height of the highest edge that the robot drives over, metres.
        max_slope_deg: Slope of the steepest surface that the robot stands on, degrees.
    """

    radius_m: float = Field(default=0.18, ge=0.0, le=5.0)
    height_m: float = Field(default=1.0, ge=0.1, le=10.0)
    max_step_m: float = Field(default=0.1, ge=0.0, le=1.0)
    max_slope_deg: float = Field(default=45.0, ge=0.0, lt=90.0)

    @property
    def climbs_stairs(self) -> bool:
        """Whether it takes the steps of stairs."""
        return self.max_step_m >= STAIR_CLIMB_M

    @model_validator(mode="after")
    def _step_is_lower_than_the_body(self) -> "BodyConfig":
        if self.max_step_m >= self.height_m:
            raise ValueError(
                f"max_step_m must be below height_m, got {self.max_step_m} and {self.height_m}"
            )
        return self


class CameraConfig(RoomConfig):
    """The RGB-D camera. The paper states none for simulations: the default is Habitat's for HM3D.

    Depth outside the sensor's range is 0 (no return), below as well as above it, as in real depth
    cameras. (Habitat clips it to the range instead, so that a far wall appears at the maximum; a
    mapper that trusts every positive depth would draw that wall.)

    Attributes:
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
        hfov_deg: Horizontal field of view, degrees.
        height_m: Height of the lens above the floor, metres.
        pitch_deg: Downward tilt, degrees; negative looks up.
        min_depth_m: Smallest depth that the sensor measures, metres.
        max_depth_m: Largest depth that the sensor measures, metres.
    """

    width: int = Field(default=640, ge=8, le=8192)
    height: int = Field(default=480, ge=8, le=8192)
    hfov_deg: float = Field(default=79.0, ge=LEAST_HFOV_DEG, le=MOST_HFOV_DEG)
    height_m: float = Field(default=0.88, gt=0.0, le=10.0)
    pitch_deg: float = Field(default=0.0, gt=-90.0, lt=90.0)
    min_depth_m: float = Field(default=0.5, ge=0.0, le=100.0)
    max_depth_m: float = Field(default=5.0, gt=0.0, le=100.0)

    @model_validator(mode="after")
    def _range_is_not_empty(self) -> "CameraConfig":
        if self.min_depth_m >= self.max_depth_m:
            raise ValueError(
                f"min_depth_m must be below max_depth_m, got {self.min_depth_m} and "
                f"{self.max_depth_m}"
            )
        return self

    @property
    def depth_limits_m(self) -> tuple[float, float]:
        """The limits as depth images have them, in single precision, metres.

        A sensor that clips reports them, and 4.7 in single precision is less than 4.7.
        """
        return float(np.float32(self.min_depth_m)), float(np.float32(self.max_depth_m))

    @model_validator(mode="after")
    def _images_fit_into_memory(self) -> "CameraConfig":
        size = self.width * self.height * _BYTES_PER_PIXEL
        if self.width * self.height > MOST_PIXELS:
            raise ValueError(
                f"an image of {self.width} × {self.height} pixels would take "
                f"{megabytes(size)} to draw and to map, at most "
                f"{megabytes(MOST_PIXELS * _BYTES_PER_PIXEL)} are allowed; make width or height "
                "smaller"
            )
        return self

    @property
    def intrinsics(self) -> PinholeCamera:
        """The camera model."""
        return PinholeCamera.from_hfov(self.width, self.height, self.hfov_deg)

    @property
    def floor_from_m(self) -> float:
        """Distance from which it shows the floor ahead, metres; its range where it shows none."""
        below = math.radians(self.pitch_deg) + math.atan2(self.height / 2.0, self.intrinsics.fy)
        if below <= 0.0:
            return self.max_depth_m
        return min(self.height_m / math.tan(min(below, math.pi / 2.0)), self.max_depth_m)

    @property
    def camera_to_base(self) -> Transform:
        """Pose of the camera on the robot: the transform from the optical to the base frame."""
        return optical_to_base(self.height_m, self.pitch_deg)

    def base_z(self, camera_to_map: Transform) -> float:
        """Height of the robot below its camera, ``map`` frame, metres."""
        return float(camera_to_map.translation[2]) - self.height_m


class MotionConfig(RoomConfig):
    """Effect of the actions, by default as in the paper.

    Attributes:
        forward_m: Length of one step forward, metres (paper: 0.5).
        turn_angle_deg: Rotation of one turn action, degrees (paper: 30); a whole number of turns
            makes a circle.
    """

    forward_m: float = Field(default=0.5, ge=0.01, le=5.0)
    turn_angle_deg: float = Field(default=30.0, ge=1.0, le=180.0)

    @model_validator(mode="after")
    def _turns_make_a_circle(self) -> "MotionConfig":
        turns = 360.0 / self.turn_angle_deg
        if abs(turns - round(turns)) > 1e-6:
            raise ValueError(
                "turn_angle_deg must divide a circle of 360 degrees, such as 30, 15 or 10, got "
                f"{self.turn_angle_deg}"
            )
        return self

    def actions_for(self, paper_actions: int) -> int:
        """Number of actions that equals a number of the paper's (steps of 0.5 m, turns of 30°)."""
        return math.ceil(paper_actions * max(0.5 / self.forward_m, 30.0 / self.turn_angle_deg))

    @property
    def turns_of_a_circle(self) -> int:
        """Number of turns that make a full circle."""
        return round(360.0 / self.turn_angle_deg)


class Embodiment(RoomConfig):
    """The description of the robot for worlds, mapping, perception, planning and agents.

    Attributes:
        body: Size of the robot, and the ground that it drives over.
        camera: RGB-D camera of the robot.
        motion: Effect of its actions.
    """

    body: BodyConfig = BodyConfig()
    camera: CameraConfig = CameraConfig()
    motion: MotionConfig = MotionConfig()
