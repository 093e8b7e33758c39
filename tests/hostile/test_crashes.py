"""Errors that nobody expected: one line, a file with the traceback, and never status 1.

An agent breaks the simulated world, since errors of its own are named as its own.
"""

import json

import pytest

from eval_runs import SMALL, write_room
from hostile.commands import check, run

pytestmark = pytest.mark.slow

BROKEN = """
import os

from hypernav.simulator.worlds.simulation import SimulatedWorld

class Broken:
    def __init__(self):
        where = os.environ["BREAK_AT"]
        if where == "build":
            raise RuntimeError("first line\\nsecond line " + "x" * 5000)
        step, left = SimulatedWorld.step, int(where)

        def broken_step(world, action):
            nonlocal left
            if left == 0:
                return 1 / 0
            left -= 1
            return step(world, action)

        SimulatedWorld.step = broken_step

    def reset(self, goal):
        pass

    def act(self, observation):
        return 2
"""


@pytest.fixture
def folder(tmp_path):
    write_room(tmp_path / "room.glb")
    (tmp_path / "broken.py").write_text(BROKEN)
    return tmp_path


def find(folder, where):
    command = ["find", "bed", "--scene", "room.glb", "--out", "out", "--agent", "broken:Broken"]
    return run([*command, *SMALL], folder, environment={"BREAK_AT": where}, seconds=60)


def test_a_crash_in_a_search_is_one_line_and_a_file(folder):
    ended = find(folder, "3")
    check(ended, 70, "ZeroDivisionError: division by zero", "out/crash.txt")
    assert ended.err.splitlines()[-1].startswith("hypernav: this should not have happened")
    kept = (folder / "out" / "crash.txt").read_text()
    assert "return 1 / 0" in kept
    assert "broken:Broken" in kept
    assert len((folder / "out" / "trace.jsonl").read_text().splitlines()) == 3


def test_a_crash_before_the_search_is_one_line_however_long_its_words_are(folder):
    ended = find(folder, "build")
    check(ended, 70, "RuntimeError: first line second line", "out/crash.txt")
    assert len(ended.err.splitlines()[-1]) < 1000


def test_a_crash_in_an_evaluation_ends_it_with_its_tracebacks(folder):
    command = ["eval", "scene:room.glb#2", "--agent", "broken:Broken", "--out", "out", *SMALL]
    ended = run([*command, "--workers", "1"], folder, environment={"BREAK_AT": "0"}, seconds=100)
    check(ended, 70, "ZeroDivisionError", "out/crash.txt")
    assert (folder / "out" / "crash.txt").read_text().count("return 1 / 0") == 3
    session = json.loads((folder / "out" / "sessions.jsonl").read_text())
    assert session["ended"].startswith("stopped: the program failed in 3 episodes")
    assert len(session["crashes"]) == 3
