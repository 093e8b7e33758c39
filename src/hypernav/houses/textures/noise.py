"""Periodic noise, and the conversion of numbers to images."""

import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.houses.random_stream import RandomStream

Gray = Float64[np.ndarray, "height width"]
Image = UInt8[np.ndarray, "height width 3"]


def smooth_noise(rng: RandomStream, height: int, width: int, rows: int, columns: int) -> Gray:
    """Periodic noise in [0, 1): random values on a lattice, interpolated smoothly.

    Args:
        rng: Source of randomness.
        height: Height of the image, pixels.
        width: Width of the image, pixels.
        rows: Number of lattice cells from top to bottom.
        columns: Number of lattice cells from left to right.
    """
    lattice = rng.array(rows, columns)
    y, fy = _split(height, rows)
    x, fx = _split(width, columns)
    y1, x1 = (y + 1) % rows, (x + 1) % columns
    top = lattice[np.ix_(y, x)] * (1.0 - fx) + lattice[np.ix_(y, x1)] * fx
    bottom = lattice[np.ix_(y1, x)] * (1.0 - fx) + lattice[np.ix_(y1, x1)] * fx
    return top * (1.0 - fy[:, None]) + bottom * fy[:, None]


def _split(pixels: int, cells: int) -> tuple[np.ndarray, np.ndarray]:
    at = np.arange(pixels) * (cells / pixels)
    whole = np.floor(at).astype(np.int64)
    part = at - whole
    return whole % cells, part * part * (3.0 - 2.0 * part)


def cloud_noise(
    rng: RandomStream, size: int, cells: int, *, octaves: int = 4, stretch: int = 1
) -> Gray:
    """Fractal noise in about [0, 1], mean one half; ``stretch`` elongates it along columns."""
    total = np.zeros((size, size))
    weight, norm = 1.0, 0.0
    for octave in range(octaves):
        rows = min(cells * 2**octave, size)
        columns = max(rows // stretch, 1)
        total += weight * smooth_noise(rng, size, size, rows, columns)
        norm += weight
        weight *= 0.5
    return total / norm


def speckle(rng: RandomStream, size: int) -> Gray:
    """White noise in [0, 1)."""
    return rng.array(size, size)


def to_image(
    values: Float64[np.ndarray, "height width *channels"],
) -> Image:
    """Numbers from 0 to 1 as an 8-bit sRGB image; grey if there is only one channel."""
    # The unusual offset keeps theoretically exact values away from the rounding boundary.
    bytes_ = np.floor(np.clip(values, 0.0, 1.0) * 255.0 + 0.50137).astype(np.uint8)
    return np.repeat(bytes_[..., None], 3, axis=2) if bytes_.ndim == 2 else bytes_


def mix(
    a: tuple[float, float, float], b: tuple[float, float, float], t: Gray
) -> Float64[np.ndarray, "height width 3"]:
    """Linear interpolation from colour a where t is 0 to colour b where t is 1."""
    t3 = np.clip(t, 0.0, 1.0)[..., None]
    return np.array(a) * (1.0 - t3) + np.array(b) * t3


def pixel_grid(height: int, width: int) -> tuple[Gray, Gray]:
    """Row and column of every pixel, as fractions of the image in [0, 1)."""
    rows = (np.arange(height) + 0.5) / height
    columns = (np.arange(width) + 0.5) / width
    return rows[:, None] + np.zeros((1, width)), columns[None, :] + np.zeros((height, 1))
