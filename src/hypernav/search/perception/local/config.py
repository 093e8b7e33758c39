"""Configuration of local perception: from detections to goal areas."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from hypernav.core.components.abilities import missed_weight_of, score_weights_of
from hypernav.core.config import Curve, RoomConfig
from hypernav.core.score_weights import NEUTRAL


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
            onto the background (paper: "erode the segmentation area"; the size is ours); 1 does not
            erode.
        keep_thin_masks: Whether a mask of which erosion would leave less than a quarter stays as it
            is.
        min_points: Number of points with depth that a goal area needs.
        dilation_kernel: Side of the kernel that dilates the cells, cells (paper: 5×5).
        dilation_iterations: Number of dilations (paper: 3).
        largest_cluster_only: Whether to keep only the connected cells that most points fall into.
        entry_reach_m: Distance from the seen cells, metres, within which the robot may enter the
            goal area, but not behind a wall; 0 (paper) sends it to the dilated cells. A quarter
            less where the detector gave no mask, since guessed pixels spill over the goal's edge.
        target: Rule for the target, the candidate that is gone to. "latest": the newest detection
            of the goal, of several the detector's first (paper). "candidates": everything that may
            be the goal is remembered with the evidence for and against it, and the one most worth
            its path is the target; a doubtful one is looked at from another side before it is taken
            for the goal.
        rejected_for_looks: Number of images for which a rejected target is not taken for the goal
            again, where target is "latest".
        look_closer_below: Score of the goal below which the detector is asked once more, about the
            part of the image around the box, enlarged; the score is then the mean of both, and may
            be below the detector's threshold. 0 never looks closer.
        score_weights: Scores of boxes, in rising order, and how much an image with such a box
            shifts the log-odds that this is the goal, as measured by an exam; empty takes what is
            known of the detector, or `hypernav.core.score_weights.NEUTRAL`.
        missed_weight: The same shift by an image that should show a candidate, but gave no box of
            it; None takes what is known of the detector.
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
    target: Literal["latest", "candidates"] = "candidates"
    rejected_for_looks: int = Field(default=40, ge=1, le=10_000)
    look_closer_below: float = Field(default=0.6, ge=0.0, le=1.0)
    score_weights: Curve = ()
    missed_weight: float | None = Field(default=None, ge=-10.0, le=0.0)

    def for_detector(self, detector: object) -> "LocalConfig":
        """The configuration with what is known of a detector, where it says nothing itself."""
        known: dict[str, Any] = {}
        if not self.score_weights:
            known["score_weights"] = score_weights_of(detector) or NEUTRAL
        if self.missed_weight is None:
            known["missed_weight"] = missed_weight_of(detector)
        return self.model_copy(update=known)
