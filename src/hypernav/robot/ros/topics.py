"""Chooses a camera's topics among those that exist."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from hypernav.core.errors import TopicChoiceError
from hypernav.robot.ros.images import encoding_of, is_grey, kind_of, readable_encodings
from hypernav.robot.ros.messages import frame_name

CAMERA_TYPES = (
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/CameraInfo",
)
"""Types of the topics of cameras."""
_ALIGN = (
    "Let the camera's driver align depth to colour (RealSense: align_depth.enable), or run "
    "depth_image_proc's register node"
)


@dataclass(frozen=True)
class CameraTopics:
    """Topics of an RGB-D camera; None for those that are to be found.

    Attributes:
        colour: Colour images.
        depth: Depth images, registered to colour.
        camera_info: Calibration of the colour images.
    """

    colour: str | None = None
    depth: str | None = None
    camera_info: str | None = None


@dataclass(frozen=True)
class OfferedTopic:
    """A topic that may be a camera's.

    Attributes:
        name: Name of the topic.
        role: What it may be: ``"colour"``, ``"depth"``, ``"camera_info"``, or ``"unreadable"`` for
            an image whose encoding can't be read.
        frame: Frame of its messages.
        encoding: Encoding of its images.
        grey: Whether it may be infrared, so that any other topic of its role comes first.
    """

    name: str
    role: str
    frame: str
    encoding: str = ""
    grey: bool = False


@dataclass(frozen=True)
class ChosenTopics:
    """One topic for each role.

    Attributes:
        colour: Colour images.
        depth: Depth images in the same frame.
        camera_info: Calibration of the colour images.
    """

    colour: OfferedTopic
    depth: OfferedTopic
    camera_info: OfferedTopic


def offered_topic(name: str, message: Any) -> OfferedTopic:
    """The role that a topic may have, judged by one of its messages.

    Args:
        name: Name of the topic.
        message: An ``Image``, a ``CompressedImage`` or a ``CameraInfo``.
    """
    frame = frame_name(message.header.frame_id)
    if hasattr(message, "distortion_model"):
        return OfferedTopic(name, "camera_info", frame)
    role = kind_of(message) or "unreadable"
    return OfferedTopic(name, role, frame, encoding_of(message), is_grey(message))


def choose_topics(
    offered: Iterable[OfferedTopic], wanted: CameraTopics, *, option_of: Callable[[str], str]
) -> ChosenTopics:
    """The topics of a camera: those that the user names, else the only ones that fit.

    If an image exists both raw and compressed, the raw one is taken; grey images, which may be
    infrared, only where there are no others. Depth must be in the frame of colour. The calibration
    is the one next to the colour images, by image_transport's convention.

    Args:
        offered: All topics with images and calibrations.
        wanted: Topics that the user names.
        option_of: The option that names the topic of a role, ``--camera-info-topic`` for example.

    Raises:
        TopicChoiceError: None fits, or several do.
    """
    offers = list(offered)
    unreadable = _of_role(offers, "unreadable")
    colours, depths = (_of_role(offers, role) for role in ("colour", "depth"))
    colour = _one(
        colours + unreadable,
        wanted.colour,
        "colour",
        "sensor_msgs/Image of colour",
        option_of("colour"),
        others=depths,
    )
    fitting = [topic for topic in depths if topic.frame == colour.frame]
    if depths and not fitting and wanted.depth is None:
        raise TopicChoiceError(
            f"no depth is registered to {colour.name} (frame '{colour.frame}'); there is "
            f"{_listed(depths)}. {_ALIGN}"
        )
    choices = depths if wanted.depth else fitting
    depth = _one(
        choices + unreadable,
        wanted.depth,
        "depth",
        "sensor_msgs/Image of depth",
        option_of("depth"),
        others=colours,
    )
    if depth.frame != colour.frame:
        raise TopicChoiceError(
            f"{depth.name} is in the frame '{depth.frame}', and {colour.name} in '{colour.frame}'; "
            f"expected depth registered to colour. {_ALIGN}"
        )
    infos = _of_role(offers, "camera_info")
    beside = [info for info in infos if _namespace(info.name) == _namespace(_raw(colour.name))]
    same_frame = [info for info in infos if info.frame == colour.frame]
    info = _one(
        infos if wanted.camera_info else (beside or same_frame or infos),
        wanted.camera_info,
        "camera_info",
        "sensor_msgs/CameraInfo",
        option_of("camera_info"),
    )
    return ChosenTopics(colour, depth, info)


def is_rectified(topic: OfferedTopic) -> bool:
    """Whether the images of a topic are undistorted, by ROS's naming convention."""
    return "rect" in _raw(topic.name).rsplit("/", 1)[-1]


def _of_role(offers: Sequence[OfferedTopic], role: str) -> list[OfferedTopic]:
    return [topic for topic in offers if topic.role == role]


def _one(
    offers: Sequence[OfferedTopic],
    wanted: str | None,
    role: str,
    kind: str,
    option: str,
    *,
    others: Sequence[OfferedTopic] = (),
) -> OfferedTopic:
    """The topic of a role; `others` are images of another one, named where none is left."""
    unreadable = [topic for topic in offers if topic.role == "unreadable"]
    readable = [topic for topic in offers if topic not in unreadable]
    names = {topic.name for topic in readable}
    fitting = [t for t in readable if _raw(t.name) == t.name or _raw(t.name) not in names]
    coloured = [topic for topic in fitting if not topic.grey]
    unread = [topic for topic in unreadable if _raw(topic.name) not in names]
    # What can't be read may be the colour camera beside an infrared one.
    fitting = coloured or ([] if unread else fitting)
    if wanted is not None:
        fitting = [topic for topic in readable if topic.name == wanted]
    if len(fitting) == 1:
        return fitting[0]
    if not fitting:
        found = f"there is {_listed(readable)}" if readable else "there is none at all"
        if unreadable:
            found += (
                f"; the encoding of {_listed(unreadable)} can't be read: expected "
                f"{readable_encodings()}; {option} names another topic"
            )
        if others:
            found += f"; {_listed(others, by_pixels=True)} cannot be {role}"
        raise TopicChoiceError(f"expected a topic {wanted or f'with {kind}'}; {found}")
    raise TopicChoiceError(
        f"several topics could be {role}: {_listed(fitting)}; say which one with {option}"
    )


def _raw(name: str) -> str:
    """The name of the raw topic that belongs to a compressed one."""
    return name.removesuffix("/compressed").removesuffix("/compressedDepth")


def _namespace(name: str) -> str:
    return name.rsplit("/", 1)[0]


def _listed(topics: Sequence[OfferedTopic], *, by_pixels: bool = False) -> str:
    return ", ".join(
        f"{topic.name} ({_pixels_of(topic) if by_pixels else _place_of(topic)})" for topic in topics
    )


def _place_of(topic: OfferedTopic) -> str:
    return f"'{topic.encoding:.40}'" if topic.role == "unreadable" else f"frame '{topic.frame}'"


def _pixels_of(topic: OfferedTopic) -> str:
    """What the pixels of an image are, by their encoding."""
    is_sixteen_bit = topic.grey and topic.role == "depth"
    words = "grey of 16 bits: depth or infrared" if is_sixteen_bit else topic.role
    return f"'{topic.encoding:.40}', {words}" if topic.encoding else words
