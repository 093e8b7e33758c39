"""Axes of files that may point up, and the turns that make them the scene's z axis."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.config import Axis

_ROWS: dict[Axis, list[list[float]]] = {
    "x": [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
    "y": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
    "z": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "-x": [[0, 1, 0], [0, 0, -1], [-1, 0, 0]],
    "-y": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    "-z": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
}
TO_Z_UP: Mapping[Axis, Float64[np.ndarray, "3 3"]] = MappingProxyType(
    {axis: np.array(rows, dtype=np.float64) for axis, rows in _ROWS.items()}
)
"""The rotation from a file's frame, by the axis that is up in it, to the scene frame."""


def axis_along(direction: Float64[np.ndarray, "3"]) -> Axis:
    """The axis that a unit vector along one of them means."""
    return max(TO_Z_UP, key=lambda axis: float(TO_Z_UP[axis][2] @ direction))
