"""Recordings of every format are read, set upright on their floor, and replayed."""

import json
import math
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from frame_writers import POSES, views, write_matched_frames, write_scannet, write_tum
from hypernav.app.cli.main import main
from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.opening import open_recording
from hypernav.robot.recordings.replay import world_to_map
from mcap_files import counts_of
from rrd_files import images_in
from small_worlds import two_rooms

WRITERS = pytest.mark.parametrize("write", [write_matched_frames, write_tum, write_scannet])


@WRITERS
def test_a_recording_says_what_was_recorded(write, tmp_path):
    write(tmp_path)
    recording = open_recording(tmp_path)
    camera = two_rooms().embodiment.camera.intrinsics
    assert recording.camera.fx == pytest.approx(camera.fx)
    assert recording.camera.cx == pytest.approx(camera.cx)
    for frame, (view, pose) in zip(recording.frames, views(), strict=True):
        assert np.array_equal(frame.rgb(), view.rgb)
        assert np.abs(frame.depth() - view.depth).max() < 0.001
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
    driven = math.dist(POSES[0].xy, POSES[1].xy)
    bearing = POSES[0].bearing_to(*POSES[1].xy)
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
    assert len((tmp_path / "out" / "trace.jsonl").read_text().splitlines()) == len(POSES)


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
        ("camera-intrinsics.txt", "nan 0 1 0 nan 1 0 0 1", "camera-intrinsics.txt"),
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
            frame.rgb()

    with pytest.raises(RecordingError, match=message):
        read()


LOST = {
    "-inf": ["-inf"] * 16,
    "nan": ["nan"] * 16,
    "Microsoft's NaN": ["-1.#IND00", "1.#QNAN"] * 8,
    "zeros": ["0"] * 16,
}


@pytest.mark.parametrize("lost", LOST.values(), ids=LOST)
def test_frames_without_a_pose_are_left_out_and_counted(lost, tmp_path, capsys):
    folder = tmp_path / "recording"
    folder.mkdir()
    write_matched_frames(folder)
    (folder / "frame-000001.pose.txt").write_text(" ".join(lost))
    assert len(open_recording(folder).frames) == len(POSES) - 1
    with pytest.raises(SystemExit) as left:
        main(["robot", "replay", str(folder), "--out", str(tmp_path / "out")])
    assert left.value.code == 0
    note = f"1 of {len(POSES)} frames are left out: they have no valid pose"
    assert note in capsys.readouterr().err
    assert json.loads((tmp_path / "out" / "result.json").read_text())["notes"] == [note]


IDENTITY = " ".join(map(str, np.eye(4).ravel()))


def write_poses(folder: Path, *poses: str) -> list[float]:
    """The frames of a recording with these poses in the places of its own; times that are read."""
    write_matched_frames(folder)
    for number, pose in enumerate(poses):
        for kind in ("color.png", "depth.png"):
            target = folder / f"frame-{number:06d}.{kind}"
            if not target.exists():
                shutil.copy(folder / f"frame-000000.{kind}", target)
        (folder / f"frame-{number:06d}.pose.txt").write_text(pose)
    return [frame.stamp_s for frame in open_recording(folder).frames]


def at(x: float) -> str:
    return f"1 0 0 {x} 0 1 0 0 0 0 1 0 0 0 0 1"


def test_the_identity_is_a_lost_pose_once_the_camera_has_moved(tmp_path):
    poses = [IDENTITY, IDENTITY, at(0.1), IDENTITY, at(0.2), IDENTITY]
    assert write_poses(tmp_path, *poses) == [0.0, 1.0, 2.0, 4.0]
    assert (
        open_recording(tmp_path)
        .notes[0]
        .startswith("2 of 6 frames are left out: their pose is exactly the identity")
    )


def test_the_identity_is_a_lost_pose_far_from_where_the_recording_goes_on(tmp_path):
    along = [at(3.0 + 0.1 * k) for k in range(6)]
    assert write_poses(tmp_path, IDENTITY, *along) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert "1 of 7 frames are left out" in open_recording(tmp_path).notes[0]


@WRITERS
def test_poses_that_are_all_the_identity_are_noted(write, tmp_path):
    write(tmp_path)
    assert not any("identity" in note for note in open_recording(tmp_path).notes)
    for path in [*tmp_path.glob("*.pose.txt"), *tmp_path.glob("pose/*.txt")]:
        path.write_text(IDENTITY)
    if write is write_tum:
        lines = [f"{number}.005 0 0 0 0 0 0 1" for number in range(len(POSES))]
        (tmp_path / "groundtruth.txt").write_text("\n".join(lines))
    recording = open_recording(tmp_path)
    assert len(recording.frames) == len(POSES)
    assert f"poses of all {len(POSES)} frames are exactly the id" in " ".join(recording.notes)


@pytest.mark.parametrize(
    ("name", "line", "expected"),
    [
        ("groundtruth.txt", "timestamp tx ty tz qx qy qz qw", "'time x y z qx qy qz qw'"),
        ("groundtruth.txt", "1.0,0,0,0,0,0,0,1", "'time x y z qx qy qz qw'.*spaces for its commas"),
        ("groundtruth.txt", "1.0 0 0 0 0 0 0", "'time x y z qx qy qz qw'"),
        ("rgb.txt", "timestamp filename", "'time file'"),
        ("depth.txt", "1.0,1.depth.png", "'time file'.*spaces for its commas"),
        ("camera.txt", "fx fy cx cy", "4 numbers in all"),
    ],
)
def test_a_line_that_is_no_row_of_its_file_is_named_with_what_it_should_be(
    name, line, expected, tmp_path
):
    write_tum(tmp_path)
    path = tmp_path / name
    path.write_text(f"# a comment\n{line}\n{path.read_text()}")
    with pytest.raises(RecordingError, match=rf"{name}, line 2: expected .*{expected}") as error:
        open_recording(tmp_path)
    assert f"found '{line}'" in str(error.value)
    assert "convert" not in str(error.value)
    assert "\n" not in str(error.value)


def test_an_empty_pose_is_a_lost_one(tmp_path):
    write_matched_frames(tmp_path)
    (tmp_path / "frame-000001.pose.txt").write_text("\n")
    assert len(open_recording(tmp_path).frames) == len(POSES) - 1


def test_the_benchmarks_camera_is_not_assumed_for_images_of_another_size(tmp_path):
    write_tum(tmp_path)
    (tmp_path / "camera.txt").unlink()
    with pytest.raises(RecordingError, match=r"write fx fy cx cy of yours into camera\.txt"):
        open_recording(tmp_path)


@pytest.mark.parametrize(
    "lost", ["0 0 0 0 0 0 0", "nan nan nan nan nan nan nan", "1 2 3 0 0 -inf 1"]
)
def test_lost_poses_of_a_trajectory_are_left_out_and_counted(lost, tmp_path):
    write_tum(tmp_path)
    path = tmp_path / "groundtruth.txt"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:2], f"1.005 {lost}", *lines[3:]]))
    recording = open_recording(tmp_path)
    assert [frame.stamp_s for frame in recording.frames] == [0.0, 2.0]
    said = " ".join(recording.notes)
    assert f"1 of {len(POSES)} poses of groundtruth.txt are left out" in said
    assert f"1 of {len(POSES)} colour images are left out" in said


def test_frames_of_scannet_without_a_pose_are_left_out_and_counted(tmp_path):
    write_scannet(tmp_path)
    (tmp_path / "pose" / "1.txt").write_text(" ".join(["-inf"] * 16))
    recording = open_recording(tmp_path)
    assert [frame.stamp_s for frame in recording.frames] == [0.0, 2.0]
    assert recording.notes == ["1 of 3 frames are left out: they have no valid pose"]


def test_the_field_s_lost_pose_is_left_out(test_data):
    recording = open_recording(test_data / "field" / "08-lost-poses" / "seven_scenes_inf")
    assert len(recording.frames) == 3
    assert recording.notes == ["1 of 4 frames are left out: they have no valid pose"]


WINDOWS = {
    "a mark": lambda text: b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode(),
    "UTF-16": lambda text: text.replace("\n", "\r\n").encode("utf-16"),
}


@pytest.mark.parametrize("written", WINDOWS.values(), ids=WINDOWS)
@WRITERS
def test_text_files_of_windows_are_read(write, written, tmp_path):
    write(tmp_path)
    told = open_recording(tmp_path)
    for path in tmp_path.rglob("*.txt"):
        path.write_bytes(written(path.read_text()))
    seen = open_recording(tmp_path)
    assert seen.camera == told.camera
    assert [frame.stamp_s for frame in seen.frames] == [frame.stamp_s for frame in told.frames]
    assert not seen.notes


def test_the_field_s_byte_order_mark_is_no_text(test_data):
    assert len(open_recording(test_data / "field" / "15-bom" / "tum").frames) == 4


@pytest.mark.parametrize("per_second", [1e3, 1e6, 1e9])
def test_times_count_any_part_of_a_second(per_second, tmp_path):
    write_tum(tmp_path)
    for name in ("rgb", "depth", "groundtruth"):
        path = tmp_path / f"{name}.txt"
        lines = [line.split(" ", 1) for line in path.read_text().splitlines()]
        written = [
            f"{round((float(at) + 1.4e9) * per_second)} {rest}" if at != "#" else f"# {rest}"
            for at, rest in lines
        ]
        path.write_text("\n".join(written))
    seen = [frame.stamp_s for frame in open_recording(tmp_path).frames]
    assert seen == pytest.approx([1.4e9, 1.4e9 + 1.0, 1.4e9 + 2.0], abs=1e-3)


def test_a_missing_trajectory_is_named_with_where_to_get_it(tmp_path):
    write_tum(tmp_path)
    (tmp_path / "groundtruth.txt").unlink()
    with pytest.raises(RecordingError, match=r"groundtruth\.txt.*CameraTrajectory"):
        open_recording(tmp_path)


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("kinect.mkv", "recording_file:="),
        ("zed.svo2", "svo_path:="),
        ("scene0000_00.sens", "--export_poses"),
    ],
)
def test_other_recordings_are_named_with_a_way_to_one_that_is_read(name, way, tmp_path):
    (tmp_path / name).write_bytes(b"recorded")
    with pytest.raises(RecordingError, match=f"{way}.*{name}|{name}.*{way}"):
        open_recording(tmp_path / name)


def test_a_folder_without_a_recording_says_what_is_expected(tmp_path):
    with pytest.raises(RecordingError, match="TUM"):
        open_recording(tmp_path)


def test_a_replay_is_recorded_for_the_viewers_as_a_search_is(tmp_path):
    (tmp_path / "recording").mkdir()
    write_matched_frames(tmp_path / "recording")
    files = ["--mcap", str(tmp_path / "a.mcap"), "--rrd", str(tmp_path / "a.rrd")]
    arguments = ["robot", "replay", str(tmp_path / "recording"), "--out", str(tmp_path / "out")]
    with pytest.raises(SystemExit) as left:
        main([*arguments, *files, "--quiet"])
    assert left.value.code == 0
    counts = counts_of(tmp_path / "a.mcap")
    assert {counts[f"/{name}"] for name in ("step", "map", "camera/image", "camera/points")} == {
        len(POSES)
    }
    assert images_in(tmp_path / "a.rrd") == len(POSES)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap"])
def test_a_pipe_is_no_recording(name, tmp_path):
    os.mkfifo(tmp_path / name)
    with pytest.raises(RecordingError, match="cannot be read"):
        open_recording(tmp_path / name)
