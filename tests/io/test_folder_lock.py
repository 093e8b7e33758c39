"""One process at a time, and none that was killed."""

import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress

import pytest

from hypernav.core.errors import RunFolderError
from hypernav.io.folder_lock import folder_lock

HOLDER = """
import sys, time
from pathlib import Path
from hypernav.io.folder_lock import folder_lock
with folder_lock(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_the_message_names_who_holds_the_lock_and_a_killed_process_holds_none(tmp_path):
    command = [sys.executable, "-c", HOLDER, str(tmp_path / "out")]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        told = rf"in use by another run \(process {holder.pid} on .+another --state"
        with (
            pytest.raises(RunFolderError, match=told),
            folder_lock(tmp_path / "out", option="--state"),
        ):
            pass
        holder.send_signal(signal.SIGKILL)
        holder.wait()
    with folder_lock(tmp_path / "out"):
        pass


def test_within_one_process_too_and_again_afterwards(tmp_path):
    told = rf"process {os.getpid()} on "
    with folder_lock(tmp_path), pytest.raises(RunFolderError, match=told), folder_lock(tmp_path):
        pass
    with folder_lock(tmp_path):
        pass


def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").touch()
    with (
        pytest.raises(RunFolderError, match=r"cannot be written \(.+\); make .+ another --out"),
        folder_lock(tmp_path / "file" / "in"),
    ):
        pass


def test_the_folder_comes_open(tmp_path):
    with folder_lock(tmp_path / "new") as folder:
        folder.write("file", b"content")
    assert (tmp_path / "new" / "file").read_bytes() == b"content"


def test_a_lock_waits_as_long_as_it_may(tmp_path):
    held = folder_lock(tmp_path)
    held.__enter__()
    release = threading.Timer(0.2, held.__exit__, (None, None, None))
    release.start()
    with folder_lock(tmp_path, patience_s=20.0):
        release.join()


@pytest.mark.parametrize("name", [".lock", ".lock.owner"])
@pytest.mark.parametrize("is_hard", [True, False])
def test_neither_lock_nor_owner_is_written_through_a_link(tmp_path, name, is_hard):
    mine, folder = tmp_path / "mine", tmp_path / "folder"
    mine.write_text("mine")
    folder.mkdir()
    if is_hard:
        os.link(mine, folder / name)
    else:
        (folder / name).symlink_to(mine)
    with suppress(RunFolderError), folder_lock(folder):
        pass
    assert mine.read_text() == "mine"
