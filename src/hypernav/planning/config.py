"""How the robot drives."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig


class PlanningConfig(RoomConfig):
    """How ways are planned and followed.

    Attributes:
        inflation_m: Obstacles are dilated by this: the robot's radius and a margin.
        comfort_m: Within this distance beyond the inflation a way costs more, so that it keeps to
            the middle of doors where there is room.
        comfort_cost: By how much; 0 switches it off (paper).
        unknown_cost: Factor on ways through unknown cells; 0 forbids them.
        targets: Of the destination's cells, go to the "nearest-straight" (paper) or to the
            "nearest-by-path".
        replan_every_steps: A path is kept this long unless it is blocked (paper: 10).
        steering: "waypoint": turn if the next waypoint is too far off, else go (paper).
            "rollout": of all headings, take the one whose step leaves the shortest way to go
            without touching an inflated obstacle.
        heading_tolerance_deg: For "waypoint" (paper: 15).
        waypoint_tolerance_m: A waypoint counts as passed within this distance.
        forward_m: Length of a step.
        turn_angle_deg: Of a turn.
    """

    inflation_m: float = Field(0.22, ge=0.0)
    comfort_m: float = Field(0.20, ge=0.0)
    comfort_cost: float = Field(1.0, ge=0.0)
    unknown_cost: float = Field(3.0, ge=0.0)
    targets: Literal["nearest-straight", "nearest-by-path"] = "nearest-by-path"
    replan_every_steps: int = Field(10, ge=1)
    steering: Literal["waypoint", "rollout"] = "rollout"
    heading_tolerance_deg: float = Field(15.0, gt=0.0)
    waypoint_tolerance_m: float = Field(0.25, gt=0.0)
    forward_m: float = Field(0.5, gt=0.0)
    turn_angle_deg: float = Field(30.0, gt=0.0, le=180.0)
