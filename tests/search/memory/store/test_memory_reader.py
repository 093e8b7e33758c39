"""What is read of a memory: all that was written, what is whole of it, or an error in words."""

import errno
import hashlib
import io
import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from hypernav.core.errors import MemoryFolderError, OutputError
from hypernav.core.goal import Goal
from hypernav.io.foreign_folder import ForeignFolder
from hypernav.search.mapping.config import MappingConfig
from memory_folders import STAIRS, change_index, files_of, look, opened, searched, view


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    return searched(tmp_path_factory.mktemp("memory") / "home")


@pytest.fixture
def home(written, tmp_path) -> Path:
    """A copy of a memory of two floors, to be damaged."""
    return Path(shutil.copytree(written, tmp_path / "home"))


def index_of(folder: Path) -> dict:
    return json.loads((folder / "memory.json").read_text())


def test_connectors_are_read_as_they_were_written(home):
    with opened(home) as memory:
        assert memory.memory.connectors == STAIRS
        memory.save()
    with opened(home) as memory:
        assert memory.memory.connectors == STAIRS


def test_an_index_from_before_connectors_were_kept_has_none(home):
    facts = index_of(home)
    del facts["connectors"]
    (home / "memory.json").write_text(json.dumps(facts))
    with opened(home) as memory:
        assert memory.memory.connectors == ()


@pytest.mark.parametrize("is_older", [True, False], ids=["unknown then", "another then"])
def test_a_memory_may_be_used_whether_drops_are_seen_or_not(home, is_older):
    facts = index_of(home)
    assert facts["mapping"]["sees_drops"]
    if is_older:
        del facts["mapping"]["sees_drops"]
        (home / "memory.json").write_text(json.dumps(facts))
    with opened(home, MappingConfig(sees_drops=False)) as memory:
        assert memory.memory.floor.map.grid.explored.any()
        memory.save()
    assert not index_of(home)["mapping"]["sees_drops"]


@pytest.mark.parametrize(
    ("part", "key", "value", "told"),
    [
        ("connectors", "floor", 2, "floor 2 is named, and there are 2"),
        ("connectors", "other_floor", 7, "floor 7 is named"),
        ("connectors", "floor", -1, "connectors.0.floor"),
        ("connectors", "passage", "open", "connectors.0.passage"),
        ("connectors", "axis", float("nan"), ""),
        ("images", "floor", 9, "floor 9 is named"),
        ("images", "number", 1, "numbers of key images must differ"),
        ("images", "number", 99, "below image_count"),
    ],
)
def test_an_index_whose_numbers_name_nothing_is_refused(home, part, key, value, told):
    records = index_of(home)[part]
    records[0][key] = value
    change_index(home, **{part: records})
    with pytest.raises(MemoryFolderError, match=rf"memory\.json is broken \(.*{told}"):
        opened(home)


def test_an_index_whose_own_floor_does_not_exist_is_refused(home):
    change_index(home, floor=2)
    with pytest.raises(MemoryFolderError, match=r"is broken \(floor 2 is named"):
        opened(home)


@pytest.mark.parametrize("code", [errno.EACCES, errno.EIO, errno.EMFILE, errno.ESTALE])
@pytest.mark.parametrize("name", ["memory.json", "state-1.npz", "000001.jpg", "000002.png"])
def test_a_file_that_cannot_be_read_now_is_no_damaged_one(home, monkeypatch, code, name):
    before = files_of(home)
    read = ForeignFolder.read

    def failing(folder, path: str, **options) -> bytes:
        if path.endswith(name):
            raise OSError(code, os.strerror(code), path)
        return read(folder, path, **options)

    monkeypatch.setattr(ForeignFolder, "read", failing)
    told = rf"{name} cannot be read \({os.strerror(code)}\).*nothing is changed.*try again"
    with pytest.raises(MemoryFolderError, match=told):
        opened(home)
    assert files_of(home) == before


def test_a_link_that_leads_nowhere_now_is_no_new_memory(home):
    (home / "memory.json").rename(home.parent / "elsewhere.json")
    (home / "memory.json").symlink_to(home / "not-mounted.json")
    with pytest.raises(MemoryFolderError, match=r"memory\.json is a link, expected a file"):
        opened(home)


def test_a_file_outside_the_folder_is_not_read(home):
    (home.parent / "secret.jpg").write_bytes(b"secret")
    images = index_of(home)["images"]
    images[0]["jpeg"]["name"] = "../secret.jpg"
    change_index(home, images=images)
    with pytest.raises(MemoryFolderError, match=r"is broken \(images\.0\.jpeg\.name"):
        opened(home)
    assert (home.parent / "secret.jpg").read_bytes() == b"secret"


@pytest.mark.parametrize("name", ["images/000001.jpg", "floor-1/state-1.npz"])
def test_a_damaged_file_is_never_removed(home, name):
    cut = (home / name).read_bytes()[:-5]
    (home / name).write_bytes(cut)
    with opened(home) as memory:
        assert len(memory.left_out) == 1
        assert (home / name).read_bytes() == cut
        memory.save()
    for _ in range(2):
        assert (home / f"{name}.damaged").read_bytes() == cut
        with opened(home) as memory:
            assert memory.left_out == ()
            memory.begin(Goal("sofa"), view(1.0, 2.0, 0.0, 3.0)).begin_search(lasts=True)
            look(memory, view(1.0, 2.0, 0.0, 3.0))
            memory.end("found", steps=1)


def test_forgetting_all_images_forgets_damaged_ones(home):
    (home / "images/000001.jpg").write_bytes(b"half an image")
    with opened(home) as memory:
        memory.save()
    (home / "images/000002.png").write_bytes(b"another")
    with opened(home) as memory:
        memory.forget_images()
        memory.save()
    assert list((home / "images").iterdir()) == []


def test_what_a_killed_first_save_leaves_is_no_other_file(home):
    (home / "memory.json").unlink()
    (home / "images/.000001.jpg.new").touch()
    with opened(home) as memory:
        assert memory.index is None
        memory.save()
    assert not list((home / "images").iterdir())


@pytest.mark.parametrize(
    "name",
    [
        "images/000001.jpg",
        "images/holiday.jpg",
        "floor-1/plan.npz",
        "floor-x/state-1.npz",
        "floor-1",
        "images",
        "notes.txt",
    ],
)
def test_other_files_are_not_taken_for_leftovers(tmp_path, name):
    folder = tmp_path / "home"
    (folder / name).parent.mkdir(parents=True)
    (folder / name).write_bytes(b"mine")
    with pytest.raises(MemoryFolderError, match=rf"holds other files \({name.split('/')[0]}"):
        opened(folder)
    assert (folder / name).read_bytes() == b"mine"


def test_of_many_other_files_three_are_named(tmp_path):
    for name in "ecadb":
        (tmp_path / name).touch()
    with pytest.raises(
        MemoryFolderError, match=r"holds other files \(a, b, c\) and no memory\.json"
    ):
        opened(tmp_path)


def test_a_memory_that_lost_its_index_is_told_from_other_files(home):
    (home / "floor-1" / "state-1.npz").rename(home / "floor-1" / "state-4.npz")
    for path in home.glob("floor-2/*"):
        path.unlink()
    (home / "memory.json").unlink()
    before = files_of(home)
    with pytest.raises(
        MemoryFolderError, match=r"lost its memory\.json.*put back a copy.*begin anew"
    ):
        opened(home)
    assert files_of(home) == before


def test_a_memory_that_is_moved_while_it_is_used_is_told_so(home, monkeypatch):
    def read(images, record, folder, *rest):
        if folder.is_in_place():
            folder.path.rename(folder.path.with_name("away"))
        return False

    with opened(home) as memory:
        home.rename(home.with_name("moved"))
        with pytest.raises(OutputError, match="was moved or removed while it was in use"):
            memory.save()
    home.with_name("moved").rename(home)
    monkeypatch.setattr("hypernav.search.memory.store.memory_reader._add_image", read)
    with pytest.raises(MemoryFolderError, match="was moved or removed while it was read"):
        opened(home)


def test_files_that_others_put_into_a_memory_stay_there(home):
    mine = [home / "images" / "holiday.jpg", home / "floor-1" / "notes.npz", home / "a.png"]
    for path in mine:
        path.write_bytes(b"mine")
    with opened(home) as memory:
        memory.forget_images()
        memory.save()
    assert {path.read_bytes() for path in mine} == {b"mine"}


def with_content(folder: Path, record: dict, content: bytes) -> dict:
    """A file with other content, and the record that vouches for it."""
    (folder / record["name"]).write_bytes(content)
    digest = hashlib.sha256(content).hexdigest()
    return record | {"size": len(content), "sha256": digest}


def marked(content: bytes, *marks: tuple[int, int]) -> bytes:
    """An archive whose first entry has other bytes, at offsets from its entry in the directory."""
    changed = bytearray(content)
    entry = content.find(b"PK\x01\x02")
    for offset, value in marks:
        changed[entry + offset] = value
    return bytes(changed)


@pytest.mark.parametrize(
    "changed",
    [
        {"trajectory": np.float64(1.0)},
        {"trajectory": np.array([["a", "b"]])},
        {"trajectory": np.full((3, 2), np.nan)},
        {"image_numbers": np.zeros((1, 4), np.int64)},
        {"patch_counts": np.array([3, -3, 0, 0])},
        {"patches": np.zeros((4, 2), np.int64)},
        {"cells": np.full((64, 64), 77, np.uint8)},
        {"first": np.array([2**62, -(2**63)])},
        [(10, 97)],
        [(8, 1)],
        [(20, 1)],
    ],
)
def test_a_map_that_no_map_can_be_is_damaged_whatever_vouches_for_it(home, changed):
    floors = index_of(home)["floors"]
    content = (home / floors[0]["state"]["name"]).read_bytes()
    if isinstance(changed, list):
        content = marked(content, *changed)
    else:
        arrays = dict(np.load(io.BytesIO(content)))
        if "cells" in changed:
            changed = {"cells": np.full_like(arrays["cells"], 77)}
        data = io.BytesIO()
        np.savez_compressed(data, **(arrays | changed))
        content = data.getvalue()
    floors[0]["state"] = with_content(home, floors[0]["state"], content)
    change_index(home, floors=floors)
    with opened(home) as memory:
        (line,) = memory.left_out
        assert line.startswith("the map of floor 1 is damaged (")
        memory.save()


@pytest.mark.parametrize("content", [b"", b"no image"])
def test_a_depth_image_that_is_none_is_damaged(home, content):
    images = index_of(home)["images"]
    images[0]["png"] = with_content(home, images[0]["png"], content)
    change_index(home, images=images)
    (home / "floor-1" / "state-1.npz").unlink()  # so that patches come from the depth
    with opened(home) as memory:
        assert memory.left_out[1].endswith("key images are missing or damaged, and left out: 0")


def test_an_impossible_camera_is_damaged(home):
    images = index_of(home)["images"]
    images[0]["camera"] = [320, 240, 0.0, 0.0, 160.0, 120.0]
    change_index(home, images=images)
    with opened(home) as memory:
        assert memory.left_out[0].endswith("key images are missing or damaged, and left out: 0")
