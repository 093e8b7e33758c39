"""Searches as MCAP, read back by the tools of the format."""

import json
import math
from contextlib import closing
from dataclasses import replace

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from scipy.spatial.transform import Rotation

from full_disks import full_disk
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers.foxglove_view import McapView
from hypernav.core.errors import OutputError
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from mcap_files import schemas_of

INFO = EpisodeInfo("bed", "hypernav", detector="ground truth", step_limit=100)
SCHEMAS = {
    "/tf": "foxglove.FrameTransforms",
    "/robot/pose": "foxglove.PoseInFrame",
    "/camera/image": "foxglove.CompressedImage",
    "/camera/calibration": "foxglove.CameraCalibration",
    "/camera/detections": "foxglove.ImageAnnotations",
    "/camera/points": "foxglove.PointCloud",
    "/map": "foxglove.Grid",
    "/plan": "foxglove.SceneUpdate",
    "/log": "foxglove.Log",
    "/step": "hypernav.Step",
    "/questions": "hypernav.Question",
}
ROBOT = Pose2(1.0, -2.0, 0.7)


@pytest.fixture
def seen(observation):
    """What a robot sees that stands somewhere and looks down a little."""
    camera_to_map = ROBOT.to_transform() @ optical_to_base(0.88, pitch_deg=20.0)
    return replace(observation, robot=ROBOT, camera_to_map=camera_to_map)


@pytest.fixture
def recorded(tmp_path, make_step, room, seen, sighting, result):
    path = tmp_path / "new" / "search.mcap"
    view = McapView(path, INFO)
    for number in range(6):
        view.add(make_step(number, detections=[sighting], events=["a bump"]), room, seen)
    view.finish(result | {"shortest_path_m": math.inf})
    view.close()
    return path


def messages_of(path, topic):
    """All messages of a topic, decoded, with their times in nanoseconds."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return [
            (message.log_time, decoded)
            for _, _, message, decoded in reader.iter_decoded_messages(topics=[topic])
        ]


def json_messages_of(path, topic):
    with path.open("rb") as file:
        return [json.loads(one.data) for _, _, one in make_reader(file).iter_messages([topic])]


def transform_of(message):
    rotation, offset = message.rotation, message.translation
    turn = Rotation.from_quat([rotation.x, rotation.y, rotation.z, rotation.w])
    return Transform(turn.as_matrix(), np.array([offset.x, offset.y, offset.z]))


def test_the_file_holds_every_topic_with_its_schema(recorded):
    schemas = schemas_of(recorded)
    assert {topic: name for topic, (name, _) in schemas.items()} == SCHEMAS
    assert all(content for _, content in schemas.values())


def test_goal_and_result_are_metadata(recorded):
    with recorded.open("rb") as file:
        kept = {one.name: one.metadata for one in make_reader(file).iter_metadata()}
    assert kept["search"]["goal"] == "bed"
    assert kept["result"]["outcome"] == '"found"'
    assert kept["result"]["shortest_path_m"] == "null"


def test_steps_are_a_second_apart(recorded):
    assert [time for time, _ in messages_of(recorded, "/map")] == [n * 10**9 for n in range(6)]


def test_the_transforms_lead_from_the_camera_to_the_map(recorded, seen):
    robot, camera = messages_of(recorded, "/tf")[0][1].transforms
    assert (robot.parent_frame_id, robot.child_frame_id) == ("map", "base_link")
    assert (camera.parent_frame_id, camera.child_frame_id) == ("base_link", "camera")
    chained = transform_of(robot) @ transform_of(camera)
    np.testing.assert_allclose(chained.matrix, seen.camera_to_map.matrix, atol=1e-12)


def test_the_points_lie_where_the_camera_measured_them(recorded, seen):
    cloud = messages_of(recorded, "/camera/points")[0][1]
    packed = np.frombuffer(cloud.data, dtype=[("xyz", "<f4", 3), ("rgba", "u1", 4)])
    assert [field.name for field in cloud.fields] == [
        "x",
        "y",
        "z",
        "red",
        "green",
        "blue",
        "alpha",
    ]
    assert (packed["rgba"] == (130, 130, 130, 255)).all()
    in_camera = seen.camera_to_map.inverse().apply(packed["xyz"].astype(np.float64))
    np.testing.assert_allclose(in_camera[:, 2], 2.0, atol=1e-5)
    pixels = seen.camera.project(in_camera)
    np.testing.assert_allclose(pixels % 1.0, 0.5, atol=1e-3)
    assert seen.camera.contains(pixels).all()


def test_the_map_covers_the_room_from_its_lower_left_corner(recorded, room):
    grid = messages_of(recorded, "/map")[0][1]
    colors = np.frombuffer(grid.data, np.uint8).reshape(-1, grid.column_count, 4)
    assert (grid.row_stride, grid.cell_stride) == (4 * grid.column_count, 4)
    x, y = grid.pose.position.x, grid.pose.position.y
    for position in ((1.0, 0.0), (-0.975, 0.0), (-1.2, 0.0)):  # free, wall, unknown
        column, row = int((position[0] - x) / 0.05), int((position[1] - y) / 0.05)
        red, _, _, alpha = colors[row, column]
        state = room.state_at(*position)
        assert (alpha, red > 200) == (0 if state.name == "UNKNOWN" else 255, state.name == "FREE")


def test_the_image_is_a_jpeg_of_the_cameras_size(recorded, seen):
    image = messages_of(recorded, "/camera/image")[0][1]
    assert image.format == "jpeg"
    decoded: np.ndarray | None = cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    assert decoded.shape == seen.rgb.shape
    assert abs(int(decoded.mean()) - 130) <= 2


def test_the_plan_names_the_blocks_and_fills_the_chosen_one(recorded):
    entities = {one.id: one for one in messages_of(recorded, "/plan")[2][1].entities}
    assert [text.text for text in entities["blocks"].texts] == ["1", "2"]
    (filled,) = entities["blocks"].cubes
    assert (filled.pose.position.x, filled.pose.position.y) == (1.25, -1.25)
    assert len(entities["trajectory"].lines[0].points) == 3


def test_questions_and_steps_are_json(recorded):
    questions = json_messages_of(recorded, "/questions")
    assert [one["kind"] for one in questions[:2]] == ["ground", "choose block"]
    assert questions[1]["answer"].startswith("2, because")
    step = json_messages_of(recorded, "/step")[0]
    assert (step["mode"], step["action"], step["events"]) == (
        "look around", "move forward", ["a bump"],
    )  # fmt: skip


def test_a_search_without_map_and_images_is_recorded_as_well(tmp_path, make_step):
    view = McapView(tmp_path / "bare.mcap", INFO)
    view.add(make_step(0), None, None)
    view.close()
    assert len(messages_of(tmp_path / "bare.mcap", "/robot/pose")) == 1
    assert messages_of(tmp_path / "bare.mcap", "/map") == []


def test_leaving_early_keeps_every_step(tmp_path, make_step, room, seen):
    view = McapView(tmp_path / "left.mcap", INFO)
    for number in range(3):
        view.add(make_step(number), room, seen)
    view.close()
    assert len(messages_of(tmp_path / "left.mcap", "/camera/image")) == 3


def test_a_full_disk_is_one_error_that_names_the_file(tmp_path, make_step, room, seen, capfd):
    rng = np.random.default_rng(0)

    def fill():
        with closing(McapView(tmp_path / "full.mcap", INFO)) as view, full_disk():
            for number in range(100):
                noise = rng.integers(0, 256, seen.rgb.shape, dtype=np.uint8)
                view.add(make_step(number), room, replace(seen, rgb=noise))

    with pytest.raises(OutputError, match=r"full\.mcap cannot be written \(File too large"):
        fill()
    assert capfd.readouterr() == ("", "")


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        McapView(tmp_path / "file" / "search.mcap", INFO)


def test_on_another_floor_robot_map_and_plan_lie_at_their_heights(tmp_path, make_step, room, seen):
    path = tmp_path / "floors.mcap"
    with closing(McapView(path, INFO)) as view:
        view.add(make_step(0), room, seen)
        view.add(make_step(1, mode="climb", z=1.5), room, seen)
        view.add(make_step(2, floor=2, z=3.0), room, seen)
    robots = [one.transforms[0].translation.z for _, one in messages_of(path, "/tf")]
    assert robots == [0.0, 1.5, 3.0]
    assert [one.pose.position.z for _, one in messages_of(path, "/robot/pose")] == robots
    assert [one.pose.position.z for _, one in messages_of(path, "/map")] == [0.0, 0.0, 3.0]
    drawn = {one.id: one for one in messages_of(path, "/plan")[2][1].entities}
    walked = [point.z for point in drawn["trajectory"].lines[0].points]
    np.testing.assert_allclose(np.array(walked) - walked[0], robots)
    assert all(text.pose.position.z > 3.0 for text in drawn["blocks"].texts)
