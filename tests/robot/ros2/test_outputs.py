"""Map, path and markers are where the search has them, as RViz reads messages."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import BlockRecord, Mode, StepTrace
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Header, Time
from hypernav.robot.ros2.network import Quality
from hypernav.robot.ros2.outputs import (
    Ros2Outputs,
    frame_message,
    grid_message,
    image_message,
    marker_message,
    path_message,
)
from hypernav.robot.wire.replies import StartInMemory

HEADER = Header(Time(5, 6), "map")


def test_a_map_has_its_first_cell_at_the_lower_left():
    cells = np.full((2, 3), Cell.UNKNOWN, dtype=np.uint8)
    cells[0, 0], cells[1, 2] = Cell.OCCUPIED, Cell.FREE
    message = grid_message(OccupancyGrid(cells, 0.05, (-1.0, 2.0)), HEADER)
    assert (message.info.width, message.info.height) == (3, 2)
    assert (message.info.origin.position.x, message.info.origin.position.y) == (-1.0, 2.0)
    assert np.frombuffer(message.data, dtype=np.int8).tolist() == [100, -1, -1, -1, -1, 0]


def test_the_corners_of_a_path_look_ahead():
    poses = path_message([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0)], HEADER).poses
    yaws = [2.0 * math.atan2(p.pose.orientation.z, p.pose.orientation.w) for p in poses]
    assert np.allclose(yaws, [0.0, math.pi / 2.0, math.pi / 2.0])
    assert path_message([], HEADER).poses == []


def test_markers_replace_those_of_before():
    trace = StepTrace(
        step=3,
        pose=(0.0, 0.0, 0.0),
        action=None,
        mode=Mode.APPROACH,
        destination=(2.0, 1.0),
        goal_area=[[(2.0, 1.0), (2.2, 1.0), (2.2, 1.2)]],
    )
    blocks = [BlockRecord(number=4, x_min=1.0, y_min=-1.0, size_m=2.0)]
    first, *markers = marker_message(trace, blocks, HEADER).markers
    assert first.action == 3
    assert [(m.ns, m.id) for m in markers] == [
        ("blocks", 4),
        ("numbers", 4),
        ("goal area", 0),
        ("destination", 0),
    ]
    square = markers[0].points
    assert (square[0].x, square[0].y) == (square[-1].x, square[-1].y) == (1.0, -1.0)
    assert (markers[1].text, markers[1].pose.position.x) == ("4", 2.0)
    assert markers[3].text == "approach"


def test_an_image_has_rows_of_three_bytes_a_pixel():
    rgb = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    message = image_message(rgb, HEADER)
    assert (message.height, message.width, message.step, message.encoding) == (2, 4, 12, "rgb8")
    assert message.data == rgb.tobytes()


class Network:
    """Keeps what is published, and how."""

    def __init__(self) -> None:
        self.qualities: dict[str, Quality] = {}
        self.published: dict[str, list[Any]] = {}

    def publisher(self, topic: str, kind: type, quality: Quality = Quality.RELIABLE) -> Any:
        self.qualities[topic] = quality
        messages = self.published[topic] = list[Any]()
        return SimpleNamespace(publish=messages.append)


def test_of_map_and_image_only_the_last_is_kept_for_a_slow_reader():
    network: Any = Network()
    Ros2Outputs(network, Ros2Config())
    latched = {topic for topic, one in network.qualities.items() if one is Quality.LATCHED}
    assert latched == {"/hypernav/image", "/hypernav/map", "/hypernav/floor"}


def test_the_floor_of_the_map_is_named():
    network: Any = Network()
    outputs = Ros2Outputs(network, Ros2Config())
    step = StepTrace(step=0, pose=(0.0, 0.0, 0.0), action=None, mode=Mode.EXPLORE, reason="")
    grid = OccupancyGrid(np.zeros((2, 3), dtype=np.uint8), 0.05, (0.0, 0.0))
    for floor in (None, 2):
        trace = step.model_copy(update={"floor": floor})
        rgb = np.zeros((4, 4, 3), dtype=np.uint8)
        outputs.publish(trace, grid, rgb, at_s=0.0, camera_frame="camera")
    assert [one.data for one in network.published["/hypernav/floor"]] == ["floor 1", "floor 2"]


def found_at(x: float, y: float, yaw: float) -> StartInMemory:
    """The frame of the robot's poses begins there in the memory."""
    return StartInMemory(
        sure=True, doubt="", turns=11, floor=1, robot_frame=(x, y, yaw), robot_frame_z=0.5
    )


def test_a_position_of_the_memory_is_where_the_robot_has_it_by_the_published_frame():
    start = found_at(3.0, -1.0, 2.0)
    (made,) = frame_message(start, HEADER, "hypernav_map").transforms
    assert (made.header.frame_id, made.child_frame_id) == ("map", "hypernav_map")
    at, turn = made.transform.translation, made.transform.rotation
    published = Pose2(at.x, at.y, 2.0 * math.atan2(turn.z, turn.w)).to_transform(at.z)
    in_memory = np.array([[0.7, 0.2, 0.1]])
    there = start.robot_to_map.apply(published.apply(in_memory))
    assert np.allclose(there, in_memory)


def test_where_the_start_was_found_people_see_everything_in_the_memorys_frame():
    network: Any = Network()
    outputs = Ros2Outputs(network, Ros2Config())
    step = StepTrace(step=0, pose=(0.0, 0.0, 0.0), action=None, mode=Mode.EXPLORE, path=[(1, 2)])
    grid = OccupancyGrid(np.zeros((2, 3), dtype=np.uint8), 0.05, (0.0, 0.0))
    rgb = np.zeros((4, 4, 3), dtype=np.uint8)
    for start in (None, found_at(3.0, -1.0, 2.0), found_at(3.0, -1.0, 2.0)):
        outputs.publish(step, grid, rgb, at_s=0.0, camera_frame="camera", start=start)
    for topic in ("map", "path"):
        frames = [one.header.frame_id for one in network.published[f"/hypernav/{topic}"]]
        assert frames == ["odom", "hypernav_map", "hypernav_map"]
    (told,) = network.published["/tf_static"]
    assert told.transforms[0].header.frame_id == "odom"
