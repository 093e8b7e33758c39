"""`hypernav serve`: its options, and how it begins and ends."""

import errno
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from hypernav.app.build.memories.building_memory import open_memory
from hypernav.app.cli.command_line import run_command
from hypernav.core.errors import (
    ConfigError,
    MemoryFolderError,
    MissingExtraError,
    ModelError,
    OutputError,
    RunFolderError,
)
from hypernav.core.geometry.transforms import Transform
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import Answer, RobotLink, body_of


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--host", "0.0.0.0"], "--token-file"),
        (["--host", "not an address"], "--token-file"),
        (["--port", "70000"], "--port"),
        (["--max-searches", "0"], "--max-searches"),
        (["--token-file", "nowhere"], "--token-file nowhere"),
        (["--detector", "no-such"], "no-such"),
        (["--set", "search.speed=3"], "speed"),
        (["--memory", "home", "--memory-mb", "0"], "--memory-mb"),
        (["--relocalize"], "add --memory FOLDER"),
        (["--memory-mb", "5"], "add --memory FOLDER"),
        (["--similarity", "local:nowhere"], "--similarity compares .* add --memory FOLDER"),
        (["--memory", "home", "--agent", "servers.robots:ScriptedAgent"], "keeps no memory"),
        (
            ["--memory", "home", "--similarity", "local:x", "--set", "search.recall=false"],
            "--similarity local:x would never be asked: .*search.recall",
        ),
    ],
)
def test_mistakes_are_said_before_anything_is_served(options, words, tmp_path):
    with pytest.raises(ConfigError, match=words):
        run_command(["serve", "--state", str(tmp_path), *options])


def test_a_model_that_is_not_there_is_said_before_anything_is_served(tmp_path):
    with pytest.raises(ModelError, match=r"nofile\.onnx"):
        run_command(["serve", "--state", str(tmp_path), "--detector", "yolox:nofile.onnx"])


def test_a_folder_of_other_files_gets_none_of_a_memory(tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    (home / "letter.txt").write_text("dear")
    with pytest.raises(MemoryFolderError, match=r"holds other files \(letter\.txt\)"):
        run_command(["serve", "--state", str(tmp_path / "state"), "--memory", str(home)])
    assert [path.name for path in home.iterdir()] == ["letter.txt"]


def test_a_broken_memory_is_said_before_anything_is_served(tmp_path):
    (tmp_path / "memory.json").write_text("{")
    with pytest.raises(MemoryFolderError, match=r"memory\.json is broken"):
        run_command(["serve", "--state", str(tmp_path / "state"), "--memory", str(tmp_path)])


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A robot's memory after one image."""
    return remembered(tmp_path / "home")


def remembered(folder: Path, **place: Any) -> Path:
    with open_memory(folder) as memory:
        seen = BoxRoom().observe()
        memory.begin(Goal("door"), seen, **place).floor.map.integrate(seen)
        memory.end("found", steps=1)
    return folder


def served(tmp_path: Path, home: Path) -> None:
    run_command(["serve", "--state", str(tmp_path / "state"), "--memory", str(home)])


def test_a_memory_that_was_learned_in_simulation_is_refused_before_a_robot_comes(tmp_path):
    home = remembered(tmp_path / "home", building="house", map_to_scene=Transform.identity())
    with pytest.raises(MemoryFolderError, match=r"of house, which is simulated; name another"):
        served(tmp_path, home)


def test_a_memory_of_which_a_file_can_not_be_read_is_said_before_anything_is_served(tmp_path, home):
    (state,) = home.glob("floor-1/state-*.npz")
    state.unlink()
    state.mkdir()
    with pytest.raises(MemoryFolderError, match=r"state-1\.npz is a folder"):
        served(tmp_path, home)


def test_a_memory_that_could_not_be_saved_is_said_before_anything_is_served(
    tmp_path, home, monkeypatch
):
    def read_only(*, dir: Path):
        raise PermissionError(errno.EACCES, "Permission denied")

    state = tmp_path / "state"
    state.mkdir()
    make = tempfile.TemporaryFile
    monkeypatch.setattr(
        "tempfile.TemporaryFile",
        lambda *, dir: read_only(dir=dir) if dir == home else make(dir=dir),
    )
    with pytest.raises(OutputError, match=r"home cannot be written \(Permission denied\)"):
        served(tmp_path, home)


def test_what_is_damaged_of_a_memory_is_said_at_the_start(tmp_path, home, monkeypatch, capsys):
    (state,) = home.glob("floor-1/state-*.npz")
    state.write_bytes(b"no archive")
    monkeypatch.setattr("hypernav.robot.server.serving.serve", lambda *args, **options: None)
    served(tmp_path, home)
    assert "the map of floor 1 is damaged" in " ".join(capsys.readouterr().err.split())


def test_a_memory_that_another_program_uses_is_not_read_at_the_start(tmp_path, home, monkeypatch):
    """It may be saving to it: what is half replaced would be taken for damaged."""
    monkeypatch.setattr("hypernav.app.cli.serve._PATIENCE_S", 0.0)
    with open_memory(home), pytest.raises(RunFolderError, match=r"in use .* another --memory"):
        served(tmp_path, home)


def test_a_memory_is_free_again_once_the_server_has_read_it(tmp_path, home, monkeypatch):
    def serve(*args, **options):
        open_memory(home).close()

    monkeypatch.setattr("hypernav.robot.server.serving.serve", serve)
    served(tmp_path, home)


def test_a_missing_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "websockets", None)
    with pytest.raises(MissingExtraError, match=r"hypernav\[robot\]"):
        run_command(["serve", "--state", str(tmp_path)])


def test_nobody_loads_the_server_unasked():
    imports = "import hypernav, hypernav.app.cli.main, hypernav.app.build.agents"
    program = f"{imports}, sys; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert not {"fastapi", "uvicorn", "websockets", "starlette"} & set(loaded.stdout.split())


@dataclass
class Ended:
    """A server in a process of its own that was ended by a signal while requests waited."""

    number: int
    status: int
    said: str
    modules: set[str]
    folder: Path
    waited: list[Answer]


@pytest.fixture(
    scope="module",
    params=[pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM],
    ids=["SIGINT", "SIGTERM"],
)
def ended(request, tmp_path_factory) -> Ended:
    state = tmp_path_factory.mktemp("state")
    program = (
        "import atexit, sys; atexit.register(lambda: print(*sys.modules))\n"
        "from hypernav.app.cli.main import main; main(sys.argv[1:])"
    )
    arguments = ["serve", "--port", "0", "--state", str(state), "--detector", "ground-truth"]
    with subprocess.Popen(
        [sys.executable, "-c", program, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell that runs tests in the background hands down SIGINT as ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as server:
        assert server.stderr is not None
        line = next(line for line in server.stderr if "serving at" in line)
        link = RobotLink(int(line.partition("http://127.0.0.1:")[2].partition(",")[0]))
        search = link.open(deadline_s=30.0, preset="paper")
        assert link.observe(search, body_of(0)).json["hold"] is False
        version = link.call("GET", search).json["version"]
        polls = [
            ("GET", f"{search}?after={version}&wait_s=30"),
            ("POST", "/v1/robots/anna/wait?wait_s=5"),
        ]
        with ThreadPoolExecutor() as pool:
            waiting = [pool.submit(link.call, *poll) for poll in polls]
            while not link.call("GET", "/v1/robots").json:
                time.sleep(0.01)
            server.send_signal(request.param)
            output, said = server.communicate(timeout=60.0)
            waited = [answer.result() for answer in waiting]
    folder = state / "searches" / search.rpartition("/")[2]
    return Ended(request.param, server.returncode, said, set(output.split()), folder, waited)


def test_a_signal_ends_it_and_the_searches_stay(ended):
    assert ended.status == 128 + ended.number
    assert (ended.folder / "observations.bin").stat().st_size > 0
    assert not (ended.folder / "end.json").exists()


def test_requests_that_wait_are_answered_at_its_end(ended):
    assert [answer.status for answer in ended.waited] == [200, 200]
    assert "Traceback" not in ended.said
    assert "ERROR" not in ended.said


def test_it_loads_nothing_of_the_simulator(ended):
    assert "hypernav.robot.server.searches.search" in ended.modules
    simulator = {name for name in ended.modules if name.startswith("hypernav.simulator.worlds.")}
    assert simulator == {
        "hypernav.simulator.worlds.config"
    }  # settings, which each configuration has
    assert not any(name.startswith("hypernav.simulator.houses") for name in ended.modules)


def test_a_new_memory_is_not_begun_before_the_first_search(tmp_path, monkeypatch):
    monkeypatch.setattr("hypernav.robot.server.serving.serve", lambda *args, **options: None)
    served(tmp_path, tmp_path / "new")
    assert not (tmp_path / "new").exists()
