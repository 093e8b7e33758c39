"""`hypernav find` with views beside its page and video."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import urllib.request

import pytest
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from box_scenes import room_glb
from hypernav.app.cli.main import main
from hypernav.app.cli.options.agent import ViewOptions
from hypernav.app.cli.screen import views as opening
from hypernav.core.errors import ConfigError
from mcap_files import counts_of
from rrd_files import images_in

SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120")
_PROTOCOL = Subprotocol("foxglove.sdk.v1")
COMMAND = (sys.executable, "-c", "from hypernav.app.cli.main import main; main()", "find")


@pytest.fixture(scope="module")
def glb(tmp_path_factory):
    """A room with a bed as a GLB whose nodes carry the names."""
    return room_glb(tmp_path_factory.mktemp("scene") / "room.glb")


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.fixture
def without(monkeypatch):
    """Makes packages ones that are not installed."""

    def take_away(*names):
        for name in names:
            monkeypatch.setitem(sys.modules, name, None)

    return take_away


@pytest.mark.slow
def test_a_recorded_search_has_the_trace_of_an_unrecorded_one(glb, tmp_path):
    search = ("find", "bed", "--scene", glb, "--seed", 5, "--quiet", "--max-steps", 15)
    plain = hypernav(*search, "--out", tmp_path / "a", *SMALL)
    files = ("--mcap", tmp_path / "b.mcap", "--rrd", tmp_path / "b.rrd")
    assert hypernav(*search, "--out", tmp_path / "b", *files, *SMALL) == plain
    traces = [(tmp_path / name / "trace.jsonl").read_bytes() for name in ("a", "b")]
    assert traces[0] == traces[1]
    steps = traces[0].count(b"\n")
    assert counts_of(tmp_path / "b.mcap")["/camera/image"] == steps
    assert images_in(tmp_path / "b.rrd") == steps


def test_two_recordings_never_share_a_file(tmp_path):
    same = tmp_path / "folder" / ".." / "a.rrd"
    with pytest.raises(ConfigError, match="each needs its own file"):
        opening.check_views(ViewOptions(rrd=tmp_path / "a.rrd", mcap=same))


@pytest.mark.slow
def test_ctrl_c_leaves_files_that_open(glb, tmp_path):
    files = ("--mcap", str(tmp_path / "a.mcap"), "--rrd", str(tmp_path / "a.rrd"))
    options = ("piano", "--scene", str(glb), "--out", str(tmp_path / "out"), "--pace", "10")
    with _started(*options, *files) as process:
        trace = tmp_path / "out" / "trace.jsonl"
        while process.poll() is None and not (trace.exists() and trace.read_text().count("\n") > 2):
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.05)
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    steps = trace.read_text().count("\n")
    assert 2 < steps < 500
    assert counts_of(tmp_path / "a.mcap")["/step"] == steps
    assert images_in(tmp_path / "a.rrd") == steps


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--mcap", "x.mcap"), "pip install 'hypernav[foxglove]'"),
        (("--view", "foxglove"), "pip install 'hypernav[foxglove]'"),
        (("--rrd", "x.rrd"), "pip install 'hypernav[rerun]'"),
        (("--view", "rerun"), "pip install 'hypernav[rerun]'"),
        (("--view", "page"), "pip install 'hypernav[robot]'"),
    ],
)
def test_a_missing_package_is_named_with_its_extra(options, words, glb, tmp_path, without, capsys):
    without("foxglove", "rerun", "uvicorn")
    assert hypernav("find", "bed", "--scene", glb, "--out", tmp_path / "out", *options) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--mcap", "--rrd", "--record"])
@pytest.mark.parametrize(
    "place", [".", "fifo", "loop", "loop/below", "file/below", "x" * 300, "/dev/full", "/dev/null"]
)
def test_what_no_file_can_be_is_refused_before_the_search(option, place, glb, tmp_path, capsys):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    out = tmp_path / "out"
    assert hypernav("find", "bed", "--scene", glb, option, tmp_path / place, "--out", out) == 2
    said = capsys.readouterr().err
    assert said.startswith("hypernav: ")
    assert said.count("\n") == 1
    assert not out.exists()


def test_an_impossible_pace_is_refused(glb, tmp_path, capsys):
    assert hypernav("find", "bed", "--scene", glb, "--out", tmp_path, "--pace", 0) == 2
    assert "--pace" in capsys.readouterr().err


@pytest.mark.slow
def test_a_search_waits_for_foxglove_and_sends_it_every_step(glb, tmp_path, monkeypatch, capsys):
    """A client of the protocol takes the place of the program, which has no screen here."""
    waiting, steps = threading.Event(), []

    class Told(opening.Views):
        def await_watchers(self, status):
            self.url = "ws://" + self.watched[0].address.partition("ws://")[2].partition(" ")[0]
            watcher = threading.Thread(target=watch, args=(self.url,), daemon=True)
            watcher.start()
            super().await_watchers(status)
            waiting.set()

        def stay(self, console):
            gone.wait(30)

    gone = threading.Event()

    def watch(url):
        with connect(url, subprotocols=[_PROTOCOL], max_size=None) as socket:
            for message in socket:
                if isinstance(message, str):
                    said = json.loads(message)
                    topics = {c["topic"]: c["id"] for c in said.get("channels", [])}
                    if "/step" in topics:
                        asked = {"id": 7, "channelId": topics["/step"]}
                        socket.send(json.dumps({"op": "subscribe", "subscriptions": [asked]}))
                    continue
                steps.append(json.loads(message[13:]))
                if steps[-1]["ending"]:
                    break
        gone.set()

    monkeypatch.setattr("hypernav.app.cli.screen.views.Views", Told)
    options = ("--view", "foxglove", "--pace", 1000, "--quiet")
    assert hypernav("find", "bed", "--scene", glb, "--out", tmp_path, *options, *SMALL) == 0
    assert waiting.is_set()
    assert "open " in capsys.readouterr().err  # although it is quiet
    assert [step["step"] for step in steps] == list(range(len(steps)))
    assert steps[-1]["ending"] == "found"


@pytest.mark.slow
def test_stop_on_the_page_ends_the_search_as_ctrl_c_does(glb, tmp_path):
    options = ("piano", "--scene", str(glb), "--out", str(tmp_path / "out"), "--view", "page")
    with _started(*options) as process:
        try:
            url = _line_with("open http", process).split()[1]
            request = urllib.request.Request(
                f"{url}v1/stop",
                data=b'{"reason": "enough"}',
                headers={"content-type": "application/json"},
            )
            urllib.request.urlopen(f"{url}v1/searches", timeout=60).close()  # a page is open
            trace = tmp_path / "out" / "trace.jsonl"
            while process.poll() is None and trace.read_text().count("\n") < 2:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(0.05)
            urllib.request.urlopen(request, timeout=60).close()
            _line_with("until Ctrl-C", process)
            process.send_signal(signal.SIGINT)
            assert process.wait(60) == 130
        finally:
            process.kill()
    assert json.loads((tmp_path / "out" / "result.json").read_text())["outcome"] == "interrupted"


def _started(*options: str) -> subprocess.Popen[str]:
    """A search in a process of its own that heeds SIGINT, which a shell's jobs don't."""
    return subprocess.Popen(
        [*COMMAND, *options, *SMALL],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def _line_with(words: str, process: subprocess.Popen[str]) -> str:
    """The next line of standard error that holds some words; others pass."""
    assert process.stderr is not None
    for line in process.stderr:
        if words in line:
            return line
    raise AssertionError(f"the command ended without saying '{words}'")


@pytest.mark.parametrize("option", ["--mcap", "--rrd", "--record"])
def test_a_file_that_the_search_itself_writes_is_refused(option, tmp_path, capsys):
    out = tmp_path / "out"
    with pytest.raises(SystemExit) as ended:
        main(["find", "bed", "--out", str(out), option, f"{tmp_path}/./out/trace.jsonl"])
    assert ended.value.code == 2
    assert "is written by the search itself" in capsys.readouterr().err
    assert not out.exists()
