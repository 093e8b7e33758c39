"""The limits that hostile cases run under are limits: who exceeds one is noticed."""

import signal

import pytest

from hostile.commands import check, run, start, wait

GREEDY = """
import time

class Hungry:
    def __init__(self):
        self.meal = b"x" * 300_000_000

class Sleepy:
    def __init__(self):
        time.sleep(60)

class Clumsy:
    def __init__(self):
        print("\\x1b[2J")
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "greedy.py").write_text(GREEDY)
    return tmp_path


def test_a_mistake_keeps_to_every_limit(folder):
    ended = run(["fnd", "bed"], folder)
    check(ended, 2, "did you mean 'find'?")
    assert ended.peak_mb < 150


def test_too_much_memory_is_noticed(folder):
    ended = run(["find", "bed", "--agent", "greedy:Hungry"], folder, memory_mb=200)
    with pytest.raises(AssertionError):
        check(ended, ended.status)


def test_too_much_time_is_noticed(folder):
    ended = run(["find", "bed", "--agent", "greedy:Sleepy"], folder, seconds=0.5)
    assert ended.status == -signal.SIGKILL
    with pytest.raises(AssertionError):
        check(ended, ended.status)


def test_control_characters_are_noticed(folder):
    ended = run(["find", "bed", "--agent", "greedy:Clumsy"], folder)
    with pytest.raises(AssertionError):
        check(ended, ended.status)


def test_a_child_has_its_own_folder_environment_and_file_limit(folder):
    program = "import os; print(os.getcwd(), os.environ['WHO'], flush=True)\n"
    (folder / "told.py").write_text(program + "open('big', 'wb').write(bytes(2_000_000))\n")
    ended = run(
        ["find", "bed", "--agent", "told:Nobody"], folder, environment={"WHO": "me"}, file_mb=1
    )
    assert f"{folder} me" in ended.out
    assert (folder / "big").stat().st_size <= 2**20


def test_a_process_of_its_own_keeps_to_the_same_rules(folder):
    check(wait(start(["fnd", "bed"], folder)), 2, "did you mean 'find'?")


@pytest.mark.slow
def test_a_process_that_takes_too_long_is_noticed(folder):
    ended = wait(start(["find", "bed", "--agent", "greedy:Sleepy"], folder), seconds=3)
    assert ended.status == -signal.SIGKILL
    with pytest.raises(AssertionError):
        check(ended, ended.status)
