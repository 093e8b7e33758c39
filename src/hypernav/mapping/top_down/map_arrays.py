"""The arrays that a map consists of: made empty, enlarged, read from a file."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import UInt8, UInt32

from hypernav.core.errors import MapError
from hypernav.core.files.allowance import MOST_BYTES, megabytes
from hypernav.mapping.config import CHUNK_CELLS, HeightBand, memory_of
from hypernav.mapping.top_down.integrate_kernels import OCCUPIED

_BUMP_OR_DROP = 128
"""Value of the bumps of older files from which it counts the views of a drop."""


class MapArrays(NamedTuple):
    """The arrays, in the order in which the kernels take them; see `integrate_kernels`."""

    evidence: UInt8[np.ndarray, "rows columns layers"]
    raised: UInt32[np.ndarray, "rows columns"]
    seen: UInt8[np.ndarray, "rows columns"]
    bumps: UInt8[np.ndarray, "rows columns"]
    drops: UInt8[np.ndarray, "rows columns"]
    cells: UInt8[np.ndarray, "rows columns"]


def empty_arrays(rows: int, columns: int, band: HeightBand) -> MapArrays:
    """Arrays of zeros, for which the system hands out memory only when they are written to.

    Raises:
        MapError: They take too much memory.
    """
    if (size := memory_of(rows * columns, band)) > MOST_BYTES:
        raise MapError(
            f"a map of {rows} × {columns} cells would take {megabytes(size)}, at most "
            f"{megabytes(MOST_BYTES)} are allowed; use a larger cell_size_m"
        )
    return MapArrays(
        evidence=np.zeros((rows, columns, band.layers), dtype=np.uint8),
        raised=np.zeros((rows, columns), dtype=np.uint32),
        seen=np.zeros((rows, columns), dtype=np.uint8),
        bumps=np.zeros((rows, columns), dtype=np.uint8),
        drops=np.zeros((rows, columns), dtype=np.uint8),
        cells=np.zeros((rows, columns), dtype=np.uint8),
    )


def enlarged(
    arrays: MapArrays, at: tuple[int, int], rows: int, columns: int, band: HeightBand
) -> MapArrays:
    """Larger arrays that hold the given ones, and zeros elsewhere.

    Args:
        arrays: The arrays so far.
        at: Row and column in the larger arrays at which they begin.
        rows: Number of rows of the larger arrays.
        columns: Number of their columns.
        band: Height band of the map.

    Raises:
        MapError: They take too much memory.
    """
    larger = empty_arrays(rows, columns, band)
    held = tuple(
        slice(first, first + side) for first, side in zip(at, arrays.cells.shape, strict=True)
    )
    for new, old in zip(larger, arrays, strict=True):
        new[held] = old
    return larger


def arrays_of(state: Mapping[str, np.ndarray], band: HeightBand) -> MapArrays:
    """Copies of the arrays in a file, by name.

    Raises:
        MapError: They are not those of a map with this height band.
    """
    cells = state["cells"].shape if "cells" in state else ()
    if len(cells) != 2 or min(cells) < 1 or any(side % CHUNK_CELLS for side in cells):
        raise MapError(f"expected the cells of a map in whole chunks, got the shape {cells}")
    arrays = empty_arrays(*cells, band)
    for name, array in arrays._asdict().items():
        found = state.get(name)
        if found is None and name == "drops":
            continue  # the file was written when bumps and drops shared an array
        if found is None or found.shape != array.shape or found.dtype != array.dtype:
            what = "none" if found is None else f"{found.dtype} {found.shape}"
            raise MapError(f"expected {name} as {array.dtype} {array.shape}, found {what}")
        array[:] = found
    if (arrays.cells > OCCUPIED).any():
        raise MapError("a cell of the map has a state that none can have")
    if "drops" not in state:
        is_drop = arrays.bumps > _BUMP_OR_DROP
        arrays.drops[is_drop] = arrays.bumps[is_drop] - _BUMP_OR_DROP
        arrays.bumps[is_drop] = 0
    return arrays
