"""What an image shows of places on the map, and what stands in between."""

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

_BESIDE_M = 0.3
"""Right before the camera nothing is in its image."""
_NEAREST_M = 0.3
_SAME_WIDTH = 0.5
"""Overlap over union of the columns of a box and of a thing."""
_DEPTH_SLACK_M = 0.5
_RECOGNISABLE_M = (1.0, 4.0)
_IN_BETWEEN_M = 0.15
_MEASURABLE_M = 0.6
"""What is nearer may itself be too near for the depth camera."""
_HIDDEN_SHARE = 0.8


def lies_open(
    places: Float64[np.ndarray, "n 2"], observation: Observation
) -> Bool[np.ndarray, " n"]:
    """Whether an image shows a place on the floor, or something behind and above it.

    Args:
        places: ``(x, y)``, ``map`` frame, metres.
        observation: The image; what is right beside its camera lies open, too.
    """
    distance, pixels = _projected(places, 0.0, observation)
    is_open = observation.camera.contains_columns(pixels[:, 0])
    farthest = observation.depth.max(axis=0)[pixels[is_open, 0].astype(int)]
    is_open[is_open] = (farthest == 0.0) | (farthest > distance[is_open])
    beside = np.linalg.norm(places - np.array(observation.robot.xy), axis=1) < _BESIDE_M
    return is_open | beside


def is_cut_off(
    places: Float64[np.ndarray, "n 2"], height_m: float, observation: Observation
) -> bool:
    """Whether something hides a thing from a camera that looks at it, such as a wall in between.

    What lies below, above or beside the image is not hidden.

    Args:
        places: Of the thing, ``(x, y)``, ``map`` frame, metres.
        height_m: Of its middle above the floor.
        observation: The image.
    """
    distance, pixels = _projected(places, height_m, observation)
    shown = (distance > _NEAREST_M) & observation.camera.contains(pixels)
    if not shown.any():
        return False
    nearest = float(distance[shown].min())
    if nearest < _MEASURABLE_M:
        return False
    # What is too near to be measured has depth 0, and is in between as well. The thing's own near
    # side hides its far one, so all is compared with the near side.
    columns, rows = pixels[shown].astype(int).T
    depth = observation.depth[rows, columns]
    return bool((depth < nearest - _IN_BETWEEN_M).mean() > _HIDDEN_SHARE)


def should_be_visible(places: Float64[np.ndarray, "n 2"], observation: Observation) -> bool:
    """Whether most of a thing lies in free sight of the camera, near enough to be recognised.

    Args:
        places: Of the thing, ``(x, y)``, ``map`` frame, metres.
        observation: The image.
    """
    distance, pixels = _projected(places, 0.0, observation)
    nearest, farthest = _RECOGNISABLE_M
    good = (distance > nearest) & (distance < farthest)
    good &= observation.camera.contains_columns(pixels[:, 0])
    if good.sum() < 0.8 * len(distance):
        return False
    # Nothing may stand in between: compare with the farthest return in the column.
    returns = observation.depth.max(axis=0)[pixels[good, 0].astype(int)]
    return bool(((returns > distance[good] - 0.3) | (returns == 0)).mean() > 0.8)


def seems_to_hold(box: Box, places: Float64[np.ndarray, "n 2"], observation: Observation) -> bool:
    """Whether a box seems to hold a thing: it is as wide, and as far away.

    Args:
        box: In the image.
        places: Of the thing, ``(x, y)``, ``map`` frame, metres.
        observation: The image.
    """
    distance, pixels = _projected(places, 0.0, observation)
    ahead = distance > _NEAREST_M
    if not ahead.any():
        return False
    distance, column = distance[ahead], pixels[ahead, 0]
    left, right = np.clip([column.min(), column.max()], 0.0, observation.camera.width)
    overlap = min(right, box.x_max) - max(left, box.x_min)
    union = max(right, box.x_max) - min(left, box.x_min)
    x_min, y_min, x_max, y_max = box.pixels()
    depth = observation.depth[y_min:y_max, x_min:x_max]
    depth = depth[is_measured(depth)]
    if overlap < _SAME_WIDTH * union or len(depth) == 0:
        return False
    middle = float(np.median(depth))
    return bool(distance.min() - _DEPTH_SLACK_M < middle < distance.max() + _DEPTH_SLACK_M)


def _projected(
    places: Float64[np.ndarray, "n 2"], height_m: float, observation: Observation
) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, "n 2"]]:
    """How far ahead places are, metres, and where in the image; NaN for those behind it."""
    points = np.column_stack([places, np.full(len(places), height_m)])
    ahead = observation.camera_to_map.inverse().apply(points)
    return ahead[:, 2], observation.camera.project(ahead)
