"""Components of a user's own that misbehave: named, with status 70, never taken for a result."""

import json

import pytest

from eval_runs import SMALL, write_room
from hostile.commands import check, run, start, wait

pytestmark = pytest.mark.slow

MODULE = """
import os, signal, sys, threading, time
import numpy as np
from hypernav import Action, Box, Detection

class Exits:
    def reset(self, goal): pass
    def act(self, observation): sys.exit(0)

class Leaves(Exits):
    def act(self, observation): os._exit(0)

class LeavesByFork(Exits):
    def act(self, observation):
        if os.fork() == 0:
            os._exit(0)
        assert os.wait()[1] == 0
        return Action.STOP

class Crashes(Exits):
    def act(self, observation): os.kill(os.getpid(), signal.SIGSEGV)

class Wanders(Exits):
    def act(self, observation):
        os.chdir("/")
        return Action.STOP

class Attributes(Exits):
    act = 5

class Lingers(Exits):
    def act(self, observation):
        threading.Thread(target=time.sleep, args=(600,), name="forgotten").start()

class Seven(Exits):
    def act(self, observation): return 7

class Alarms(Exits):
    def act(self, observation):
        signal.signal(signal.SIGALRM, lambda *_: sys.exit(0))
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        return Action.TURN_LEFT

class Nothing:
    def detect(self, observation, goal): return None

class Raises:
    def detect(self, observation, goal): raise KeyError("mine")

class Ends:
    def detect(self, observation, goal): sys.exit(0)

class Nan:
    def detect(self, observation, goal):
        return [Detection(Box(1, 1, 50, 50), float("nan"), "bed")]

class Boxes:
    def detect(self, observation, goal): return [Detection(Box(1, 1, 50, 50), 0.9, "bed")]

class Small:
    def segment(self, observation, box): return np.ones((10, 10), bool)

class Chooses:
    def choose(self, overview, goal, excluded): return None
"""
CASES = {
    ("--agent", "mine:Exits"): "--agent mine:Exits: act ended the program (SystemExit: 0, ",
    ("--agent", "mine:Alarms"): "a component ended the program (SystemExit: 0), outside a call",
    ("--agent", "mine:Seven"): "--agent mine:Seven: act returned 7; expected an Action",
    ("--agent", "sys:exit"): "sys:exit: its constructor ended the program",
    ("--agent", "exits:Thing"): "exits:Thing: its import ended the program",
    (
        "--detector",
        "mine:Nothing",
    ): "--detector mine:Nothing: detect returned None",
    ("--detector", "mine:Raises"): "--detector mine:Raises: detect raised (KeyError: 'mine', ",
    ("--detector", "mine:Ends"): "--detector mine:Ends: detect ended the program",
    (
        "--detector",
        "mine:Nan",
    ): "--detector mine:Nan: detect returned a list with a Detection with the sc",
    (
        "--detector",
        "mine:Boxes",
        "--segmenter",
        "mine:Small",
    ): "--segmenter mine:Small: segment",
    (
        "--reasoner",
        "mine:Chooses",
    ): "--reasoner mine:Chooses: choose returned None",
}


@pytest.fixture
def folder(tmp_path):
    write_room(tmp_path / "room.glb")
    (tmp_path / "mine.py").write_text(MODULE)
    (tmp_path / "exits.py").write_text("raise SystemExit(0)")
    return tmp_path


@pytest.mark.parametrize("options", CASES, ids=" ".join)
def test_it_is_named_with_what_it_did(options, folder):
    ended = run(["find", "lamp", "--scene", "room.glb", "--out", "out", *options, *SMALL], folder)
    check(ended, 70, f"hypernav: {CASES[options]}")
    assert "should not have happened" not in ended.err
    assert not (folder / "out" / "result.json").exists()


def test_what_is_no_component_is_the_users_mistake(folder):
    ended = run(
        ["find", "bed", "--scene", "room.glb", "--out", "out", "--agent", "builtins:int"], folder
    )
    check(ended, 2, "builtins:int: expected a class or a function of your own")


@pytest.mark.parametrize(
    ("agent", "did"),
    [
        ("Exits", "act ended the program"),
        ("Leaves", "ended the process of a worker with status 0, as os._exit does"),
        ("Crashes", r"its process was killed by signal 11 (SIGSEGV)"),
    ],
)
def test_an_evaluation_never_takes_it_for_the_simulators_fault(agent, did, folder):
    command = ["eval", "scene:room.glb#2", "--out", "out", "--workers", "1", *SMALL]
    ended = run([*command, "--agent", f"mine:{agent}"], folder, seconds=100)
    check(ended, 70, "hypernav: a component of your own failed in 3 episodes, last in room.glb/")
    check(ended, 70, f"--agent mine:{agent}: {did}")
    assert not (folder / "out" / "episodes.jsonl").exists()
    assert len(json.loads((folder / "out" / "sessions.jsonl").read_text())["crashes"]) == 3


def test_an_agent_whose_method_is_none_is_the_users_mistake(folder):
    options = ["--scene", "room.glb", "--out", "out", "--agent", "mine:Attributes", *SMALL]
    check(run(["find", "lamp", *options], folder), 2, "mine:Attributes is no Agent: it has no act")


def test_a_working_directory_that_it_changes_moves_no_results(folder):
    options = ["--scene", "room.glb", "--out", "out", "--agent", "mine:Wanders", *SMALL]
    ended = run(["find", "lamp", *options], folder)
    assert ended.status == 1
    assert "open out/index.html" in ended.err
    assert {"index.html", "result.json", "episode.mp4"} <= {
        path.name for path in (folder / "out").iterdir()
    }


def test_a_process_that_it_forks_may_end_as_it_likes(folder):
    options = ["--scene", "room.glb", "--out", "out", "--agent", "mine:LeavesByFork", *SMALL]
    assert run(["find", "lamp", *options], folder).status == 1
    assert (folder / "out" / "index.html").exists()


def test_a_thread_that_it_forgets_keeps_no_process_alive(folder):
    options = ["--scene", "room.glb", "--out", "out", "--agent", "mine:Lingers", *SMALL]
    ended = wait(start(["find", "lamp", *options], folder), seconds=300)
    check(ended, 1, "hypernav: ended although a component has left a thread running: forgotten")
    assert (folder / "out" / "index.html").exists()
