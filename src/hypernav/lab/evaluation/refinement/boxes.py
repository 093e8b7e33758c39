"""The boxes that goal areas are made from: true ones, jittered ones, and those of a detector."""

from collections.abc import Sequence

import numpy as np

from hypernav.core.geometry.boxes import Box, Detection

JITTER_SHARE = 0.10
"""Standard deviation of a jittered edge, as a share of the box's side."""
MATCHING_IOU = 0.5
"""Intersection over union above which a detector's box belongs to the true one."""
LEAST_SIDE_PX = 10.0
"""Side below which a box is left out: it is too thin for a segmenter."""


def jittered(box: Box, rng: np.random.Generator, *, width: int, height: int) -> Box:
    """A box whose four edges are moved independently by normal noise, inside the image.

    Args:
        box: True box, pixels.
        rng: Source of the noise.
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
    """
    sides = np.array([box.x_max - box.x_min, box.y_max - box.y_min] * 2)
    edges = np.array([box.x_min, box.y_min, box.x_max, box.y_max])
    moved = edges + rng.normal(0.0, JITTER_SHARE, 4) * sides
    low, high = np.minimum(moved[:2], moved[2:]), np.maximum(moved[:2], moved[2:])
    return Box(*low.tolist(), *high.tolist()).clipped(width, height)


def matching(box: Box, detections: Sequence[Detection]) -> Box | None:
    """The detector's box that overlaps most with the true one; None if none overlaps enough.

    Other boxes are skipped: the study judges what is made of a detection, not the detector.
    """
    boxes = [one.box for one in detections if one.is_goal]
    best = max(boxes, key=box.iou, default=None)
    return best if best is not None and box.iou(best) > MATCHING_IOU else None


def is_wide_enough(box: Box) -> bool:
    """Whether both sides of a box have at least `LEAST_SIDE_PX`."""
    return min(box.x_max - box.x_min, box.y_max - box.y_min) >= LEAST_SIDE_PX
