"""Bags of ROS 1 and ROS 2 replay as the frames that they were written from."""

import io
import shutil
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bag_writers import (
    CAMERA_INFO,
    COLOUR,
    DEPTH,
    FORMATS,
    OPTICAL,
    in_map_frame,
    repacked,
    write_bag,
)
from frame_writers import write_matched_frames
from hypernav.app.cli.main import main
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


def test_depth_that_may_be_infrared_is_noted(frames, tmp_path):
    def change(topic, message, _):
        if topic == DEPTH:
            message.encoding = "mono16"
        return topic, message

    with closing(open_recording(write_bag(tmp_path, "mcap", frames, change=change))) as bag:
        assert f"depth is read from {DEPTH}" in bag.notes[0]
        assert np.array_equal(bag.frames[0].depth(), frames.frames[0].depth())


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


def assert_same_frames(bag, frames, count=None):
    """The frames of a bag are those of another recording."""
    assert len(bag.frames) == (count or len(frames.frames))
    for told, seen in zip(frames.frames, bag.frames, strict=count is None):
        assert np.array_equal(told.rgb(), seen.rgb())
        assert np.array_equal(told.depth(), seen.depth())
        assert np.allclose(told.camera_to_world.matrix, seen.camera_to_world.matrix)


@pytest.mark.parametrize("name", ["odometry_then_wheels", "wheels_then_odometry"])
def test_all_publishers_of_a_topic_are_heard(name, test_data):
    field = test_data / "field"
    alone = open_recording(field / "13-tum-depth-in-mm" / "right")
    with closing(open_recording(field / "06-ros1-two-tf-publishers" / f"{name}.bag")) as bag:
        assert len(bag.frames) == 4
        first, last = bag.frames[0], bag.frames[-1]
        moved = (first.camera_to_world.inverse() @ last.camera_to_world).translation
        theirs = [alone.frames[k].camera_to_world for k in (0, -1)]
        assert moved == pytest.approx((theirs[0].inverse() @ theirs[1]).translation, abs=1e-6)
        assert not bag.notes


@EVERY_FORMAT
def test_two_cameras_on_one_topic_recorded_at_one_time_stay_apart(format, frames, tmp_path):
    """The clock of a simulation stands still for a while."""

    def one_time(at_s: float) -> int:
        return 5

    bag = write_bag(tmp_path, format, frames, recorded_ns=one_time, publishers=2)
    with closing(open_recording(bag)) as recording:
        assert_same_frames(recording, frames)


@pytest.mark.parametrize("encoding", ["bayer_rggb8", "yuv422_yuy2"])
def test_a_camera_without_rgb_shows_its_colours(encoding, test_data):
    field = test_data / "field"
    right = open_recording(field / "13-tum-depth-in-mm" / "right").frames[0].rgb()
    bag = field / "07-yuv-and-bayer-colour" / encoding / "recorded"
    with closing(open_recording(bag)) as recording:
        seen = recording.frames[0].rgb()
        assert np.median(np.abs(seen.astype(int) - right)) <= 4


def lost_for_a_while(topic, message, make):
    """The localisation says nothing in the middle of the recording."""
    if topic == "/tf" and message.transforms[0].header.stamp.sec == 1:
        rotation = message.transforms[0].transform.rotation
        rotation.x = rotation.y = rotation.z = rotation.w = 0.0
    return topic, message


def test_frames_without_a_pose_in_tf_are_left_out_and_counted(frames, tmp_path):
    bag = write_bag(tmp_path, "sqlite", frames, change=lost_for_a_while)
    with closing(open_recording(bag)) as recording:
        assert [frame.stamp_s for frame in recording.frames] == [0.0, 2.0]
        said = " ".join(recording.notes)
    assert "1 of 3 messages of /tf are left out" in said
    assert "1 of 3 colour images are left out" in said


def cut(path: Path, bytes_left: int) -> None:
    path.write_bytes(path.read_bytes()[:bytes_left])


def test_a_cut_file_is_read_up_to_the_cut(test_data):
    whole = test_data / "field" / "14-recording-not-closed" / "no_metadata" / "recorded.mcap"
    with (
        closing(open_recording(whole.parent.parent / "cut.mcap")) as some,
        closing(open_recording(whole)) as all_frames,
    ):
        assert_same_frames(some, all_frames, count=3)
        assert "was not closed" in some.notes[0]
        assert not all_frames.notes


@pytest.mark.parametrize("metadata", [None, ""])
@pytest.mark.parametrize("format", ["sqlite", "mcap"])
def test_a_folder_without_metadata_is_read(format, metadata, frames, tmp_path):
    bag = write_bag(tmp_path, format, frames)
    (bag / "metadata.yaml").unlink()
    if metadata is not None:
        (bag / "metadata.yaml").write_text(metadata)
    with closing(open_recording(bag)) as recording:
        assert_same_frames(recording, frames)
        assert "was not closed" in recording.notes[0]


@pytest.mark.parametrize("compression", ["", "lz4", "zstd"])
def test_every_whole_message_of_a_cut_chunk_is_read(compression, frames, tmp_path):
    rng = np.random.default_rng(0)

    def noisy(topic, message, make):
        if topic == COLOUR:
            message.data = rng.integers(0, 256, message.data.size, dtype=np.uint8)
        return topic, message

    (whole,) = write_bag(tmp_path, "mcap", frames, change=noisy).glob("*.mcap")
    path = tmp_path / "cut.mcap"
    repacked(whole, path, compression)
    size = path.stat().st_size
    counts = []
    for share in (1.0, 0.8, 0.5):
        cut(path, int(size * share) - 40)
        with closing(open_recording(path)) as recording:
            counts.append(len(recording.frames))
            recording.frames[-1].depth()
    assert counts[0] >= counts[1] >= counts[2] >= 1
    assert counts[0] > counts[2]


def test_blocks_that_were_never_written_end_a_file(frames, tmp_path):
    (file,) = write_bag(tmp_path, "mcap", frames).glob("*.mcap")
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) * 2 // 3] + bytes(4096))
    with closing(open_recording(file)) as recording:
        assert 0 < len(recording.frames) < 3


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("cut.bag", "rosbag reindex"),
        ("recording.bag.active", "rosbag reindex"),
        ("cut.db3", "recover"),
    ],
)
def test_what_must_be_mended_first_says_how(name, command, frames, tmp_path):
    source = write_bag(tmp_path, "sqlite" if name.endswith("db3") else "ros1", frames)
    file = source if source.is_file() else next(source.glob("*.db3"))
    path = tmp_path / name
    shutil.copy(file, path)
    cut(path, file.stat().st_size * 2 // 3)
    with pytest.raises(RecordingError, match=f"{command}.*{name}|{name}.*{command}"):
        open_recording(path)


def test_packed_files_without_metadata_are_to_be_unpacked(tmp_path):
    (tmp_path / "recorded_0.db3.zstd").write_bytes(b"packed")
    with pytest.raises(RecordingError, match=r"zstd -d .*recorded_0\.db3\.zstd"):
        open_recording(tmp_path)


@pytest.mark.parametrize("unset", [{0, 1, 2}, {2}])
def test_images_without_a_time_have_that_of_their_recording(unset, frames, tmp_path):
    def change(topic, message, make):
        if topic in (COLOUR, DEPTH) and message.header.stamp.sec in unset:
            message.header.stamp.sec = message.header.stamp.nanosec = 0
        return topic, message

    with closing(open_recording(write_bag(tmp_path, "mcap", frames, change=change))) as bag:
        assert_same_frames(bag, frames)
        assert f"{len(unset)} of 3 messages of {COLOUR} have no time" in bag.notes[0]


def upright(topic, message, make):
    """A robot in a world whose z axis points up, with images in the frame of the camera's body."""
    if topic == "/tf_static":
        rotation = message.transforms[0].transform.rotation
        rotation.x = rotation.y = rotation.z = 0.0
        rotation.w = 1.0
        message.transforms[0].child_frame_id = "camera_link"
    if hasattr(message, "header"):
        message.header.frame_id = "camera_link"
    return topic, message


def test_a_frame_of_the_body_of_the_camera_is_no_optical_frame(tmp_path, frames):
    turned = in_map_frame(frames)
    (tmp_path / "optical").mkdir()
    (tmp_path / "body").mkdir()
    right = write_bag(tmp_path / "optical", "mcap", turned)
    named_wrongly = write_bag(tmp_path / "body", "mcap", turned, change=upright)
    with closing(open_recording(right)) as first, closing(open_recording(named_wrongly)) as second:
        assert_same_frames(second, first)
        assert not first.notes
        assert "'camera_link', whose z axis points up" in second.notes[0]


def test_two_publishers_that_contradict_each_other_are_named(frames, tmp_path):
    def change(topic, message, make):
        if topic == "/tf" and message.transforms[0].header.stamp.sec == 1:
            message.transforms[0].header.frame_id = "zed_odom"
        return topic, message

    with pytest.raises(RecordingError, match=r"'base_link'.*'odom'.*'zed_odom'.*switch"):
        open_recording(write_bag(tmp_path, "ros1", frames, change=change))


def test_a_bag_of_realsense_s_own_tools_says_how_it_becomes_one_of_ros(frames, tmp_path):
    names = {
        COLOUR: "/device_0/sensor_1/Color_0/image/data",
        DEPTH: "/device_0/sensor_0/Depth_0/image/data",
        CAMERA_INFO: "/device_0/sensor_1/Color_0/info/camera_info",
    }

    def change(topic, message, make):
        if topic not in names:
            return None
        message.header.frame_id = "0"
        return names[topic], message

    with pytest.raises(RecordingError, match=r"rosbag_filename:=/.*align_depth\.enable"):
        open_recording(write_bag(tmp_path, "ros1", frames, change=change))
