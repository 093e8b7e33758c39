"""Detection of edge pixels, which need more than one ray, and mixing of their colours (numba)."""

import numpy as np
from numba import njit
from numba.extending import register_jitable

_CONTRAST = 28
# A strong contrast needs less of a bend: depth hardly shows where ceilings meet walls.
_BEND_CONTRAST = 0.35


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _bend(before, near, far, after):
    """Deviation of four depths in a row from a plane through the middle two; 0 is no depth.

    On a plane the inverse of depth changes evenly from pixel to pixel.
    """
    if near == 0.0 or far == 0.0:
        return 0.0 if near == far else 1.0
    step = 1.0 / far - 1.0 / near
    bend = 0.0
    if before > 0.0:
        bend = abs(step - (1.0 / near - 1.0 / before))
    if after > 0.0:
        bend = max(bend, abs(1.0 / after - 1.0 / far - step))
    return bend * near


@njit(cache=True, nogil=True, error_model="numpy")
def find_edges(rgb, ids, depth, first_row, last_row, pixels):
    """Pixels of some rows at which objects or faces meet with a visible contrast.

    Args:
        rgb: Colours, uint8 [height, width, 3].
        ids: Instances, int32 [height, width].
        depth: Depth in metres, 0 where nothing was hit, float32 [height, width].
        first_row: First row to search.
        last_row: One beyond the last row.
        pixels: Output: pixel numbers, row by row, int64 [rows * width].

    Returns:
        Number of edge pixels.
    """
    height, width = depth.shape
    marked = np.zeros((last_row - first_row, width), dtype=np.bool_)
    for row in range(max(first_row - 1, 0), last_row):
        for column in range(width):
            for down in range(2):  # the next pixel on the right, then the one below
                y, x = row + down, column + 1 - down
                if y >= height or x >= width or (down == 0 and row < first_row):
                    continue
                contrast = 0
                for channel in range(3):
                    here, there = np.int32(rgb[row, column, channel]), np.int32(rgb[y, x, channel])
                    contrast = max(contrast, abs(here - there))
                if contrast <= _CONTRAST:
                    continue
                if ids[row, column] == ids[y, x]:
                    y0, x0 = row - down, column - 1 + down
                    y3, x3 = y + down, x + 1 - down
                    before = depth[y0, x0] if y0 >= 0 and x0 >= 0 else np.float32(0.0)
                    after = depth[y3, x3] if y3 < height and x3 < width else np.float32(0.0)
                    bend = _bend(before, depth[row, column], depth[y, x], after)
                    if bend * contrast < _BEND_CONTRAST:
                        continue
                if row >= first_row:
                    marked[row - first_row, column] = True
                if y < last_row:
                    marked[y - first_row, x] = True
    count = 0
    for row in range(last_row - first_row):
        for column in range(width):
            if marked[row, column]:
                pixels[count] = (first_row + row) * width + column
                count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def mix_samples(pixels, samples, rgb):
    """Replace the colour of pixels by the mean of itself and of further samples.

    Args:
        pixels: Pixel numbers, int64 [pixels].
        samples: Further colours, uint8 [pixels, samples, 3].
        rgb: Colours, changed in place, uint8 [height * width, 3].
    """
    count = samples.shape[1] + 1
    for number in range(pixels.shape[0]):
        for channel in range(3):
            total = np.int64(rgb[pixels[number], channel])
            for sample in range(samples.shape[1]):
                total += samples[number, sample, channel]
            rgb[pixels[number], channel] = (total + count // 2) // count
