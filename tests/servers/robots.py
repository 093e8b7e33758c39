"""A server of robots in this process, an agent whose every word is scripted, and a plain client."""

import http.client
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode, StepTrace
from hypernav.robot.server.guard import Access
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.server.searches.agents import AgentPlan, PlanAgent
from hypernav.robot.server.searches.searches import Searches
from hypernav.robot.server.serving import RobotServer, listening
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.requests import ObservationFacts, OpenSearch
from hypernav.robot.wire.values import PlanarPose
from hypernav.simulator.worlds.box_room import BoxRoom

TOKEN = "a-secret-of-many-characters"


@dataclass
class Script:
    """What the scripted agents of this process do.

    Attributes:
        gate: Agents wait for it before they answer, unless they look for something "quick".
        error: Error that they raise instead of answering.
        length: Number of steps after which they say that the goal is here.
        seen: Number of observations that they were shown.
    """

    gate: threading.Event = field(default_factory=threading.Event)
    error: Exception | None = None
    length: int = 1000
    seen: int = 0


SCRIPT = Script()


class ScriptedAgent:
    """Answers at once, whatever it sees; its map is one free cell."""

    def reset(self, goal: Goal) -> None:
        self._is_quick = goal.text == "quick"
        self._steps = 0
        self._trace: StepTrace | None = None

    def act(self, observation: Observation) -> Action:
        SCRIPT.seen += 1
        if not self._is_quick:
            SCRIPT.gate.wait()
        if SCRIPT.error is not None:
            raise SCRIPT.error
        action = Action.TURN_LEFT if self._steps % 3 else Action.MOVE_FORWARD
        action = Action.STOP if self._steps >= SCRIPT.length else action
        robot = observation.robot
        self._trace = StepTrace(
            step=self._steps,
            pose=(robot.x, robot.y, robot.yaw),
            action=action,
            mode=Mode.EXPLORE,
            reason=f"step {self._steps}",
            path=[(robot.x, robot.y), (1.0, 1.0)],
            ending=Ending.of(action),
        )
        self._steps += 1
        return action

    @property
    def last_step(self) -> StepTrace:
        assert self._trace is not None
        return self._trace

    @property
    def grid(self) -> OccupancyGrid:
        return OccupancyGrid(np.ones((1, 1), np.uint8), 0.05, (0.0, 0.0))


def scripted_plan(request: OpenSearch) -> AgentPlan:
    """The scripted agent, for any robot."""
    config = preset("default").model_copy(update={"embodiment": request.robot})
    return AgentPlan(config, ComponentSpecs(agent=request.agent or "servers.robots:ScriptedAgent"))


def real_plan(request: OpenSearch) -> AgentPlan:
    """The agent of this package, with ground truth."""
    config = preset("default").model_copy(update={"embodiment": request.robot})
    return AgentPlan(config, ComponentSpecs())


@contextmanager
def robot_server(
    state: Path,
    plan: PlanAgent = scripted_plan,
    *,
    token: str | None = None,
    limits: ServerLimits | None = None,
    port: int = 0,
    memory: Path | None = None,
) -> Iterator["RobotLink"]:
    """A server on a free port of this machine, or a given one, and a client of it."""
    access, limits = Access("127.0.0.1", token), limits or ServerLimits()
    with Searches(state, plan, limits) as searches, listening("127.0.0.1", port) as listener:
        server = RobotServer(searches, access, limits, memory)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        end = time.monotonic() + 10.0
        while not server.started and time.monotonic() < end:
            time.sleep(0.005)
        try:
            yield RobotLink(listener.getsockname()[1], token)
        finally:
            server.should_exit = server.force_exit = True
            thread.join(timeout=5.0)


class Answer:
    """An HTTP response."""

    def __init__(self, status: int, headers: dict[str, str], content: bytes) -> None:
        self.status = status
        self.headers = headers
        self.content = content

    @property
    def json(self) -> Any:
        return json.loads(self.content)


class RobotLink:
    """A plain HTTP client of a server of robots."""

    def __init__(self, port: int, token: str | None = None) -> None:
        self.port = port
        self.token = token

    def call(
        self, method: str, path: str, body: Any = b"", *, headers: dict[str, str] | None = None
    ) -> Answer:
        """One request; anything but bytes is sent as JSON."""
        sent = {} if self.token is None else {"authorization": f"Bearer {self.token}"}
        data = body
        if not isinstance(body, bytes):
            data, sent["content-type"] = json.dumps(body).encode(), "application/json"
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60.0)
        try:
            connection.request(method, path, data, sent | (headers or {}))
            response = connection.getresponse()
            names = {name.lower(): value for name, value in response.getheaders()}
            return Answer(response.status, names, response.read())
        finally:
            connection.close()

    def open(self, goal: str = "door", **values: Any) -> str:
        """Open a search for the robot of a `BoxRoom`; its path."""
        robot = BoxRoom().embodiment.model_dump()
        request = {"goal": goal, "labels": True, "embodiment": robot} | values
        answer = self.call("POST", "/v1/searches", request)
        assert answer.status == 201, answer.content
        return f"/v1/searches/{answer.json['id']}"

    def observe(self, search: str, body: bytes) -> Answer:
        """Send an observation."""
        return self.call("POST", f"{search}/observations", body)

    def answer(self, search: str, sequence: int) -> dict[str, Any]:
        """The answer to the last observation, however long it takes."""
        reply = self.call("GET", f"{search}/replies/{sequence}").json
        while reply["hold"]:
            reply = self.call("GET", f"{search}/replies/{sequence}").json
        return reply


def body_of(
    sequence: int, room: BoxRoom | None = None, *, depth: float | None = None, **facts: Any
) -> bytes:
    """An observation in a room as bytes; a depth given is that of every pixel."""
    seen = (room or BoxRoom()).observe()
    x, y = seen.robot.xy
    pose = PlanarPose(x=x, y=y, yaw=seen.robot.yaw)
    values = {"stamp_s": 0.1 * sequence, "base_to_odom": pose} | facts
    said = ObservationFacts(sequence=sequence, **values)
    far = seen.depth if depth is None else np.full_like(seen.depth, depth)
    noisy = seen.rgb.copy()
    noisy[0, :8] = 30 * (sequence % 8)  # no two images of a camera are the same
    noisy[0, 8:16] = sequence // 8 % 8 * 30
    return pack_observation(said, noisy, far, seen.truth)


def drive(
    link: RobotLink, search: str, room: BoxRoom, first: int = 0, most: int = 1000
) -> list[dict[str, Any]]:
    """Drive in a room as the server says, to the end or for some steps; the replies."""
    replies = []
    for sequence in range(first, first + most):
        body = body_of(sequence, room)
        reply = link.observe(search, body).json
        if reply["hold"]:
            reply = link.answer(search, sequence)
        replies.append(reply)
        if reply["done"]:
            break
        room.step(Action(reply["action"]))
    return replies
