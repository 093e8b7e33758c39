"""What DDS refuses or cannot decode ends neither the thread of the network nor a search unsaid."""

import re
import struct
import threading
import time
from contextlib import closing

import pytest
from cyclonedds.core import DDSException

from hypernav.core.errors import RosNetworkError
from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2 import network as dds
from hypernav.robot.ros2.network import Quality, Ros2Network
from loopback import DOMAIN, LOOPBACK


@pytest.fixture(autouse=True)
def _loopback(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)


def test_a_message_that_cannot_be_decoded_is_as_one_that_got_lost(monkeypatch, caplog):
    received, broken, decode = threading.Event(), [b"the first"], ros.TFMessage.deserialize

    def decoded(data: bytes) -> ros.TFMessage:
        if broken:
            broken.clear()
            raise struct.error("unpack_from requires a buffer of at least 4 bytes")
        return decode(data)

    monkeypatch.setattr(ros.TFMessage, "deserialize", decoded)
    with closing(Ros2Network(DOMAIN)) as theirs, closing(Ros2Network(DOMAIN)) as ours:
        ours.subscribe("/tf", ros.TFMessage, Quality.RELIABLE, lambda _: received.set())
        publisher = theirs.publisher("/tf", ros.TFMessage)
        for _ in range(400):
            publisher.publish(ros.TFMessage())
            if received.wait(0.05):
                break
        assert received.is_set()
    assert not broken
    assert "/tf: unpack_from" in caplog.text


def test_a_mistake_of_a_receiver_is_no_lost_message(monkeypatch, caplog):
    told: list[object] = []
    raised = threading.Event()

    def note(failed: threading.ExceptHookArgs) -> None:
        told.append(failed.exc_value)
        raised.set()

    def receive(_: object) -> None:
        raise ValueError("a mistake of ours")

    monkeypatch.setattr(threading, "excepthook", note)
    with closing(Ros2Network(DOMAIN)) as theirs, closing(Ros2Network(DOMAIN)) as ours:
        ours.subscribe("/tf", ros.TFMessage, Quality.RELIABLE, receive)
        publisher = theirs.publisher("/tf", ros.TFMessage)
        for _ in range(400):
            publisher.publish(ros.TFMessage())
            if raised.wait(0.05):
                break
    assert [str(error) for error in told] == ["a mistake of ours"]
    assert caplog.text == ""


def test_publishers_are_those_of_others_until_they_end():
    with closing(Ros2Network(DOMAIN)) as theirs, closing(Ros2Network(DOMAIN)) as ours:
        own = ours.publisher("/cmd_vel", ros.Twist)
        publishers = [theirs.publisher(name, ros.Twist) for name in ("/cmd_vel", "cmd_vel", "/x")]
        assert counted(ours, 2)
        del publishers[1]
        assert counted(ours, 1)
        publishers.clear()
        assert counted(ours, 0)
        assert counted(theirs, 1)
        del own


def counted(network: Ros2Network, count: int) -> bool:
    """Whether a network comes to know so many publishers."""
    for _ in range(600):
        if network.publishers("/cmd_vel") == count:
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize("refused", ["DataReader", "DataWriter", "Topic"])
def test_what_dds_refuses_names_the_topic(monkeypatch, refused):
    def refuse(*_: object, **__: object) -> None:
        raise DDSException(DDSException.DDS_RETCODE_BAD_PARAMETER, "of no use")

    monkeypatch.setattr(dds, refused, refuse)
    with closing(Ros2Network(DOMAIN)) as network:
        if refused != "DataWriter":
            with pytest.raises(RosNetworkError, match="'/nose' can't be read as Image"):
                network.subscribe("/nose", ros.Image, Quality.SENSOR, print)
        if refused != "DataReader":
            with pytest.raises(RosNetworkError, match="'/nose' can't be written as Image"):
                network.publisher("/nose", ros.Image)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("offered", "asked", "words"),
    [
        (Quality.RELIABLE, Quality.STATIC, "its durability is less .*transient local"),
        (Quality.SENSOR, Quality.RELIABLE, r"its reliability is less .*\(reliable\)"),
        (Quality.STATIC, Quality.SENSOR, None),
    ],
)
def test_a_publisher_of_another_quality_of_service_is_named_once(caplog, offered, asked, words):
    with closing(Ros2Network(DOMAIN)) as theirs, closing(Ros2Network(DOMAIN)) as ours:
        ours.subscribe("/tf_static", ros.TFMessage, asked, print)
        publisher = theirs.publisher("/tf_static", ros.TFMessage, offered)
        until_s = time.monotonic() + (3.0 if words is None else 60.0)
        while time.monotonic() < until_s and not (words and words_in(caplog)):
            time.sleep(0.1)
        time.sleep(1.5)
        del publisher
    said = words_in(caplog)
    assert len(said) == (words is not None)
    if words is not None:
        assert re.search(f"'/tf_static': a publisher isn't heard, because {words}", said[0])


def words_in(caplog: pytest.LogCaptureFixture) -> list[str]:
    """Warnings about publishers that aren't heard."""
    return [one.message for one in caplog.records if "isn't heard" in one.message]
