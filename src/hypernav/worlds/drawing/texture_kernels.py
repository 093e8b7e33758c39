"""Halving of textures (numba)."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def halve(codes, light_of_code, light):
    """Mean light of every four texels of an image with even sides.

    It adds in the order of OpenCV's INTER_AREA, so that both give the same bits, but needs no image
    of the light at full size.

    Args:
        codes: sRGB codes, uint8 [2 rows, 2 columns, 3].
        light_of_code: Light of every code, float32 [256].
        light: Output: mean light, float32 [rows, columns, 3].
    """
    quarter = np.float32(0.25)
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            top, left = 2 * row, 2 * column
            for channel in range(3):
                total = light_of_code[codes[top, left, channel]]
                total += light_of_code[codes[top, left + 1, channel]]
                total += light_of_code[codes[top + 1, left, channel]]
                total += light_of_code[codes[top + 1, left + 1, channel]]
                light[row, column, channel] = total * quarter


@njit(cache=True, nogil=True, error_model="numpy")
def encode(light, code_of_root, codes):
    """Codes of light, by a table over its square root, where the codes lie evenly.

    Args:
        light: Light of opaque texels, float32 [rows, columns, 3].
        code_of_root: Code of every square root, uint8 [steps].
        codes: Output: sRGB codes, uint8 [rows, columns, 3].
    """
    last = np.float32(len(code_of_root) - 1)
    for row in range(light.shape[0]):
        for column in range(light.shape[1]):
            for channel in range(3):
                own = min(max(light[row, column, channel], np.float32(0.0)), np.float32(1.0))
                index = np.float32(np.sqrt(own)) * last + np.float32(0.5)
                codes[row, column, channel] = code_of_root[np.int32(index)]
