"""How a detection becomes a goal area, and when that is believed."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from hypernav.core.config import RoomConfig


def _odd(side: int) -> int:
    if side % 2 == 0:
        raise ValueError(
            f"a kernel needs an odd side, so that it has a middle; 1 does nothing, got {side}"
        )
    return side


OddSide = Annotated[int, Field(ge=1, le=101), AfterValidator(_odd)]
"""Side of a kernel."""


class LocalConfig(RoomConfig):
    """How a detection becomes a goal area.

    Attributes:
        erosion_px: Side of the kernel that erodes the mask, so that its edge does not spill onto
            the background (paper: "the mask is eroded"); 1 does not erode.
        min_points: Fewer points of the target with depth are not trusted.
        dilation_kernel: Side of the kernel that dilates the cells (paper: 5×5).
        dilation_iterations: How often (paper: 3).
        largest_cluster_only: Keep only the cells that hang together with most points.
        entry_reach_m: The robot goes to where it is so near to cells that it saw, but not behind
            a wall; 0 (paper) sends it to the dilated cells.
        target: "latest": every new detection moves the goal area (paper). "hold": the robot keeps
            to one target, whose area grows with every look at it, and other detections do not
            distract it.
        pick: Which of several detections becomes the target: the detector's "first" (paper), or
            the one "nearest" to the robot.
        min_sightings: A target counts only when seen in this many images.
        min_mean_score: A target whose detections were less certain on average is rejected when the
            robot stands before it.
        sure_score: A target whose detections were less certain on average is looked at once more,
            from another side, before it is believed; 0 (paper) does without.
        weigh_rivals: Take what the detector calls by other names into account: a target that looks
            more like something else is dropped.
        max_missed_share: A held target is dropped when, of the images that should have shown it,
            more than this share did not. 1 never drops one.
        min_verdicts: Images needed before that share is believed.
    """

    erosion_px: OddSide = 5
    min_points: int = Field(default=12, ge=1)
    dilation_kernel: OddSide = 5
    dilation_iterations: int = Field(default=3, ge=0)
    largest_cluster_only: bool = True
    entry_reach_m: float = Field(default=0.8, ge=0.0)
    target: Literal["latest", "hold"] = "hold"
    pick: Literal["first", "nearest"] = "nearest"
    min_sightings: int = Field(default=1, ge=1)
    min_mean_score: float = Field(default=0.45, ge=0.0, le=1.0)
    sure_score: float = Field(default=0.75, ge=0.0, le=1.0)
    weigh_rivals: bool = True
    max_missed_share: float = Field(default=0.75, ge=0.0, le=1.0)
    min_verdicts: int = Field(default=4, ge=1)
