"""Files that are replaced in one step."""

import os

import pytest

from hypernav.core.errors import OutputError
from hypernav.io.writing import csv_file, own_folder, write_whole


@pytest.mark.parametrize("content", ["grüße\n", b"\x00\xff"])
def test_a_file_is_made_and_replaced_and_nothing_else_is_left(tmp_path, content):
    path = tmp_path / "file"
    write_whole(path, "much longer than what comes next")
    write_whole(path, content)
    assert path.read_bytes() == (content.encode() if isinstance(content, str) else content)
    assert list(tmp_path.iterdir()) == [path]


def test_on_a_full_disk_the_file_is_as_before(tmp_path, monkeypatch):
    path = tmp_path / "file"
    write_whole(path, "before")

    def full(_file: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write_whole(path, "after")
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_table_replaces_a_hard_link(tmp_path):
    mine, table = tmp_path / "mine", tmp_path / "table.csv"
    mine.write_text("mine")
    table.hardlink_to(mine)
    with csv_file(table) as file:
        file.write("a,b\r\n")
    assert (mine.read_text(), table.read_bytes()) == ("mine", b"a,b\r\n")


def test_a_folder_below_is_made_and_is_no_link(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    home = tmp_path / "home"
    home.mkdir()
    for _ in range(2):
        assert own_folder(home, "a", "b").is_dir()
    (home / "link").symlink_to(tmp_path / "elsewhere")
    (home / "a" / "link").symlink_to(tmp_path / "elsewhere")
    for names in (("link",), ("link", "b"), ("a", "link")):
        with pytest.raises(OutputError, match="link is a link"):
            own_folder(home, *names)
    assert not list((tmp_path / "elsewhere").iterdir())
