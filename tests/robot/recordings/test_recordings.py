"""Recordings of every format are read, set upright on their floor, and replayed."""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from hypernav.cli.main import main
from hypernav.core.errors import RecordingError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.robot.recordings.opening import open_recording
from hypernav.robot.recordings.upright import world_to_map
from small_worlds import two_rooms

_POSES = [Pose2(2.0, 1.0, 0.3), Pose2(2.4, 1.2, 0.5), Pose2(2.8, 1.3, 0.8)]
_Y_UP = Transform(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), np.array([7.0, -3.0, 2.0]))
"""From the scene to a world with y up and its origin somewhere."""


def _views():
    world = two_rooms()
    to_base = world.embodiment.camera.camera_to_base
    for pose in _POSES:
        camera_to_scene = pose.to_transform() @ to_base
        yield world.view_from(camera_to_scene), _Y_UP @ camera_to_scene


def _save(folder: Path, stem: str, view, per_metre: float) -> None:
    Image.fromarray(view.rgb).save(folder / f"{stem}.color.png")
    depth = np.rint(view.depth * per_metre).astype(np.uint16)
    Image.fromarray(depth).save(folder / f"{stem}.depth.png")


def write_matched_frames(folder: Path) -> None:
    camera = two_rooms().embodiment.camera.intrinsics
    matrix = [[camera.fx, 0, camera.cx - 0.5], [0, camera.fy, camera.cy - 0.5], [0, 0, 1]]
    np.savetxt(folder / "camera-intrinsics.txt", matrix)
    for number, (view, pose) in enumerate(_views()):
        _save(folder, f"frame-{number:06d}", view, 1000.0)
        np.savetxt(folder / f"frame-{number:06d}.pose.txt", pose.matrix)


def write_tum(folder: Path) -> None:
    camera = two_rooms().embodiment.camera.intrinsics
    numbers = [[camera.fx, camera.fy, camera.cx - 0.5, camera.cy - 0.5]]
    np.savetxt(folder / "camera.txt", numbers)
    lists = {"rgb": "# colour\n", "depth": "# depth\n", "groundtruth": "# poses\n"}
    for number, (view, pose) in enumerate(_views()):
        _save(folder, str(number), view, 5000.0)
        lists["rgb"] += f"{number}.000 {number}.color.png\n"
        lists["depth"] += f"{number}.010 {number}.depth.png\n"
        where = [*pose.translation, *Rotation.from_matrix(pose.rotation).as_quat()]
        lists["groundtruth"] += f"{number}.005 {' '.join(map(str, where))}\n"
    for name, text in lists.items():
        (folder / f"{name}.txt").write_text(text)


WRITERS = pytest.mark.parametrize("write", [write_matched_frames, write_tum])


@WRITERS
def test_a_recording_says_what_was_recorded(write, tmp_path):
    write(tmp_path)
    recording = open_recording(tmp_path)
    camera = two_rooms().embodiment.camera.intrinsics
    assert recording.camera.fx == pytest.approx(camera.fx)
    assert recording.camera.cx == pytest.approx(camera.cx)
    for frame, (view, pose) in zip(recording.frames, _views(), strict=True):
        assert np.array_equal(recording.rgb(frame), view.rgb)
        assert np.abs(recording.depth(frame) - view.depth).max() < 0.001
        assert np.allclose(frame.camera_to_world.matrix, pose.matrix, atol=1e-6)


@WRITERS
def test_it_is_set_upright_on_its_floor_with_the_first_camera_at_the_origin(write, tmp_path):
    write(tmp_path)
    recording = open_recording(tmp_path)
    to_map = world_to_map(recording)
    first, second = (to_map @ frame.camera_to_world for frame in recording.frames[:2])
    height_m = two_rooms().embodiment.camera.height_m
    assert first.translation == pytest.approx([0.0, 0.0, height_m], abs=0.04)
    assert first.rotation[:, 2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    driven = math.dist(_POSES[0].xy, _POSES[1].xy)
    bearing = _POSES[0].bearing_to(*_POSES[1].xy)
    assert second.translation[:2] == pytest.approx(
        [driven * math.cos(bearing), driven * math.sin(bearing)], abs=1e-6
    )


@WRITERS
def test_a_replay_draws_the_map_and_writes_the_page(write, tmp_path):
    (tmp_path / "recording").mkdir()
    write(tmp_path / "recording")
    arguments = ["robot", "replay", str(tmp_path / "recording"), "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit) as left:
        main([*arguments, "--quiet"])
    assert left.value.code == 0
    page = (tmp_path / "out" / "index.html").read_text()
    assert "A recording" in page
    assert len((tmp_path / "out" / "trace.jsonl").read_text().splitlines()) == len(_POSES)


def test_a_real_camera_shows_its_couch(test_data, tmp_path):
    pytest.importorskip("onnxruntime")
    detector = f"yolox:{test_data / 'models' / 'yolox_nano.onnx'}"
    arguments = ["robot", "replay", str(test_data / "rgbd" / "lounge"), "--goal", "couch"]
    with pytest.raises(SystemExit) as left:
        main([*arguments, "--detector", detector, "--out", str(tmp_path), "--quiet"])
    assert left.value.code == 0
    assert '"sightings": 5' in (tmp_path / "result.json").read_text()


def test_a_detector_without_a_goal_is_a_mistake(test_data, capsys):
    with pytest.raises(SystemExit) as left:
        main(["robot", "replay", str(test_data / "rgbd" / "lounge"), "--goal", "couch"])
    assert left.value.code == 2
    assert "--detector" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("frame-000001.pose.txt", "1 2 3", "16"),
        ("frame-000001.pose.txt", " ".join(["2.0"] * 16), "rigid"),
        ("frame-000001.color.png", "", "read|PNG"),
        ("camera-intrinsics.txt", "a b", "numbers"),
    ],
)
def test_what_is_broken_is_named(name, content, message, tmp_path):
    write_matched_frames(tmp_path)
    (tmp_path / name).write_text(content)

    def read() -> None:
        recording = open_recording(tmp_path)
        for frame in recording.frames:
            recording.rgb(frame)

    with pytest.raises(RecordingError, match=message):
        read()


def test_a_folder_without_a_recording_says_what_is_expected(tmp_path):
    with pytest.raises(RecordingError, match="TUM"):
        open_recording(tmp_path)
