import shutil
from pathlib import Path

import numpy as np
import pytest

from hypernav.io.cache_folder import cache_folder
from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.house_cache import cached_building, generator_version
from hypernav.simulator.worlds.scenes.scene import Scene

NUMBER = BUILTIN_HOUSE


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("master")
    cached_building(house(NUMBER), folder)
    return folder


@pytest.fixture
def filled(master: Path, tmp_path: Path) -> Path:
    shutil.copytree(master, tmp_path, dirs_exist_ok=True)
    return tmp_path


def files(folder: Path) -> tuple[Path, list[Path]]:
    home = folder / "houses" / generator_version()
    return home / f"{NUMBER}.npz", sorted((home / "textures").iterdir())


def check_same(a: Scene, b: Scene) -> None:
    for name in ("vertices", "faces", "uv", "colors", "normals", "face_material", "face_instance"):
        assert np.array_equal(getattr(a, name), getattr(b, name)), name
    assert a.instances == b.instances
    assert a.name == b.name
    for one, two in zip(a.materials, b.materials, strict=True):
        assert (one.name, one.color, one.wrap, one.unlit) == (
            two.name,
            two.color,
            two.wrap,
            two.unlit,
        )
        assert (one.texture is None) == (two.texture is None)
        if one.texture is not None and two.texture is not None:
            assert np.array_equal(one.texture, two.texture)


def test_a_house_from_the_cache_is_the_house(builtin_scene: Scene, filled: Path):
    check_same(cached_building(house(NUMBER), filled), builtin_scene)


def test_nothing_is_left_over(filled: Path):
    path, _ = files(filled)
    assert not [p for p in path.parent.rglob("*") if p.name.startswith(".new")]


@pytest.mark.parametrize(
    "content",
    [
        b"not a zip file",
        pytest.param(b"", marks=pytest.mark.slow),
        pytest.param(b"PK\x03\x04 broken", marks=pytest.mark.slow),
    ],
)
def test_a_broken_file_is_replaced(builtin_scene: Scene, filled: Path, content: bytes):
    path, _ = files(filled)
    good = path.read_bytes()
    path.write_bytes(content)
    check_same(cached_building(house(NUMBER), filled), builtin_scene)
    assert len(path.read_bytes()) == len(good)


@pytest.mark.slow
def test_a_cut_file_is_replaced(builtin_scene: Scene, filled: Path):
    path, _ = files(filled)
    path.write_bytes(path.read_bytes()[:-2000])
    check_same(cached_building(house(NUMBER), filled), builtin_scene)


def test_broken_textures_are_made_again(
    builtin_scene: Scene, filled: Path, monkeypatch: pytest.MonkeyPatch
):
    _, textures = files(filled)
    textures[0].write_bytes(b"broken")
    np.save(textures[1], np.zeros(3))
    from hypernav.simulator.houses.textures import library

    monkeypatch.setattr(library, "_TEXTURES", {})
    check_same(cached_building(house(NUMBER), filled), builtin_scene)
    assert np.load(textures[0]).ndim == 3


def test_a_cache_that_cannot_be_written_is_done_without(builtin_scene: Scene, tmp_path: Path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    check_same(cached_building(house(NUMBER), blocked), builtin_scene)


def test_the_folder_can_be_chosen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv("HYPERNAV_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("HYPERNAV_CACHE")
    assert cache_folder().name == "hypernav"


def test_a_cache_that_cannot_be_read_is_not_said_for_every_file(tmp_path: Path, caplog):
    cached_building(house(NUMBER), tmp_path / ("x" * 300))
    assert not caplog.records
