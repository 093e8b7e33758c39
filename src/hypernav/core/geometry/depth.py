"""Validity of depths: the one rule for worlds, mapping and perception."""

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

    0 (no return), NaN and infinities are none, and neither is a limit of the sensor's range: a
    sensor that clamps, such as Habitat's, reports its limits for all that lies beyond them.

    Works on a number and on an array. Compiled kernels compile this very function.

    Args:
        depth: Depth along the optical axis, metres.
        nearest_m: Lower limit of the sensor's range, metres; by default every return counts.
        farthest_m: Upper limit of the sensor's range, metres.
    """
    return (depth > nearest_m) & (depth < farthest_m)
