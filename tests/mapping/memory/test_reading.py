"""What is read of a memory: all that was written, what is whole of it, or an error in words."""

import json
import shutil
from pathlib import Path

import pytest

from hypernav.core.errors import MemoryFolderError
from memory_folders import STAIRS, change_index, opened, searched


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
    with pytest.raises(MemoryFolderError, match="floor 2 is named"):
        opened(home)
