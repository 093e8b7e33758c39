"""Configuration of planning and path following."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import MOST_STEPS, RoomConfig
from hypernav.core.embodiment import BodyConfig


class PlanningConfig(RoomConfig):
    """Configuration of planning and path following.

    Values not marked with "paper" are ours: the paper is silent on them. What each of its sentences
    became: docs/method.md.

    Attributes:
        margin_m: Margin between the robot and obstacles, metres: obstacles are dilated by the
            robot's radius plus this margin.
        squeeze_m: Reduction of that dilation where no path leads, or nothing is left to explore,
            metres; 0 never reduces it.
        prefer_known: Whether a path over explored floor that squeezes through a gap, or enters
            the destination elsewhere than at the best positions, is preferred to a path through the
            unknown of more than twice its cost; else it is taken only where there is no other.
        comfort_cost: Addition to the cost factor of 1 within 0.2 m beyond the dilation, so that a
            path keeps to the middle of doors where there is room; 0 switches it off.
        unknown_cost: Cost factor of unknown cells; 1 treats them as free ones, 0 forbids them.
        targets: Choice among the destination's cells: the "nearest-straight" (paper) or the
            "nearest-by-path".
        start_in_obstacle: Beginning of a path for a robot inside an inflated obstacle: the shortest
            "escape" between the obstacles, or the free cell that is "nearest" in a straight line
            (paper).
        end_in_obstacle: Cell that stands in for a destination that cannot be entered (it lies on a
            table): the nearest "reachable" one, or the "nearest" free one, whether a path leads
            there or not (paper).
        max_gap_m: Largest distance of that cell from the destination, metres; beyond it there is no
            path. None sets no limit (paper).
        waypoints: Waypoints of a path: "corners", between which the robot drives straight, or
            "dense", one in every cell (paper: fine-grained waypoints).
        replan_every_steps: Number of steps for which a path is kept unless it is blocked (paper:
            10). None keeps it to its end.
        replan_when_moved: Whether a path is planned anew as well when a detection moves its
            destination; the paper names no such case.
        steering: Manner of following a path. "waypoint": turn if the next waypoint is too far off
            the heading, else go forward (paper). "lattice": search the sequence of turns and steps
            that leads on best without touching an inflated obstacle, and carry it out.
        turn_cost_m: Cost of a turn of 30 degrees to "lattice" steering, as length of path, metres:
            a turn is a step, and a staircase of turns is no shorter than one bend.
        heading_tolerance_deg: Largest angle off the heading at which "waypoint" steering goes
            forward, degrees (paper: 15).
        waypoint_tolerance_m: Distance within which a waypoint counts as passed, metres.
        bump_sensor: Whether a step that is cut short marks an obstacle before the robot.
    """

    margin_m: float = Field(default=0.04, ge=0.0, le=2.0)
    squeeze_m: float = Field(default=0.04, ge=0.0, le=2.0)
    prefer_known: bool = True
    comfort_cost: float = Field(default=1.0, ge=0.0, le=1000.0)
    unknown_cost: float = Field(default=3.0, ge=0.0, le=1000.0)
    targets: Literal["nearest-straight", "nearest-by-path"] = "nearest-by-path"
    start_in_obstacle: Literal["escape", "nearest"] = "escape"
    end_in_obstacle: Literal["reachable", "nearest"] = "reachable"
    max_gap_m: float | None = Field(default=1.0, ge=0.0, le=50.0)
    waypoints: Literal["corners", "dense"] = "corners"
    replan_every_steps: int | None = Field(default=10, ge=1, le=MOST_STEPS)
    replan_when_moved: bool = True
    steering: Literal["waypoint", "lattice"] = "lattice"
    turn_cost_m: float = Field(default=0.2, ge=0.0, le=10.0)
    heading_tolerance_deg: float = Field(default=15.0, gt=0.0, le=180.0)
    waypoint_tolerance_m: float = Field(default=0.25, gt=0.0, le=10.0)
    bump_sensor: bool = True

    def clearances_m(self, body: BodyConfig) -> tuple[float, ...]:
        """Distances from obstacles that the robot's middle keeps, the largest first, metres."""
        clearance_m = body.radius_m + self.margin_m
        if self.squeeze_m <= 0.0:
            return (clearance_m,)
        return (clearance_m, max(clearance_m - self.squeeze_m, 0.0))
