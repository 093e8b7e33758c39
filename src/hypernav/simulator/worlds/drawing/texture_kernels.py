"""Halving of textures, and textures read at many positions at once (numba kernels).

A texture is read between its four nearest texels. Finding these and mixing them are loops of their
own over positions whose results lie one after the other in memory, with a choice between two values
in place of every branch and whole numbers of 32 bits, so that LLVM computes eight at once; only
fetching the texels goes one by one.
"""

import numpy as np
from numba import njit
from numba.extending import register_jitable

U, V = 0, 1  # coordinates, v upwards
SHARE = 2  # by which the colour is multiplied
RED, GREEN, BLUE = 3, 4, 5  # output: sRGB codes 0 to 255, times the share
READ_ROWS = 6
WIDTH, HEIGHT = 0, 1  # of the level of the texture, texels
WRAP_U, WRAP_V = 2, 3  # modes of `Wrap`
_RIGHT, _BELOW = 4, 5  # how far between the texels, in 256
_CORNER = 6  # 4 rows: the texels, at first by their numbers within the level
LEVEL_ROWS = 10
_CODE = np.int32(255)
_ONE = np.int32(1)
_NONE = np.int32(0)
_WHOLE = np.int32(256)


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


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def wrapped(coordinate, mode):
    """A texture coordinate mapped into [0, 1]; modes are those of `Wrap`."""
    repeated = coordinate - np.floor(coordinate)
    mirrored = coordinate - 2.0 * np.floor(coordinate * 0.5)
    mirrored = 2.0 - mirrored if mirrored > 1.0 else mirrored
    clamped = min(max(coordinate, 0.0), 1.0)
    inside = repeated if mode == 0 else (mirrored if mode == 1 else clamped)
    # A surface seen exactly edge-on gives infinite steps, and those NaN.
    return inside if 0.0 <= inside <= 1.0 else 0.0


@register_jitable(error_model="numpy", no_cfunc_wrapper=True)
def _neighbours(position, size, wrap):
    """The two texels around a position along one axis, and how far it lies between, in 256."""
    below = np.floor(position)
    between = np.int32((position - below) * 256.0 + 0.5)
    first = np.int32(below)
    second = np.int32(first + _ONE)
    last = np.int32(size - _ONE)
    first = (last if wrap == 0 else _NONE) if first < _NONE else first
    second = (_NONE if wrap == 0 else last) if second > last else second
    return first, second, between


@njit(cache=True, nogil=True, error_model="numpy")
def read_texels(texels, count, first_texels, reads, of_level):
    """Colours of textures at some positions.

    Args:
        texels: See `TextureSet`.
        count: Number of positions.
        first_texels: First texel of the level that is read, int64 [positions].
        reads: Coordinates and shares; the colours are filled in; float64 [READ_ROWS, positions],
            whose rows are named here.
        of_level: Size of the level and modes of `Wrap`; the rows behind them are working memory;
            int32 [LEVEL_ROWS, positions], whose rows are named here.
    """
    for read in range(count):
        width, height = of_level[WIDTH, read], of_level[HEIGHT, read]
        wrap_u, wrap_v = of_level[WRAP_U, read], of_level[WRAP_V, read]
        x = wrapped(reads[U, read], wrap_u) * width - 0.5
        y = (1.0 - wrapped(reads[V, read], wrap_v)) * height - 0.5
        left, right, of_level[_RIGHT, read] = _neighbours(x, width, wrap_u)
        top, bottom, of_level[_BELOW, read] = _neighbours(y, height, wrap_v)
        upper, lower = np.int32(top * width), np.int32(bottom * width)
        of_level[_CORNER, read] = upper + left
        of_level[_CORNER + 1, read] = upper + right
        of_level[_CORNER + 2, read] = lower + left
        of_level[_CORNER + 3, read] = lower + right
    for read in range(count):
        first = first_texels[read]
        for corner in range(_CORNER, _CORNER + 4):
            texel = texels[np.uint64(first + of_level[corner, read])]
            of_level[corner, read] = texel
    for read in range(count):
        right, below = of_level[_RIGHT, read], of_level[_BELOW, read]
        left, above = np.int32(_WHOLE - right), np.int32(_WHOLE - below)
        a, b = of_level[_CORNER, read], of_level[_CORNER + 1, read]
        c, d = of_level[_CORNER + 2, read], of_level[_CORNER + 3, read]
        # Weights in 1/65536; a sum of four weighted codes has at most 24 bits.
        wa, wb = np.int32(left * above), np.int32(right * above)
        wc, wd = np.int32(left * below), np.int32(right * below)
        share = reads[SHARE, read]
        for channel in range(3):
            shift = 8 * channel
            code = wa * ((a >> shift) & _CODE) + wb * ((b >> shift) & _CODE)
            code += wc * ((c >> shift) & _CODE) + wd * ((d >> shift) & _CODE)
            reads[RED + channel, read] = share * (np.int32(code) / 65536.0)
