"""How the robot drives."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import BodyConfig


class PlanningConfig(RoomConfig):
    """How ways are planned and followed.

    Attributes:
        margin_m: Room between the robot and obstacles: these are dilated by its radius and this.
        squeeze_m: Where no way leads, or nothing is left to explore, obstacles are dilated by so
            much less; 0 (paper) does without.
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
    """

    margin_m: float = Field(default=0.04, ge=0.0)
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

    def clearances_m(self, body: BodyConfig) -> tuple[float, ...]:
        """How far from obstacles the robot's middle keeps, in the order to try, metres."""
        clearance_m = body.radius_m + self.margin_m
        if self.squeeze_m <= 0.0:
            return (clearance_m,)
        return (clearance_m, max(clearance_m - self.squeeze_m, 0.0))
