"""What one detection shows of a thing: where it lies, and how large it is."""

import math

import numpy as np
from jaxtyping import Bool

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation
from hypernav.mapping.memory.goal_area import points_under_mask
from hypernav.mapping.memory.thing import Thing

_MOST_POINTS = 250
"""Number of pixels of a detection's box that are read, about."""
_LARGEST_STRIDE = 24
_LEAST_POINTS = 3
_STRAYS = 0.05
"""Share of a detection's points at each end of each axis that don't count to its extent."""
_SAME_DEPTH_M = 0.5
"""Distance in depth from a box's middle up to which its pixels are the thing's, without a mask."""


def seen_thing(
    detection: Detection, observation: Observation, camera: CameraConfig, search: int
) -> Thing | None:
    """A detection as a thing, without a number yet; None with too few pixels of depth.

    Args:
        detection: The detection.
        observation: The image, with heights counted from the floor.
        camera: Camera, whose range of depth counts.
        search: Number of the present search.
    """
    height, width = observation.depth.shape
    box = detection.box.clipped(width, height)
    points = points_under_mask(
        _mask(box, observation, camera) if detection.mask is None else detection.mask,
        observation,
        min_depth_m=camera.min_depth_m,
        max_depth_m=camera.max_depth_m,
        stride=min(max(int(math.sqrt(box.area / _MOST_POINTS)), 1), _LARGEST_STRIDE),
        window=box.pixels(),
    )
    if len(points) < _LEAST_POINTS:
        return None
    spread = np.sort(points, axis=0)  # much faster than percentiles
    first = int(_STRAYS * len(points))
    (x0, y0, z0), (x1, y1, z1) = spread[[first, -1 - first]].round(3).tolist()
    score = round(float(detection.score), 4)
    return Thing(
        number=-1,
        label=detection.label,
        score=score,
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        views=((*observation.robot.xy, score),),
        pixels=float(detection.box.area),
        first_search=search,
        last_search=search,
    )


def _mask(
    box: Box, observation: Observation, camera: CameraConfig
) -> Bool[np.ndarray, "height width"]:
    """The pixels of a box that are about as far away as its middle, where it has no mask."""
    mask = np.zeros(observation.depth.shape, dtype=bool)
    x_min, y_min, x_max, y_max = box.pixels()
    window = (slice(y_min, y_max), slice(x_min, x_max))
    middle_m = _middle_depth(box, observation, camera)
    mask[window] = np.abs(observation.depth[window] - middle_m) <= _SAME_DEPTH_M
    return mask


def _middle_depth(box: Box, observation: Observation, camera: CameraConfig) -> float:
    """Median depth in the middle half of a box, metres; NaN where nothing is measured."""
    dx, dy = (box.x_max - box.x_min) / 4.0, (box.y_max - box.y_min) / 4.0
    rows = slice(round(box.y_min + dy), round(box.y_max - dy) + 1)
    columns = slice(round(box.x_min + dx), round(box.x_max - dx) + 1)
    depths = observation.depth[rows, columns]
    depths = depths[is_measured(depths, camera.min_depth_m, camera.max_depth_m)]
    return float(np.median(depths)) if depths.size else math.nan
