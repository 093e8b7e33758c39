"""The folder of a search may be a stranger's: nothing outside it is written."""

import os
from pathlib import Path

import pytest
from pydantic import BaseModel

from hypernav.core.errors import RunFolderError
from hypernav.robot.server.searches.journal import _write_whole


class Content(BaseModel):
    word: str = "new"


@pytest.mark.parametrize("join", [Path.symlink_to, Path.hardlink_to])
def test_no_file_elsewhere_is_written(tmp_path, join):
    mine = tmp_path / "mine"
    mine.write_text("mine")
    join(tmp_path / ".end.json.new", mine)
    with pytest.raises(RunFolderError, match="link"):
        _write_whole(tmp_path / "end.json", Content())
    assert mine.read_text() == "mine"


def test_a_pipe_is_refused(tmp_path):
    os.mkfifo(tmp_path / ".end.json.new")
    with pytest.raises(RunFolderError):
        _write_whole(tmp_path / "end.json", Content())


def test_the_reserved_room_is_used_and_the_rest_given_back(tmp_path):
    (tmp_path / ".end.json.new").write_bytes(bytes(4096))
    _write_whole(tmp_path / "end.json", Content())
    assert Content.model_validate_json((tmp_path / "end.json").read_text()) == Content()
    assert [one.name for one in tmp_path.iterdir()] == ["end.json"]
