"""Below a folder only regular files of its own are touched, whatever is put in their place."""

import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from hypernav.io.foreign_folder import ForeignFolder, NotOwnError


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "home" / "images").mkdir(parents=True)
    (tmp_path / "home" / "images" / "a").write_bytes(b"abc")
    with ForeignFolder(tmp_path / "home") as opened:
        yield opened


def test_files_are_written_read_listed_renamed_and_removed(folder):
    folder.write("b", "grüße")
    folder.write("b", b"\x00\xff")
    folder.make_folder("floor")
    folder.make_folder("floor")
    folder.write("floor/c", b"", sync=False)
    assert folder.read("b", most=2) == b"\x00\xff"
    assert folder.listing() == {"images": True, "b": False, "floor": True}
    folder.rename("images/a", "a.damaged")
    assert folder.listing("images") == {"a.damaged": False}
    folder.remove("floor/c")
    assert not folder.holds("floor/c")
    assert folder.holds("b")
    with pytest.raises(OSError, match="at most"):
        folder.read("b", most=1)


@pytest.mark.parametrize("name", ["../x", "images/../../x", "/etc/passwd", "images//a", "..", ""])
def test_no_name_leads_out(folder, name):
    for act in (folder.read, folder.remove, lambda name: folder.write(name, b"")):
        with pytest.raises(OSError, match="leads out of the folder"):
            act(name)


def test_links_are_neither_read_nor_written_nor_entered(folder, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "a").write_bytes(b"mine")
    (folder.path / "file").symlink_to(tmp_path / "mine" / "a")
    (folder.path / "photos").symlink_to(tmp_path / "mine")
    (folder.path / ".new.new").symlink_to(tmp_path / "mine" / "a")
    (folder.path / "none").symlink_to(tmp_path / "nowhere")
    for act in (
        lambda: folder.read("file"),
        lambda: folder.read("none"),
        lambda: folder.read("photos/a"),
        lambda: folder.remove("photos/a"),
        lambda: folder.rename("photos/a", "b"),
        lambda: folder.write("photos/b", b""),
        lambda: folder.write("new", b""),
        lambda: folder.descriptor_of("none", os.O_RDWR | os.O_CREAT),
        lambda: folder.make_folder("photos"),
        lambda: folder.listing("photos"),
        folder.listing,
    ):
        with pytest.raises(NotOwnError, match="is a link, expected a file"):
            act()
    folder.write("file", b"own")  # takes the place of the link
    assert (tmp_path / "mine" / "a").read_bytes() == b"mine"
    assert [one.name for one in (tmp_path / "mine").iterdir()] == ["a"]


def test_pipes_and_sockets_are_refused_at_once(folder):
    os.mkfifo(folder.path / "images" / "pipe")
    os.mkfifo(folder.path / "images" / ".b.new")
    for act in (
        lambda: folder.read("images/pipe"),
        lambda: folder.descriptor_of("images/pipe", os.O_WRONLY),
        lambda: folder.write("images/b", b""),
        lambda: folder.listing("images"),
    ):
        with pytest.raises(NotOwnError, match="is a pipe"):
            act()
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(folder.path / "s"))
        with pytest.raises(NotOwnError, match="s is a socket"):
            folder.read("s")


def test_a_hard_link_to_a_file_elsewhere_is_replaced_not_written(folder, tmp_path):
    (tmp_path / "mine").write_bytes(b"mine")
    for name in ("b", ".b.new"):
        os.link(tmp_path / "mine", folder.path / name)
    folder.write("b", b"own")
    assert (tmp_path / "mine").read_bytes() == b"mine"
    assert folder.read("b") == b"own"


def test_a_folder_that_is_swapped_while_it_is_read_leads_nowhere_else(folder, tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "b").write_bytes(b"theirs")
    assert folder.is_in_place()
    folder.path.rename(tmp_path / "moved")
    folder.path.symlink_to(tmp_path / "other")
    assert not folder.is_in_place()
    assert folder.read("images/a") == b"abc"
    assert not folder.holds("b")


def test_a_closed_folder_is_no_other_one(tmp_path):
    with ForeignFolder(tmp_path) as folder:
        folder.write("a", b"")
    assert not folder.is_in_place()
    with ForeignFolder(tmp_path), pytest.raises(OSError, match="Bad file descriptor"):
        folder.read("a")


def test_no_descriptor_is_left_open(folder):
    before = len(os.listdir("/dev/fd"))
    (folder.path / "link").symlink_to("images")
    for name in ("images/a", "images/none", "link/a", "images", "../x"):
        for act in (folder.read, folder.remove):
            with suppress(OSError):
                act(name)
    folder.write("images/b", b"")
    assert len(os.listdir("/dev/fd")) == before


def test_a_file_gets_its_name_once_its_content_is_on_the_disk(folder, monkeypatch):
    sync, replace, done = os.fsync, os.replace, list[str | int]()

    def noted_sync(descriptor):
        sync(descriptor)
        done.append(os.fstat(descriptor).st_size)

    def noted_replace(old, new, **where):
        replace(old, new, **where)
        done.append(new)

    monkeypatch.setattr(os, "fsync", noted_sync)
    monkeypatch.setattr(os, "replace", noted_replace)
    folder.write("images/a", bytes(300_000))
    assert done == [300_000, "a"]


WRITER = """
import itertools, sys
from pathlib import Path
from hypernav.io.foreign_folder import ForeignFolder
with ForeignFolder(Path(sys.argv[1])) as folder:
    for k in itertools.count():
        folder.write("file", b"%d" % (k % 10) * 200_000, sync=False)
        if k == 0:
            print("begun", flush=True)
"""


def test_a_kill_leaves_the_old_content_or_the_new_one(tmp_path):
    for _ in range(4):
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path)], stdout=subprocess.PIPE
        ) as writer:
            assert writer.stdout is not None
            writer.stdout.readline()
            writer.send_signal(signal.SIGKILL)
            writer.wait()
        content = (Path(tmp_path) / "file").read_bytes()
        assert len(content) == 200_000
        assert len(set(content)) == 1
