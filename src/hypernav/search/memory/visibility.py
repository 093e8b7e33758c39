"""Visibility of positions and objects on the map in an image, and what hides them."""

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation
from hypernav.search.memory.image_kernels import count_visible

BLIND_M = 0.3
"""Distance from the robot, metres, within which no image shows the floor: it counts as seen."""
SHOWN_M = 4.0
"""Distance beyond which no image can be expected to show a thing, metres."""
_SAME_WIDTH = 0.5
"""Least overlap over union of the image columns of a box and of an object in it."""
SAME_DEPTH_M = 0.5
"""Difference in depth up to which the pixels of a box and a thing in it are as far away, metres."""
_OWN_DEPTH_M = 1.0
"""Depth of an object, metres, by which its near side may lie before its far side."""
_WALL_SLACK_M = 0.3
"""Depth, metres, by which what is behind an object may be nearer than the object."""
_RECOGNISABLE_M = (1.0, SHOWN_M)
_IN_BETWEEN_M = 0.15
_MEASURABLE_M = 0.6
"""Depth, metres, below which an object may be too near for the depth camera."""
_HIDDEN_SHARE = 0.8


def lies_open(
    positions: Float64[np.ndarray, "n 2"], observation: Observation
) -> Bool[np.ndarray, " n"]:
    """Whether an image shows positions on the floor, or something behind and above them.

    A column of the image without any depth shows nothing: what fills it is too near to be measured,
    since a column with a free view would show the floor.

    Args:
        positions: Positions ``(x, y)``, ``map`` frame, metres.
        observation: Frame of the image; positions right beside its camera lie open, too.
    """
    distance, pixels = _projected(positions, 0.0, observation)
    is_open = observation.camera.contains_columns(pixels[:, 0])
    farthest = observation.farthest_m[pixels[is_open, 0].astype(int)]
    is_open[is_open] = farthest > distance[is_open]
    beside = np.linalg.norm(positions - np.array(observation.robot.xy), axis=1) < BLIND_M
    return is_open | beside


def is_cut_off(
    positions: Float64[np.ndarray, "n 2"], height_m: float, observation: Observation
) -> bool:
    """Whether something, such as a wall, hides an object from a camera that looks at it.

    Objects below, above or beside the image are not hidden.

    Args:
        positions: Positions of the object, ``(x, y)``, ``map`` frame, metres.
        height_m: Height of the object's middle above the floor, metres.
        observation: Frame of the image.
    """
    distance, pixels = _projected(positions, height_m, observation)
    shown = (distance > BLIND_M) & observation.camera.contains(pixels)
    if not shown.any():
        return False
    nearest = float(distance[shown].min())
    if nearest < _MEASURABLE_M:
        return False
    # What is too near to be measured has depth 0, and is in between as well. An object's near
    # side hides its far one, so all is compared with the near side.
    columns, rows = pixels[shown].astype(int).T
    depth = observation.depth[rows, columns]
    return bool((depth < nearest - _IN_BETWEEN_M).mean() > _HIDDEN_SHARE)


def should_be_visible(
    positions: Float64[np.ndarray, "n 2"], height_m: float, observation: Observation
) -> bool:
    """Whether the camera has a free view of most of an object, near enough to recognise it.

    Args:
        positions: Positions of the object, ``(x, y)``, ``map`` frame, metres.
        height_m: Height of the object's middle above the floor, metres.
        observation: Frame of the image.
    """
    return bool(are_visible(positions[None], np.array([height_m]), observation)[0])


def are_visible(
    positions: Float64[np.ndarray, "objects n 2"],
    heights_m: Float64[np.ndarray, " objects"],
    observation: Observation,
) -> Bool[np.ndarray, " objects"]:
    """The same of several objects at once; see `should_be_visible`."""
    # Nothing may stand in between. The farthest depth of a column tells of what is as high as the
    # camera, the one at the object's height of what is lower, such as a bed before a nightstand.
    # The object's own near side may be nearer than what was seen of it from another side.
    counts = count_visible(
        positions,
        heights_m,
        np.require(observation.depth, np.float32, ["C", "W"]),
        observation.farthest_m,
        observation.camera.lens,
        observation.camera_to_map.inverse().rows,
        _RECOGNISABLE_M,
        (_WALL_SLACK_M, _OWN_DEPTH_M),
    )
    shown, free = counts.T
    return (shown >= 0.8 * positions.shape[1]) & (free > 0.8 * shown)


def seems_to_hold(
    box: Box, positions: Float64[np.ndarray, "n 2"], observation: Observation
) -> bool:
    """Whether a box seems to hold an object: both are about as wide and as far away.

    Args:
        box: Box in the image.
        positions: Positions of the object, ``(x, y)``, ``map`` frame, metres.
        observation: Frame of the image.
    """
    distance, pixels = _projected(positions, 0.0, observation)
    ahead = distance > BLIND_M
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
    return bool(distance.min() - SAME_DEPTH_M < middle < distance.max() + SAME_DEPTH_M)


def _projected(
    positions: Float64[np.ndarray, "n 2"],
    height_m: float | Float64[np.ndarray, " n"],
    observation: Observation,
) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, "n 2"]]:
    """Depths of positions, metres, and pixels ``(u, v)``; NaN for positions behind the camera."""
    points = np.column_stack([positions, np.broadcast_to(height_m, len(positions))])
    ahead = observation.camera_to_map.inverse().apply(points)
    return ahead[:, 2], observation.camera.project(ahead)
