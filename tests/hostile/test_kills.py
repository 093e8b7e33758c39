"""Signals at any moment: what was done stays, and an evaluation loses and doubles nothing."""

import json
import os
import random
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from eval_runs import SMALL, write_room
from hostile.commands import check, start, wait

FIND = ("--agent", "tired:Tired", "--max-steps", "400", *SMALL)
EPISODES = 24
Process = subprocess.Popen[str]


@pytest.fixture
def folder(tmp_path, tired):
    write_room(tmp_path / "room.glb")
    shutil.copy(tired, tmp_path)
    return tmp_path


def lines_of(path: Path) -> int:
    return path.read_bytes().count(b"\n") if path.exists() else 0


def minds_signals(process: Process, folder: Path) -> bool:
    """Whether the program has come so far that it decides itself what SIGTERM does."""
    caught = Path(f"/proc/{process.pid}/status").read_text().partition("SigCgt:")[2].split()
    return bool(caught) and bool(int(caught[0], 16) >> (signal.SIGTERM - 1) & 1)


def has_steps(count: int) -> Callable[[Process, Path], bool]:
    return lambda process, folder: lines_of(folder / "out" / "trace.jsonl") >= count


def writes_result(process: Process, folder: Path) -> bool:
    return (folder / "out" / "result.json").exists()


def send_when(
    process: Process,
    number: signal.Signals,
    ready: Callable[[Process, Path], bool],
    folder: Path,
    later_s: float = 0.0,
) -> None:
    deadline = time.monotonic() + 60
    while process.poll() is None and not ready(process, folder) and time.monotonic() < deadline:
        time.sleep(0.002)
    time.sleep(later_s)
    process.send_signal(number)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("ready", "later_s"),
    [(minds_signals, 0.0), (minds_signals, 0.1), (minds_signals, 0.4), (minds_signals, 1.0)],
)
def test_a_search_in_its_first_second_ends_in_a_line(number, ready, later_s, folder):
    process = start(["find", "door", "--scene", "room.glb", "--out", "out", *FIND], folder)
    send_when(process, number, ready, folder, later_s)
    check(wait(process, seconds=60), 128 + number, "hypernav: ")


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("ready", "later_s"), [(has_steps(1), 0.0), (has_steps(12), 0.03), (writes_result, 0.0)]
)
def test_a_search_leaves_what_it_has(number, ready, later_s, folder):
    # The last moment, the writing of the page, comes by itself after a few steps.
    steps = "4" if ready is writes_result else "400"
    command = ["find", "door", "--scene", "room.glb", "--out", "out", *FIND, "--max-steps", steps]
    process = start(command, folder)
    send_when(process, number, ready, folder, later_s)
    check(wait(process, seconds=60), 128 + number, "index.html")
    result = json.loads((folder / "out" / "result.json").read_text())
    trace = (folder / "out" / "trace.jsonl").read_text().splitlines()
    assert result["outcome"] == ("not_found" if ready is writes_result else "interrupted")
    assert result["steps"] - 1 <= len(trace) <= result["steps"]
    assert [json.loads(line)["step"] for line in trace] == list(range(len(trace)))
    assert "</html>" in (folder / "out" / "index.html").read_text()
    assert (folder / "out" / "episode.mp4").stat().st_size > 0


def children_of(process: Process) -> list[int]:
    tasks = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [int(child) for child in tasks.read_text().split()]


@pytest.mark.slow
@pytest.mark.parametrize("later_s", [0.0, 0.3, 0.8, 1.6])
def test_ctrl_c_while_workers_import_is_one_line(later_s, folder):
    """A terminal sends it to all processes of a command, so to its workers as well."""
    command = ["eval", "scene:room.glb#4", "--out", "out", "--workers", "2", *FIND]
    process = start(command, folder)
    deadline = time.monotonic() + 60
    while not (children := children_of(process)) and time.monotonic() < deadline:
        time.sleep(0.002)
    time.sleep(later_s)
    for one in {*children, *children_of(process), process.pid}:
        with suppress(ProcessLookupError):
            os.kill(one, signal.SIGINT)
    ended = wait(process, seconds=60)
    check(ended, 130, "hypernav: interrupted")
    assert ended.err.count("\n") <= 3, ended.err


@pytest.mark.slow
def test_a_killed_evaluation_goes_on_without_loss_or_double(folder):
    """Killed eight times, by every signal and at every stage, and then left alone."""
    rng = random.Random(12)
    out = folder / "out"
    command = ["eval", f"scene:room.glb#{EPISODES // 2}", "--agent", "tired:Tired", "--out", "out"]
    command += ["--max-steps", "12", "--workers", "2", *SMALL]
    starts = 0
    for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGKILL) * 2:
        sessions, episodes = lines_of(out / "sessions.jsonl"), lines_of(out / "episodes.jsonl")
        begun = rng.random() < 0.75
        later = episodes + rng.randrange(4)

        def ready(process: Process, _: Path, begun=begun, sessions=sessions, later=later) -> bool:
            if not begun:
                return minds_signals(process, folder)
            return (
                lines_of(out / "sessions.jsonl") > sessions
                and lines_of(out / "episodes.jsonl") >= later
            )

        process = start(command, folder)
        send_when(process, number, ready, folder, later_s=0.3 * rng.random())
        status = -signal.SIGKILL if number is signal.SIGKILL else 128 + number
        ended = wait(process, seconds=60)
        check(ended, [0, status])
        if ended.status == 0:
            break
        starts += begun
        assert lines_of(out / "sessions.jsonl") >= starts
    check(wait(start(command, folder), seconds=100), 0, f"{EPISODES} of {EPISODES} episodes done")
    records = [json.loads(line) for line in (out / "episodes.jsonl").read_text().splitlines()]
    keys = [(record["scene_id"], record["episode_id"]) for record in records]
    assert len(keys) == len(set(keys)) == EPISODES
    assert all(record["steps"] for record in records)
    endings = [json.loads(s)["ended"] for s in (out / "sessions.jsonl").read_text().splitlines()]
    assert endings[-1] == "finished"
    assert {"interrupted", "killed, or still running"} <= set(endings)
