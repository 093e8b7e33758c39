"""A robot that Nav2 drives: goals out over DDS, and what odometry shows of them."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager

import pytest

from dds_processes import PATIENT, driver, nav2, robot_in
from hypernav.app.cli.main import main
from hypernav.core.embodiment import Action
from hypernav.core.episode import SUCCESS_DISTANCE_M
from hypernav.core.errors import Nav2Error
from hypernav.io.layered_config import layered
from hypernav.robot.client.robot import Executed
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.nav2_robot import Nav2Robot
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensors import Ros2Sensors
from loopback import DOMAIN, LOOPBACK

HERE = (0.0, 0.0, 0.0)


@pytest.fixture(autouse=True)
def _loopback(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)


@contextmanager
def driven_by_nav2(*assignments: str) -> Iterator[Nav2Robot]:
    config = layered(Ros2Config(), environment={}, assignments=[*PATIENT, *assignments])
    with (
        closing(Ros2Network(DOMAIN)) as network,
        closing(Nav2Robot(network, config, Ros2Sensors(network, config))) as robot,
    ):
        yield robot


@contextmanager
def driving(robot: Nav2Robot) -> Iterator[list[Executed]]:
    """Drives ahead meanwhile; the list holds the outcomes."""
    ended, outcomes = threading.Event(), list[Executed]()

    def drive() -> None:
        while not ended.is_set():
            outcomes.append(robot.execute(Action.MOVE_FORWARD))

    thread = threading.Thread(target=drive)
    thread.start()
    try:
        yield outcomes
    finally:
        ended.set()
        robot.stop()
        thread.join()


@pytest.mark.slow
def test_steps_turns_and_paths_end_where_odometry_says():
    with robot_in("builtin", HERE) as body, nav2(), driven_by_nav2() as robot:
        start = robot.odometry()
        assert robot.execute(Action.TURN_LEFT) is Executed.DONE
        assert robot.odometry().yaw - start.yaw == pytest.approx(0.524, abs=0.175)
        assert robot.execute(Action.TURN_RIGHT) is Executed.DONE
        assert robot.execute(Action.MOVE_FORWARD) is Executed.DONE
        assert start.distance_to(*robot.odometry().xy) == pytest.approx(0.5, abs=0.15)
        here = robot.odometry()
        enough = robot.follow([here.xy, (here.x - 5.0, here.y)], lambda at: at.x < here.x - 0.3)
        assert enough is Executed.DONE
        here = robot.odometry()
        path = [here.xy, (here.x - 0.4, here.y)]
        assert robot.follow(path, lambda _: False) is Executed.DONE
        assert robot.odometry().distance_to(*path[-1]) < 0.15
        assert body.told("state")["speed"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lost", "replans_s", "settings"),
    [
        ("freeze", 0.0, ()),
        ("lose", 0.0, ()),
        ("freeze", 2.0, ("topics.stop_cmd_vel=/stop_cmd_vel",)),
    ],
)
def test_nav2_is_stopped_when_the_camera_freezes_or_odometry_is_lost(lost, replans_s, settings):
    with (
        robot_in("builtin", HERE) as body,
        nav2("--replans", str(replans_s)),
        driven_by_nav2("timing.fresh_s=0.3", *settings) as robot,
        driving(robot),
    ):
        while body.told("state")["speed"] == 0.0:
            time.sleep(0.01)
        began = body.told(lost)
        time.sleep(1.5)
        stood = body.told("state")
        assert stood["speed"] == 0.0
        assert stood["stopped_s"] - began["now_s"] < 0.5
        time.sleep(1.0)
        later = body.told("thaw")
        assert (later["x"], later["y"]) == pytest.approx((stood["x"], stood["y"]), abs=0.02)
        while body.told("state")["speed"] == 0.0:  # it goes on
            time.sleep(0.01)


@pytest.mark.slow
def test_nav2_that_still_has_odometry_does_not_drive_back_to_where_ours_ended():
    with (
        robot_in("builtin", HERE) as body,
        nav2("--tf", "/wheels/tf"),
        driven_by_nav2("timing.fresh_s=0.4") as robot,
        driving(robot),
    ):
        while body.told("state")["speed"] < 0.3:
            time.sleep(0.01)
        body.told("lose")
        seen = [body.told("state")]
        while seen[-1]["speed"] > 0.0:
            seen.append(body.told("state"))
        stopped = seen[-1]
        for _ in range(20):
            time.sleep(0.1)
            seen.append(body.told("state"))
        assert min(one["x"] for one in seen[seen.index(stopped) :]) > stopped["x"] - 0.02
        assert seen[-1]["yaw"] == pytest.approx(stopped["yaw"], abs=0.1)
        body.told("thaw")


@pytest.mark.slow
def test_the_lock_stops_nav2_when_hypernav_is_killed():
    settings = ("topics.nav2_lock=/nav2_lock", "nav2.ahead_m=4", "nav2.corner_cut_m=4")
    with (
        robot_in("builtin", (-1.4, 0.0, 0.0), "--lock", "/nav2_lock") as body,
        nav2(),
        driver(*settings) as hypernav,
    ):
        while body.told("state")["speed"] < 0.3:
            assert hypernav.poll() is None
            time.sleep(0.01)
        hypernav.kill()
        killed = body.told("state")
        before, now = killed, body.told("state")
        while now["x"] > before["x"] + 0.01 or now is killed:
            time.sleep(0.5)
            before, now = now, body.told("state")
        assert now["x"] - killed["x"] < 1.0  # of 2 m to what stands before its goal


@pytest.mark.slow
def test_stop_stops_nav2_in_the_middle_of_a_motion():
    with robot_in("builtin", HERE) as body, nav2(), driven_by_nav2() as robot:
        here = robot.odometry()
        ended: list[Executed] = []
        path = [here.xy, (here.x + 5.0, here.y)]
        thread = threading.Thread(target=lambda: ended.append(robot.follow(path, lambda _: False)))
        thread.start()
        while body.told("state")["speed"] == 0.0:
            time.sleep(0.01)
        pressed = body.told("state")
        robot.stop()
        thread.join(10.0)
        assert ended == [Executed.STOPPED]
        time.sleep(1.0)
        stood = body.told("state")
        assert stood["speed"] == 0.0
        assert stood["stopped_s"] - pressed["now_s"] < 0.5
        assert robot.odometry().distance_to(*path[-1]) > 1.0


@pytest.mark.slow
def test_a_nav2_that_never_moves_is_an_error_that_says_what_to_look_at():
    with (
        robot_in("builtin", HERE),
        nav2("--asleep"),
        driven_by_nav2("nav2.blocked_s=2") as robot,
        pytest.raises(Nav2Error, match=r"no nearer to any for 2 s .* does a goal from RViz move"),
    ):
        robot.execute(Action.TURN_LEFT)


@pytest.mark.slow
def test_a_motion_ends_in_time_and_a_goal_checker_that_may_be_content_is_named_before(caplog):
    with (
        robot_in("builtin", HERE),
        nav2("--asleep"),
        driven_by_nav2("nav2.blocked_s=600", "nav2.motion_s=5") as robot,
    ):
        assert robot.execute(Action.TURN_LEFT) is Executed.BLOCKED
    assert "30° (0.52 rad) from its goal" in caplog.text
    assert "yaw_goal_tolerance" in caplog.text


@pytest.mark.slow
def test_what_stands_in_the_way_is_blocked():
    with robot_in("builtin", HERE), nav2(), driven_by_nav2("nav2.blocked_s=2") as robot:
        executed = [robot.execute(Action.MOVE_FORWARD)]
        while executed[-1] is Executed.DONE and len(executed) < 40:
            executed.append(robot.execute(Action.MOVE_FORWARD))
        assert executed[-1] is Executed.BLOCKED


@pytest.mark.slow
def test_the_bed_of_a_real_house_is_found_with_nav2(small_house, test_data, tmp_path):
    pytest.importorskip("onnxruntime")
    detector = f"yolox:{test_data / 'models' / 'yolox_nano.onnx'}"
    start = (-2.65, -0.68, -27.6)
    with robot_in(str(small_house), start, camera=(320, 240)) as robot, nav2():
        words = [word for value in PATIENT for word in ("--set", value)]
        command = ["robot", "ros2", "bed", "--drive", "nav2", *words, "--detector", detector]
        with pytest.raises(SystemExit) as left:
            main([*command, "--out", str(tmp_path), "--quiet"])
        assert left.value.code == 0
        result = json.loads((tmp_path / "result.json").read_text())
        assert (result["outcome"], result["drive"]) == ("found", "nav2")
        state = robot.told("state")
        assert state["goal_m"] < SUCCESS_DISTANCE_M
        assert state["speed"] == 0.0
