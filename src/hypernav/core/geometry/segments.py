"""Straight lines between two points on the floor plan."""

import numpy as np
from jaxtyping import Float64


def distances_to_segment(
    points: Float64[np.ndarray, "n 2"],
    start: Float64[np.ndarray, "2"],
    end: Float64[np.ndarray, "2"],
) -> Float64[np.ndarray, " n"]:
    """Distance of each point from the straight line between two others, in the unit of the points.

    Args:
        points: Points ``(x, y)``.
        start: One end of the line ``(x, y)``.
        end: Its other end; the same point makes the line that point.
    """
    along = end - start
    square = float(along @ along)
    shares = np.clip((points - start) @ along / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.linalg.norm(points - start - np.outer(shares, along), axis=1)
