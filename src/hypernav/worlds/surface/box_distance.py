"""Positions on the floor around an object's box."""

import numpy as np
from jaxtyping import Bool, Float64

_MESH_ERROR_M = 0.25
"""Height of a mesh above its floor: a voxel, and some more."""
_UNEVEN_M = 1.0
"""How far floors of one storey are apart in height."""


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


def floors_of_box(floor_z: Float64[np.ndarray, " n"], low_z: float) -> Bool[np.ndarray, " n"]:
    """Whether floors around a thing are those of its storey: of the highest one below it.

    Without this a thing would count as reached on the gallery over it, or under the stairwell in
    which it hangs.

    Args:
        floor_z: Heights of the floors around the thing, metres.
        low_z: Height of the thing's lowest point, metres.
    """
    below = floor_z <= low_z + _MESH_ERROR_M
    return below & (floor_z >= floor_z[below].max(initial=-np.inf) - _UNEVEN_M)
