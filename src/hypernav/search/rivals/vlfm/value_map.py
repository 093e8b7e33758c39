"""The value map: how well what the camera saw of each place fits the goal.

Source: Yokoyama et al., "VLFM: Vision-Language Frontier Maps for Zero-Shot Semantic Navigation",
2024, and its released code, whose values these are unless they are said to be ours.
"""

import math

import numpy as np
from jaxtyping import Float, Float32, Float64

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.observation import Observation
from hypernav.search.rivals.vlfm.value_kernels import (
    fuse_view,
    medians_around,
    reach_of_columns,
)

_CHUNK_CELLS = 128
"""Side of the chunks by which the map grows, cells; ours."""


_EDGE_CONFIDENCE = 0.25
"""Confidence of a view at the edges of the image; it is 1 in the middle (VLFM's code; its paper has
0)."""
_LEAST_CONFIDENCE = 0.35
"""Confidence below which a view counts only where no surer value is known (VLFM's code)."""


class ValueMap:
    """Values of the floor around the robot, in the ``map`` frame, and their confidences.

    A view shows, in each image column, the cells up to the farthest point that was measured in that
    column. Columns without any depth show nothing (ours: the original fills holes). A tilted camera
    counts as a level one that sees as far (ours: the original has no tilted one).
    """

    def __init__(self, camera: CameraConfig, *, cell_size_m: float) -> None:
        """Begin with an empty map.

        Args:
            camera: Range of the camera.
            cell_size_m: Side of a cell, metres.
        """
        self._range_m = camera.depth_limits_m
        self._size = cell_size_m
        self._row = self._column = 0
        self._values = np.zeros((0, 0), dtype=np.float32)
        self._confidences = self._values.copy()
        self._weights: tuple[PinholeCamera, Float32[np.ndarray, " width"]] | None = None

    @property
    def values(self) -> Float32[np.ndarray, "rows columns"]:
        """Values of the cells, NaN where there is none; the first cell is at `origin`."""
        return np.where(self._confidences > 0.0, self._values, np.float32(np.nan))

    @property
    def confidences(self) -> Float32[np.ndarray, "rows columns"]:
        """Confidence of the values, 0 to 1; 0 where there is none."""
        return self._confidences.copy()

    @property
    def origin(self) -> tuple[float, float]:
        """Lower left corner ``(x, y)`` of the first cell, metres."""
        return (self._column * self._size, self._row * self._size)

    def integrate(self, observation: Observation, value: float) -> None:
        """Fuse the value of one view.

        Args:
            observation: Frame with camera and poses in the ``map`` frame.
            value: How well the view fits the goal; more is better.
        """
        camera, rotation = observation.camera, observation.camera_to_map.rotation
        heading = math.atan2(rotation[1, 2], rotation[0, 2])
        ahead = np.array([math.cos(heading), math.sin(heading)])
        _, down = camera.ray_slopes()
        forward = down * (ahead @ rotation[:2, 1]) + ahead @ rotation[:2, 2]
        reach = reach_of_columns(
            np.require(observation.depth, np.float32, ["C"]),
            forward.astype(np.float32),
            np.float32(self._range_m[0]),
            np.float32(self._range_m[1]),
        )
        x, y = (float(number) for number in observation.camera_to_map.translation[:2])
        left, right = camera.cx / camera.fx, (camera.width - camera.cx) / camera.fx
        far_m = float(reach.max())
        sides = np.array([[-ahead[1], ahead[0]], [ahead[1], -ahead[0]]])
        corners = far_m * (ahead + sides * [[left], [right]])
        points = np.array([x, y]) + np.concatenate([np.zeros((1, 2)), corners])
        first = np.floor(points.min(axis=0) / self._size).astype(int)
        last = np.floor(points.max(axis=0) / self._size).astype(int) + 1
        self._grow(int(first[1]), int(first[0]), int(last[1]), int(last[0]))
        rows = slice(first[1] - self._row, last[1] - self._row)
        columns = slice(first[0] - self._column, last[0] - self._column)
        fuse_view(
            self._values[rows, columns],
            self._confidences[rows, columns],
            (float(first[0]) * self._size, float(first[1]) * self._size),
            self._size,
            (x, y, float(ahead[0]), float(ahead[1])),
            (camera.fx, camera.cx),
            reach,
            self._weights_of(camera),
            np.float32(value),
            _LEAST_CONFIDENCE,
        )

    def median_near(
        self, points: Float[np.ndarray, "n 2"], radius_m: float
    ) -> Float64[np.ndarray, " n"]:
        """Median of the values around each point, -1 where there is no value.

        Args:
            points: Positions ``(x, y)``, ``map`` frame, metres.
            radius_m: Distance within which values count, metres.
        """
        cells = (np.asarray(points, dtype=np.float64) - np.array(self.origin)) / self._size
        centres = np.ascontiguousarray(cells[:, ::-1])
        return medians_around(self._values, self._confidences, centres, radius_m / self._size)

    def _weights_of(self, camera: PinholeCamera) -> Float32[np.ndarray, " width"]:
        """Confidence of a view in each image column."""
        if self._weights is None or self._weights[0] != camera:
            least = _EDGE_CONFIDENCE
            angles = np.arctan(camera.ray_slopes()[0])
            falling = np.cos(np.pi * angles / camera.hfov) ** 2
            self._weights = camera, (least + (1.0 - least) * falling).astype(np.float32)
        return self._weights[1]

    def _grow(self, row: int, column: int, row_end: int, column_end: int) -> None:
        """Make the map hold these cells (numbered from the frame's origin), in whole chunks."""
        rows, columns = self._values.shape
        if rows:
            row, column = min(row, self._row), min(column, self._column)
            row_end = max(row_end, self._row + rows)
            column_end = max(column_end, self._column + columns)
        row, column = row // _CHUNK_CELLS * _CHUNK_CELLS, column // _CHUNK_CELLS * _CHUNK_CELLS
        shape = (
            -(-(row_end - row) // _CHUNK_CELLS) * _CHUNK_CELLS,
            -(-(column_end - column) // _CHUNK_CELLS) * _CHUNK_CELLS,
        )
        if shape == (rows, columns):
            return
        grown = np.zeros((2, *shape), dtype=np.float32)
        i, j = self._row - row, self._column - column
        grown[0, i : i + rows, j : j + columns] = self._values
        grown[1, i : i + rows, j : j + columns] = self._confidences
        self._values, self._confidences = grown[0], grown[1]
        self._row, self._column = row, column
