"""Bags of ROS 1 and ROS 2, read without ROS: by the package ``rosbags`` (extra ``bags``)."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.errors import RecordingError, RosMessageError, TransformMissingError
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.bag_file import STORAGES, BagFile, MessageKey
from hypernav.robot.recordings.recording import RecordedFrame, Recording, left_out
from hypernav.robot.ros.images import colour_of, depth_of, depth_per_metre
from hypernav.robot.ros.messages import Calibration, calibration_of, frame_name, stamp_s
from hypernav.robot.ros.topics import (
    CAMERA_TYPES,
    CameraTopics,
    ChosenTopics,
    choose_topics,
    is_rectified,
    offered_topic,
)
from hypernav.robot.ros.transform_tree import TransformTree

_APART_S = 0.02
"""Largest difference of the times of colour and depth that belong together."""
_TRANSFORM_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
_ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
_SDK = "/device_0/sensor_"
"""Begin of the topics that librealsense records (rs-record, RealSense Viewer)."""
_SUFFIXES = (*STORAGES, ".bag", ".active")
_Z_UP = ("map", "odom")
"""Frames whose z axis points up, by REP 105."""
_UP = 0.7
"""Cosine of the angle to z up, from which on an axis points up."""
_OPTICAL_TO_BODY = Transform(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.zeros(3))
"""From x right, y down, z forward to x forward, y left, z up (REP 103)."""


def is_bag(path: Path) -> bool:
    """Whether a path is a bag: a ROS 1 file, a rosbag2 folder, or a file of such a folder."""
    if not path.is_dir():
        return path.suffix in _SUFFIXES
    names = ("metadata.yaml", *(f"*{suffix}*" for suffix in STORAGES))
    return any(next(path.glob(name), None) is not None for name in names)


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
        if any(name.startswith(_SDK) for name in bag.topics(*CAMERA_TYPES)):
            raise RecordingError(
                f"{path} is of RealSense's own tools, not of ROS: its depth is not registered, and "
                "it has no poses. Play it with 'ros2 launch realsense2_camera rs_launch.py "
                f"rosbag_filename:={path.absolute()} align_depth.enable:=true', and record a bag "
                "with the poses of a SLAM program"
            )
        offers = [offered_topic(name, bag.first(name)) for name in bag.topics(*CAMERA_TYPES)]
        chosen = choose_topics(offers, topics, option_of=_option_of)
        if chosen.depth.grey:
            bag.notes.append(
                f"depth is read from {chosen.depth.name}, in millimetres; its encoding "
                f"'{chosen.depth.encoding}' may also be that of infrared images"
            )
        with bag.checked():
            calibration = calibration_of(
                bag.first(chosen.camera_info.name), rectified=is_rectified(chosen.colour)
            )
        frames = _frames(bag, chosen, calibration)
        return Recording(
            path.name,
            calibration.camera,
            frames,
            depth_per_metre(chosen.depth.encoding),
            bag.notes,
            opened.pop_all().close,
        )


def _option_of(role: str) -> str:
    return f"--{role.replace('_', '-')}-topic"


def _frames(bag: BagFile, chosen: ChosenTopics, calibration: Calibration) -> list[RecordedFrame]:
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
    colours, depths = (_stamped(bag, topic.name) for topic in (chosen.colour, chosen.depth))
    depth_stamps = np.array([stamp for stamp, _ in depths])
    reason = f"no colour image has a depth image within {_APART_S:g} s"
    frames = []
    for stamp, key in sorted(colours):
        near = int(np.abs(depth_stamps - stamp).argmin())
        if abs(depth_stamps[near] - stamp) > _APART_S:
            continue
        try:
            pose = tree.pose(calibration.frame, world, stamp)
        except TransformMissingError as error:
            reason = str(error)
            continue
        rgb = partial(_rgb, bag, chosen.colour.name, key, calibration)
        depth = partial(_depth, bag, chosen.depth.name, depths[near][1], calibration)
        frames.append(RecordedFrame(f"{stamp:.3f}", pose, stamp, rgb, depth))
    if not frames:
        raise RecordingError(f"{bag.path} holds no frame that can be used: {reason}")
    why = f"without a depth image within {_APART_S:g} s, or without a pose in tf"
    bag.notes += left_out(len(colours) - len(frames), len(colours), "colour images", why)
    return _with_optical_poses(bag, frames, calibration.frame, world)


def _stamped(bag: BagFile, topic: str) -> list[tuple[float, MessageKey]]:
    """Times and keys of all messages of a topic.

    Simulations begin at 0, but no later message has that time; drivers that set none leave it.
    """
    found = [(stamp_s(message.header), key) for key, message in bag.messages(topic)]
    is_set = [stamp != 0.0 for stamp, _ in found]
    first_counts = len(found) < 2 or is_set[1]
    unset = [i for i, known in enumerate(is_set) if not (known or (i == 0 and first_counts))]
    for i in unset:
        key = found[i][1]
        found[i] = (1e-9 * key[0], key)
    if unset:
        bag.notes.append(
            f"{len(unset)} of {len(found)} messages of {topic} have no time; the time of their "
            "recording is taken, which is later"
        )
    return found


def _with_optical_poses(
    bag: BagFile, frames: list[RecordedFrame], frame: str, world: str
) -> list[RecordedFrame]:
    """The frames; with the poses of the optical frame if images name that of the camera's body.

    A camera that always looks at the ceiling is taken for one whose driver or simulator names the
    wrong frame, since its x axis looks along the floor.
    """
    looks_up = all(one.camera_to_world.rotation[2, 2] > _UP for one in frames)
    if world not in _Z_UP or "optical" in frame or not looks_up:
        return frames
    bag.notes.append(
        f"images are in the frame '{frame}', whose z axis points up, so it is taken for one with x "
        "forward and z up (REP 103), not for an optical frame"
    )
    return [replace(one, camera_to_world=one.camera_to_world @ _OPTICAL_TO_BODY) for one in frames]


def _transforms(bag: BagFile) -> TransformTree:
    """All poses of all frames; odometry only where tf lacks that pose."""
    tree = TransformTree()
    with bag.checked():
        for name in bag.topics(*_TRANSFORM_TYPES):
            static = name.endswith("tf_static")
            _add(bag, name, partial(tree.add_message, static=static), must_hold=static)
        by_tf = tree.frames()

        def add_odometry(message: Any) -> None:
            if frame_name(message.child_frame_id) not in by_tf:
                tree.add_odometry(message)

        for name in bag.topics(_ODOMETRY_TYPE):
            _add(bag, name, add_odometry)
    return tree


def _add(bag: BagFile, topic: str, add: Callable[[Any], None], *, must_hold: bool = False) -> None:
    """Add all messages of a topic; those in which a localisation was lost are counted.

    Raises:
        RosMessageError: One that must hold a pose holds none.
    """
    lost, count, why = 0, 0, ""
    for _, message in bag.messages(topic):
        count += 1
        try:
            add(message)
        except RosMessageError as error:
            if must_hold:
                raise
            lost, why = lost + 1, str(error)
    bag.notes += left_out(lost, count, f"messages of {topic}", f"without a pose: {why}")


def _rgb(
    bag: BagFile, topic: str, key: MessageKey, calibration: Calibration
) -> UInt8[np.ndarray, "height width 3"]:
    with bag.checked():
        return calibration.straightened_colour(colour_of(bag.message(topic, key)))


def _depth(
    bag: BagFile, topic: str, key: MessageKey, calibration: Calibration
) -> Float32[np.ndarray, "height width"]:
    with bag.checked():
        return calibration.straightened_depth(depth_of(bag.message(topic, key)))
