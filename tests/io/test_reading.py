import errno
import os
import socket
from pathlib import Path

import pytest

from hypernav.io.reading import MOST_BYTES, Allowance, check_file, path_below, read_file, text_of


def test_a_file_is_read_whole(tmp_path):
    (tmp_path / "a").write_bytes(b"abc")
    assert read_file(tmp_path / "a", most=3) == b"abc"
    check_file(tmp_path / "a", most=3)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_text_comes_without_its_mark(encoding):
    assert text_of("Küche 床".encode(encoding)) == "Küche 床"


def test_what_is_no_text_is_an_error_or_replaced():
    with pytest.raises(UnicodeDecodeError):
        text_of(b"\xff")
    assert text_of(b"a\xff", errors="replace") == "a\ufffd"


@pytest.mark.parametrize("read", [read_file, check_file])
def test_what_is_no_file_of_limited_size_is_refused_at_once(tmp_path, read):
    os.mkfifo(tmp_path / "pipe")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "s"))
        for path, words in (
            (Path("/dev/zero"), "it is a device"),
            (tmp_path / "pipe", "it is a pipe"),
            (tmp_path / "s", "socket|No such device"),
            (tmp_path, "it is a folder|Is a directory"),
            (tmp_path / "nowhere", "No such file"),
        ):
            with pytest.raises(OSError, match=words):
                read(path)
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(OSError, match="it has 2,000 MB, at most 2,000 MB are read"):
        read(tmp_path / "sparse")
    with pytest.raises(OSError, match="at most 5 MB are read"):
        read(tmp_path / "sparse", most=5_000_000)


@pytest.mark.parametrize(
    ("at", "code"), [("/dev/zero", errno.EINVAL), ("pipe", errno.EINVAL), (".", errno.EISDIR)]
)
def test_what_is_no_file_has_the_number_of_its_error(tmp_path, at, code):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="expected a file") as refused:
        check_file(tmp_path / at)
    assert refused.value.errno == code


@pytest.mark.parametrize("reference", ["a.png", "textures/a.png", "textures/../a.png", "./a.png"])
def test_references_into_the_folder_are_followed(tmp_path, reference):
    assert path_below(tmp_path, reference) == tmp_path / os.path.normpath(reference)


@pytest.mark.parametrize(
    "reference", ["../a.png", "/dev/zero", "a/../../b", "..", "a\0b", "\ud800", "a\nb"]
)
def test_references_out_of_the_folder_and_impossible_ones_are_refused(tmp_path, reference):
    with pytest.raises(OSError, match=r"outside the folder|no name can have"):
        path_below(tmp_path, reference)


def test_an_allowance_holds_for_everything_together():
    allowance = Allowance()
    allowance.spend(MOST_BYTES - 10, "this")
    allowance.spend(10, "that")
    with pytest.raises(OSError, match=r"one more would take .* MB, all of a file at most 2,000 MB"):
        allowance.spend(1, "one more")
