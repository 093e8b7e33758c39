"""Goals for Nav2: their frame, how many there are, and when odometry shows that one is reached."""

import math
from contextlib import closing
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.cli.main import main
from hypernav.core.config import layered
from hypernav.core.errors import ConfigError, Nav2Error
from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.ros2.config import Nav2Config, Ros2Config
from hypernav.robot.ros2.drives import check_drive
from hypernav.robot.ros2.idl_types import PoseStamped
from hypernav.robot.ros2.nav2 import goals as nav2_goals
from hypernav.robot.ros2.nav2.aims import Aims
from hypernav.robot.ros2.nav2.goals import Nav2Goals
from hypernav.robot.ros2.nav2.progress import Arrival, Progress
from hypernav.robot.ros2.network import Quality, Ros2Network
from loopback import DOMAIN, LOOPBACK

ORIGIN = Pose2(0.0, 0.0, 0.0)


class Sensors:
    """Where the robot is, and where its localisation has the odometry."""

    def __init__(self) -> None:
        self.robot, self.found = Pose2(1.0, 0.0, 0.0), ORIGIN

    def odometry(self) -> Pose2:
        return self.robot

    def odom_to_map(self) -> Pose2:
        return self.found


class Topic:
    """Keeps what is published."""

    def __init__(self) -> None:
        self.published: list[PoseStamped] = []

    def publisher(self, *_: object) -> "Topic":
        return self

    def publish(self, message: PoseStamped) -> None:
        self.published.append(message)

    @property
    def poses(self) -> list[tuple[float, float, float]]:
        return [
            (one.pose.position.x, one.pose.position.y, 2.0 * math.asin(one.pose.orientation.z))
            for one in self.published
        ]


def goals_of(**frames: str) -> tuple[Nav2Goals, Topic, Any, list[float]]:
    topic, sensors, now_s = Topic(), Sensors(), [0.0]
    network: Any = topic
    anything: Any = sensors
    config = layered(
        Ros2Config(),
        environment={},
        assignments=[f"frames.{name}={frame}" for name, frame in frames.items()],
    )
    return Nav2Goals(network, config, anything, clock=lambda: now_s[0]), topic, sensors, now_s


def test_goals_are_in_the_frame_of_the_odometry_without_a_localisation():
    goals, topic, _, _ = goals_of(odom="robot1/odom")
    goals.send(Pose2(2.0, 1.0, 0.5))
    assert topic.poses == [pytest.approx((2.0, 1.0, 0.5))]
    header = topic.published[0].header
    assert (header.frame_id, header.stamp.sec, header.stamp.nanosec) == ("robot1/odom", 0, 0)


def test_goals_are_in_the_map_of_the_localisation_and_follow_its_jumps():
    goals, topic, sensors, _ = goals_of(map="map")
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
    assert [x for x, _, _ in topic.poses] == pytest.approx([2.0, 1.0, 2.0])


def test_standstill_is_the_pose_where_the_robot_is_by_now():
    goals, topic, sensors, now_s = goals_of()
    goals.send(Pose2(2.0, 0.0, 0.0))
    for tick in range(9):  # 20 times a second, while it rolls on
        now_s[0], sensors.robot = 0.05 * tick, Pose2(1.0 + 0.01 * tick, 0.0, 0.1)
        goals.send(None)
    assert topic.poses[1:] == [
        pytest.approx((1.0, 0.0, 0.1)),
        pytest.approx((1.04, 0.0, 0.1)),
        pytest.approx((1.08, 0.0, 0.1)),
    ]


def test_without_nav2_nobody_takes_goals(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    config = layered(
        Ros2Config(), environment={}, assignments=["topics.goal_pose=/nobody/goal_pose"]
    )
    anything: Any = Sensors()
    with closing(Ros2Network(DOMAIN)) as ours, closing(Ros2Network(DOMAIN)) as theirs:
        goals = Nav2Goals(ours, config, anything)
        with pytest.raises(Nav2Error, match=r"nobody reads '/nobody/goal_pose' .* Nav2 running"):
            goals.await_reader(0.3)
        monkeypatch.setattr(nav2_goals, "_LOOK_S", 0.01)
        theirs.subscribe("/nobody/goal_pose", PoseStamped, Quality.RELIABLE, lambda _: None)
        goals.await_reader(60.0)


def test_a_robot_has_arrived_when_it_stands_at_the_goal_or_stays_there():
    arrival, near, far = Arrival(0.1, 0.2), Pose2(0.05, 0.0, 0.1), Pose2(0.2, 0.0, 0.0)
    turned = Pose2(0.0, 0.0, 0.3)
    assert arrival.is_at(ORIGIN, near, 0.1, is_standing=True)
    assert not arrival.is_at(ORIGIN, far, 0.1, is_standing=True)
    assert not arrival.is_at(ORIGIN, turned, 0.1, is_standing=True)
    sways = [arrival.is_at(ORIGIN, near, 0.1, is_standing=False) for _ in range(30)]
    assert sways[:18] == [False] * 18
    assert sways[-1]


def test_progress_is_motion_of_either_kind():
    progress = Progress(ORIGIN)
    assert [progress.still_s(Pose2(0.05, 0.0, 0.0), 1.0) for _ in range(3)] == [1.0, 2.0, 3.0]
    assert not progress.has_moved
    assert progress.still_s(Pose2(0.2, 0.0, 0.0), 1.0) == 0.0
    assert progress.has_moved
    assert progress.still_s(Pose2(0.2, 0.0, 0.0), 1.0) == 1.0
    assert progress.still_s(Pose2(0.2, 0.0, -0.2), 1.0) == 0.0


CORNER = [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)]


def test_goals_on_a_path_are_few_and_pass_its_corner():
    aims, robot, seen = Aims(CORNER, Nav2Config()), ORIGIN, list[Pose2]()
    for _ in range(400):
        goal = aims.at(robot)
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
    goal = Aims(CORNER, config).at(Pose2(along, 0.0, 0.0))
    # The distance of the corner from the line between robot and goal.
    dx, dy = goal.x - along, goal.y
    if dy > 1e-6:
        assert abs(dy * (1.0 - along)) / math.hypot(dx, dy) <= cut_m + 1e-6


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("nav2.reached_m=0.3", "nav2.reached_m 0.3: a motion of 0.5 .* less than 0.2"),
        ("nav2.reached_deg=15", "nav2.reached_deg 15: a motion of 30 .* less than 12"),
        ("embodiment.motion.forward_m=0.25", "nav2.reached_m 0.15: a motion of 0.25"),
    ],
)
def test_what_counts_as_reached_must_be_a_motion_made(assignment, message):
    config = layered(Ros2Config(), environment={}, assignments=[assignment])
    check_drive("cmd_vel", config)
    with pytest.raises(ConfigError, match=message):
        check_drive("nav2", config)


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
