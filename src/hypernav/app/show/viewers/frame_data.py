"""Compact data of one observation and one map for the views."""

import math
from collections.abc import Iterable

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, StepTrace, floor_of
from hypernav.search.drawing import palette

_MOST_POINTS = 6000
"""Points of a cloud: every eighth pixel of an image of 640 × 480, 70 kB a step."""
_JPEG_QUALITY = 80

Line = list[tuple[float, float, float]]
"""Points of a line, ``map`` frame, metres."""


def _cell_colors() -> UInt8[np.ndarray, "3 4"]:
    colors = np.zeros((len(Cell), 4), dtype=np.uint8)
    colors[Cell.FREE] = (*palette.FREE, 255)
    colors[Cell.OCCUPIED] = (*palette.OCCUPIED, 255)
    return colors


_CELL_COLORS = _cell_colors()


class FloorHeights:
    """Heights of the floors, as far as the robot has been on them."""

    def __init__(self) -> None:
        """Begin with none."""
        self._heights_m: dict[int, float] = {}

    def of(self, step: StepTrace) -> float:
        """Height of the floor of a step, metres: that at which the robot came onto it."""
        floor = floor_of(step)
        if step.mode is not Mode.CLIMB:
            self._heights_m.setdefault(floor, step.z)
        return self._heights_m.get(floor, step.z)


def at_height(points: Iterable[tuple[float, float]], z: float) -> Line:
    """Points on the floor plan, all at one height."""
    return [(x, y, z) for x, y in points]


def colour_jpeg(observation: Observation) -> bytes:
    """The colour image as a JPEG file."""
    quality = [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY]
    _, data = cv2.imencode(".jpg", observation.rgb[..., ::-1], quality)
    return data.tobytes()


def cloud(
    observation: Observation, most_points: int = _MOST_POINTS
) -> tuple[Float32[np.ndarray, "n 3"], UInt8[np.ndarray, "n 3"]]:
    """Points of an evenly thinned depth image, and their colours.

    Args:
        observation: Frame with depth and colour.
        most_points: Largest number of points.

    Returns:
        Points in the ``map`` frame, metres, and RGB. Pixels without a depth have no point.
    """
    height, width = observation.depth.shape
    stride = math.ceil(math.sqrt(height * width / most_points))
    window = np.s_[stride // 2 :: stride, stride // 2 :: stride]
    depth = observation.depth[window]
    rows, columns = np.nonzero(is_measured(depth))
    points = observation.camera.unproject_pixels(
        rows * stride + stride // 2, columns * stride + stride // 2, depth[rows, columns]
    )
    points = observation.camera_to_map.apply(points).astype(np.float32)
    return points, observation.rgb[window][rows, columns]


def map_colors(grid: OccupancyGrid) -> UInt8[np.ndarray, "rows columns 4"]:
    """The colours of the cells, RGBA, first row lowest; unknown cells are transparent."""
    return _CELL_COLORS[grid.cells]
