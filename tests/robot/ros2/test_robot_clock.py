"""A message's age is known although two clocks differ, drift, and the network delays everything."""

import math

import pytest

from hypernav.robot.ros2.guarded_output import RobotClock

AHEAD_S = 1.7e9
"""By how much the robot's clock is ahead of ours."""


class Clock:
    """Our clock, which a test moves."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


def heard(clock: Clock, robot: RobotClock, *, delay_s: float, seconds: float, rate: float) -> float:
    """Twenty messages a second with a delay; returns the age of the last when it arrives."""
    stamp_s = -math.inf
    for _ in range(round(seconds * 20)):
        clock.now_s += 0.05
        stamp_s = AHEAD_S + (clock.now_s - delay_s) * rate
        robot.hear(stamp_s)
    return robot.age_s(stamp_s)


def test_without_a_message_everything_is_old():
    assert RobotClock(clock=Clock()).age_s(AHEAD_S) == math.inf


def test_a_delay_that_all_messages_share_is_seen():
    clock = Clock()
    robot = RobotClock(clock=clock)
    assert heard(clock, robot, delay_s=0.02, seconds=10, rate=1.0) == pytest.approx(0.0, abs=1e-3)
    assert heard(clock, robot, delay_s=0.82, seconds=10, rate=1.0) == pytest.approx(0.8, abs=0.01)
    assert heard(clock, robot, delay_s=0.02, seconds=10, rate=1.0) == pytest.approx(0.0, abs=1e-3)


def test_silence_makes_old():
    clock = Clock()
    robot = RobotClock(clock=clock)
    heard(clock, robot, delay_s=0.02, seconds=1, rate=1.0)
    now_s = robot.now_s
    clock.now_s += 3.0
    assert robot.age_s(now_s) == pytest.approx(3.0)


@pytest.mark.parametrize("rate", [1.0 - 1e-4, 1.0 + 1e-4])
def test_clocks_that_drift_apart_make_nothing_old(rate):
    clock = Clock()
    robot = RobotClock(clock=clock)
    assert heard(clock, robot, delay_s=0.02, seconds=7200, rate=rate) < 0.01


def test_a_simulator_slower_than_real_time_grows_old_unless_that_is_said():
    clock = Clock()
    assert heard(clock, RobotClock(clock=clock), delay_s=0.02, seconds=60, rate=0.8) > 10.0
    told = RobotClock(0.5, clock=clock)
    assert heard(clock, told, delay_s=0.02, seconds=60, rate=0.8) < 0.01
    now_s = told.now_s
    clock.now_s += 3.0
    assert told.age_s(now_s) == pytest.approx(3.0)
