"""One process at a time, and none that was killed."""

import os
import signal
import subprocess
import sys

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
