"""The rule for bounds of images and grids, for pixels and cells."""

from typing import overload

import numpy as np
from jaxtyping import Bool, Shaped


@overload
def is_within(index: float, end: float) -> bool: ...
@overload
def is_within(index: Shaped[np.ndarray, "*n"], end: float) -> Bool[np.ndarray, "*n"]: ...
def is_within(index, end):
    """Whether an index or coordinate lies in ``[0, end)``; NaN does not."""
    return (index >= 0) & (index < end)


@overload
def has_cell(shape: tuple[int, ...], row: int, column: int) -> bool: ...
@overload
def has_cell(
    shape: tuple[int, ...], row: Shaped[np.ndarray, "*n"], column: Shaped[np.ndarray, "*n"]
) -> Bool[np.ndarray, "*n"]: ...
def has_cell(shape, row, column):
    """Whether an array of this shape, ``(rows, columns)``, has a cell (or each of several)."""
    return is_within(row, shape[0]) & is_within(column, shape[1])
