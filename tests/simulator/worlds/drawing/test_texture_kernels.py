"""Textures are read between their four nearest texels, as their mode of repetition says."""

import math

import numpy as np
import pytest

from hypernav.simulator.worlds.drawing.texture_kernels import (
    HEIGHT,
    LEVEL_ROWS,
    READ_ROWS,
    RED,
    SHARE,
    WIDTH,
    WRAP_U,
    WRAP_V,
    U,
    V,
    read_texels,
)
from hypernav.simulator.worlds.scenes.scene import Wrap

STRANGE = [0.0, 1.0, -0.0, 2.0, -1.0, math.inf, -math.inf, math.nan, 1e300, 1e-300, 0.5 - 1e-17]


def read(image: np.ndarray, u: np.ndarray, v: np.ndarray, wraps: tuple[Wrap, Wrap]) -> np.ndarray:
    """Colours of an image, [rows, columns, 3], at positions."""
    height, width = image.shape[:2]
    before = 7  # texels of another texture
    texels = np.zeros(before + width * height, np.uint32)
    texels[before:] = (image.reshape(-1, 3).astype(np.uint32) << [0, 8, 16]).sum(axis=1)
    texels[before:] |= np.uint32(255 << 24)
    reads = np.zeros((READ_ROWS, len(u)))
    of_level = np.zeros((LEVEL_ROWS, len(u)), np.int32)
    reads[U], reads[V], reads[SHARE] = u, v, 1.0
    of_level[WIDTH], of_level[HEIGHT] = width, height
    of_level[WRAP_U], of_level[WRAP_V] = wraps
    read_texels(texels, len(u), np.full(len(u), before), reads, of_level)
    return reads[RED : RED + 3].T


def expected(image: np.ndarray, u: float, v: float, wraps: tuple[Wrap, Wrap]) -> np.ndarray:
    """The same at one position, by the definition."""
    height, width = image.shape[:2]
    x = texel_position(u, width, wraps[0])
    y = height - 1 - texel_position(v, height, wraps[1])
    column, row = math.floor(x), math.floor(y)
    total = np.zeros(3)
    for down in (0, 1):
        for right in (0, 1):
            weight = abs(1 - right - (x - column)) * abs(1 - down - (y - row))
            own = (
                neighbour(row + down, height, wraps[1]),
                neighbour(column + right, width, wraps[0]),
            )
            total += weight * image[own]
    return total


def texel_position(coordinate: float, size: int, wrap: Wrap) -> float:
    if wrap == Wrap.REPEAT:
        inside = coordinate % 1.0
    elif wrap == Wrap.MIRROR:
        inside = 1.0 - abs(coordinate % 2.0 - 1.0)
    else:
        inside = min(max(coordinate, 0.0), 1.0)
    return inside * size - 0.5


def neighbour(number: int, size: int, wrap: Wrap) -> int:
    return number % size if wrap == Wrap.REPEAT else min(max(number, 0), size - 1)


@pytest.mark.parametrize("size", [(1, 1), (2, 3), (16, 8)])
@pytest.mark.parametrize("wrap_v", list(Wrap))
@pytest.mark.parametrize("wrap_u", list(Wrap))
def test_colours_lie_between_those_of_the_four_nearest_texels(
    wrap_u: Wrap, wrap_v: Wrap, size: tuple[int, int]
) -> None:
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (*size, 3), dtype=np.uint8)
    u, v = rng.uniform(-3.0, 3.0, (2, 200))
    seen = read(image, u, v, (wrap_u, wrap_v))
    for own, at_u, at_v in zip(seen, u, v, strict=True):
        # Weights are rounded to 1/256.
        assert own == pytest.approx(expected(image, at_u, at_v, (wrap_u, wrap_v)), abs=1.1)


@pytest.mark.parametrize("wrap", list(Wrap))
def test_strange_coordinates_give_some_colour_of_the_image(wrap: Wrap) -> None:
    image = np.full((4, 4, 3), (10, 20, 30), np.uint8)
    u, v = (axis.ravel() for axis in np.meshgrid(STRANGE, STRANGE))
    assert (read(image, u, v, (wrap, wrap)) == (10, 20, 30)).all()
