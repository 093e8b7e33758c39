"""What goes over DDS are the very bytes that ROS 2 has for its messages, by `rosbags`."""

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2.idl_types import ROS_TYPES

STORES = pytest.mark.parametrize("distribution", ["ROS2_HUMBLE", "ROS2_JAZZY", "ROS2_KILTED"])
NAMES = pytest.mark.parametrize("name", ROS_TYPES)


def filled(kind: type, numbers) -> Any:
    """A message that differs from its defaults in every value."""

    def value(of: object) -> object:
        if is_dataclass(of):
            return filled(type(of), numbers)
        if isinstance(of, bool):
            return not of
        if isinstance(of, int):
            return next(numbers)
        if isinstance(of, float):
            return next(numbers) + 0.5
        if isinstance(of, str):
            return "word" * (next(numbers) % 5)
        if isinstance(of, bytes):
            return bytes([next(numbers) % 100, 2, 3, 4, 5])
        assert isinstance(of, list)
        return [value(each) for each in of] if of else _list_of(kind, numbers)

    message = kind()
    for one in fields(kind):
        kind_of_list = LISTS.get((kind, one.name))
        now = getattr(message, one.name)
        if kind_of_list is float:
            now = [next(numbers) + 0.25 for _ in range(3)]
        elif kind_of_list is not None:
            now = [filled(kind_of_list, numbers) for _ in range(2)]
        else:
            now = value(now)
        setattr(message, one.name, now)
    return message


def _list_of(kind: type, numbers) -> list:
    raise AssertionError(f"say in LISTS what the lists of {kind.__name__} hold")


LISTS = {
    (ros.TFMessage, "transforms"): ros.TransformStamped,
    (ros.Path, "poses"): ros.PoseStamped,
    (ros.CameraInfo, "d"): float,
    (ros.Marker, "points"): ros.Point,
    (ros.Marker, "colors"): ros.ColorRGBA,
    (ros.Marker, "uv_coordinates"): ros.UVCoordinate,
    (ros.MarkerArray, "markers"): ros.Marker,
}


def same(ours: object, theirs: object) -> bool:
    """Whether two messages hold the same."""
    if is_dataclass(ours):
        return all(same(getattr(ours, f.name), getattr(theirs, f.name)) for f in fields(ours))
    if isinstance(ours, bytes):
        return ours == np.asarray(theirs).tobytes()
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))  # pyright: ignore
    return ours == theirs


@STORES
@NAMES
@pytest.mark.parametrize("is_empty", [True, False])
def test_a_message_has_ros_bytes(name, distribution, is_empty):
    store = get_typestore(Stores[distribution])
    kind = ROS_TYPES[name]
    message = kind() if is_empty else filled(kind, iter(range(1, 10_000)))
    data = message.serialize()
    theirs = store.deserialize_cdr(data, name)
    assert same(message, theirs)
    assert bytes(store.serialize_cdr(theirs, name)) == data
    assert kind.deserialize(data) == message


@NAMES
def test_a_type_has_the_name_that_ros_gives_it_on_dds(name):
    package, _, kind = name.split("/")
    assert ROS_TYPES[name].__idl_typename__ == f"{package}.msg.dds_.{kind}_"


@pytest.mark.parametrize("kind", [ros.CompressedImage, ros.Image, ros.MeshFile, ros.OccupancyGrid])
def test_large_data_is_bytes_at_once(kind):
    """Fails where cyclonedds has changed the internals that `_data_as_bytes` exchanges."""
    for machine in (kind.__idl__.v1_machine, kind.__idl__.v2_machine):
        assert type(machine.members_machines["data"]).__name__ == "BytesMachine"
    message = kind(data=bytes(range(256)) * 100)
    assert type(kind.deserialize(message.serialize()).data) is bytes
