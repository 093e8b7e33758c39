"""The folder of an exam may be a stranger's: no pipe is read, and no file elsewhere is cut."""

import os
from pathlib import Path

import pytest

from hypernav.core.errors import RunFolderError
from hypernav.lab.exam.sitting import ANSWERS, read_answers


def test_a_pipe_in_place_of_the_answers_is_refused(tmp_path):
    os.mkfifo(tmp_path / ANSWERS)
    with pytest.raises(RunFolderError, match="a pipe"):
        read_answers(tmp_path)


@pytest.mark.parametrize("join", [Path.symlink_to, Path.hardlink_to])
def test_no_file_elsewhere_is_cut(tmp_path, join):
    mine = tmp_path / "mine"
    mine.write_text("not a whole line")
    join(tmp_path / ANSWERS, mine)
    with pytest.raises(RunFolderError, match="link"):
        read_answers(tmp_path)
    assert mine.read_text() == "not a whole line"
