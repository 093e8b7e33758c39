"""Bags of every format, written by `rosbags` from the frames of a recording."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from scipy.spatial.transform import Rotation

from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.recording import Recording
from hypernav.robot.recordings.replay import world_to_map

FORMATS = ("sqlite", "mcap", "ros1")
OPTICAL = "camera_color_optical_frame"
COLOUR, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
CAMERA_INFO = "/camera/color/camera_info"
_BASE_TO_CAMERA = Transform(
    np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.array([0.1, 0.0, 0.9])
)
"""Pose of the camera on the robot that carries it; ``/tf_static`` has it."""


class Messages:
    """Makes the messages of a recording as ROS's drivers do."""

    def __init__(self, typestore: Any) -> None:
        self.types = typestore.types

    def header(self, stamp_s: float, frame: str) -> Any:
        time = self.types["builtin_interfaces/msg/Time"]
        stamp = time(sec=int(stamp_s), nanosec=round(stamp_s % 1.0 * 1e9))
        sequence = {"seq": 0} if self.is_ros1 else {}
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **sequence)

    @property
    def is_ros1(self) -> bool:
        return "tf2_msgs/msg/TF2Error" not in self.types

    def image(self, stamp_s: float, frame: str, encoding: str, pixels: np.ndarray) -> Any:
        height, width = pixels.shape[:2]
        return self.types["sensor_msgs/msg/Image"](
            header=self.header(stamp_s, frame),
            height=height,
            width=width,
            encoding=encoding,
            is_bigendian=0,
            step=pixels[0].nbytes,
            data=np.frombuffer(pixels.tobytes(), dtype=np.uint8),
        )

    def compressed(self, stamp_s: float, frame: str, format: str, data: bytes) -> Any:
        return self.types["sensor_msgs/msg/CompressedImage"](
            header=self.header(stamp_s, frame),
            format=format,
            data=np.frombuffer(data, dtype=np.uint8),
        )

    def camera_info(self, stamp_s: float, frame: str, recording: Recording) -> Any:
        camera = recording.camera
        cx, cy = camera.cx - 0.5, camera.cy - 0.5
        k = np.array([camera.fx, 0, cx, 0, camera.fy, cy, 0, 0, 1])
        p = np.array([camera.fx, 0, cx, 0, 0, camera.fy, cy, 0, 0, 0, 1, 0])
        matrices = {"d": np.zeros(5), "k": k, "r": np.eye(3).ravel(), "p": p}
        if self.is_ros1:
            matrices = {name.upper(): matrix for name, matrix in matrices.items()}
        region = self.types["sensor_msgs/msg/RegionOfInterest"]
        return self.types["sensor_msgs/msg/CameraInfo"](
            header=self.header(stamp_s, frame),
            height=camera.height,
            width=camera.width,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=region(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
            **matrices,
        )

    def transform(self, stamp_s: float, parent: str, child: str, pose: Transform) -> Any:
        types = self.types
        x, y, z, w = Rotation.from_matrix(pose.rotation).as_quat()
        a, b, c = pose.translation
        stamped = types["geometry_msgs/msg/TransformStamped"](
            header=self.header(stamp_s, parent),
            child_frame_id=child,
            transform=types["geometry_msgs/msg/Transform"](
                translation=types["geometry_msgs/msg/Vector3"](x=a, y=b, z=c),
                rotation=types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
            ),
        )
        return types["tf2_msgs/msg/TFMessage"](transforms=[stamped])


def recorded_messages(recording: Recording, make: Messages) -> Iterator[tuple[str, float, Any]]:
    """What a robot with the recording's camera publishes: topic, time and message."""
    start_s = recording.frames[0].stamp_s
    mount = make.transform(start_s, "base_link", OPTICAL, _BASE_TO_CAMERA)
    yield "/tf_static", start_s, mount
    for frame in recording.frames:
        at = frame.stamp_s
        base = frame.camera_to_world @ _BASE_TO_CAMERA.inverse()
        yield "/tf", at, make.transform(at, "odom", "base_link", base)
        yield CAMERA_INFO, at, make.camera_info(at, OPTICAL, recording)
        yield COLOUR, at, make.image(at, OPTICAL, "rgb8", frame.rgb())
        millimetres = np.rint(frame.depth() * 1000.0).astype(np.uint16)
        yield DEPTH, at, make.image(at, OPTICAL, "16UC1", millimetres)


def write_bag(
    folder: Path,
    format: str,
    recording: Recording,
    *,
    change: Callable[[str, Any, Messages], tuple[str, Any] | None] = lambda topic, message, _: (
        topic,
        message,
    ),
    recorded_ns: Callable[[float], int] = lambda at_s: round(at_s * 1e9) + 7,
    publishers: int = 1,
) -> Path:
    """Write a bag.

    Args:
        folder: An empty folder.
        format: One of `FORMATS`.
        recording: The frames.
        change: Replaces topic and message, or leaves them out with None.
        recorded_ns: Time of the recording of a message.
        publishers: How many publishers take turns on every topic.
    """
    is_ros1 = format == "ros1"
    store = get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.ROS2_HUMBLE)
    if is_ros1:
        text = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))
        path = folder / "recorded.bag"
        writer: Any = Writer1(path)
    else:
        path = folder / "recorded"
        plugin = StoragePlugin.MCAP if format == "mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path, version=9, storage_plugin=plugin)
    serialize = store.serialize_ros1 if is_ros1 else store.serialize_cdr
    make, connections = Messages(store), {}
    with writer:
        for number, (name, at, said) in enumerate(recorded_messages(recording, make)):
            if (changed := change(name, said, make)) is None:
                continue
            topic, message = changed
            kind = message.__msgtype__
            who = (topic, number // 5 % publishers if is_ros1 else 0)  # ROS 2 records no publisher
            if who not in connections:
                named = {"callerid": f"/{who[1]}"} if is_ros1 else {}
                connections[who] = writer.add_connection(topic, kind, typestore=store, **named)
            writer.write(connections[who], recorded_ns(at), serialize(message, kind))
    return path


def in_map_frame(recording: Recording) -> Recording:
    """A recording in a world whose z axis points up, as a robot's odometry has it."""
    to_map = world_to_map(recording)
    frames = [
        replace(one, camera_to_world=to_map @ one.camera_to_world) for one in recording.frames
    ]
    return replace(recording, frames=frames)


def repacked(source: Path, target: Path, compression: str) -> None:
    """Copy an MCAP file in small chunks, packed or not."""
    kinds = {"": CompressionType.NONE, "lz4": CompressionType.LZ4, "zstd": CompressionType.ZSTD}
    with source.open("rb") as file, target.open("wb") as written:
        writer = McapWriter(written, chunk_size=30_000, compression=kinds[compression])
        writer.start(profile="ros2")
        channels: dict[int, int] = {}
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            if channel.id not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, known, channel.metadata
                )
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time
            )
        writer.finish()
