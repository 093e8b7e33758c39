"""``kill -9`` at any moment: the search goes on and ends as it would have."""

import json
import random
import signal
import subprocess
import sys
import threading
import time
from http.client import HTTPException
from pathlib import Path
from typing import Any

import pytest

from hypernav.core.embodiment import Action
from hypernav.core.trace import without_timings
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import RobotLink, body_of
from servers.scripted import Asked, ScriptedServer

_STEPS = 70
_PROGRAM = "import sys; from hypernav.app.cli.main import main; main(sys.argv[1:])"


def first_offered(asked: Asked) -> str:
    """A model that goes to the first block, and is sure that the goal is not there."""
    return str(asked.allowed[0]) if asked.allowed and asked.kind == "choose block" else "no"


class ServerProcess:
    """`hypernav serve` in a process of its own, which can be killed and started again."""

    def __init__(self, state: Path, vlm: str) -> None:
        self._arguments = [
            *("serve", "--port", "0", "--state", str(state), "--vlm", vlm),
            *("--detector", "ground-truth", "--preset", "paper"),
        ]
        self.link = RobotLink(0)
        self.start()

    def start(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM, *self._arguments], stderr=subprocess.PIPE, text=True
        )
        assert self._process.stderr is not None
        line = next(line for line in self._process.stderr if "serving at" in line)
        self.link.port = int(line.partition("http://127.0.0.1:")[2].partition(",")[0])

    def kill(self) -> None:
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        assert self._process.stderr is not None
        self._process.stderr.close()


def patient(link: RobotLink, method: str, path: str, body: bytes = b"") -> Any:
    """The answer of a server that may be dead just now."""
    while True:
        try:
            answer = link.call(method, path, body)
        except (OSError, HTTPException):  # before its answer, or in the middle of it
            time.sleep(0.02)
        else:
            assert answer.status == 200, answer.content
            return answer.json


def driven(link: RobotLink, search: str) -> list[dict[str, Any]]:
    """The replies of a whole search; the robot repeats what was not answered."""
    room, replies = BoxRoom(), []
    while not replies or not replies[-1]["done"]:
        body = body_of(len(replies), room)
        reply = patient(link, "POST", f"{search}/observations", body)
        while reply["hold"]:
            reply = patient(link, "POST", f"{search}/observations", body)
        replies.append(reply)
        room.step(Action(reply["action"]))
    return replies


def trace_of(link: RobotLink, search: str) -> list[Any]:
    lines = link.call("GET", f"{search}/trace").content.decode().splitlines()
    return [without_timings(json.loads(line)) for line in lines]


@pytest.mark.slow
def test_ten_kills_change_nothing(tmp_path):
    rng = random.Random(16)
    with ScriptedServer(first_offered) as model:
        model.delay_s = 0.1
        runs, asked = [], []
        for name, kills in (("whole", 0), ("killed", 10)):
            model.requests.clear()
            server = ServerProcess(tmp_path / name, model.spec)
            search = server.link.open("unicorn", max_steps=_STEPS, deadline_s=0.3)

            def kill_often(server=server, kills=kills) -> None:
                for _ in range(kills):
                    time.sleep(rng.uniform(0.0, 0.8))
                    server.kill()
                    server.start()

            killing = threading.Thread(target=kill_often)
            killing.start()
            replies = driven(server.link, search)
            killing.join()
            runs.append((replies, trace_of(server.link, search)))
            asked.append(len(model.requests))
            server.kill()
    assert runs[0] == runs[1]
    assert len(runs[0][1]) == _STEPS
    # A question may be lost with the server before its answer is there, and is asked again.
    assert asked[0] <= asked[1] <= asked[0] + 10
    assert asked[0] > 3
