import errno
import os
import re
from pathlib import Path

import pytest

from hypernav.app.cli.guards.crashes import OutOfMemoryError, ReportedCrashError, crash_report
from hypernav.core.errors import ConfigError, CrashError, OutputError


def test_the_traceback_is_in_the_folder(tmp_path):
    folder = tmp_path / "new" / "folder"
    with pytest.raises(ReportedCrashError, match="KeyError: 'seven'"), crash_report(folder):
        raise KeyError("seven")
    assert 'raise KeyError("seven")' in (folder / "crash.txt").read_text()


@pytest.mark.parametrize(
    "put", [Path.symlink_to, Path.hardlink_to, lambda path, _: os.mkfifo(path)]
)
def test_what_a_stranger_put_in_its_place_is_replaced(put, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_text("kept")
    (tmp_path / "folder").mkdir()
    put(tmp_path / "folder" / "crash.txt", elsewhere)
    with pytest.raises(ReportedCrashError, match=r"crash\.txt"), crash_report(tmp_path / "folder"):
        raise KeyError("seven")
    assert elsewhere.read_text() == "kept"
    assert 'raise KeyError("seven")' in (tmp_path / "folder" / "crash.txt").read_text()


@pytest.mark.parametrize("folder", [None, Path("/dev/null/below")])
def test_without_a_folder_it_is_in_a_temporary_file(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(ReportedCrashError) as caught, crash_report(folder):
        raise KeyError("seven")
    named = re.search(r"\S+\.txt", str(caught.value))
    assert named is not None
    assert 'raise KeyError("seven")' in Path(named[0]).read_text()


def test_where_nothing_can_be_written_the_message_says_so(monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", "/dev/null")
    with pytest.raises(ReportedCrashError, match="could not be written"), crash_report():
        raise KeyError("seven")


def test_the_traceback_of_another_process_is_kept(tmp_path):
    with pytest.raises(ReportedCrashError, match=r"worker 3.*crash\.txt"), crash_report(tmp_path):
        raise CrashError("worker 3 failed", "line 12 of that program")
    assert "line 12 of that program" in (tmp_path / "crash.txt").read_text()


@pytest.mark.parametrize(
    ("number", "remedy"),
    [(errno.ENOSPC, "free some"), (errno.EDQUOT, "free some"), (errno.EFBIG, "ulimit -f")],
)
def test_too_little_room_for_a_file_is_no_error_of_this_program(number, remedy, tmp_path):
    with pytest.raises(OutputError, match=f"cannot be written.*{remedy}"), crash_report(tmp_path):
        raise OSError(number, os.strerror(number))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("error", [ConfigError("wrong"), KeyboardInterrupt(), SystemExit(0)])
def test_what_is_no_crash_passes(error, tmp_path):
    with pytest.raises(type(error)), crash_report(tmp_path):
        raise error
    assert not list(tmp_path.iterdir())


def test_a_crash_inside_is_reported_once(tmp_path):
    with pytest.raises(ReportedCrashError, match=r"inner.crash\.txt"):  # noqa: SIM117
        with crash_report(tmp_path / "outer"), crash_report(tmp_path / "inner"):
            raise KeyError("seven")
    assert [path.name for path in tmp_path.iterdir()] == ["inner"]


def test_too_little_memory_is_no_error_of_this_program(tmp_path):
    with pytest.raises(OutOfMemoryError, match=r"out of memory \(768 KiB\).*ulimit"):  # noqa: SIM117
        with crash_report(tmp_path):
            raise MemoryError("768 KiB")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "error",
    [
        ImportError("lib.so: failed to map segment from shared object: Operation not permitted"),
        RuntimeError("a cause of itself"),
    ],
)
def test_what_is_no_lack_of_memory_is_a_crash(error, tmp_path):
    with pytest.raises(ReportedCrashError), crash_report(tmp_path):
        raise error from error


@pytest.mark.parametrize(
    "error",
    [
        ImportError("libblas.so: failed to map segment from shared object"),
        OSError(errno.ENOMEM, "refused"),
        RuntimeError("can't start new thread"),
        RuntimeError("(-4:Insufficient memory) Failed to allocate 8294400 bytes"),  # OpenCV
    ],
)
def test_neither_is_memory_that_the_system_refuses_to_a_library(error, tmp_path):
    with pytest.raises(OutOfMemoryError, match="out of memory"), crash_report(tmp_path):
        raise OSError("could not find the library") from error  # as llvmlite does
    assert not list(tmp_path.iterdir())
