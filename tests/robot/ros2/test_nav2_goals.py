"""Goals for Nav2: their frame, how many there are, and when odometry shows that one is reached."""

import math
import time
from collections import defaultdict
from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import Any, cast

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hypernav.app.cli.main import main
from hypernav.core.errors import ConfigError, Nav2Error, RosNetworkError, TransformMissingError
from hypernav.core.geometry.transforms import Pose2
from hypernav.io.layered_config import layered
from hypernav.robot.ros2.config import Nav2Config, Ros2Config
from hypernav.robot.ros2.drives import check_drive
from hypernav.robot.ros2.idl_types import Bool, Twist, TwistStamped
from hypernav.robot.ros2.nav2_goals import Nav2Goals, WheelHold, wait_for
from hypernav.robot.ros2.nav2_progress import Aims, Arrival, Motion, Progress, ShortOfGoals, ToPose
from hypernav.robot.ros2.network import Quality, Ros2Network
from loopback import DOMAIN, LOOPBACK

ORIGIN = Pose2(0.0, 0.0, 0.0)


class Sensors:
    """Where the localisation has the odometry, until it is lost."""

    def __init__(self) -> None:
        self.found: Pose2 | None = ORIGIN

    def lose(self) -> None:
        self.found = None

    def odom_to_map(self) -> Pose2:
        if self.found is None:
            raise TransformMissingError("the localisation has ended")
        return self.found


class Topic:
    """Keeps what is published, unless it is broken."""

    def __init__(self) -> None:
        self.published: list[Any] = []
        self.is_broken, self.is_read = False, True

    def has_reader(self) -> bool:
        return self.is_read

    def publish(self, message: object) -> None:
        if self.is_broken:
            raise RosNetworkError("the buffer is full")
        self.published.append(message)

    @property
    def poses(self) -> list[tuple[float, float, float]]:
        return [
            (one.pose.position.x, one.pose.position.y, 2.0 * math.asin(one.pose.orientation.z))
            for one in self.published
        ]


class Network:
    """Topics by name, and what others publish: the multiplexer's velocities."""

    is_settled = True

    def __init__(self) -> None:
        self.topics = defaultdict[str, Topic](Topic)
        self.others = {"/cmd_vel": 1}

    def publishers(self, topic: str) -> int:
        return self.others.get(topic, 0)

    def publisher(self, topic: str, *_: object) -> Topic:
        return self.topics[topic]


def configured(*assignments: str) -> Ros2Config:
    return layered(Ros2Config(), environment={}, assignments=assignments)


def goals_on(network: Network, *assignments: str) -> tuple[Nav2Goals, Sensors, list[float]]:
    sensors, now_s = Sensors(), [0.0]
    config = configured(*assignments)
    goals = Nav2Goals(cast(Any, network), config, cast(Any, sensors), clock=lambda: now_s[0])
    return goals, sensors, now_s


def goals_of(*assignments: str) -> tuple[Nav2Goals, Topic, Sensors, list[float]]:
    network = Network()
    goals, sensors, now_s = goals_on(network, *assignments)
    return goals, network.topics["/goal_pose"], sensors, now_s


def test_goals_are_in_the_frame_of_the_odometry_without_a_localisation():
    goals, topic, _, _ = goals_of("frames.odom=robot1/odom")
    goals.send(Pose2(2.0, 1.0, 0.5))
    assert topic.poses == [pytest.approx((2.0, 1.0, 0.5))]
    header = topic.published[0].header
    assert (header.frame_id, header.stamp.sec, header.stamp.nanosec) == ("robot1/odom", 0, 0)


def test_goals_are_in_the_map_of_the_localisation_and_follow_its_jumps():
    goals, topic, sensors, _ = goals_of("frames.map=map")
    sensors.found = Pose2(10.0, 0.0, math.pi / 2.0)
    goals.send(Pose2(2.0, 1.0, 0.0))
    assert topic.published[0].header.frame_id == "map"
    sensors.found = Pose2(10.01, 0.0, math.pi / 2.0)
    goals.send(Pose2(2.0, 1.0, 0.0))
    sensors.found = Pose2(10.3, 0.0, math.pi / 2.0)
    goals.send(Pose2(2.0, 1.0, 0.0))
    half = math.pi / 2.0
    assert topic.poses == [pytest.approx((9.0, 2.0, half)), pytest.approx((9.3, 2.0, half))]


def test_a_goal_is_published_once_and_again_after_a_standstill():
    goals, topic, _, _ = goals_of()
    for _ in range(5):
        goals.send(Pose2(2.0, 0.0, 0.0))
    goals.send(None)
    goals.send(Pose2(2.0, 0.0, 0.0))
    assert [x for x, _, _ in topic.poses] == pytest.approx([2.0, 0.0, 2.0])


def test_standstill_is_the_origin_of_the_base_which_nav2_itself_finds():
    goals, topic, sensors, now_s = goals_of("frames.base=body", "frames.map=map")
    goals.send(Pose2(2.0, 0.0, 0.0))
    sensors.lose()
    for tick in range(9):  # 20 times a second, while it rolls on
        now_s[0] = 0.05 * tick
        goals.send(None)
    assert topic.poses[1:] == [pytest.approx((0.0, 0.0, 0.0))] * 3
    assert [one.header.frame_id for one in topic.published] == ["map", "body", "body", "body"]
    assert {(one.header.stamp.sec, one.header.stamp.nanosec) for one in topic.published} == {(0, 0)}


HOLDS = ("topics.stop_cmd_vel=/stop_cmd_vel", "topics.nav2_lock=/nav2_lock")


def test_the_lock_is_open_only_while_nav2_is_told_to_drive():
    network = Network()
    goals, _, _ = goals_on(network, *HOLDS)
    lock, stop = network.topics["/nav2_lock"], network.topics["/stop_cmd_vel"]
    assert lock.published == []
    for _ in range(3):
        goals.send(Pose2(2.0, 0.0, 0.0))
    assert lock.published == [Bool(False)] * 3
    assert stop.published == []
    for _ in range(3):
        goals.send(None)
    assert lock.published == [Bool(False)] * 3 + [Bool(True)] * 3
    assert stop.published == [Twist()] * 3


@pytest.mark.parametrize("broken", ["/stop_cmd_vel", "/nav2_lock", "/goal_pose"])
def test_what_fails_to_stop_the_robot_keeps_nothing_else_from_it(broken):
    network = Network()
    goals, _, _ = goals_on(network, *HOLDS)
    network.topics[broken].is_broken = True
    with pytest.raises(RosNetworkError):
        goals.send(None)
    told = [len(topic.published) for name, topic in network.topics.items() if name != broken]
    assert told == [1, 1]


def test_a_goal_that_is_not_taken_opens_no_lock():
    network = Network()
    goals, sensors, _ = goals_on(network, "frames.map=map", *HOLDS)
    sensors.lose()
    with pytest.raises(TransformMissingError):
        goals.send(Pose2(2.0, 0.0, 0.0))
    assert network.topics["/nav2_lock"].published == []


@pytest.mark.parametrize(
    ("unread", "message"),
    [
        ("/goal_pose", "nobody reads '/goal_pose' .* Nav2 running"),
        ("/stop_cmd_vel", "nobody reads '/stop_cmd_vel' .* geometry_msgs/Twist, .*cmd_vel_type"),
        ("/nav2_lock", "nobody reads '/nav2_lock' .* std_msgs/Bool, .* with this lock"),
    ],
)
def test_whoever_is_to_be_told_must_be_there(unread, message):
    network = Network()
    goals, _, _ = goals_on(network, *HOLDS)
    goals.await_readers(0.0)
    network.topics[unread].is_read = False
    with pytest.raises(Nav2Error, match=message):
        goals.await_readers(0.0)


@pytest.mark.parametrize(
    ("topic", "count", "message"),
    [
        ("/cmd_vel", 2, "2 publishers on '/cmd_vel' .*expected one.*behavior_server.*cmd_vel_out"),
        ("/cmd_vel", 0, "0 publishers on '/cmd_vel' .*expected one"),
        ("/nav2_lock", 1, r"1 other publisher\(s\) on '/nav2_lock' .*End them"),
        ("/stop_cmd_vel", 1, r"1 other publisher\(s\) on '/stop_cmd_vel' .*End them"),
    ],
)
def test_nothing_may_lead_past_the_multiplexer(topic, count, message):
    network = Network()
    network.others[topic] = count
    goals_on(network)[0].await_readers(0.0)  # there is none
    goals, _, _ = goals_on(network, *HOLDS)
    with pytest.raises(Nav2Error, match=message):
        goals.await_readers(0.0)
    network.others[topic] = int(topic == "/cmd_vel")
    goals.await_readers(0.0)


def test_a_reader_of_another_type_is_none(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    config = configured("topics.stop_cmd_vel=/stop_cmd_vel", "cmd_vel_type=TwistStamped")
    with closing(Ros2Network(DOMAIN)) as ours, closing(Ros2Network(DOMAIN)) as theirs:
        taken = partial(theirs.subscribe, quality=Quality.RELIABLE, receive=lambda _: None)
        taken("/stop_cmd_vel", Twist)
        hold = WheelHold(ours, config, cast(Any, Sensors()))
        with pytest.raises(Nav2Error, match=r"nobody reads '/stop_cmd_vel' .*/TwistStamped"):
            hold.await_multiplexer(1.0)
        taken("/stop_cmd_vel", TwistStamped)
        multiplexer = theirs.publisher("/cmd_vel", TwistStamped)
        hold.await_multiplexer(60.0)
        assert not multiplexer.has_reader()


def test_a_robot_has_arrived_when_it_stands_at_the_goal_or_stays_there():
    arrival, near, far = Arrival(0.1, 0.2), Pose2(0.05, 0.0, 0.1), Pose2(0.2, 0.0, 0.0)
    turned = Pose2(0.0, 0.0, 0.3)
    assert arrival.has_settled_at(ORIGIN, near, 0.1, is_standing=True)
    assert not arrival.has_settled_at(ORIGIN, far, 0.1, is_standing=True)
    assert not arrival.has_settled_at(ORIGIN, turned, 0.1, is_standing=True)
    sways = [arrival.has_settled_at(ORIGIN, near, 0.1, is_standing=False) for _ in range(30)]
    assert sways[:18] == [False] * 18
    assert sways[-1]


AHEAD = ToPose(ORIGIN, Pose2(1.0, 0.0, 0.0))
TURN = ToPose(ORIGIN, Pose2(0.0, 0.0, 1.0))


def idle_of(motion: Motion, *poses: Pose2) -> tuple[list[float], Progress]:
    """Times without progress of a robot that is looked at once a second."""
    progress = Progress()
    return [progress.idle_s(motion.at(pose), 1.0) for pose in poses], progress


def test_progress_of_a_drive_is_distance_gained():
    xs = (0.0, 0.05, 0.2, 0.2, 0.35)
    idle, progress = idle_of(AHEAD, *(Pose2(x, 0.0, 0.0) for x in xs))
    assert idle == [1.0, 2.0, 0.0, 1.0, 0.0]
    assert progress.is_made
    assert progress.taken_s == 5.0


def test_progress_of_a_turn_is_heading_gained():
    idle, progress = idle_of(TURN, *(Pose2(0.0, 0.0, yaw) for yaw in (0.0, 0.05, 0.2, 0.2)))
    assert idle == [1.0, 2.0, 0.0, 1.0]
    assert progress.is_made


@pytest.mark.parametrize(
    ("motion", "recovery"),
    [
        (AHEAD, [Pose2(0.0, 0.0, yaw) for yaw in (0.5, 1.0, 1.57, 2.5, -2.5, -1.0)]),
        (AHEAD, [Pose2(x, 0.0, 0.0) for x in (-0.1, -0.3, -0.2, 0.0, -0.3, 0.0)]),
        (TURN, [Pose2(0.0, 0.0, yaw) for yaw in (-0.5, -1.0, -0.5, 0.0, -1.5, 0.0)]),
        (TURN, [Pose2(x, 0.0, 0.0) for x in (-0.1, -0.3, -0.2, 0.0, -0.3, 0.0)]),
    ],
)
def test_recoveries_of_nav2_are_no_progress(motion, recovery):
    idle, progress = idle_of(motion, ORIGIN, *recovery)
    assert idle == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    assert not progress.is_made


@pytest.mark.parametrize("motion", [AHEAD, TURN, Aims([(0.0, 0.0), (3.0, 0.0)], Nav2Config())])
def test_a_robot_far_from_where_its_motion_leads_is_astray(motion):
    for near in (ORIGIN, Pose2(0.0, 0.4, 2.0), Pose2(-0.3, 0.0, 0.0)):
        assert not motion.at(near).is_astray
    for far in (Pose2(0.0, 0.7, 0.0), Pose2(-0.7, 0.0, 0.0)):
        assert motion.at(far).is_astray


def test_beside_a_path_only_what_was_made_along_it_counts():
    aims = Aims([(0.0, 0.0), (3.0, 0.0)], Nav2Config(corner_cut_m=0.1))
    for aside in (Pose2(0.0, 0.5, 1.0), Pose2(-0.5, 0.0, 1.0)):
        assert aims.at(aside).made.distance_to(0.0, 0.0) == pytest.approx(0.0, abs=0.02)
    made = aims.at(Pose2(0.6, 0.4, 1.0)).made
    assert (made.x, made.y, made.yaw) == pytest.approx((0.6, 0.0, 1.0), abs=0.02)
    assert aims.at(Pose2(0.7, 0.05, 0.0)).made == Pose2(0.7, 0.05, 0.0)


def test_a_route_that_is_left_to_nav2_may_lead_anywhere():
    aims = Aims([(0.0, 0.0), (3.0, 0.0)], Nav2Config(ahead_m=50.0, corner_cut_m=50.0))
    aim = aims.at(Pose2(-1.0, 2.0, 0.0))
    assert aim.made == Pose2(-1.0, 2.0, 0.0)
    assert not aim.is_astray


@pytest.mark.parametrize(
    ("robot", "idle_s", "is_said"),
    [
        (Pose2(0.2, 0.0, 0.1), 4.0, True),
        (Pose2(0.0, 0.0, math.radians(14.0)), 4.0, True),
        (Pose2(0.2, 0.0, 0.1), 2.0, False),  # it may still brake, or plan
        (Pose2(1.0, 0.0, 0.0), 4.0, False),  # so far no goal checker is content
        (Pose2(0.0, 0.0, 1.5), 4.0, False),
    ],
)
def test_a_goal_checker_that_may_be_content_too_soon_is_named_once(robot, idle_s, is_said, caplog):
    short = ShortOfGoals(Nav2Config())
    for _ in range(3):
        short.look(ORIGIN, robot, idle_s)
    assert caplog.text.count("xy_goal_tolerance and yaw_goal_tolerance") == is_said


CORNER = [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)]


def test_goals_on_a_path_are_few_and_pass_its_corner():
    aims, robot, seen = Aims(CORNER, Nav2Config()), ORIGIN, list[Pose2]()
    for _ in range(400):
        goal = aims.at(robot).goal
        if goal not in seen:
            seen.append(goal)
        away_m = robot.distance_to(*goal.xy)
        step_m = min(0.03, away_m)
        bearing = robot.yaw + (robot.bearing_to(*goal.xy) if away_m > 0.01 else 0.0)
        robot = Pose2(
            robot.x + step_m * math.cos(bearing), robot.y + step_m * math.sin(bearing), bearing
        )
    assert robot.distance_to(1.0, 3.0) < 0.02
    assert len(seen) < 15


@given(st.floats(0.0, 1.0), st.floats(0.02, 1.0))
def test_a_goal_cuts_no_corner_by_more_than_is_allowed(along, cut_m):
    config = Nav2Config(ahead_m=3.0, corner_cut_m=cut_m)
    goal = Aims(CORNER, config).at(Pose2(along, 0.0, 0.0)).goal
    # The distance of the corner from the line between robot and goal.
    dx, dy = goal.x - along, goal.y
    if dy > 1e-6:
        assert abs(dy * (1.0 - along)) / math.hypot(dx, dy) <= cut_m + 1e-6


@given(
    st.floats(0.2, 3.0),
    st.floats(0.0, 1.0),
    st.lists(st.floats(0.0, 0.3), min_size=1, max_size=40),
)
@example(0.375, 0.0, [0.25, 0.296875, 0.0703125, 0.21875, 0.09375, 0.0])
def test_no_goal_is_behind_the_robot_however_near_goals_are(ahead_m, driven_m, steps_m):
    aims, length_m = Aims([(0.0, 0.0), (20.0, 0.0)], Nav2Config(ahead_m=ahead_m)), 20.0
    x = driven_m  # since the path was planned
    for step_m in steps_m:
        goal = aims.at(Pose2(x, 0.0, 0.0)).goal
        assert goal.yaw == 0.0
        assert x < goal.x <= min(x + ahead_m + 0.04, length_m)
        x += step_m


def test_progress_on_a_path_is_kept_for_the_same_path_only():
    aims = Aims(CORNER, Nav2Config())
    assert aims.is_on(list(CORNER))
    assert not aims.is_on(CORNER[:2])


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("nav2.reached_m=0.3", "nav2.reached_m 0.3: a motion of 0.5 .* less than 0.2"),
        ("nav2.reached_deg=15", "nav2.reached_deg 15: a motion of 30 .* less than 12"),
        ("embodiment.motion.forward_m=0.25", "nav2.reached_m 0.15: a motion of 0.25"),
    ],
)
def test_what_counts_as_reached_must_be_a_motion_made(assignment, message):
    config = configured(assignment)
    check_drive("cmd_vel", config)
    with pytest.raises(ConfigError, match=message):
        check_drive("nav2", config)


@pytest.mark.parametrize(
    ("assignments", "message"),
    [
        (("stop_cmd_vel=cmd_vel",), r"stop_cmd_vel 'cmd_vel' is topics\.cmd_vel.*twist_mux"),
        (("nav2_lock=/cmd_vel",), r"nav2_lock '/cmd_vel' is topics\.cmd_vel"),
        (("goal_pose=/cmd_vel",), r"goal_pose '/cmd_vel' is topics\.cmd_vel"),
        (("stop_cmd_vel=/x", "nav2_lock=x"), r"nav2_lock 'x' is topics\.stop_cmd_vel"),
    ],
)
def test_whatever_is_told_apart_has_a_topic_of_its_own(assignments, message):
    config = configured(*(f"topics.{one}" for one in assignments))
    check_drive("cmd_vel", config)
    with pytest.raises(ConfigError, match=message):
        check_drive("nav2", config)


@pytest.mark.parametrize(
    ("settings", "is_said"),
    [((), False), (("nav2.ahead_m=10",), True), (("nav2.ahead_m=10", HOLDS[1]), False)],
)
def test_far_goals_without_a_lock_are_warned_of(settings, is_said, caplog):
    check_drive("nav2", configured(*settings))
    assert ("topics.nav2_lock" in caplog.text) is is_said


@pytest.mark.parametrize(
    ("drive", "setting", "warning"),
    [
        ("nav2", "speed.max_speed_m_s=0.2", "speed: without effect with --drive nav2; Nav2's own"),
        ("cmd_vel", "nav2.reached_m=0.1", "nav2: without effect with --drive cmd_vel"),
        ("cmd_vel", "topics.nav2_lock=/lock", "topics.nav2_lock: without effect"),
        ("nav2", "nav2.reached_m=0.1", ""),
        ("nav2", "topics.cmd_vel=/wheels", ""),
        ("cmd_vel", "speed.max_speed_m_s=0.2", ""),
    ],
)
def test_settings_of_the_other_drive_are_warned_of(drive, setting, warning, caplog):
    check_drive(drive, configured(setting))
    assert warning in caplog.text
    assert bool(caplog.text) == bool(warning)


@pytest.mark.parametrize("quiet", [(), ("--quiet",)])
def test_warnings_are_shown_unless_only_errors_are_asked_for(quiet, capsys):
    settings = ("speed.max_speed_m_s=0.2", "topics.stop_cmd_vel=/cmd_vel")
    words = [word for setting in settings for word in ("--set", setting)]
    with pytest.raises(SystemExit):
        main(["robot", "ros2", "bed", "--drive", "nav2", *words, *quiet])
    shown = capsys.readouterr().err
    assert ("speed: without effect" in shown) is not bool(quiet)
    assert "is topics.cmd_vel" in " ".join(shown.split())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--drive", "nav3"), "nav2"),
        (("--drive", "nav2", "--set", "nav2.reached_m=0.4"), "counts as blocked"),
        (("--drive", "nav2", "--set", "frames.map=''"), "frames.map"),
        (("--drive", "nav2", "--set", "nav2.ahead=1"), "ahead_m"),
    ],
)
def test_a_mistake_ends_the_command_before_it_looks_for_the_robot(options, words, capsys):
    with pytest.raises(SystemExit) as left:
        main(["robot", "ros2", "bed", *options])
    assert left.value.code == 2
    assert words in capsys.readouterr().err


def answers(*words: str | None) -> Callable[[], str | None]:
    """Gives these answers, one for each question, and fails if asked once more."""
    remaining = iter(words)
    return lambda: next(remaining)


def test_what_is_there_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "sleep", pytest.fail)
    wait_for(answers(None), timeout_s=60.0)


def test_what_comes_late_is_waited_for() -> None:
    wait_for(answers("nobody reads", "nobody reads", None), timeout_s=60.0)


def test_the_last_words_say_what_is_missing() -> None:
    words = answers("nobody publishes tf", *["nobody reads the goal"] * 100)
    with pytest.raises(Nav2Error, match=r"^nobody reads the goal$"):
        wait_for(words, timeout_s=0.15)


def test_it_looks_once_even_without_time_to_wait() -> None:
    wait_for(answers(None), timeout_s=0.0)
