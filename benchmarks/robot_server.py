"""Time that a server of robots takes for an observation, beside a model.

One robot after the other: a server in a process of its own answers depth and poses recorded in a
simulated furnished house, over HTTP and over WebSocket. Then 4, 8, 16 and 24 robots send one every
200 ms; they begin one after the other, and a server that is busy refuses some of them. They send
bodies that were encoded before, so they take little; the processor time of the server and that of
the robots (Linux) say more than the clock where other programs run as well. At last, the parts of
an observation in this process, without network and disk.

    python benchmarks/robot_server.py DATA      # DATA holds episodes/small_house.npz
"""

import http.client
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import connect

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.embodiment import Embodiment
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels
from hypernav.robot.server.searches.agents import AgentPlan
from hypernav.robot.server.searches.decisions import Decisions
from hypernav.robot.server.searches.journal import SearchRecord
from hypernav.robot.wire.frames import decode_observation, pack_observation, unpack_observation
from hypernav.robot.wire.requests import ObservationFacts, OpenSearch
from hypernav.robot.wire.values import PlanarPose

STEPS = 100
ROBOTS = (4, 8, 16, 24)
PERIOD_S = 0.2
_BEGIN_S = 0.3
"""Time between the beginnings of two robots."""

Ask = Callable[[bytes], dict]


def recorded(data: Path) -> list[bytes]:
    """Observations of a search, as bytes; the goal is never in sight."""
    run = np.load(data / "episodes" / "small_house.npz")
    nothing = LabelledPixels(np.full((480, 640), -1, np.int32), dict[int, ObjectLabel]())
    rng, bodies = np.random.default_rng(0), []
    for number in range(STEPS):
        depth = run["depth_mm"][number].astype(np.float32) / 1000.0
        shade = np.clip(depth * 50.0, 0, 235)[..., None] + rng.integers(0, 20, (480, 640, 3))
        x, y, yaw = (float(value) for value in run["xy_yaw"][number])
        pose = PlanarPose(x=x, y=y, yaw=yaw)
        facts = ObservationFacts(
            sequence=number,
            stamp_s=number * PERIOD_S,
            base_to_odom=pose,
            blocked=number % 20 > 0,  # a recorded robot doesn't turn as it is told
        )
        bodies.append(pack_observation(facts, shade.astype(np.uint8), depth, nothing))
    return bodies


@contextmanager
def served() -> Iterator[tuple[int, int]]:
    """A server in a process of its own; its port, and the number of the process."""
    with tempfile.TemporaryDirectory() as state:
        program = "import sys; from hypernav.app.cli.main import main; main(sys.argv[1:])"
        options = ["--port", "0", "--state", state, "--max-searches", "64"]
        command = [sys.executable, "-c", program, "serve", *options]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
            try:
                assert server.stderr is not None
                line = next(line for line in server.stderr if "serving" in line)
                yield int(line.split("http://127.0.0.1:")[1].split(",")[0]), server.pid
            finally:
                server.terminate()


class BusyError(Exception):
    """The server opens no other search."""


class Link:
    """One connection to the server, kept open."""

    def __init__(self, port: int) -> None:
        """Connect to a port of this machine."""
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60.0)

    def call(self, path: str, body: bytes) -> dict:
        """Post, and read the answer."""
        self._connection.request("POST", path, body, {"content-type": "application/json"})
        response = self._connection.getresponse()
        content = json.loads(response.read())
        if content.get("error") == "busy":
            raise BusyError(content["message"])
        assert response.status in (200, 201), content
        return content

    def open(self) -> str:
        """Open a search; its path."""
        request = {
            "goal": "unicorn",
            "labels": True,
            "embodiment": Embodiment().model_dump(),
            "deadline_s": 30.0,
            "max_steps": 10_000,
        }
        return f"/v1/searches/{self.call('/v1/searches', json.dumps(request).encode())['id']}"


def times_ms(ask: Ask, bodies: list[bytes]) -> list[float]:
    """Time from sending an observation to having its answer, milliseconds each."""
    times = []
    for body in bodies:
        start = time.perf_counter()
        reply = ask(body)
        times.append((time.perf_counter() - start) * 1e3)
        if reply["done"]:
            break
    return times


def over_http(port: int, bodies: list[bytes]) -> list[float]:
    """Times over HTTP."""
    link = Link(port)
    search = link.open()
    times = times_ms(lambda body: link.call(f"{search}/observations", body), bodies)
    link.call(f"{search}/close", b"")
    return times


def over_websocket(port: int, bodies: list[bytes]) -> list[float]:
    """Times over a WebSocket."""
    search = Link(port).open()
    with connect(f"ws://127.0.0.1:{port}{search}/stream", proxy=None, compression=None) as socket:

        def ask(body: bytes) -> dict:
            socket.send(body)
            return json.loads(socket.recv())["reply"]

        times = times_ms(ask, bodies)
    Link(port).call(f"{search}/close", b"")
    return times


def together(port: int, bodies: list[bytes], robots: int) -> tuple[list[float], list[str]]:
    """Times of several robots at a fixed rate, and what those were told who were refused."""
    times: list[float] = []
    refused: list[str] = []

    def drive(number: int) -> None:
        begin = time.perf_counter() + number * (_BEGIN_S + PERIOD_S / robots)
        time.sleep(max(begin - time.perf_counter(), 0.0))
        link = Link(port)
        try:
            search = link.open()
        except BusyError as busy:
            refused.append(str(busy))
            return
        begin = time.perf_counter()
        for number, body in enumerate(bodies):
            time.sleep(max(begin + number * PERIOD_S - time.perf_counter(), 0.0))
            times.extend(times_ms(lambda body: link.call(f"{search}/observations", body), [body]))
        link.call(f"{search}/close", b"")

    threads = [threading.Thread(target=drive, args=(number,)) for number in range(robots)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return times, refused


def processor_ms(process: int) -> float:
    """Processor time that a process has taken, milliseconds; NaN where the system does not say."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return float("nan")
    return (int(fields[11]) + int(fields[12])) * 1e3 / os.sysconf("SC_CLK_TCK")


@contextmanager
def said(what: str, process: int) -> Iterator[list[float]]:
    """Print one line of figures about the times that the block adds."""
    times: list[float] = []
    before, robots = processor_ms(process), time.process_time()
    yield times
    each = (processor_ms(process) - before) / len(times)
    robots = (time.process_time() - robots) * 1e3 / len(times)
    median, late = np.percentile(times, [50, 95])
    print(
        f"{what:26} {len(times):4} observations  median {median:6.1f} ms  95% {late:6.1f} ms  "
        f"most {max(times):6.1f} ms  processor {each:5.1f} ms each, robots {robots:4.1f} ms"
    )


def parts_ms(bodies: list[bytes]) -> dict[str, float]:
    """Median processor time of the parts of an observation, milliseconds."""
    request = OpenSearch(goal="unicorn", labels=True)
    config, specs = HyPerNavConfig(), ComponentSpecs()
    record = SearchRecord(
        id="0" * 32, opened_s=0.0, version="", words="", request=request, specs=specs, config=config
    )
    times = defaultdict[str, list[float]](list)

    def timed(name: str, work: Callable[..., Any], *given: Any) -> Any:
        begin = time.process_time()
        result = work(*given)
        times[name].append((time.process_time() - begin) * 1e3)
        return result

    with tempfile.TemporaryDirectory() as folder:
        plan = AgentPlan(config=config, specs=specs)
        decisions = Decisions(record, plan.build(Goal(request.goal), Path(folder)))
        to_base = request.embodiment.camera.camera_to_base
        for body in bodies:
            packed = timed("header", unpack_observation, body)
            timed("images", decode_observation, packed, request.camera, to_base)
            seen = timed("images and checks", decisions.check, packed)
            step, _ = timed("decision", decisions.decide, packed, seen)
            timed("record as JSON", step.model_dump_json)
        decisions.close(None)
    return {name: float(np.median(taken)) for name, taken in times.items()}


def main() -> None:
    """Measure and print."""
    bodies = recorded(Path(sys.argv[1]))
    print(f"{len(bodies[0]) // 1000} kB an observation, {os.cpu_count()} cores")
    with served() as (port, process):
        over_http(port, bodies[:20])  # loads the compiled kernels
        with said("one robot, HTTP", process) as times:
            times += over_http(port, bodies)
        with said("one robot, WebSocket", process) as times:
            times += over_websocket(port, bodies)
        for robots in ROBOTS:
            with said(f"{robots} robots, one each {PERIOD_S * 1e3:.0f} ms", process) as times:
                found, refused = together(port, bodies, robots)
                times += found
            late = sum(one > PERIOD_S * 1e3 for one in times)
            print(
                f"    {late} answers came later; {len(refused)} robots were refused", *refused[:1]
            )
    parts_ms(bodies[:20])  # loads the compiled kernels
    parts = "  ".join(f"{name} {taken:.1f}" for name, taken in parts_ms(bodies).items())
    print(f"of an observation, processor ms: {parts}")


if __name__ == "__main__":
    main()
