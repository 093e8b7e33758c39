"""Whatever is in the files of a scan, it is read or refused with one of our errors."""

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hostile.damage import bounded, damaged, hostile
from hypernav.core.errors import SceneError
from hypernav.io.reading import MOST_PIXELS
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from hypernav.simulator.worlds.scenes.material_images import basis_size, decode_basis, is_basis
from scan_writers.basis_bytes import basis, ktx2
from scan_writers.buildings import House, Thing
from scan_writers.encoded_images import FINE, HOLES, MIPS
from scan_writers.matterport import house_lines, semantic_ply
from scan_writers.scans import (
    semantic_lines,
    write_semantic_colors,
    write_semantic_texture,
    write_visual,
)

pytestmark = pytest.mark.slow

STEM = "wcojb4TFT35"
ROOM = House(
    (
        Thing("floor", (0.0, 0.0, -0.1), (4.0, 3.0, 0.0)),
        Thing('chair, "red"', (1.0, 1.0, 0.0), (1.5, 1.5, 0.9)),
    )
)
TEXT = ("\n".join(semantic_lines(ROOM)) + "\n").encode()
COLORS = np.random.default_rng(0).integers(0, 256, (2, 3, 3))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("val") / f"00802-{STEM}"


def sound(folder: Path) -> dict[str, bytes]:
    """The content of every file of a sound scan."""
    write_visual(ROOM, folder / f"{STEM}.glb")
    write_semantic_colors(ROOM, folder / f"{STEM}.semantic.glb")
    write_semantic_texture(ROOM, folder / "texture.glb")
    (folder / f"{STEM}.semantic.txt").write_bytes(TEXT)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def scan(folder: Path) -> Path:
    sound(folder)
    return folder / f"{STEM}.glb"


def opened(scan: Path) -> None:
    """Open the scan; every triangle of what is read has its instance."""
    try:
        with bounded():
            scene = open_scene(scan)
    except SceneError:
        return
    assert len(scene.faces) > 0
    assert all(map(math.isfinite, scene.vertices[scene.faces].ravel()))
    assert 0 <= scene.face_instance.min() <= scene.face_instance.max() < len(scene.instances)


def files() -> dict[str, bytes]:
    """The content of every file of a sound scan, for mutations."""
    with tempfile.TemporaryDirectory() as folder:
        return sound(Path(folder))


SOUND = files()


@hostile
@given(damaged(SOUND[f"{STEM}.glb"]))
def test_meshes(scan, content):
    for name in (f"{STEM}.semantic.glb", f"{STEM}.semantic.txt"):
        scan.with_name(name).write_bytes(SOUND[name])
    scan.write_bytes(content)
    opened(scan)


@hostile
@given(damaged(SOUND[f"{STEM}.semantic.glb"]) | damaged(SOUND["texture.glb"]))
def test_semantic_meshes(scan, content):
    scan.write_bytes(SOUND[f"{STEM}.glb"])
    scan.with_name(f"{STEM}.semantic.txt").write_bytes(TEXT)
    scan.with_name(f"{STEM}.semantic.glb").write_bytes(content)
    opened(scan)


@hostile
@given(damaged(TEXT))
def test_annotations(scan, content):
    scan.write_bytes(SOUND[f"{STEM}.glb"])
    scan.with_name(f"{STEM}.semantic.glb").write_bytes(SOUND[f"{STEM}.semantic.glb"])
    scan.with_name(f"{STEM}.semantic.txt").write_bytes(content)
    opened(scan)


HOUSE_TEXT = ("\n".join(house_lines(ROOM)) + "\n").encode()
PLY = semantic_ply(ROOM)


@hostile
@given(st.tuples(damaged(HOUSE_TEXT), st.just(PLY)) | st.tuples(st.just(HOUSE_TEXT), damaged(PLY)))
def test_annotations_of_matterport(tmp_path_factory, content):
    scan = tmp_path_factory.getbasetemp() / "17DRP5sb8fy" / "17DRP5sb8fy.glb"
    scan.parent.mkdir(exist_ok=True)
    scan.write_bytes(SOUND[f"{STEM}.glb"])
    for ending, changed in zip((".house", "_semantic.ply"), content, strict=True):
        scan.with_name(f"{scan.stem}{ending}").write_bytes(changed)
    opened(scan)


@hostile
@given(st.sampled_from([ktx2(COLORS), basis(COLORS), MIPS, HOLES, FINE]).flatmap(damaged))
def test_images(content):
    pytest.importorskip("opengl_basisu", reason="pip install 'hypernav[hm3d]'")
    if not is_basis(content) or (size := basis_size(content)) is None:
        return
    if size[0] * size[1] > MOST_PIXELS:
        return  # refused before it is decoded
    with bounded():
        rgba = decode_basis(content)
    assert rgba is None or rgba.shape == (size[1], size[0], 4)
