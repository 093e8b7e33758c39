"""The second look: what a detector says of a weak box in the enlarged part of the image around it.

It is asked of every detector with scores, in the same way, as a search and an exam ask it.
"""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from hypernav.core.components.abilities import looks_closer
from hypernav.core.components.protocols import Detector
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation

_TIMES = 2.5
"""Side of the part, in sides of the box."""
_LEAST_PX = 96.0
"""Smallest side of the part, pixels."""
_MOST = 3
"""Largest number of parts of one image."""
_SAME_IOU = 0.3
"""Overlap from which on a box in the part is the one that the part was made for."""


def detect_twice(
    detector: Detector, observation: Observation, goal: Goal, below: float
) -> list[Detection]:
    """What a detector finds; the score of a weak box of the goal is the mean of two looks.

    Args:
        detector: The detector.
        observation: The image.
        goal: The goal.
        below: Score below which a box of the goal is looked at once more; 0 never does.
    """
    found = detector.detect(observation, goal)
    weak = [one for one in found if one.is_goal and one.score < below]
    if not weak or not looks_closer(detector):
        return found
    weak = sorted(weak, key=lambda one: -one.score)[:_MOST]
    closer = {id(one): looked_closer(one, detector, observation, goal, below) for one in weak}
    again = [closer.get(id(one), one) for one in found]
    if any(before.score < after.score for before, after in pairwise(found)):
        return again  # the detector's own order is another one
    return sorted(again, key=lambda one: -one.score)


def looked_closer(
    weak: Detection, detector: Detector, observation: Observation, goal: Goal, below: float
) -> Detection:
    """A detection of the goal after the second look, which is not taken from `below` on."""
    if weak.score >= below:
        return weak
    height, width = observation.rgb.shape[:2]
    box = weak.box
    side = max(_TIMES * max(box.x_max - box.x_min, box.y_max - box.y_min), _LEAST_PX)
    x = int(np.clip((box.x_min + box.x_max - side) / 2.0, 0.0, max(width - side, 0.0)))
    y = int(np.clip((box.y_min + box.y_max - side) / 2.0, 0.0, max(height - side, 0.0)))
    rows, columns = slice(y, y + math.ceil(side)), slice(x, x + math.ceil(side))
    part = observation.part(rows, columns)
    if part.rgb.shape == observation.rgb.shape:
        return weak
    inside = Box(box.x_min - x, box.y_min - y, box.x_max - x, box.y_max - y)
    same = (one for one in detector.detect(part, goal) if one.is_goal and one.label == weak.label)
    best = max(same, key=lambda one: one.box.iou(inside), default=None)
    is_same = best is not None and best.box.iou(inside) >= _SAME_IOU
    again = best.score if best is not None and is_same else 0.0
    return replace(weak, score=(weak.score + again) / 2.0)
