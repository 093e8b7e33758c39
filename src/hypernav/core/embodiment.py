"""What the robot is, said once: its body, its camera, what its actions do."""

import math

from pydantic import Field, model_validator

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Transform


class BodyConfig(RoomConfig):
    """The robot's body: a cylinder.

    The defaults are those of Habitat's HM3D robot as its navigation mesh really treats it: Recast
    rounds the height of 0.88 m up to its voxels of 0.2 m. The step is half of Habitat's 0.2 m, what
    a wheeled robot can take; stairs (0.17 m and more a step) are therefore not walkable, and one
    storey is all that a robot can reach.

    Attributes:
        radius_m: Radius of the cylinder.
        height_m: Room that it needs above the floor.
        max_step_m: Highest edge that it drives over.
        max_slope_deg: Steepest surface that it stands on.
    """

    radius_m: float = Field(default=0.18, ge=0.0, le=5.0)
    height_m: float = Field(default=1.0, ge=0.1, le=10.0)
    max_step_m: float = Field(default=0.1, ge=0.0, le=1.0)
    max_slope_deg: float = Field(default=45.0, ge=0.0, lt=90.0)

    @model_validator(mode="after")
    def _step_is_lower_than_the_body(self) -> "BodyConfig":
        if self.max_step_m >= self.height_m:
            raise ValueError(
                f"max_step_m must be below height_m, got {self.max_step_m} and {self.height_m}"
            )
        return self


class CameraConfig(RoomConfig):
    """The RGB-D camera, by default that of Habitat's HM3D challenge.

    Depth outside the sensor's range is 0, no return, on both sides of it, as real depth cameras
    report it. (Habitat clips it to the range instead, so that a far wall looks like one at the
    maximum; a mapper that trusts every positive depth would draw that wall.)

    Attributes:
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
        hfov_deg: Horizontal field of view.
        height_m: Height of the lens above the floor.
        pitch_deg: Downward tilt; negative looks up.
        min_depth_m: Nearest return.
        max_depth_m: Farthest return.
    """

    width: int = Field(default=640, ge=8, le=8192)
    height: int = Field(default=480, ge=8, le=8192)
    hfov_deg: float = Field(default=79.0, ge=1.0, le=170.0)
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
    def intrinsics(self) -> PinholeCamera:
        """The camera model."""
        return PinholeCamera.from_hfov(self.width, self.height, self.hfov_deg)

    @property
    def camera_to_base(self) -> Transform:
        """Where the camera sits on the robot."""
        return optical_to_base(self.height_m, self.pitch_deg)


class MotionConfig(RoomConfig):
    """What the actions do, by default as in the paper.

    Attributes:
        forward_m: Length of a step forward.
        turn_angle_deg: Rotation of one turn action; a whole number of turns makes a circle.
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
        """As many actions as do what so many of the paper's do, steps of 0.5 m and turns of 30°."""
        return math.ceil(paper_actions * max(0.5 / self.forward_m, 30.0 / self.turn_angle_deg))

    @property
    def turns_of_a_circle(self) -> int:
        """How many turns bring the robot around once."""
        return round(360.0 / self.turn_angle_deg)


class Embodiment(RoomConfig):
    """What the robot is; everyone who needs to know reads it from here.

    Attributes:
        body: How large it is and what it drives over.
        camera: What it sees with.
        motion: What its actions do.
    """

    body: BodyConfig = BodyConfig()
    camera: CameraConfig = CameraConfig()
    motion: MotionConfig = MotionConfig()
