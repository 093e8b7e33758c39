"""What is appended is there as a whole or not at all."""

import os
import resource
import signal
from contextlib import closing

import pytest

from hypernav.io.writing import AppendOnlyFile


def test_it_goes_on_behind_what_is_there(tmp_path):
    path = tmp_path / "file"
    for data in (b"one", b"", b"two"):
        with closing(AppendOnlyFile(path)) as file:
            file.append(data, sync=True)
            assert path.read_bytes().endswith(data)
            assert file.size == path.stat().st_size
    assert path.read_bytes() == b"onetwo"


def test_what_is_cut_is_gone_and_the_next_piece_follows_the_rest(tmp_path):
    path = tmp_path / "file"
    with closing(AppendOnlyFile(path)) as file:
        file.append(b"one, two")
        file.cut(3)
        file.append(b" and three")
        assert file.read(4, 99) == b"and three"
    assert path.read_bytes() == b"one and three"


def test_a_reader_changes_nothing(tmp_path):
    with pytest.raises(FileNotFoundError):
        AppendOnlyFile(tmp_path / "file", to_read=True)
    (tmp_path / "file").write_bytes(b"half a rec")
    with closing(AppendOnlyFile(tmp_path / "file", to_read=True)) as file:
        assert (file.size, file.read(5, 99)) == (10, b"a rec")


def test_a_piece_that_finds_no_room_leaves_the_file_as_before(tmp_path):
    path = tmp_path / "file"
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    with closing(AppendOnlyFile(path)) as file:
        file.append(b"x" * 900)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
        try:
            with pytest.raises(OSError, match="File too large"):
                file.append(b"y" * 200)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
            signal.signal(signal.SIGXFSZ, ignored)
        assert path.read_bytes() == b"x" * 900
        file.append(b"z")
    assert path.read_bytes() == b"x" * 900 + b"z"


def test_the_rights_of_a_new_file(tmp_path):
    with closing(AppendOnlyFile(tmp_path / "file", mode=0o600)):
        assert os.stat(tmp_path / "file").st_mode & 0o777 == 0o600


def test_nothing_is_appended_to_a_file_that_is_also_elsewhere(tmp_path):
    (tmp_path / "mine").write_bytes(b"mine")
    os.link(tmp_path / "mine", tmp_path / "hard")
    (tmp_path / "link").symlink_to("mine")
    for name, words in (("hard", "is also a file elsewhere"), ("link", "is a link")):
        with pytest.raises(OSError, match=words):
            AppendOnlyFile(tmp_path / name)
    with closing(AppendOnlyFile(tmp_path / "hard", to_read=True)) as file:
        assert file.read(0, 9) == b"mine"
