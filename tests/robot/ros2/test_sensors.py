"""A legged robot's sensors over DDS: odometry as a topic, a body that tilts, several cameras."""

import gc
import math
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from types import SimpleNamespace

import numpy as np
import pytest
from cyclonedds.sub import DataReader
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.errors import (
    ConfigError,
    RosNetworkError,
    TopicChoiceError,
    TransformMissingError,
)
from hypernav.core.geometry.transforms import Pose2
from hypernav.io.layered_config import layered
from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.network import Quality, Ros2Network
from hypernav.robot.ros2.outputs import ros_time
from hypernav.robot.ros2.sensors import RgbdStream, RivalOdometry, Ros2Sensors
from hypernav.robot.ros2.velocity_base import Ros2Base
from loopback import DOMAIN, LOOPBACK

PITCH = math.radians(10.0)
"""Downward tilt of the body."""
NAMED = (
    *("topics.colour=/front/image_raw", "topics.depth=/front/depth"),
    *("topics.camera_info=/front/camera_info", "topics.odometry=/odom"),
    *("frames.floor_z_m=-0.3", "timing.find_s=60"),
)
OPTICAL = ros.Quaternion(-0.5, 0.5, -0.5, 0.5)


@contextmanager
def legged_robot(
    network: Ros2Network,
    *,
    cameras: tuple[str, ...] = ("front",),
    late_s: Sequence[float] = (0.0,),
    odometry_behind_s: float = 0.0,
    speed_m_s: float = 0.0,
    namespace: str = "",
    mount: ros.Quaternion = OPTICAL,
    image: tuple[str, int, bytes] = ("rgb8", 192, bytes(192 * 48)),
) -> Iterator[None]:
    """Publishes 20 times a second until the block ends; the body stands at the origin of odom.

    With a speed it drifts to its left. In a namespace its odometry is in tf. An image is its
    encoding, the bytes of a row, and all bytes.

    All messages come later than they are stamped, by the first number of `late_s`; odometry is by
    so much older than images.
    """
    sensor, ended = Quality.SENSOR, threading.Event()
    network.subscribe("/cmd_vel", ros.Twist, Quality.RELIABLE, lambda _: None)
    colours = [network.publisher(f"/{name}/image_raw", ros.Image, sensor) for name in cameras]
    depths = [network.publisher(f"/{name}/depth", ros.Image, sensor) for name in cameras]
    infos = [network.publisher(f"/{name}/camera_info", ros.CameraInfo, sensor) for name in cameras]
    odometry = network.publisher("/odom", ros.Odometry)
    moving = network.publisher(f"{namespace}/tf", ros.TFMessage)
    static = network.publisher(f"{namespace}/tf_static", ros.TFMessage, Quality.STATIC)
    mounts = [
        ros.TransformStamped(
            ros.Header(frame_id="base_link"),
            f"{name}_optical",
            ros.Transform(ros.Vector3(0.2), mount),
        )
        for name in cameras
    ]
    static.publish(ros.TFMessage(mounts))
    body = ros.Pose(ros.Point(), ros.Quaternion(y=math.sin(PITCH / 2), w=math.cos(PITCH / 2)))

    began_s = time.time()

    def live() -> None:
        while not ended.wait(0.05):
            now_s = time.time() - late_s[0]
            stamp, odometry_s = ros_time(now_s), now_s - odometry_behind_s
            body.position.y = speed_m_s * (odometry_s - began_s)
            before = ros.Header(ros_time(odometry_s), "odom")
            if namespace:
                at = ros.Transform(ros.Vector3(y=body.position.y), body.orientation)
                moving.publish(ros.TFMessage([ros.TransformStamped(before, "base_link", at)]))
            else:
                odometry.publish(ros.Odometry(before, "base_link", ros.PoseWithCovariance(body)))
            for name, colour, depth, info in zip(cameras, colours, depths, infos, strict=True):
                header = ros.Header(stamp, f"{name}_optical")
                k = [40.0, 0.0, 31.5, 0.0, 40.0, 23.5, 0.0, 0.0, 1.0]
                info.publish(ros.CameraInfo(header, 48, 64, "plumb_bob", k=k))
                encoding, step, pixels = image
                colour.publish(ros.Image(header, 48, 64, encoding, 0, step, pixels))
                metres = np.full((48, 64), 1.5, dtype=np.float32).tobytes()
                depth.publish(ros.Image(header, 48, 64, "32FC1", 0, 256, metres))

    thread = threading.Thread(target=live)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def configured(*assignments: str) -> Ros2Config:
    return layered(Ros2Config(), environment={}, assignments=[f"domain={DOMAIN}", *assignments])


@pytest.fixture
def networks(monkeypatch) -> Iterator[tuple[Ros2Network, Ros2Network]]:
    """That of the robot and ours."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    with closing(Ros2Network(DOMAIN)) as theirs, closing(Ros2Network(DOMAIN)) as ours:
        yield theirs, ours


@pytest.mark.slow
def test_the_camera_of_a_tilted_body_is_where_it_is_over_the_floor(networks):
    theirs, ours = networks
    config = configured(*NAMED)
    with legged_robot(theirs), closing(Ros2Base(ours, config, Ros2Sensors(ours, config))) as base:
        sensed = base.sense()
        pose = sensed.camera_to_base
        assert pose is not None
        at = [0.2 * math.cos(PITCH), 0.0, 0.3 - 0.2 * math.sin(PITCH)]
        assert pose.translation == pytest.approx(at)
        forward = [math.cos(PITCH), 0.0, -math.sin(PITCH)]
        assert pose.rotation[:, 2] == pytest.approx(forward)
        assert base.embodiment.camera.pitch_deg == pytest.approx(10.0)
        assert base.embodiment.camera.height_m == pytest.approx(at[2])
        assert (sensed.depth == 1.5).all()
        assert (base.camera.cx, base.camera.cy) == (32.0, 24.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("range_m", "of_the_map"),
    [
        (("embodiment.camera.min_depth_m=2.0",), 0.0),
        # What is far draws nothing, but shows that everything before it is gone.
        (("embodiment.camera.min_depth_m=0.1", "embodiment.camera.max_depth_m=1.0"), 1.5),
    ],
)
def test_what_is_out_of_the_range_of_maps_is_in_the_way(networks, range_m, of_the_map):
    theirs, ours = networks
    config = configured(*NAMED, *range_m)
    with legged_robot(theirs), closing(Ros2Base(ours, config, Ros2Sensors(ours, config))) as base:
        assert (base.depth_view().depth == 1.5).all()
        assert (base.sense().depth == of_the_map).all()


@pytest.mark.slow
def test_a_live_camera_without_rgb_shows_its_colours(networks):
    theirs, ours = networks
    config = configured(*NAMED)
    red = ("yuv422_yuy2", 128, bytes([81, 90, 81, 240]) * (32 * 48))
    with (
        legged_robot(theirs, image=red),
        closing(Ros2Base(ours, config, Ros2Sensors(ours, config))) as base,
    ):
        assert np.abs(base.sense().rgb.astype(int) - [255, 0, 0]).max() <= 3


def test_a_camera_below_the_floor_names_the_floor(networks):
    theirs, ours = networks
    config = configured(*NAMED, "frames.floor_z_m=5")
    with legged_robot(theirs), pytest.raises(ConfigError, match=r"-5\.0.*floor_z_m"):
        Ros2Base(ours, config, Ros2Sensors(ours, config))


@pytest.mark.slow
def test_frames_of_a_robot_in_a_namespace_are_heard(networks):
    theirs, ours = networks
    frames = ("topics.tf=/robot1/tf", "topics.tf_static=/robot1/tf_static")
    config = configured(*NAMED[:3], *NAMED[4:], *frames)
    with legged_robot(theirs, namespace="/robot1"):
        pose = Ros2Sensors(ours, config).odometry()
        assert pose.xy == (0.0, 0.0)
        with pytest.raises(TransformMissingError):
            Ros2Sensors(ours, configured(*NAMED[:3], *NAMED[4:], "timing.find_s=4"))


@pytest.mark.slow
def test_two_robots_with_the_same_names_are_said(networks):
    theirs, ours = networks
    with legged_robot(theirs), legged_robot(theirs, speed_m_s=-5.0):
        sensors = Ros2Sensors(ours, configured(*NAMED))

        def watch() -> None:
            until_s = time.monotonic() + 30.0
            while time.monotonic() < until_s:
                sensors.wait_for_pair()
                time.sleep(0.05)

        with pytest.raises(TransformMissingError, match=r"'base_link' in 'odom': .* two robots"):
            watch()


def test_a_frame_that_is_not_optical_is_said(networks):
    theirs, ours = networks
    level = ros.Quaternion(y=-math.sin(PITCH / 2), w=math.cos(PITCH / 2))
    with (
        legged_robot(theirs, mount=level),
        pytest.raises(ConfigError, match=r"looks up by 90°.*'front_optical'.*_optical_frame"),
    ):
        Ros2Base(ours, configured(*NAMED), Ros2Sensors(ours, configured(*NAMED)))


@pytest.mark.slow
def test_of_several_cameras_one_must_be_named(networks):
    theirs, ours = networks
    with legged_robot(theirs, cameras=("front", "rear")):
        config = configured("topics.odometry=/odom", "timing.find_s=4")
        with pytest.raises(TopicChoiceError, match=r"/front/image_raw.*/rear.*topics\.colour"):
            Ros2Sensors(ours, config)
        named = configured(*NAMED)
        assert Ros2Sensors(ours, named).calibration.frame == "front_optical"


def readers(topic: str) -> set[int]:
    """The readers of a topic in this process."""
    found = [one for one in gc.get_objects() if type(one) is DataReader]
    return {id(one) for one in found if one.topic.get_name() == f"rt{topic}"}


def test_topics_that_were_only_looked_at_are_received_no_longer(networks):
    theirs, ours = networks
    before = readers("/front/camera_info")
    with legged_robot(theirs):
        sensors = Ros2Sensors(ours, configured(*NAMED))
        until_s = time.monotonic() + 10.0
        while readers("/front/camera_info") - before and time.monotonic() < until_s:
            time.sleep(0.1)
        assert not readers("/front/camera_info") - before
        assert sensors.calibration.frame == "front_optical"


@pytest.mark.slow
def test_a_robot_that_falls_silent_is_waited_for_and_then_given_up(networks):
    theirs, ours = networks
    config = configured(*NAMED, "timing.patience_s=1")
    with legged_robot(theirs):
        base = Ros2Base(ours, config, Ros2Sensors(ours, config))
    with closing(base), pytest.raises(RosNetworkError, match="no fresh images and odometry"):
        base.sense()


@pytest.mark.slow
def test_images_wait_for_the_odometry_of_their_time(networks):
    theirs, ours = networks
    config = configured(*NAMED)
    with (
        legged_robot(theirs, odometry_behind_s=0.25),
        closing(Ros2Base(ours, config, Ros2Sensors(ours, config))) as base,
    ):
        for _ in range(10):
            assert base.sense().stamp_s > 0.0
            assert (base.depth_view().depth == 1.5).all()


@pytest.mark.slow
def test_odometry_that_lags_too_far_behind_images_is_nothing_to_drive_by(networks):
    theirs, ours = networks
    config = configured(*NAMED, "timing.patience_s=2")
    with legged_robot(theirs, odometry_behind_s=0.45):
        sensors = Ros2Sensors(ours, config)
        with pytest.raises(RosNetworkError, match="no fresh images and odometry"):
            sensors.wait_for_pair()


@pytest.mark.slow
def test_odometry_that_lags_for_longer_than_images_are_kept_is_named_at_the_start(networks):
    theirs, ours = networks
    with (
        legged_robot(theirs, odometry_behind_s=1.5),
        pytest.raises(TransformMissingError, match=r"the odometry is 1\.[5-9].* behind all images"),
    ):
        Ros2Sensors(ours, configured(*NAMED, "timing.find_s=4"))


@pytest.mark.slow
def test_a_halt_ends_the_wait_for_images(networks):
    theirs, ours = networks
    config = configured(*NAMED)
    with legged_robot(theirs):
        base = Ros2Base(ours, config, Ros2Sensors(ours, config))
    time.sleep(1.0)  # what came last is old
    with closing(base):
        threading.Timer(0.3, base.halt).start()
        assert not base.depth_view().depth.any()


def test_a_delay_that_images_and_odometry_share_makes_them_old(networks):
    theirs, ours = networks
    late_s = [0.0]
    with legged_robot(theirs, late_s=late_s):
        sensors = Ros2Sensors(ours, configured(*NAMED))
        assert sensors.wait_for_pair() is not None
        late_s[0] = 0.7
        time.sleep(1.5)  # they come again, and still belong together
        assert not sensors.is_fresh()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "stands"),
    [((), False), (("nav2.still_s=1", "nav2.still_m=0.1"), True)],
)
def test_a_robot_stands_that_moves_less_than_the_file_says(networks, settings, stands):
    theirs, ours = networks
    with legged_robot(theirs, speed_m_s=0.06):
        sensors = Ros2Sensors(ours, configured(*NAMED, *settings))
        until_s = time.monotonic() + (60.0 if stands else 2.0)
        is_standing = False
        while not is_standing and time.monotonic() < until_s:
            sensors.wait_for_pair()
            is_standing = sensors.is_standing()
            time.sleep(0.02)
    assert is_standing is stands


def test_no_robot_is_an_error_that_names_the_domain(networks):
    with pytest.raises(TopicChoiceError, match="none; is the domain"):
        Ros2Sensors(networks[1], configured("timing.find_s=0.5"))


def words_of(*poses: Pose2) -> str | None:
    rivals = RivalOdometry()
    for pose in poses:
        rivals.note(pose)
    return rivals.words


@pytest.mark.parametrize("other", [Pose2(1.2, 0.0, 0.0), Pose2(0.0, 0.0, 0.5)])
def test_poses_that_jump_forth_and_back_have_two_publishers(other):
    words = words_of(*[Pose2(0.0, 0.0, 0.0), other] * 10)
    assert words is not None
    assert f"by {other.x:.2f} m" in words
    assert "two robots in one domain" in words


def test_a_driving_turning_swaying_and_once_relocalised_robot_has_one():
    driven = [Pose2(0.2 * i, 0.0, 0.1 * i) for i in range(40)]
    swaying = [Pose2(0.04 * math.sin(i), 0.0, 0.05 * math.cos(2 * i)) for i in range(40)]
    assert words_of(*driven, Pose2(0.0, 5.0, 1.0), *swaying) is None


def test_a_rival_that_has_ended_is_forgotten():
    jumping = [Pose2(0.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.0)] * 20
    assert words_of(*jumping, *[Pose2(0.0, 0.0, 0.0)] * 40) is None


class Clock:
    """A clock that is set by hand."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def image(at_ms: int) -> SimpleNamespace:
    stamp = SimpleNamespace(sec=at_ms // 1000, nanosec=at_ms % 1000 * 1_000_000)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp))


@given(st.permutations([("colour", 100), ("depth", 110), ("colour", 133), ("depth", 140)]))
def test_the_newest_pair_wins_in_whatever_order_images_come(arrivals):
    stream = RgbdStream(0.015)
    for name, at_ms in arrivals:
        (stream.add_colour if name == "colour" else stream.add_depth)(image(at_ms))
    assert stream.latest is not None
    assert stream.latest.stamp_s == 0.133
    assert stream.latest.depth.header.stamp.nanosec == 140_000_000


def test_images_too_far_apart_are_no_pair():
    stream = RgbdStream(0.015)
    stream.add_colour(image(100))
    stream.add_depth(image(116))
    assert stream.latest is None
    assert "no pair" in stream.described()


def test_a_camera_that_repeats_itself_sends_nothing_new():
    clock = Clock()
    stream = RgbdStream(0.015, clock=clock)
    for clock.now_s in (1.0, 2.0, 3.0):
        stream.add_colour(image(100))
        stream.add_depth(image(100))
    assert stream.latest is not None
    assert stream.latest.received_s == 1.0


def test_it_remembers_few_images():
    stream = RgbdStream(0.0)
    for at_ms in range(0, 10_000, 10):
        stream.add_colour(image(at_ms))
    stream.add_depth(image(0))
    assert stream.latest is None
    stream.add_depth(image(9_990))
    assert stream.latest is not None


def test_a_pair_of_before_is_there_for_an_odometry_that_lags_behind():
    stream = RgbdStream(0.0)
    for at_ms in (100, 200, 300):
        stream.add_colour(image(at_ms))
        stream.add_depth(image(at_ms))
    pair = stream.newest_until(0.25)
    assert pair is not None
    assert pair.stamp_s == 0.2
    assert stream.newest_until(0.05) is None


@pytest.mark.parametrize("period_ms", [10, 50, 200, 500])
def test_pairs_are_kept_for_as_long_at_any_rate(period_ms):
    stream = RgbdStream(0.0)
    for at_ms in range(0, 3001, period_ms):
        stream.add_colour(image(at_ms))
        stream.add_depth(image(at_ms))
    assert stream.newest_until(2.6) is not None
    assert stream.newest_until(2.35) is None
