"""A ROS 2 network, joined as a DDS participant: topics by ROS names, and quality of service."""

import logging
import struct
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import Any, Generic, TypeVar

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import (
    DDSException,
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from hypernav.core.errors import RosMessageError, RosNetworkError
from hypernav.robot.ros2.idl_types import ROS_TYPES

_LOG = logging.getLogger(__name__)
_XCDR1 = Policy.DataRepresentation(use_cdrv0_representation=True)
"""The encoding that ROS 2 speaks."""
_MOST_WAITING = 100
_WAIT_S = 0.1
_ALL_S = 2.0
"""Time in a domain after which all topics are known, seconds."""
_ANY = SampleState.Any | ViewState.Any | InstanceState.Any
_LOOK_S = 1.0
"""Time between two looks for publishers that aren't heard, seconds."""
_LESS = (
    (Policy.Durability, "TransientLocal", "Volatile", "durability", "transient local"),
    (Policy.Reliability, "Reliable", "BestEffort", "reliability", "reliable"),
)
"""Policies, what a reader may ask for, what is less, and both for people: DDS keeps such a
publisher from the reader, and says nothing."""
_NAMES = {kind.__idl_typename__.replace(".", "::"): name for name, kind in ROS_TYPES.items()}
_UNDECODABLE = (struct.error, ValueError, AssertionError)
"""Errors of reading bytes that are not a message of the type."""
_MessageT = TypeVar("_MessageT", bound=IdlStruct)


class Quality(Enum):
    """Quality-of-service profiles, named by their purpose."""

    SENSOR = Qos(
        Policy.Reliability.BestEffort,
        Policy.Durability.Volatile,
        Policy.History.KeepLast(5),
        _XCDR1,
    )
    """ROS's sensor data: only the newest message, without retransmission."""
    RELIABLE = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(_MOST_WAITING),
        _XCDR1,
    )
    """ROS's default: lost messages are sent again."""
    LATCHED = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.TransientLocal,
        Policy.History.KeepLast(1),
        _XCDR1,
    )
    """Late subscribers also get the last message: maps."""
    STATIC = Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.TransientLocal,
        Policy.History.KeepLast(_MOST_WAITING),
        _XCDR1,
    )
    """The same with many publishers: ``/tf_static``."""


class Publisher(Generic[_MessageT]):
    """Writes messages of one topic."""

    def __init__(self, writer: DataWriter[_MessageT]) -> None:
        """Take over a writer of DDS."""
        self._writer = writer

    def publish(self, message: _MessageT) -> None:
        """Send a message.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        with _dds_errors_as("a message can't be sent"):
            self._writer.write(message)

    def has_reader(self) -> bool:
        """Whether somebody reads the messages."""
        with _dds_errors_as("nobody knows who reads"):
            return bool(self._writer.get_matched_subscriptions())


@dataclass(frozen=True, eq=False)
class _Subscription:
    topic: str
    reader: DataReader[Any]
    condition: ReadCondition
    receive: Callable[[Any], None]
    quality: Quality

    def take(self) -> None:
        """Pass on what arrived; a message that cannot be decoded counts as lost."""
        for _ in range(_MOST_WAITING):
            try:
                messages = self.reader.take(1)  # in a batch, one broken message loses all
            except _UNDECODABLE as error:
                _LOG.warning("%s: %s", self.topic, error)
                continue
            except DDSException as error:
                _LOG.warning("%s: %s", self.topic, error)
                return
            if not messages:
                return
            if messages[0].sample_info.valid_data:
                self._hand_on(messages[0])

    def _hand_on(self, message: Any) -> None:
        try:
            self.receive(message)
        except RosMessageError as error:
            _LOG.warning("%s: %s", self.topic, error)


class Ros2Network:
    """A ROS 2 network. Messages arrive in a thread of their own."""

    def __init__(self, domain_id: int) -> None:
        """Join a domain.

        Raises:
            RosNetworkError: There is no network, or ``CYCLONEDDS_URI`` is wrong.
        """
        try:
            self._participant = DomainParticipant(domain_id)
            self._offers = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
            self._wishes = BuiltinDataReader(self._participant, BuiltinTopicDcpsSubscription)
            self._waiting = WaitSet(self._participant)
        except DDSException as error:
            raise RosNetworkError(
                f"can't join the DDS domain {domain_id}: {error}; look at CYCLONEDDS_URI and at "
                "the network's interfaces"
            ) from error
        self._joined_s = time.monotonic()
        self._subscriptions: list[_Subscription] = []
        self._unheard: set[tuple[uuid.UUID, str]] = set()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._read, name="ros2", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop receiving; the domain is left when nothing refers to the network any more."""
        self._ended.set()
        self._thread.join()

    def publisher(
        self, topic: str, kind: type[_MessageT], quality: Quality = Quality.RELIABLE
    ) -> Publisher[_MessageT]:
        """Publish messages.

        Args:
            topic: ROS name of the topic, ``/cmd_vel``.
            kind: Type of its messages.
            quality: Quality of service.

        Raises:
            RosNetworkError: The topic can't be written.
        """
        with _dds_errors_as(f"'{topic}' can't be written as {kind.__name__}"):
            described = Topic(self._participant, _dds_name(topic), kind)
            return Publisher(DataWriter(self._participant, described, qos=quality.value))

    def subscribe(
        self,
        topic: str,
        kind: type[_MessageT],
        quality: Quality,
        receive: Callable[[_MessageT], None],
    ) -> Callable[[], None]:
        """Receive messages, in the network's thread.

        Args:
            topic: ROS name of the topic.
            kind: Type of its messages.
            quality: Quality of service that is asked for.
            receive: Function that takes a message.

        Returns:
            Function that ends the subscription.

        Raises:
            RosNetworkError: The topic can't be read.
        """
        with _dds_errors_as(f"'{topic}' can't be read as {kind.__name__}"):
            described = Topic(self._participant, _dds_name(topic), kind)
            reader = DataReader(self._participant, described, qos=quality.value)
            condition = ReadCondition(reader, _ANY)
            subscription = _Subscription(topic, reader, condition, receive, quality)
            self._subscriptions.append(subscription)
            self._waiting.attach(subscription.condition)

        def end() -> None:
            self._waiting.detach(subscription.condition)
            self._subscriptions.remove(subscription)

        return end

    def published(self) -> dict[str, str]:
        """The topics that others publish, with their ROS types, as far as hypernav knows these."""
        return {
            offer.topic_name.removeprefix("rt"): _NAMES[offer.type_name]
            for offer in self._offers.read(10_000)
            if offer.sample_info.valid_data
            and offer.topic_name.startswith("rt/")
            and offer.type_name in _NAMES
        }

    @property
    def is_settled(self) -> bool:
        """Whether the network was joined long enough ago to know all topics and publishers."""
        return time.monotonic() - self._joined_s >= _ALL_S

    def publishers(self, topic: str) -> int:
        """Number of publishers that others have of a topic now, whatever its type is.

        Publishers of a killed process count until its lease ends, after about 10 s.

        Args:
            topic: ROS name of the topic.
        """
        name, own = _dds_name(topic), self._participant.guid
        return sum(
            offer.topic_name == name and offer.participant_key != own
            for offer in self._offers.read(10_000)
            if offer.sample_info.valid_data
            and offer.sample_info.instance_state == InstanceState.Alive
        )

    def read_as(self, topic: str) -> list[str]:
        """The types as which others read a topic now, as far as hypernav knows these.

        Args:
            topic: ROS name of the topic.
        """
        name, own = _dds_name(topic), self._participant.guid
        types = {
            _NAMES[wish.type_name]
            for wish in self._wishes.read(10_000)
            if wish.sample_info.valid_data
            and wish.sample_info.instance_state == InstanceState.Alive
            and wish.topic_name == name
            and wish.participant_key != own
            and wish.type_name in _NAMES
        }
        return sorted(types)

    def _name_unheard(self) -> None:
        """Name each publisher once that DDS keeps from a reader of ours."""
        asked = {_dds_name(one.topic): one for one in list(self._subscriptions)}
        for offer in self._offers.read(10_000):
            if not offer.sample_info.valid_data or offer.topic_name not in asked:
                continue
            reader = asked[offer.topic_name]
            for policy, wish, less, word, wished in _LESS:
                is_asked = _kind(reader.quality.value, policy) == wish
                if not is_asked or _kind(offer.qos, policy) != less:
                    continue
                if (offer.key, word) not in self._unheard:
                    self._unheard.add((offer.key, word))
                    _LOG.warning(
                        "'%s': a publisher isn't heard, because its %s is less than hypernav asks "
                        "for (%s); `ros2 topic info -v %s` names it",
                        *(reader.topic, word, wished, reader.topic),
                    )

    def _read(self) -> None:
        looked_s = time.monotonic()
        while not self._ended.is_set():
            if time.monotonic() - looked_s > _LOOK_S:
                looked_s = time.monotonic()
                self._name_unheard()
            if not self._subscriptions:
                time.sleep(_WAIT_S)
                continue
            self._waiting.wait(duration(seconds=_WAIT_S))
            for subscription in list(self._subscriptions):
                subscription.take()


def _kind(quality: Qos, policy: Any) -> str:
    """Name of the policy of one kind in a quality of service; empty without one."""
    return type(quality[policy]).__name__.rpartition(".")[2] if policy in quality else ""


def _dds_name(topic: str) -> str:
    """Name on DDS of a topic of ROS."""
    return f"rt/{topic.lstrip('/')}"


@contextmanager
def _dds_errors_as(what: str) -> Iterator[None]:
    """Turn errors of DDS into ours."""
    try:
        yield
    except DDSException as error:
        raise RosNetworkError(f"{what}: {error}") from error
