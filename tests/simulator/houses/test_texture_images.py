import numpy as np
import pytest

from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.textures.library import _MAKERS, texture
from hypernav.simulator.houses.textures.patterns import cloud_noise, smooth_noise, to_image


@pytest.mark.parametrize("name", _MAKERS)
def test_every_texture_is_a_small_read_only_image(name: str):
    image = texture(name)
    assert image.dtype == np.uint8
    assert image.shape[2] == 3
    assert max(image.shape[:2]) <= 512
    assert image.std() > 0.5
    with pytest.raises(ValueError, match="read-only"):
        image[0, 0, 0] = 1


def test_variants_differ_and_are_kept():
    assert not np.array_equal(texture("rug 1"), texture("rug 2"))
    assert texture("rug 1") is texture("rug 1")


def test_an_unknown_texture_is_an_error():
    with pytest.raises(KeyError):
        texture("unobtainium")


def test_noise_continues_across_its_edges():
    noise = smooth_noise(RandomStream(1), 64, 64, 8, 8)
    inside = np.abs(np.diff(noise, axis=1)).max()
    assert np.abs(noise[:, 0] - noise[:, -1]).max() <= inside + 1e-12
    assert noise.min() >= 0.0
    assert noise.max() <= 1.0
    assert 0.3 < cloud_noise(RandomStream(2), 64, 4).mean() < 0.7


def test_numbers_become_bytes():
    assert to_image(np.array([[0.0, 0.5, 1.0]])).tolist() == [[[0] * 3, [128] * 3, [255] * 3]]
