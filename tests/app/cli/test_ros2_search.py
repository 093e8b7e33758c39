"""What people see of a search on ROS 2 may get lost; the search goes on."""

from collections.abc import Generator, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
from rich.console import Console

from hypernav.app.cli.robots import ros2
from hypernav.app.cli.screen.views import Views
from hypernav.core.embodiment import Action
from hypernav.core.errors import LinkLostError, RosNetworkError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.trace import Mode, StepTrace
from hypernav.robot.client.links import HttpServer
from hypernav.robot.client.robot import Executed, Sensed
from hypernav.robot.client.robot_client import ClientStep, RobotClient
from hypernav.robot.wire.replies import Reply, SearchOpened, SearchState, Status

CAMERA = PinholeCamera.from_hfov(2, 2, 79.0)
HERE = Pose2(0.0, 0.0, 0.0)


class Client(RobotClient):
    """Four steps of a robot that turns on the spot."""

    def __init__(self) -> None:
        pass

    def __iter__(self) -> Generator[ClientStep, None, None]:
        for number in range(4):
            image = np.full((2, 2, 3), number, np.uint8)
            sensed = Sensed(image, np.ones((2, 2), np.float32), HERE, 0.0)
            reply = Reply(sequence=number, action=Action.TURN_LEFT, mode=Mode.EXPLORE)
            yield ClientStep(sensed, reply, Executed.DONE, blocked=False)


class Server(HttpServer):
    """Has one more step each time it is asked; its second answer gets lost."""

    def __init__(self) -> None:
        self.asked = 0

    def trace(self, search_id: str, *, since: int = 0) -> Iterator[StepTrace]:
        self.asked += 1
        if self.asked == 2:
            raise LinkLostError("the answer got lost")
        for step in range(since, self.asked):
            action, mode = Action.TURN_LEFT, Mode.EXPLORE
            yield StepTrace(step=step, pose=(0.0, 0.0, 0.0), action=action, mode=mode, reason="")

    def status(self, search_id: str, *, after: int = -1, wait_s: float = 0.0) -> Status:
        return Status(
            id=search_id,
            version=self.asked,
            goal="bed",
            words="",
            opened_s=0.0,
            state=SearchState.WAITING,
            next_sequence=self.asked,
        )

    def grid(self, search_id: str) -> OccupancyGrid:
        return OccupancyGrid(np.ones((1, 1), np.uint8), 0.05, (0.0, 0.0))


class Recorder:
    """Notes the steps, and which image each was recorded with."""

    def __init__(self) -> None:
        self.noted: list[tuple[int, int | None]] = []

    def add(self, step: StepTrace, grid: OccupancyGrid | None, observation: Any) -> None:
        image = None if observation is None else int(observation.rgb[0, 0, 0])
        self.noted.append((step.step, image))

    def finish(self, result: Mapping[str, Any]) -> None:
        pass

    def close(self) -> None:
        pass


class FullNetwork:
    """Outputs that nobody reads in time."""

    def publish(self, *_: object, **__: object) -> None:
        raise RosNetworkError("the buffer is full")


def test_a_lost_answer_and_a_full_network_end_no_search_and_are_told(caplog):
    recorder = Recorder()
    base: Any = SimpleNamespace(
        odometry=lambda: HERE,
        observation=lambda sensed: sensed.observation(CAMERA, Transform.identity()),
        sensors=SimpleNamespace(calibration=SimpleNamespace(frame="camera")),
    )
    opened = SearchOpened(id="0" * 32, next_sequence=0, version="", words="")
    status = Console(quiet=True).status("")
    network: Any = FullNetwork()
    ended = ros2._search(Client(), base, Server(), opened, network, Views([recorder], None), status)
    assert ended == (None, 0.0, None)
    assert recorder.noted == [(0, 0), (1, None), (2, 2), (3, 3)]
    assert "step 2 is not shown: the answer got lost" in caplog.text
    assert "step 3 is not shown: the buffer is full" in caplog.text
