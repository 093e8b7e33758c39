"""Which depths are measurements: the one rule, for worlds, mapping and perception."""

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
    """Whether a depth tells how far away something is.

    0 (no return), NaN and infinities don't, and neither does a limit of the sensor's range: a
    sensor that clamps, such as Habitat's, reports its limits for all that lies beyond them.

    Works on a number and on an array. Compiled kernels compile this very function.

    Args:
        depth: Metres along the optical axis.
        nearest_m: Lower limit of the sensor's range; by default whatever is a return counts.
        farthest_m: Upper limit of the sensor's range.
    """
    return (depth > nearest_m) & (depth < farthest_m)
