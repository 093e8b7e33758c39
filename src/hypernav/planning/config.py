"""How the robot drives."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig


class PlanningConfig(RoomConfig):
    """How ways are planned and followed.

    Attributes:
        inflation_m: Obstacles are dilated by this: the robot's radius and a margin.
        squeeze_m: Where no way leads, one is searched with obstacles dilated by so much less; 0
            (paper) does without.
        comfort_m: Within this distance beyond the inflation a way costs more, so that it keeps to
            the middle of doors where there is room.
        comfort_cost: By how much; 0 switches it off (paper).
        unknown_cost: Factor on ways through unknown cells; 0 forbids them.
        end_in_unknown: A way may end in unknown cells of the destination if it has no other open
            ones; else only in known ones (paper).
        targets: Of the destination's cells, go to the "nearest-straight" (paper) or to the
            "nearest-by-path".
        max_gap_m: A destination that cannot be entered (it lies on a table) is gone to if a
            reachable place is this near; else there is no path.
        replan_every_steps: A path is kept this long unless it is blocked (paper: 10).
        steering: "waypoint": turn if the next waypoint is too far off, else go (paper).
            "lattice": search the sequence of turns and steps that leads on best without touching
            an inflated obstacle, and do its first.
        heading_tolerance_deg: For "waypoint" (paper: 15).
        waypoint_tolerance_m: A waypoint counts as passed within this distance.
        forward_m: Length of a step.
        turn_angle_deg: Of a turn.
    """

    inflation_m: float = Field(default=0.22, ge=0.0)
    squeeze_m: float = Field(default=0.04, ge=0.0)
    comfort_m: float = Field(default=0.20, ge=0.0)
    comfort_cost: float = Field(default=1.0, ge=0.0)
    unknown_cost: float = Field(default=3.0, ge=0.0)
    end_in_unknown: bool = True
    targets: Literal["nearest-straight", "nearest-by-path"] = "nearest-by-path"
    max_gap_m: float = Field(default=1.0, ge=0.0)
    replan_every_steps: int = Field(default=10, ge=1)
    steering: Literal["waypoint", "lattice"] = "lattice"
    heading_tolerance_deg: float = Field(default=15.0, gt=0.0)
    waypoint_tolerance_m: float = Field(default=0.25, gt=0.0)
    forward_m: float = Field(default=0.5, gt=0.0)
    turn_angle_deg: float = Field(default=30.0, gt=0.0, le=180.0)

    @property
    def inflations_m(self) -> tuple[float, ...]:
        """By how much obstacles are dilated, in the order to try."""
        if self.squeeze_m <= 0.0:
            return (self.inflation_m,)
        return (self.inflation_m, max(self.inflation_m - self.squeeze_m, 0.0))
