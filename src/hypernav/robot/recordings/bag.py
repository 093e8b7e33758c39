"""Bags of ROS 1 and ROS 2, read without ROS: by the package ``rosbags`` (extra ``bags``)."""

from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.errors import RecordingError, TransformMissingError
from hypernav.robot.recordings.bag_file import BagFile
from hypernav.robot.recordings.recording import RecordedFrame, Recording
from hypernav.robot.ros.calibration import Calibration, calibration_of
from hypernav.robot.ros.images import colour_of, depth_of
from hypernav.robot.ros.messages import frame_name, stamp_s
from hypernav.robot.ros.topics import (
    CAMERA_TYPES,
    CameraTopics,
    ChosenTopics,
    OfferedTopic,
    choose_topics,
    is_rectified,
    offered_topic,
)
from hypernav.robot.ros.transform_tree import TransformTree

_APART_S = 0.02
"""Largest difference of the times of colour and depth that belong together."""
_TRANSFORM_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
_ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
_SUFFIXES = (".bag", ".db3", ".mcap")


def is_bag(path: Path) -> bool:
    """Whether a path is a bag: a ROS 1 file, a rosbag2 folder, or a file of such a folder."""
    return path.suffix in _SUFFIXES or (path / "metadata.yaml").is_file()


def read_bag(path: Path, topics: CameraTopics) -> Recording:
    """Read everything but the images, which are read when they are asked for.

    The world is the root of the camera's frames: ``map`` if the robot was localised, else the frame
    of its odometry. Images without a pose, and colour or depth without the other, are left out.

    Raises:
        RecordingError: The bag is damaged, or needed data is missing.
        TopicChoiceError: No topic fits, or several do.
        MissingExtraError: The package that reads bags is not installed.
    """
    with ExitStack() as opened:
        bag = opened.enter_context(BagFile(path))
        chosen = choose_topics(_offered(bag), topics, option_of=_option_of)
        with bag.checked():
            calibration = calibration_of(
                bag.first(chosen.camera_info.name), rectified=is_rectified(chosen.colour)
            )
        frames = list(_frames(bag, chosen, calibration))
        return Recording(path.name, calibration.camera, frames, opened.pop_all().close)


def _offered(bag: BagFile) -> Iterator[OfferedTopic]:
    """Topics that may be the camera's, judged by their first messages."""
    for name in bag.topics(*CAMERA_TYPES):
        offer = offered_topic(name, bag.first(name))
        if offer is not None:
            yield offer


def _option_of(role: str) -> str:
    return f"--{role.replace('_', '-')}-topic"


def _frames(
    bag: BagFile, chosen: ChosenTopics, calibration: Calibration
) -> Iterator[RecordedFrame]:
    """All pairs of images with a pose.

    Raises:
        RecordingError: There is none.
    """
    tree = _transforms(bag)
    if not tree.is_moving(calibration.frame):
        raise RecordingError(
            f"{bag.path}: neither tf nor odometry says how '{calibration.frame}' moves; record "
            "/tf and /tf_static with the images"
        )
    world = tree.root_of(calibration.frame)
    depths = [(stamp_s(message.header), at) for at, message in bag.messages(chosen.depth.name)]
    depth_stamps = np.array([stamp for stamp, _ in depths])
    reason = f"no colour image has a depth image within {_APART_S:g} s"
    count = 0
    for at, message in bag.messages(chosen.colour.name):
        stamp = stamp_s(message.header)
        near = int(np.abs(depth_stamps - stamp).argmin())
        if abs(depth_stamps[near] - stamp) > _APART_S:
            continue
        try:
            pose = tree.pose(calibration.frame, world, stamp)
        except TransformMissingError as error:
            reason = str(error)
            continue
        count += 1
        rgb = partial(_rgb, bag, chosen.colour.name, at, calibration)
        depth = partial(_depth, bag, chosen.depth.name, depths[near][1], calibration)
        yield RecordedFrame(f"{stamp:.3f}", pose, stamp, rgb, depth)
    if count == 0:
        raise RecordingError(f"{bag.path} holds no frame that can be used: {reason}")


def _transforms(bag: BagFile) -> TransformTree:
    """All poses of all frames; odometry only where tf lacks that pose."""
    tree = TransformTree()
    with bag.checked():
        for name in bag.topics(*_TRANSFORM_TYPES):
            for _, message in bag.messages(name):
                tree.add_message(message, static=name.endswith("tf_static"))
        for name in bag.topics(_ODOMETRY_TYPE):
            child = frame_name(bag.first(name).child_frame_id)
            if child in tree:
                continue
            for _, message in bag.messages(name):
                tree.add_odometry(message)
    return tree


def _rgb(
    bag: BagFile, topic: str, at: int, calibration: Calibration
) -> UInt8[np.ndarray, "height width 3"]:
    with bag.checked():
        return calibration.straightened_colour(colour_of(bag.message(topic, at)))


def _depth(
    bag: BagFile, topic: str, at: int, calibration: Calibration
) -> Float32[np.ndarray, "height width"]:
    with bag.checked():
        return calibration.straightened_depth(depth_of(bag.message(topic, at)))
