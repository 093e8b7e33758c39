"""A scan from the cache is the scan itself."""

import os
import shutil
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.worlds.drawing import rays, textures
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.scans.scan_loading import ScanFiles, cached_scan, load_scan
from hypernav.simulator.worlds.scenes.scene import Scene
from scan_writers.buildings import two_storeys
from scan_writers.scans import write_scan


def files_of(mesh: Path) -> ScanFiles:
    found = ScanFiles.of(mesh)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def mesh(tmp_path_factory) -> Path:
    return write_scan(two_storeys(), tmp_path_factory.mktemp("scans") / "00802-wcojb4TFT35")


@pytest.fixture
def files(mesh, tmp_path) -> ScanFiles:
    """Those of a copy, which a test may change."""
    return files_of(shutil.copytree(mesh.parent, tmp_path / mesh.parent.name) / mesh.name)


class Loads:
    """Loads scans, and counts."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, files: ScanFiles) -> Scene:
        self.count += 1
        return load_scan(files)


def assert_same(found: Scene, expected: Scene) -> None:
    for field in fields(Scene):
        ours, theirs = getattr(found, field.name), getattr(expected, field.name)
        if isinstance(theirs, np.ndarray):
            assert np.array_equal(ours, theirs)
            assert ours.dtype == theirs.dtype
        elif field.name not in ("materials", "cache"):
            assert ours == theirs
    for ours, theirs in zip(found.materials, expected.materials, strict=True):
        assert (ours.name, ours.color, ours.wrap, ours.unlit) == (
            theirs.name, theirs.color, theirs.wrap, theirs.unlit,
        )  # fmt: skip
        assert (ours.texture is None) == (theirs.texture is None)
        if ours.texture is not None and theirs.texture is not None:
            assert np.array_equal(ours.texture, theirs.texture)


def test_a_scan_is_loaded_once(files, tmp_path):
    load, scan = Loads(), load_scan(files)
    for _ in range(3):
        found = cached_scan(files, load, folder=tmp_path / "cache", least_bytes=0)
        assert_same(found, scan)
    assert load.count == 1


def test_small_scans_are_not_kept(files, tmp_path):
    cached_scan(files, load_scan, folder=tmp_path / "cache")
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize("name", ["mesh", "semantic_mesh", "semantic_text"])
def test_a_file_that_changes_is_read_again(files, tmp_path, name):
    load = Loads()
    cached_scan(files, load, folder=tmp_path / "cache", least_bytes=0)
    os.utime(getattr(files, name), (1, 1))
    cached_scan(files, load, folder=tmp_path / "cache", least_bytes=0)
    assert load.count == 2


@pytest.mark.parametrize("damage", [b"", b"PK\3\4 nothing", None])
@pytest.mark.parametrize("name", ["scan.npz", "0.npy"])
def test_a_broken_cache_is_written_again(files, tmp_path, name, damage, caplog):
    cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0)
    (path,) = (tmp_path / "cache" / "scans").glob(f"*/{name}")
    if damage is None:
        path.write_bytes(path.read_bytes()[:-100])
    else:
        path.write_bytes(damage)
    load, scan = Loads(), load_scan(files)
    for _ in range(2):
        found = cached_scan(files, load, folder=tmp_path / "cache", least_bytes=0)
        assert_same(found, scan)
    assert load.count == 1
    assert "is written again" in caplog.text


def drawn(scene: Scene) -> np.ndarray:
    camera = PinholeCamera.from_hfov(64, 48, 79.0)
    renderer = CpuRenderer(scene, RenderConfig(threads=1))
    pose = Pose2(1.5, 1.5, 0.7).to_transform() @ optical_to_base(0.88)
    rgb = renderer.render(camera, pose).rgb
    renderer.close()
    return rgb


def test_what_drawing_needs_is_kept_with_the_scan(files, tmp_path, monkeypatch):
    fresh = drawn(load_scan(files))
    assert len(np.unique(fresh)) > 3
    for _ in range(2):
        found = cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0)
        assert np.array_equal(drawn(found), fresh)
        monkeypatch.setattr(textures, "collect_textures", None)
        monkeypatch.setattr(rays, "_along_a_curve", None)


def test_and_is_made_anew_for_another_scan_and_where_it_is_broken(files, tmp_path):
    fresh = drawn(load_scan(files))
    drawn(cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0))
    for path in (tmp_path / "cache").rglob("te*.npy"):
        path.write_bytes(path.read_bytes()[:-4])
    found = cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0)
    assert np.array_equal(drawn(found), fresh)
    os.utime(files.mesh, (1, 1))
    other = cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0)
    assert other.cache != found.cache


def test_without_a_folder_to_write_to_nothing_is_kept(files, tmp_path):
    (tmp_path / "file").write_bytes(b"")
    found = cached_scan(files, load_scan, folder=tmp_path / "file", least_bytes=0)
    assert_same(found, load_scan(files))
