"""A robot in another process that speaks nothing but DDS, on the loopback interface."""

import json
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager

import pytest

from dds_processes import PATIENT, robot_in
from hypernav.app.cli.main import main
from hypernav.core.episode import SUCCESS_DISTANCE_M
from hypernav.core.errors import TopicChoiceError
from hypernav.io.layered_config import layered
from hypernav.robot.driving.base import Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import OccupancyGrid
from hypernav.robot.ros2.network import Quality, Ros2Network
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_base import Ros2Base
from loopback import DOMAIN, LOOPBACK
from mcap_files import counts_of
from rrd_files import images_in


@pytest.fixture(autouse=True)
def _loopback(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)


@contextmanager
def base_of(*assignments: str) -> Iterator[Ros2Base]:
    config = layered(Ros2Config(), environment={}, assignments=[*PATIENT, *assignments])
    with closing(Ros2Network(DOMAIN)) as network:
        sensors = Ros2Sensors(network, config)
        with closing(Ros2Base(network, config, sensors)) as base:
            yield base


@pytest.mark.slow
def test_a_camera_that_freezes_stops_the_robot_soon():
    with robot_in("builtin", (0.0, 0.0, 0.0)) as robot, base_of() as base:
        assert base.embodiment.camera.height_m == pytest.approx(0.88, abs=0.01)
        while robot.told("state")["speed"] == 0.0:  # a busy machine may stop it, too
            base.depth_view()
            base.drive(Velocity(0.2), 0.1)
        frozen = robot.told("freeze")
        until_s = time.monotonic() + 1.5
        while time.monotonic() < until_s:
            base.drive(Velocity(0.2), 0.05)  # whatever the search wants
        stopped = robot.told("state")
        assert stopped["speed"] == 0.0
        assert stopped["stopped_s"] - frozen["now_s"] < 0.6
        robot.told("thaw")
        base.depth_view()  # waits for the camera
        base.sense()


@pytest.mark.slow
def test_topics_are_found_by_type_and_a_wrong_name_lists_them():
    with robot_in("builtin", (0.0, 0.0, 0.0)), closing(Ros2Network(DOMAIN)) as network:
        config = layered(Ros2Config(), environment={}, assignments=PATIENT)
        assert Ros2Sensors(network, config).calibration.frame == "camera_optical_frame"
        config = layered(
            Ros2Config(), environment={}, assignments=["topics.colour=/nose", "timing.find_s=3"]
        )
        with pytest.raises(TopicChoiceError, match=r"/nose.*/camera/depth/image_raw"):
            Ros2Sensors(network, config)


@pytest.mark.slow
def test_the_bed_of_a_real_house_is_found_over_dds(small_house, test_data, tmp_path):
    pytest.importorskip("onnxruntime")
    detector = f"yolox:{test_data / 'models' / 'yolox_nano.onnx'}"
    with (
        robot_in(str(small_house), (-2.65, -0.68, -27.6), camera=(320, 240)) as robot,
        closing(Ros2Network(DOMAIN)) as rviz,
    ):
        maps: list[OccupancyGrid] = []
        rviz.subscribe("/hypernav/map", OccupancyGrid, Quality.LATCHED, maps.append)
        words = [word for value in PATIENT for word in ("--set", value)]
        files = ["--mcap", str(tmp_path / "a.mcap"), "--rrd", str(tmp_path / "a.rrd")]
        command = ["robot", "ros2", "bed", *words, "--detector", detector, *files]
        with pytest.raises(SystemExit) as left:
            main([*command, "--out", str(tmp_path), "--quiet"])
        assert left.value.code == 0
        result = json.loads((tmp_path / "result.json").read_text())
        assert (result["outcome"], result["reasoner"]) == ("found", "geometric")
        assert robot.told("state")["goal_m"] < SUCCESS_DISTANCE_M
    assert maps[-1].info.width * maps[-1].info.height == len(maps[-1].data)
    assert len(maps) > 5
    counts = counts_of(tmp_path / "a.mcap")
    assert counts["/step"] == result["steps"]
    assert 5 < counts["/camera/image"] == counts["/camera/points"] == images_in(tmp_path / "a.rrd")
