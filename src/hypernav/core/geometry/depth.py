"""The rule for valid depths, for worlds, mapping and perception."""

import math
from typing import overload

import numpy as np
from jaxtyping import Bool, Float


@overload
def is_measured(depth: float, nearest_m: float = ..., farthest_m: float = ...) -> bool: ...
@overload
def is_measured(
    depth: Float[np.ndarray, "*n"], nearest_m: float = ..., farthest_m: float = ...
) -> Bool[np.ndarray, "*n"]: ...
def is_measured(depth, nearest_m=0.0, farthest_m=math.inf):
    """Whether a depth is a measured distance.

    0 (no return), NaN and infinities are not, and neither are the limits of the sensor's range: a
    sensor that clips, such as Habitat's, reports its limits for everything beyond them.

    Works on numbers and arrays. Compiled kernels use this same function.

    Args:
        depth: Depth along the optical axis, metres.
        nearest_m: Lower limit of the sensor's range, metres; by default every return counts.
        farthest_m: Upper limit of the sensor's range, metres.
    """
    return (depth > nearest_m) & (depth < farthest_m)
