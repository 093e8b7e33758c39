"""A limit in which libraries don't load is refused before they do."""

import subprocess
import sys

import pytest

from eval_runs import SMALL, write_room

PROGRAM = """
import resource, sys
size = int(sys.argv.pop(1)) * 2**20
resource.setrlimit(resource.RLIMIT_AS, (size, size))
from hypernav.app.cli.main import main
main()
"""


@pytest.mark.parametrize("megabytes", [400, 700, 1200])
def test_a_small_one_is_named(megabytes: int) -> None:
    command = [sys.executable, "-c", PROGRAM, str(megabytes), "find", "bed"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"hypernav: this process may take {megabytes} MB of addresses")
    assert ended.stderr.count("\n") == 1


def test_help_needs_less() -> None:
    command = [sys.executable, "-c", PROGRAM, "700", "find", "--help"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode == 0


@pytest.mark.slow
def test_an_evaluation_in_little_more_ends(tmp_path) -> None:
    scene, out = write_room(tmp_path / "room.glb"), tmp_path / "out"
    command = [sys.executable, "-c", PROGRAM, "1526", "eval", f"scene:{scene}#1", "--out", out]
    command += ["--workers", "1", "--max-steps", "30", *SMALL]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    is_done = ended.returncode == 0 and "2 of 2 episodes done" in ended.stdout + ended.stderr
    assert is_done or ended.stderr.splitlines()[-1].startswith("hypernav: ")
