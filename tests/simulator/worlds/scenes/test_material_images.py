"""Decoding of images; those in Basis Universal need the package of the extra hm3d."""

import sys

import cv2
import numpy as np
import pytest

from hypernav.core.errors import MissingExtraError
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from hypernav.simulator.worlds.scenes.material_images import (
    basis_size,
    decode_basis,
    decode_images,
    is_basis,
)
from scan_writers.basis_bytes import basis, ktx2
from scan_writers.buildings import two_storeys
from scan_writers.encoded_images import FINE, HEIGHT, HOLES, MIPS, WIDTH, picture
from scan_writers.scans import write_visual

COLORS = np.random.default_rng(0).integers(0, 256, (2, 3, 3))
WRITERS = pytest.mark.parametrize("write", [ktx2, basis])
HOUSE = two_storeys()


@pytest.fixture
def _installed():
    pytest.importorskip("opengl_basisu", reason="pip install 'hypernav[hm3d]'")


@WRITERS
@pytest.mark.usefixtures("_installed")
def test_an_image_is_decoded_top_row_first(write):
    content = write(COLORS)
    assert is_basis(content)
    assert basis_size(content) == (12, 8)
    rgba = decode_basis(content)
    assert rgba is not None
    assert np.array_equal(rgba[..., :3], np.kron(COLORS, np.ones((4, 4, 1))))
    assert (rgba[..., 3] == 255).all()


@pytest.mark.parametrize(
    ("content", "accuracy"),
    [(MIPS, 12.0), (HOLES, 12.0), (FINE, 1.0)],
    ids=["mips", "holes", "fine"],
)
@pytest.mark.usefixtures("_installed")
def test_what_the_encoder_writes_is_decoded(content, accuracy):
    assert basis_size(content) == (WIDTH, HEIGHT)
    rgba = decode_basis(content)
    assert rgba is not None
    seen, right = rgba[..., :3].astype(float), picture().astype(float)
    assert np.abs(seen - right).mean() < accuracy
    for mirrored in (right[::-1], right[:, ::-1]):
        assert np.abs(seen - mirrored).mean() > 30.0


@pytest.mark.usefixtures("_installed")
def test_holes_are_where_the_encoder_was_given_them():
    rgba = decode_basis(HOLES)
    assert rgba is not None
    assert (rgba[:, : WIDTH // 2, 3] == 255).all()
    assert (rgba[:, WIDTH // 2 :, 3] == 0).all()


@WRITERS
@pytest.mark.usefixtures("_installed")
def test_a_scan_shows_its_textures(write, tmp_path):
    path = write_visual(HOUSE, tmp_path / "x.basis.glb", image=write(COLORS))
    scene = open_scene(path)
    texture = scene.materials[0].texture
    assert texture is not None
    assert np.array_equal(texture[::4, ::4], COLORS)
    assert scene.materials[0].opaque is None


@WRITERS
@pytest.mark.usefixtures("_installed")
@pytest.mark.parametrize("length", [12, 60, 100, 130])
def test_an_image_that_is_cut_off_is_one_warning(write, length, tmp_path, caplog):
    path = write_visual(HOUSE, tmp_path / "x.basis.glb", image=write(COLORS)[:length])
    assert open_scene(path).materials[0].texture is None
    (message,) = caplog.messages
    assert "x.basis.glb: texture 0 cannot be decoded" in message


@pytest.mark.usefixtures("_installed")
def test_a_level_that_unpacks_to_more_than_its_pixels_is_refused():
    content = bytearray(ktx2(COLORS))
    content[44] = 2
    content[96:104] = (2**40).to_bytes(8, "little")
    assert basis_size(bytes(content)) is None


def test_without_the_package_the_error_is_the_remedy(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    path = write_visual(HOUSE, tmp_path / "x.basis.glb", image=ktx2(COLORS))
    with pytest.raises(MissingExtraError, match=r"pip install 'hypernav\[hm3d\]'"):
        open_scene(path)


def test_broken_images_are_none_without_a_word_of_the_decoders(capfd):
    pixels = np.random.default_rng(0).integers(0, 255, (32, 32, 3), dtype=np.uint8)
    whole = {kind: cv2.imencode(kind, pixels)[1].tobytes() for kind in (".png", ".jpg")}
    contents = {
        "whole": whole[".png"],
        "cut": whole[".png"][:600],
        "damaged": whole[".png"][:500] + b"?" + whole[".png"][501:],
        "words": whole[".jpg"][:300] + bytes(9) + whole[".jpg"][300:],
    }
    images = decode_images(contents)
    assert images["whole"] is not None
    assert np.array_equal(images["whole"].rgb, pixels[..., ::-1])
    assert images["damaged"] is None
    assert capfd.readouterr().err == ""
