from itertools import pairwise

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.simulator.worlds.drawing.texture_kernels import halve
from hypernav.simulator.worlds.drawing.textures import (
    SRGB_TO_LINEAR,
    TextureSet,
    collect_textures,
    linear_to_srgb,
)
from hypernav.simulator.worlds.scenes.scene import Material


def level(textures: TextureSet, texture: int, number: int) -> np.ndarray:
    """One level as RGBA codes."""
    first, width, height = textures.levels[texture, number]
    packed = textures.texels[first : first + width * height].reshape(height, width)
    return np.stack([packed >> shift & 255 for shift in (0, 8, 16, 24)], axis=-1)


@given(width=st.integers(1, 40), height=st.integers(1, 40), seed=st.integers(0, 99))
@settings(max_examples=30, deadline=None)
def test_levels_halve_down_to_one_texel_and_keep_the_light(
    width: int, height: int, seed: int
) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    textures = collect_textures([Material("a", (1.0, 1.0, 1.0), image)], 1.0)
    count = textures.level_count[0]
    np.testing.assert_array_equal(level(textures, 0, 0)[..., :3], image)
    sizes = textures.levels[0, :count, 1:].tolist()
    for finer, coarser in pairwise(sizes):
        assert coarser == [max(side // 2, 1) for side in finer]
    assert sizes[-1] == [1, 1]
    mean_light = SRGB_TO_LINEAR[image].mean(axis=(0, 1))
    last = SRGB_TO_LINEAR[level(textures, 0, count - 1)[0, 0, :3]]
    np.testing.assert_allclose(last, mean_light, atol=0.03)


def test_srgb_there_and_back() -> None:
    codes = linear_to_srgb(SRGB_TO_LINEAR) * 255.0
    np.testing.assert_allclose(codes, np.arange(256), atol=0.01)


def test_holes_lend_no_colour_to_their_surroundings() -> None:
    image = np.full((8, 8, 3), 255, np.uint8)
    opaque = np.indices((8, 8)).sum(axis=0) % 2 == 0
    image[opaque] = (0, 100, 0)
    leaf = Material("leaf", (1.0, 1.0, 1.0), image, opaque=opaque)
    textures = collect_textures([leaf], 1.0)
    coarse = level(textures, 0, 1)
    np.testing.assert_allclose(coarse[..., :3], np.full((4, 4, 3), (0, 100, 0)), atol=1)
    np.testing.assert_allclose(coarse[..., 3], 128, atol=1)


def test_materials_share_equal_images() -> None:
    image = np.zeros((4, 4, 3), np.uint8)
    materials = [
        Material("a", (1.0, 1.0, 1.0), image),
        Material("plain", (1.0, 0.0, 0.0)),
        Material("b", (0.5, 1.0, 1.0), image),
    ]
    textures = collect_textures(materials, 1.0)
    assert textures.of_material.tolist() == [0, -1, 0]
    assert len(textures.texels) == 16 + 4 + 1


def test_no_textures_at_all() -> None:
    textures = collect_textures([Material("plain", (1.0, 0.0, 0.0))], 1.0)
    assert textures.of_material.tolist() == [-1]


@pytest.mark.parametrize(
    ("budget_mb", "big", "small"), [(1.0, 128, 8), (0.01, 32, 8), (1e-9, 1, 1)]
)
def test_the_largest_shrink_until_all_fit(budget_mb: float, big: int, small: int) -> None:
    white = (1.0, 1.0, 1.0)
    materials = [
        Material("big", white, np.zeros((128, 128, 3), np.uint8)),
        Material("small", white, np.zeros((8, 8, 3), np.uint8)),
    ]
    textures = collect_textures(materials, budget_mb)
    assert textures.levels[:, 0, 1].tolist() == [big, small]


@given(width=st.integers(1, 20), height=st.integers(1, 20), seed=st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_the_kernel_halves_as_opencv_does_to_the_bit(width: int, height: int, seed: int) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (2 * height, 2 * width, 3), np.uint8)
    light = np.empty((height, width, 3), np.float32)
    halve(image, SRGB_TO_LINEAR, light)
    full = SRGB_TO_LINEAR[image]
    expected = cv2.resize(full, (width, height), interpolation=cv2.INTER_AREA)
    assert np.array_equal(light, expected.reshape(light.shape))


@given(seed=st.integers(0, 99))
@settings(max_examples=10, deadline=None)
def test_opaque_texels_are_coded_like_those_with_holes(seed: int) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (16, 8, 3), np.uint8)
    solid = Material("a", (1.0, 1.0, 1.0), image, opaque=np.ones((16, 8), dtype=bool))
    plain = Material("b", (1.0, 1.0, 1.0), image)
    textures = [collect_textures([material], 1.0) for material in (solid, plain)]
    assert np.array_equal(textures[0].texels, textures[1].texels)
