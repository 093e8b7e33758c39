"""What a client does when the server is late, lost or wrong, and when someone presses stop."""

import math
import threading
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.errors import (
    ContractError,
    LinkLostError,
    RequestRefusedError,
    SensorError,
    ServerUnreachableError,
)
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.robot.client.links import HttpServer, ServerAddress
from hypernav.robot.client.robot import Executed
from hypernav.robot.client.robot_client import Patience, RobotClient, Watchdog
from hypernav.robot.wire.frames import unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding
from robot_links import StandIn
from servers.scripted import closed_port

Corners = Sequence[tuple[float, float]]


class Script:
    """A link that answers from a list; an error in it is raised."""

    def __init__(self, *answers: Reply | Exception) -> None:
        self.answers = list(answers)
        self.asked: list[int] = []
        self.asked_again = 0
        self.given_up: list[str] = []

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        assert unpack_observation(body).header.sequence == sequence
        self.asked.append(sequence)
        return self._next()

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        self.asked_again += 1
        return self._next()

    def give_up(self, reason: str) -> None:
        self.given_up.append(reason)

    def close(self) -> None:
        return None

    def _next(self) -> Reply:
        answer = self.answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer


def go(sequence: int) -> Reply:
    return Reply(sequence=sequence, action=Action.MOVE_FORWARD)


def end(sequence: int) -> Reply:
    return Reply(sequence=sequence, action=Action.STOP, done=True, ending=SearchEnding.FOUND)


def refusal(error: str, expected: int | None = None, status: int = 409) -> RequestRefusedError:
    return RequestRefusedError("no", error=error, status=status, expected=expected)


class Driver(StandIn):
    """A robot that can follow paths."""

    def __init__(self) -> None:
        super().__init__()
        self.followed: list[Corners] = []

    def follow(self, path: Corners, until: Callable[[Pose2], bool]) -> Executed:
        if not until(Pose2(self.x, 0.0, 0.0)):
            self.followed.append(path)
            self.x = path[-1][0]
        return Executed.DONE


@pytest.mark.parametrize(("end_m", "is_followed"), [(0.2, False), (0.49, False), (2.0, True)])
def test_a_path_that_ends_within_a_step_is_a_step(end_m, is_followed):
    """Stopping at its end would look like a bump to an agent."""
    robot = Driver()
    ahead = Reply(sequence=0, action=Action.MOVE_FORWARD, path=((0.0, 0.0), (end_m, 0.0)))
    steps = list(RobotClient(robot, Script(ahead, end(1)), continuous=True))
    assert robot.followed[:1] == ([[(0.0, 0.0), (end_m, 0.0)]] if is_followed else [])
    assert robot.executed == ([] if is_followed else [Action.MOVE_FORWARD])
    assert not any(step.blocked for step in steps)


def test_what_got_lost_is_sent_again_and_executed_once():
    robot, link = StandIn(), Script(LinkLostError("lost"), go(0), LinkLostError("lost"), end(1))
    steps = list(RobotClient(robot, link))
    assert link.asked == [0, 0, 1, 1]
    assert robot.executed == [Action.MOVE_FORWARD]
    assert steps[-1].reply.ending is SearchEnding.FOUND


@pytest.mark.parametrize(
    ("refused", "asked", "asked_again"),
    [
        (refusal("sequence", expected=0), [0, 0], 0),
        (refusal("sequence", expected=1), [0], 1),
        (refusal("pending"), [0], 1),
        (refusal("busy", status=503), [0, 0], 0),
    ],
    ids=["late copy", "accepted already", "pending", "busy"],
)
def test_a_refusal_that_is_none_of_this_observation_is_passed_over(refused, asked, asked_again):
    link = Script(refused, end(0))
    list(RobotClient(StandIn(), link))
    assert (link.asked, link.asked_again) == (asked, asked_again)


@pytest.mark.parametrize(
    "refused", [refusal("sequence", expected=7), refusal("invalid", None, 422)]
)
def test_a_refusal_for_good_ends_the_search_and_stops_the_robot(refused):
    robot = StandIn()
    with pytest.raises(RequestRefusedError):
        list(RobotClient(robot, Script(refused)))
    assert robot.stops > 0
    assert robot.executed == []


def test_a_server_that_is_gone_for_too_long_is_an_error_and_the_robot_stands():
    robot = StandIn()
    link = Script(*[LinkLostError("connection refused")] * 50)
    with pytest.raises(ServerUnreachableError, match="connection refused"):
        list(RobotClient(robot, link, patience=Patience(unreachable_s=0.2)))
    assert robot.stops > 0
    assert robot.executed == []


def test_where_nobody_listens_the_error_asks_for_the_server():
    with (
        closed_port() as port,
        closing(HttpServer(ServerAddress("127.0.0.1", port))) as server,
        pytest.raises(LinkLostError, match=r"refused; is hypernav serve running there\?"),
    ):
        server.stop("a search")


def test_stop_ends_a_motion_under_way_and_allows_no_other():
    robot, link = StandIn(), Script(go(0), go(1))
    robot.hangs = True
    client = RobotClient(robot, link)
    search = threading.Thread(target=lambda: list(client))
    search.start()
    robot.begun.wait()
    client.stop()
    search.join()
    assert robot.executed == [Action.MOVE_FORWARD]
    assert link.asked == [0]


def test_what_the_server_finds_wrong_with_the_sensors_is_an_error():
    robot = StandIn()
    failed = Reply(
        sequence=1,
        action=Action.STOP,
        reason="is the camera frozen?",
        done=True,
        ending=SearchEnding.ROBOT_FAILED,
    )
    with pytest.raises(SensorError, match="is the camera frozen"):
        list(RobotClient(robot, Script(go(0), failed)))
    assert robot.executed == [Action.MOVE_FORWARD]
    assert robot.stops > 0


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (SensorError("no image for 60 s"), "no image for 60 s"),
        (ZeroDivisionError("0 wheels"), "the robot's program ended by ZeroDivisionError: 0 wheels"),
        (KeyboardInterrupt(), "the robot's program ended by KeyboardInterrupt"),
    ],
    ids=["of its sensors", "of its program", "Ctrl-C"],
)
@pytest.mark.parametrize("where", ["observe", "execute"])
def test_the_server_is_told_by_what_a_robot_ends_once_it_stands(monkeypatch, error, words, where):
    robot, link, stood = StandIn(), Script(go(0), go(1)), []

    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr(robot, where, fails)
    monkeypatch.setattr(link, "give_up", lambda reason: stood.append((reason, robot.stops > 0)))
    with pytest.raises(type(error)):
        list(RobotClient(robot, link))
    assert stood == [(words, True)]


def test_who_leaves_the_loop_may_go_on_later():
    link = Script(go(0), go(1))
    for _ in RobotClient(StandIn(), link):
        break
    assert link.given_up == []


def test_after_stop_nothing_begins():
    robot, link = StandIn(), Script(go(0))
    client = RobotClient(robot, link)
    client.stop()
    assert list(client) == []
    assert robot.executed == []


class FakeClock:
    """Time that passes only when the test says so."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._now_s = 0.0

    def wait(self, event: threading.Event, seconds: float) -> bool:
        with self._changed:
            while self._now_s < seconds and not event.is_set():
                self._changed.wait(0.001)
            return self._now_s < seconds

    def pass_time(self, seconds: float) -> None:
        with self._changed:
            self._now_s += seconds


@pytest.mark.parametrize(("seconds", "stops"), [(0.49, 0), (0.5, 1), (9.0, 1)])
def test_the_watchdog_stops_the_robot_at_the_deadline(seconds, stops):
    robot, clock = StandIn(), FakeClock()
    watchdog = Watchdog(0.5, robot.stop, wait=clock.wait)
    with watchdog:
        clock.pass_time(seconds)
    assert robot.stops == watchdog.times_late == stops


def test_after_an_answer_in_time_the_watchdog_does_nothing():
    robot, clock = StandIn(), FakeClock()
    with Watchdog(0.5, robot.stop, wait=clock.wait):
        pass
    clock.pass_time(9.0)
    assert robot.stops == 0


def test_a_late_answer_stops_the_robot_before_it_comes():
    robot = StandIn()

    class Late(Script):
        def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
            assert robot.stopped.wait(10.0)
            return super().ask(body, sequence, timeout_s)

    client = RobotClient(robot, Late(end(0)), patience=Patience(deadline_s=0.01))
    list(client)
    assert client.watchdog.times_late == 1


@pytest.mark.parametrize("answer", [None, True, "DONE"])
def test_a_motion_that_says_nothing_of_itself_is_named(answer):
    robot, link = StandIn(), Script(go(0))
    robot.execute = lambda action: answer
    with pytest.raises(ContractError, match=f"returned {answer!r}; expected Executed.DONE"):
        list(RobotClient(robot, link))
    assert link.given_up


def test_a_robot_that_observes_nothing_is_named():
    robot, link = StandIn(), Script(end(0))
    robot.observe = lambda: None  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(ContractError, match="observe returned None; expected a Sensed"):
        list(RobotClient(robot, link))
    assert link.given_up


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"odometry": Pose2(math.nan, 0.0, 0.0)}, r"odometry: .* got Pose2\(x=nan"),
        ({"odom_to_map": Pose2(0.0, 0.0, math.inf)}, r"odom_to_map: .* yaw=inf"),
        ({"camera_to_base": Transform(np.eye(3), np.full(3, np.nan))}, "camera_to_base"),
        ({"stamp_s": 1.7e18}, r"seconds from 0 to 1e\+12, got 1\.7e\+18"),
    ],
)
def test_what_a_robot_cannot_have_sensed_is_one_line(changes, words):
    sensed = StandIn().observe()
    with pytest.raises(SensorError, match=words) as raised:
        replace(sensed, **changes)
    assert "\n" not in str(raised.value)
