"""Where several topics fit, the error names what the user writes to choose one."""

import pytest

from hypernav.core.errors import TopicChoiceError
from hypernav.robot.recordings import bag
from hypernav.robot.ros.topics import CameraTopics, OfferedTopic, choose_topics
from hypernav.robot.ros2 import sensors
from hypernav.robot.ros2.config import TopicsConfig

CAMERA = [
    OfferedTopic("/front/image_raw", "colour", "optical"),
    OfferedTopic("/front/depth", "depth", "optical"),
    OfferedTopic("/front/camera_info", "camera_info", "optical"),
]
OTHER = {"colour": "/front/image_color", "depth": "/front/depth2", "camera_info": "/front/info"}
ROLES = pytest.mark.parametrize("role", OTHER)


def told(role: str, option_of) -> str:
    """The error where two topics could have a role."""
    offers = [*CAMERA, OfferedTopic(OTHER[role], role, "optical")]
    with pytest.raises(TopicChoiceError) as error:
        choose_topics(offers, CameraTopics(None, None, None), option_of=option_of)
    return str(error.value)


@ROLES
def test_a_robot_on_ros_2_has_a_key_of_its_file(role):
    assert told(role, sensors._option_of).endswith(f"say which one with topics.{role} of --config")
    assert role in TopicsConfig.model_fields


@ROLES
def test_a_bag_has_an_option(role):
    option = {"camera_info": "--camera-info-topic"}.get(role, f"--{role}-topic")
    assert told(role, bag._option_of).endswith(f"say which one with {option}")


INFRARED = OfferedTopic("/front/infra", "colour", "optical", "mono8", grey=True)
FILM = OfferedTopic("/front/film", "unreadable", "optical", "h264")


def test_grey_images_are_taken_where_there_is_no_colour():
    def chosen(*topics):
        return choose_topics(topics, CameraTopics(), option_of=bag._option_of).colour

    assert chosen(*CAMERA, INFRARED) == CAMERA[0]
    assert chosen(INFRARED, *CAMERA[1:]) == INFRARED
    with pytest.raises(TopicChoiceError, match="/front/film"):
        chosen(INFRARED, FILM, *CAMERA[1:])


@pytest.mark.parametrize("wanted", [CameraTopics(), CameraTopics(colour="/front/film")])
def test_an_encoding_that_cannot_be_read_is_named_with_those_that_can(wanted):
    with pytest.raises(TopicChoiceError, match=r"/front/film \('h264'\).*yuv422_yuy2.*JPEG"):
        choose_topics([FILM, *CAMERA[1:]], wanted, option_of=bag._option_of)


SIXTEEN = OfferedTopic("/front/image", "depth", "optical", "mono16", grey=True)


@pytest.mark.parametrize("wanted", [None, SIXTEEN.name])
def test_grey_of_16_bits_is_named_as_what_it_may_be_where_colour_is_missing(wanted):
    told = r"of colour|topic /front/image.*/front/image \('mono16', grey of 16 bits: depth or infra"
    with pytest.raises(TopicChoiceError, match=told) as error:
        choose_topics([SIXTEEN, CAMERA[2]], CameraTopics(wanted), option_of=bag._option_of)
    assert "depth or infrared) cannot be colour" in str(error.value)


def test_a_colour_topic_without_depth_is_named():
    with pytest.raises(TopicChoiceError, match=r"/front/infra \('mono8', colour\) cannot be depth"):
        choose_topics([INFRARED, CAMERA[2]], CameraTopics(), option_of=bag._option_of)
