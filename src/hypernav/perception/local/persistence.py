"""Errors that belong to things and the sides they are seen from, for stand-ins of detectors.

All numbers are drawn from hashes, so they don't change when the robot comes back.
"""

import hashlib
import math
from statistics import NormalDist

import numpy as np

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

SAME_THING_FOUND = 0.7
"""Correlation between views of whether one thing is found: at this value a thing that is found in
one view is found in about 58% of its others, as by YOLOX (benchmarks/persistent_errors.py)."""

SAME_NAME_SAID = 0.45
"""The same for wrong names: at a rate of 0.06, what is said in one view is said in 23% of the
others, as by YOLOX."""

STANDARD_NORMAL = NormalDist()

_SIDES_PX = (30.0, 60.0, 120.0, 240.0)
"""Square root of the area of a thing's box where a bin of size ends, pixels of 640×480."""
_SECTORS = 8


def view_of(true: Detection, observation: Observation) -> tuple[int, int, bool]:
    """Side from which a thing is seen, bin of its box's size, and whether the image cuts it off.

    The side is the sector of the direction from the thing to the camera.
    """
    assert true.mask is not None
    rows, columns = np.nonzero(true.mask)
    depth = observation.depth[rows, columns]
    measured = is_measured(depth)
    towards = float(np.median(columns)) + 0.5
    bearing = observation.robot.yaw + observation.camera.bearing_of(towards)
    if measured.any():
        point = observation.camera.unproject_pixels(
            np.array([int(np.median(rows))]),
            np.array([int(np.median(columns))]),
            float(np.median(depth[measured])),
        )
        x, y, _ = observation.camera_to_map.apply(point)[0]
        eye = observation.camera_to_map.translation
        bearing = math.atan2(float(y - eye[1]), float(x - eye[0]))
    sector = int(bearing / (2.0 * math.pi) * _SECTORS // 1) % _SECTORS
    return sector, size_bin(true.box, observation), is_cut_off(true.box, observation)


def size_bin(box: Box, observation: Observation) -> int:
    """Number of the bin of a box's size, 0 to 4."""
    side = math.sqrt(box.area) * 640.0 / observation.camera.width
    return int(np.searchsorted(_SIDES_PX, side, side="right"))


def is_cut_off(box: Box, observation: Observation) -> bool:
    """Whether a box touches the edge of the image."""
    height, width = observation.depth.shape
    return touches_edge(box, width, height)


def touches_edge(box: Box, width: int, height: int) -> bool:
    """Whether a box touches the edge of an image of this size, pixels."""
    return box.x_min < 1 or box.y_min < 1 or box.x_max > width - 1 or box.y_max > height - 1


def latent(key: tuple[object, ...], view: tuple[object, ...], persistence: float) -> float:
    """A standard normal number of a thing in a view, correlated between its views.

    A part is drawn for the thing and a part for the view. Both are normal, so that any chance can
    be had with any persistence (a Gaussian copula).

    Args:
        key: The thing, and what it is asked about.
        view: The view.
        persistence: Correlation between views, 0 to 1.
    """
    own, seen = normal(key), normal((*key, *view))
    return math.sqrt(persistence) * own + math.sqrt(1.0 - persistence) * seen


def normal(key: tuple[object, ...]) -> float:
    """A standard normal number that a key always gives."""
    return STANDARD_NORMAL.inv_cdf(uniform(key))


def uniform(key: tuple[object, ...]) -> float:
    """A number in (0, 1) that a key always gives."""
    digest = hashlib.blake2b(repr(key).encode(), digest_size=7).digest()
    return (int.from_bytes(digest, "big") + 0.5) / 2.0**56
