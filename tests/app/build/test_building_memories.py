"""The memory of a building, as Python shows it."""

from pathlib import Path

import pytest

from box_scenes import room_glb
from hypernav import HyPerNavConfig, find, open_memory
from hypernav.core.errors import OutputError

CONFIG = HyPerNavConfig().with_(embodiment={"camera": {"width": 160, "height": 120}})


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """The memory of one search."""
    folder = tmp_path_factory.mktemp("remembered")
    scene = str(room_glb(folder / "room.glb"))
    with open_memory(folder / "home", CONFIG) as opened:
        for _ in find("bed", scene, config=CONFIG, memory=opened):
            pass
        yield opened


def test_every_thing_is_a_row_of_the_table_and_named_in_a_notebook(home):
    pytest.importorskip("pandas")
    things = [thing for floor in home.memory.floors for thing in floor.things.known]
    table = home.to_pandas()
    assert things
    assert list(table.label) == [thing.label for thing in things]
    assert list(zip(table.x, table.y, table.z, strict=True)) == [one.position for one in things]
    shown = home._repr_html_()
    assert all(thing.label in shown for thing in things)
    assert shown.count("<img") == len(home.memory.floors)


def test_it_says_what_it_holds_in_a_line(home):
    assert f"1 search, {len(home.to_pandas())} thing" in repr(home)
    assert "\n" not in repr(home)


def test_its_page_is_written_where_it_is_wanted(home, tmp_path: Path):
    page = home.save_page(tmp_path / "memory.html")
    assert "<html" in page.read_text("utf-8")
    with pytest.raises(OutputError, match="cannot be written"):
        home.save_page(tmp_path / "nowhere" / "memory.html")
