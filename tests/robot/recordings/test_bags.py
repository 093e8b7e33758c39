"""Bags of ROS 1 and ROS 2 replay as the frames that they were written from."""

import io
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bag_writers import CAMERA_INFO, COLOUR, DEPTH, FORMATS, OPTICAL, write_bag
from frame_writers import write_matched_frames
from hypernav.cli.main import main
from hypernav.core.errors import (
    HyPerNavError,
    MissingExtraError,
    RecordingError,
    TopicChoiceError,
)
from hypernav.robot.recordings.opening import open_recording
from hypernav.robot.ros.topics import CameraTopics

EVERY_FORMAT = pytest.mark.parametrize("format", FORMATS)


@pytest.fixture
def frames(tmp_path):
    """A small recording of files."""
    folder = tmp_path / "frames"
    folder.mkdir()
    write_matched_frames(folder)
    return open_recording(folder)


def replay(path: Path, out: Path) -> None:
    with pytest.raises(SystemExit) as left:
        main(["robot", "replay", str(path), "--out", str(out), "--quiet"])
    assert left.value.code == 0


@pytest.fixture(scope="module")
def lounge_replayed(test_data, tmp_path_factory) -> Path:
    """What a replay of a real camera's frames leaves."""
    folder = tmp_path_factory.mktemp("of_frames")
    replay(test_data / "rgbd" / "lounge", folder)
    return folder


@EVERY_FORMAT
def test_a_bag_of_a_real_camera_replays_to_the_map_of_its_frames(
    format, test_data, lounge_replayed, tmp_path
):
    bag = write_bag(tmp_path, format, open_recording(test_data / "rgbd" / "lounge"))
    replay(bag, tmp_path / "of_bag")
    for name in ("map.pgm", "map.yaml"):
        assert (tmp_path / "of_bag" / name).read_bytes() == (lounge_replayed / name).read_bytes()


@EVERY_FORMAT
def test_a_bag_holds_the_very_images_and_poses(format, frames, tmp_path):
    with closing(open_recording(write_bag(tmp_path, format, frames))) as bag:
        assert bag.camera == frames.camera
        for told, seen in zip(frames.frames, bag.frames, strict=True):
            assert np.array_equal(told.rgb(), seen.rgb())
            assert np.array_equal(told.depth(), seen.depth())
            pose = told.camera_to_world.matrix
            assert np.allclose(pose, seen.camera_to_world.matrix, atol=1e-12)


def test_a_single_file_of_a_bag_is_one_too(frames, tmp_path):
    (file,) = write_bag(tmp_path, "mcap", frames).glob("*.mcap")
    with closing(open_recording(file.rename(tmp_path / "alone.mcap"))) as bag:
        assert len(bag.frames) == len(frames.frames)


def test_messages_of_every_transport_and_encoding_are_the_same_image(frames, tmp_path):
    def change(topic, message, make):
        stamp = message.header.stamp.sec if hasattr(message, "header") else 0
        if topic == COLOUR:
            pixels = message.data.reshape(message.height, message.width, 3)
            if stamp == 0:
                return topic, make.image(stamp, OPTICAL, "bgr8", pixels[:, :, ::-1])
            if stamp == 1:
                alpha = np.full_like(pixels[:, :, :1], 7)
                return topic, make.image(stamp, OPTICAL, "rgba8", np.dstack([pixels, alpha]))
        if topic == DEPTH and stamp == 0:
            metres = message.data.view("<u2").reshape(message.height, message.width) / 1000.0
            metres = np.where(metres == 0.0, np.nan, metres).astype(np.float32)
            return topic, make.image(stamp, OPTICAL, "32FC1", metres)
        return topic, message

    with closing(open_recording(write_bag(tmp_path, "sqlite", frames, change=change))) as bag:
        for told, seen in zip(frames.frames, bag.frames, strict=True):
            assert np.array_equal(told.rgb(), seen.rgb())
            assert np.allclose(told.depth(), seen.depth(), atol=1e-6)


def test_compressed_topics_do_where_there_are_no_others(frames, tmp_path):
    def change(topic, message, make):
        if topic not in (COLOUR, DEPTH):
            return topic, message
        stamp, file = message.header.stamp.sec, io.BytesIO()
        if topic == COLOUR:
            pixels = message.data.reshape(message.height, message.width, 3)
            Image.fromarray(pixels).save(file, "PNG")
            said = make.compressed(stamp, OPTICAL, "rgb8; png compressed bgr8", file.getvalue())
            return f"{topic}/compressed", said
        pixels = message.data.view("<u2").reshape(message.height, message.width)
        Image.fromarray(pixels).save(file, "PNG")
        data = bytes(12) + file.getvalue()
        said = make.compressed(stamp, OPTICAL, "16UC1; compressedDepth png", data)
        return f"{topic}/compressedDepth", said

    with closing(open_recording(write_bag(tmp_path, "mcap", frames, change=change))) as bag:
        for told, seen in zip(frames.frames, bag.frames, strict=True):
            assert np.array_equal(told.rgb(), seen.rgb())
            assert np.array_equal(told.depth(), seen.depth())


def two_cameras(topic, message, make):
    """Every second frame is another camera's."""
    if topic == COLOUR and message.header.stamp.sec == 1:
        return "/rear/color/image_raw", message
    return topic, message


def test_several_cameras_are_asked_about(frames, tmp_path):
    bag = write_bag(tmp_path, "sqlite", frames, change=two_cameras)
    with pytest.raises(TopicChoiceError, match=rf"{COLOUR}.*/rear/color/image_raw.*--colour-topic"):
        open_recording(bag)
    with closing(open_recording(bag, CameraTopics(colour=COLOUR))) as front:
        assert [frame.stamp_s for frame in front.frames] == [0.0, 2.0]


def test_the_command_takes_the_topic(frames, tmp_path):
    bag = write_bag(tmp_path, "sqlite", frames, change=two_cameras)
    out = tmp_path / "out"
    arguments = ["robot", "replay", str(bag), "--colour-topic", COLOUR, "--out", str(out)]
    with pytest.raises(SystemExit) as left:
        main([*arguments, "--quiet"])
    assert left.value.code == 0
    assert len((out / "trace.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize("wanted", [CameraTopics(), CameraTopics(depth=DEPTH)])
def test_depth_of_another_lens_is_refused(wanted, frames, tmp_path):
    def change(topic, message, make):
        if topic == DEPTH:
            message.header.frame_id = "camera_depth_optical_frame"
        return topic, message

    bag = write_bag(tmp_path, "sqlite", frames, change=change)
    with pytest.raises(TopicChoiceError, match="registered") as refused:
        open_recording(bag, wanted)
    assert "camera_depth_optical_frame" in str(refused.value)


@pytest.mark.parametrize("missing", [COLOUR, DEPTH, CAMERA_INFO, "/tf", "/tf_static"])
def test_what_is_missing_is_named(missing, frames, tmp_path):
    def change(topic, message, make):
        return None if topic == missing else (topic, message)

    bag = write_bag(tmp_path, "sqlite", frames, change=change)
    with pytest.raises(HyPerNavError, match=r"Image|CameraInfo|tf"):
        open_recording(bag)


@EVERY_FORMAT
def test_damaged_bags_are_one_error(format, frames, tmp_path):
    bag = write_bag(tmp_path, format, frames)
    files = [bag] if bag.is_file() else sorted(bag.iterdir())
    rng, refused = np.random.default_rng(1), 0
    for number in range(60):
        file = files[number % len(files)]
        whole = file.read_bytes()
        damaged = bytearray(whole)
        at = int(rng.integers(len(damaged)))
        if number % 3 == 0:
            del damaged[at:]
        elif number % 3 == 1:
            del damaged[at : at + 20]
        else:
            damaged[at] ^= 255
        file.write_bytes(damaged)
        try:
            with closing(open_recording(bag)) as recording:
                for frame in recording.frames:
                    frame.rgb()
                    frame.depth()
        except (RecordingError, TopicChoiceError):
            refused += 1
        file.write_bytes(whole)
    assert refused > 20


def test_a_missing_reader_says_what_to_install(frames, tmp_path, monkeypatch):
    bag = write_bag(tmp_path, "sqlite", frames)
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'hypernav\[bags\]'"):
        open_recording(bag)
