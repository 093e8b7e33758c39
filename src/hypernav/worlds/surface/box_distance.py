"""Positions on the floor around an object's box."""

import numpy as np
from jaxtyping import Bool, Float64


def is_near_box(
    points: Float64[np.ndarray, "n 2"],
    low: tuple[float, float],
    high: tuple[float, float],
    reach_m: float,
) -> Bool[np.ndarray, "n"]:
    """Whether points are within a distance of a box, seen from above.

    Args:
        points: Positions, metres.
        low: Lowest corner of the box.
        high: Its highest corner.
        reach_m: Greatest distance to the box.
    """
    gaps = np.maximum(np.maximum(np.array(low) - points, points - np.array(high)), 0.0)
    return (gaps**2).sum(axis=1) <= reach_m**2
