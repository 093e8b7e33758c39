"""Files that are written: what may lie where they will be."""

import pytest

from hypernav.core.errors import OutputError
from hypernav.io.writing import OutputFile, check_regular


def test_a_link_will_do_if_its_file_can_be_made(tmp_path):
    link = tmp_path / "map.png"
    link.symlink_to("later.png")
    check_regular(link)
    OutputFile(link).close()
    assert (tmp_path / "later.png").is_file()


def test_a_link_into_a_folder_that_is_not_there_is_refused(tmp_path):
    link = tmp_path / "map.png"
    link.symlink_to(tmp_path / "nowhere" / "x")
    with pytest.raises(OutputError, match=r"map.png cannot be written .*no folder .*nowhere\)"):
        check_regular(link)


def test_a_link_to_itself_is_not_told_to_free_space(tmp_path):
    link = tmp_path / "map.png"
    link.symlink_to("map.png")
    with pytest.raises(OutputError, match="lead in a circle") as refusal:
        check_regular(link)
    assert "space" not in str(refusal.value)
