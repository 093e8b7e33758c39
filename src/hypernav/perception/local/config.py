"""Configuration of local perception: from detections to goal areas."""

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
"""Side of a kernel, an odd number of cells or pixels."""


class LocalConfig(RoomConfig):
    """Configuration of local perception, from detections to goal areas.

    Values not marked with "paper" are ours: the paper is silent on them.

    Attributes:
        published_segmenter: Segmenter of the published method (paper: MobileSAM). Where another
            stands in for it, screens, results and reports say so. Empty: none is missed.
        pixels: Pixels of a detection that count: those of its "mask" (paper), or all of its "box",
            which are not eroded.
        erosion_px: Side of the kernel that erodes the mask, pixels, so that its edge does not spill
            onto the background (paper: "the mask is eroded", its size is ours); 1 does not erode.
        keep_thin_masks: Whether a mask of which erosion would leave less than a quarter stays as it
            is.
        min_points: Number of points with depth that a goal area needs.
        dilation_kernel: Side of the kernel that dilates the cells, cells (paper: 5×5).
        dilation_iterations: Number of dilations (paper: 3).
        largest_cluster_only: Whether to keep only the connected cells that most points fall into.
        entry_reach_m: Distance from the seen cells, metres, within which the robot may enter the
            goal area, but not behind a wall; 0 (paper) sends it to the dilated cells.
        target: Rule for new detections. "latest": every new detection moves the goal area (paper).
            "hold": the robot keeps to one target, whose area grows with every look at it, and other
            detections do not distract it.
        pick: Choice among several detections: the detector's "first", or the one "nearest" to the
            robot.
        min_sightings: Number of images that must show a target before it counts.
        min_mean_score: Mean score of a target's detections below which it is rejected when the
            robot stands before it.
        sure_score: Mean score of a target's detections below which it needs a second look, from
            another side; 0 does without.
        weigh_rivals: Whether detections of other labels count as evidence against a target: one
            that looks more like something else is dropped.
        max_missed_share: Share of the images that should have shown a held target and did not,
            above which it is dropped; 1 never drops one.
        min_verdicts: Number of images needed before that share is believed.
        rejected_for_looks: Number of images for which what was rejected is not taken for the goal
            again; None sets no end.
        believe_again: Whether a rejected target is taken for the goal again once ``min_verdicts``
            images from new positions showed it with a mean score of ``min_mean_score``; after
            every further rejection twice as many are needed. The robot also goes to each of them
            once more before it gives up. What the presence check denies stays rejected.
    """

    published_segmenter: str = ""
    pixels: Literal["mask", "box"] = "mask"
    erosion_px: OddSide = 5
    keep_thin_masks: bool = True
    min_points: int = Field(default=12, ge=1, le=1_000_000)
    dilation_kernel: OddSide = 5
    dilation_iterations: int = Field(default=3, ge=0, le=100)
    largest_cluster_only: bool = True
    entry_reach_m: float = Field(default=0.8, ge=0.0, le=50.0)
    target: Literal["latest", "hold"] = "hold"
    pick: Literal["first", "nearest"] = "nearest"
    min_sightings: int = Field(default=1, ge=1, le=10_000)
    min_mean_score: float = Field(default=0.45, ge=0.0, le=1.0)
    sure_score: float = Field(default=0.75, ge=0.0, le=1.0)
    weigh_rivals: bool = True
    max_missed_share: float = Field(default=0.75, ge=0.0, le=1.0)
    min_verdicts: int = Field(default=4, ge=1, le=10_000)
    rejected_for_looks: int | None = Field(default=None, ge=1, le=10_000)
    believe_again: bool = True
