"""At the start a robot is told that nobody reads its velocities, or that others send some."""

from contextlib import closing
from types import SimpleNamespace
from typing import Any, cast

import pytest

from hypernav.core.errors import RosNetworkError
from hypernav.robot.driving.base import Velocity
from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.network import Quality, Ros2Network
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_base import VelocityPublisher
from loopback import DOMAIN, LOOPBACK

SENSORS = cast(Ros2Sensors, SimpleNamespace(robot_now_s=1.0))


@pytest.fixture(autouse=True)
def _loopback(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)


def publisher(network: Ros2Network) -> VelocityPublisher:
    return VelocityPublisher("/wheels", network, Ros2Config(), SENSORS)


def test_velocities_of_another_type_than_the_robot_reads_are_named():
    with closing(Ros2Network(DOMAIN)) as robot, closing(Ros2Network(DOMAIN)) as ours:
        robot.subscribe("/wheels", ros.TwistStamped, Quality.RELIABLE, lambda _: None)
        with pytest.raises(
            RosNetworkError,
            match=r"nobody reads '/wheels' as Twist .*read as geometry_msgs/\w*/?TwistStamped",
        ):
            publisher(ours).await_wheels(1.0)


def test_velocities_that_nobody_reads_are_named():
    with (
        closing(Ros2Network(DOMAIN)) as ours,
        pytest.raises(RosNetworkError, match=r"would not move.*topics\.cmd_vel"),
    ):
        publisher(ours).await_wheels(0.2)


def test_others_who_drive_are_named(caplog):
    read: list[Any] = []
    with closing(Ros2Network(DOMAIN)) as robot, closing(Ros2Network(DOMAIN)) as ours:
        robot.subscribe("/wheels", ros.Twist, Quality.RELIABLE, read.append)
        wheels = publisher(ours)
        wheels.await_wheels(10.0)
        assert caplog.text == ""
        joystick = robot.publisher("/wheels", ros.Twist)
        while ours.publishers("/wheels") == 0:
            joystick.publish(ros.Twist())
        wheels.await_wheels(10.0)
        wheels.publish(Velocity(0.1))
    assert "1 other publisher(s) on '/wheels'" in caplog.text
