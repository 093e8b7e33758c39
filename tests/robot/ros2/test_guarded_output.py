"""Commands go to the robot only as long as somebody means them and it is safe."""

import math
import threading
import time
from contextlib import closing, nullcontext

import pytest

from hypernav.core.errors import RosNetworkError, TransformMissingError
from hypernav.robot.driving.base import STANDSTILL, Velocity
from hypernav.robot.ros2.drives import given_back
from hypernav.robot.ros2.guarded_output import GuardedOutput, RobotClock

FORWARD = Velocity(0.5)


class Wheels:
    """Remembers what it was told."""

    def __init__(self) -> None:
        self.told: list[Velocity] = []
        self.changed = threading.Condition()

    def __call__(self, velocity: Velocity) -> None:
        with self.changed:
            self.told.append(velocity)
            self.changed.notify_all()

    def wait_for_more_than(self, count: int) -> bool:
        with self.changed:
            return self.changed.wait_for(lambda: len(self.told) > count, timeout=30.0)

    def wait_for(self, velocity: Velocity) -> bool:
        with self.changed:
            return self.changed.wait_for(lambda: self.told[-1:] == [velocity], timeout=30.0)


def test_a_command_holds_for_a_moment_without_another():
    wheels = Wheels()
    with closing(GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True)) as output:
        output.command(FORWARD)
        assert wheels.told == [FORWARD]
        assert wheels.wait_for(STANDSTILL)


def test_what_is_not_safe_is_not_sent():
    wheels, safe = Wheels(), threading.Event()
    with closing(GuardedOutput(wheels, STANDSTILL, is_safe=safe.is_set)) as output:
        output.command(FORWARD)
        assert wheels.told[-1] == STANDSTILL
        safe.set()
        output.command(FORWARD)
        assert wheels.told[-1] == FORWARD
        safe.clear()
        assert wheels.wait_for(STANDSTILL)


@pytest.mark.parametrize("error", [RosNetworkError("gone"), TransformMissingError("no tf")])
def test_what_cannot_be_sent_for_a_while_is_tried_again(error):
    wheels, fails = Wheels(), threading.Event()

    def send(velocity):
        if fails.is_set():
            raise error
        wheels(velocity)

    with closing(GuardedOutput(send, STANDSTILL, is_safe=lambda: True)) as output:
        output.command(FORWARD)
        fails.set()
        output.command(FORWARD)
        fails.clear()
        assert wheels.wait_for(STANDSTILL)


def test_after_the_end_nothing_but_standstill_is_sent():
    wheels = Wheels()
    output = GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True)
    output.command(FORWARD)
    output.close()
    output.command(FORWARD)
    assert wheels.told[-1] == STANDSTILL


def test_standing_it_falls_silent_so_that_others_may_drive():
    wheels = Wheels()
    with closing(GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True)) as output:
        output.command(FORWARD)
        output.command(STANDSTILL)
        time.sleep(1.0)
        told = len(wheels.told)
        assert 2 <= told <= 11
        time.sleep(0.3)
        assert len(wheels.told) == told


def test_standstill_is_said_on_until_the_robot_stands_and_again_when_it_moves():
    wheels, stands = Wheels(), threading.Event()
    with closing(
        GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True, is_standing=stands.is_set)
    ) as output:
        output.command(FORWARD)
        output.halt()
        time.sleep(1.0)
        assert len(wheels.told) > 13
        stands.set()
        time.sleep(0.3)
        told = len(wheels.told)
        time.sleep(0.3)
        assert len(wheels.told) == told
        stands.clear()
        assert wheels.wait_for_more_than(told)
        stands.set()


def test_nothing_is_said_before_the_first_command():
    wheels, stands = Wheels(), threading.Event()
    with closing(
        GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True, is_standing=stands.is_set)
    ):
        time.sleep(0.3)
        assert wheels.told == []
        stands.set()


@pytest.mark.slow
def test_a_robot_that_drives_on_at_the_end_is_an_error():
    wheels = Wheels()
    output = GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True, is_standing=lambda: False)
    output.command(FORWARD)
    with pytest.raises(RosNetworkError, match="told to stand still, but its odometry shows motion"):
        output.close()
    assert wheels.told[-1] == STANDSTILL


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_a_robot_that_drives_on_hides_no_other_error(error, caplog):
    class Robot:
        def close(self) -> None:
            raise RosNetworkError("it does not stand")

    with pytest.raises(RosNetworkError, match="it does not stand"), given_back(Robot()):
        pass
    assert caplog.text == ""
    with pytest.raises(error), given_back(Robot()):
        raise error
    assert "it does not stand" in caplog.text


class HeldRobot:
    """Stands while standstill is said, and a few looks longer; gives up its goal after so often."""

    def __init__(self, gives_up_after: int) -> None:
        self._gives_up_after = gives_up_after
        self._silent_looks = 0
        self.told = 0

    def __call__(self, velocity: Velocity) -> None:
        assert velocity == STANDSTILL
        self._silent_looks = 0
        self.told += 1

    def is_standing(self) -> bool:
        self._silent_looks += 1
        return self.told >= self._gives_up_after or self._silent_looks <= 5


@pytest.mark.parametrize(
    ("gives_up_after", "is_in_time"),
    [(10, True), (15, True), pytest.param(999, False, marks=pytest.mark.slow)],
)
def test_a_robot_that_only_its_hold_makes_stand_does_not_stand(gives_up_after, is_in_time):
    robot = HeldRobot(gives_up_after)
    output = GuardedOutput(
        robot, STANDSTILL, is_safe=lambda: True, is_standing=robot.is_standing, silence_s=1.0
    )
    with nullcontext() if is_in_time else pytest.raises(RosNetworkError, match="shows motion"):
        output.close()
    assert robot.told >= min(gives_up_after, 11)


def test_the_last_word_is_standstill():
    wheels = Wheels()
    output = GuardedOutput(wheels, STANDSTILL, is_safe=lambda: True)
    output.command(FORWARD)
    output.close()
    assert wheels.told[-1] == STANDSTILL


@pytest.mark.parametrize(
    ("refused", "is_told"), [(3, True), pytest.param(1000, False, marks=pytest.mark.slow)]
)
def test_the_last_standstill_is_tried_again_and_its_failure_is_an_error(refused, is_told):
    wheels, left = Wheels(), 0

    def send(velocity: Velocity) -> None:
        nonlocal left
        if left > 0:
            left -= 1
            raise RosNetworkError("the buffer is full")
        wheels(velocity)

    output = GuardedOutput(send, STANDSTILL, is_safe=lambda: True)
    output.command(FORWARD)
    left = refused
    with nullcontext() if is_told else pytest.raises(RosNetworkError, match="could not be told"):
        output.close()
    assert (wheels.told[-1] == STANDSTILL) is is_told


def test_what_the_network_does_not_take_is_said_once_and_tried_again(caplog):
    wheels, works = Wheels(), threading.Event()

    def send(velocity: Velocity) -> None:
        if not works.is_set():
            raise RosNetworkError("the buffer is full")
        wheels(velocity)

    with closing(GuardedOutput(send, STANDSTILL, is_safe=lambda: True)) as output:
        output.command(STANDSTILL)
        time.sleep(1.0)  # longer than standstill is said
        works.set()
        assert wheels.wait_for(STANDSTILL)
        output.command(FORWARD)
        assert wheels.told[-1] == FORWARD
    assert [record.message for record in caplog.records] == [
        "the robot is not told how to drive: the buffer is full; trying again"
    ]


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
