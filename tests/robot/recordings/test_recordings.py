"""Recordings of every format are read, set upright on their floor, and replayed."""

import math

import numpy as np
import pytest

from frame_writers import POSES, views, write_matched_frames, write_tum
from hypernav.cli.main import main
from hypernav.core.errors import RecordingError
from hypernav.robot.recordings.opening import open_recording
from hypernav.robot.recordings.upright import world_to_map
from mcap_files import counts_of
from rrd_files import images_in
from small_worlds import two_rooms

WRITERS = pytest.mark.parametrize("write", [write_matched_frames, write_tum])


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
