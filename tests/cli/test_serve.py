"""`hypernav serve`: its options, and how it begins and ends."""

import signal
import subprocess
import sys

import pytest

from hypernav.cli.command_line import run_command
from hypernav.core.errors import ConfigError, MissingExtraError
from servers.robots import RobotLink, body_of


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--host", "0.0.0.0"], "--token-file"),
        (["--host", "not an address"], "--token-file"),
        (["--port", "70000"], "--port"),
        (["--max-searches", "0"], "--max-searches"),
        (["--token-file", "nowhere"], "--token-file nowhere"),
        (["--record", "r.jsonl"], "--record"),
        (["--detector", "no-such"], "no-such"),
        (["--set", "search.speed=3"], "speed"),
    ],
)
def test_mistakes_are_said_before_anything_is_served(options, words, tmp_path):
    with pytest.raises(ConfigError, match=words):
        run_command(["serve", "--state", str(tmp_path), *options])


def test_a_missing_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "websockets", None)
    with pytest.raises(MissingExtraError, match=r"hypernav\[robot\]"):
        run_command(["serve", "--state", str(tmp_path)])


def test_nobody_loads_the_server_unasked():
    program = "import hypernav, hypernav.cli.main, hypernav.build.agents, sys; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert not {"fastapi", "uvicorn", "websockets", "starlette"} & set(loaded.stdout.split())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_the_searches_stay(tmp_path, number):
    program = "import sys; from hypernav.cli.main import main; main(sys.argv[1:])"
    arguments = ["serve", "--port", "0", "--state", str(tmp_path), "--detector", "ground-truth"]
    with subprocess.Popen(
        [sys.executable, "-c", program, *arguments],
        stderr=subprocess.PIPE,
        text=True,
        # A shell that runs tests in the background hands down SIGINT as ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as server:
        assert server.stderr is not None
        line = next(line for line in server.stderr if "serving at" in line)
        link = RobotLink(int(line.partition("http://127.0.0.1:")[2].partition(",")[0]))
        search = link.open(deadline_s=0.05, preset="paper")
        assert link.observe(search, body_of(0)).status == 200
        server.send_signal(number)
        said = server.stderr.read()
        assert server.wait(timeout=60.0) == 128 + number
    assert "Traceback" not in said
    folder = tmp_path / "searches" / search.rpartition("/")[2]
    assert (folder / "observations.bin").stat().st_size > 0
    assert not (folder / "end.json").exists()
