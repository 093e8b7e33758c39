"""What people see of a search on ROS 2 may get lost; the search goes on."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from hypernav.cli.robots import ros2
from hypernav.core.actions import Action
from hypernav.core.errors import LinkLostError, RosNetworkError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Mode, StepTrace
from hypernav.robot.client.robot import Sensed

HERE = Pose2(0.0, 0.0, 0.0)
STEPS = 4


def steps() -> Iterator[Any]:
    """What a client says of each step."""
    sensed = Sensed(np.zeros((2, 2, 3), np.uint8), np.ones((2, 2), np.float32), HERE, 0.0)
    for number in range(STEPS):
        reply = SimpleNamespace(sequence=number, mode="explore", reason="", ending=None)
        yield SimpleNamespace(reply=reply, sensed=sensed)


class Server:
    """Has one more step each time it is asked; its second answer gets lost."""

    def __init__(self) -> None:
        self.asked = 0

    def trace(self, search_id: str, *, since: int) -> Iterator[StepTrace]:
        self.asked += 1
        if self.asked == 2:
            raise LinkLostError("the answer got lost")
        for step in range(since, self.asked):
            action, mode = Action.TURN_LEFT, Mode.EXPLORE
            yield StepTrace(step=step, pose=(0.0, 0.0, 0.0), action=action, mode=mode, reason="")

    def grid(self, search_id: str) -> OccupancyGrid:
        return OccupancyGrid(np.ones((1, 1), np.uint8), 0.05, (0.0, 0.0))


def test_a_lost_answer_and_a_full_network_end_no_search():
    recorded: list[int] = []
    published: list[int] = []

    def publish(trace: StepTrace, *_: object, **__: object) -> None:
        published.append(trace.step)
        if trace.step == 2:
            raise RosNetworkError("nobody reads the images")

    recorder = SimpleNamespace(record=lambda trace, *_: recorded.append(trace.step))
    sensors = SimpleNamespace(calibration=SimpleNamespace(frame="camera"))
    parts: list[Any] = [
        steps(),
        SimpleNamespace(odometry=lambda: HERE, sensors=sensors),
        Server(),
        SimpleNamespace(id="a"),
        SimpleNamespace(publish=publish),
        recorder,
        SimpleNamespace(update=lambda _: None),
    ]
    assert ros2._search(*parts) == (None, 0.0)
    assert recorded == published == [0, 1, 2, 3]
