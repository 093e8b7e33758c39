"""Inflation of the obstacles of a map by the size of the robot."""

import math

import cv2
import numpy as np
from jaxtyping import Bool, UInt8


def disc(radius_m: float, cell_size_m: float) -> UInt8[np.ndarray, "side side"]:
    """Cells whose middles lie within a radius of the middle cell's, as a structuring element."""
    radius = radius_m / cell_size_m
    reach = math.floor(radius + 1e-9)
    squared = np.arange(-reach, reach + 1) ** 2
    return (squared[:, None] + squared[None, :] <= radius**2 + 1e-9).astype(np.uint8)


def inflate(
    cells: Bool[np.ndarray, "rows columns"] | UInt8[np.ndarray, "rows columns"],
    radius_m: float,
    cell_size_m: float,
    *,
    outside: bool = False,
) -> UInt8[np.ndarray, "rows columns"]:
    """All cells within a radius of the given ones, those included: 1, and 0 elsewhere.

    Args:
        cells: Mask of the given cells, not 0.
        radius_m: Distance between middles of cells, metres.
        cell_size_m: Side of a cell, metres.
        outside: Whether everything outside the grid is given too.
    """
    return cv2.dilate(
        cells.astype(np.uint8),
        disc(radius_m, cell_size_m),
        borderType=cv2.BORDER_CONSTANT,
        borderValue=int(outside),
    )
