"""What a robot on a ROS 2 network senses: images, calibration and the poses of its frames.

Colour and depth are paired by their times. Two publishers of one odometry are noticed.
"""

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from hypernav.core.errors import RosNetworkError, TopicChoiceError, TransformMissingError
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.robot.ros.messages import Calibration, calibration_of, stamp_s
from hypernav.robot.ros.topics import (
    CAMERA_TYPES,
    CameraTopics,
    ChosenTopics,
    choose_topics,
    is_rectified,
    offered_topic,
)
from hypernav.robot.ros.transform_tree import TransformTree
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.guarded_output import RobotClock
from hypernav.robot.ros2.idl_types import ROS_TYPES, Odometry, TFMessage
from hypernav.robot.ros2.network import Quality, Ros2Network

_LEAST_M, _LEAST_RAD = 0.1, math.radians(6.0)
"""Smallest jump between two poses that follow each other: no legged body sways so fast."""
_BACK_SHARE = 0.3
"""Share of a jump within which the pose after the next is back where the first one was."""
_POSES, _MOST_BACK = 40, 10
"""Number of poses that are looked at, and how many of them may jump forth and back."""


class RivalOdometry:
    """Looks for poses that jump forth and back, as those of two publishers in turn do.

    Each would be right; taken together, every second image would be placed wrongly.
    """

    def __init__(self) -> None:
        """Begin without poses."""
        self._last: deque[Pose2] = deque(maxlen=3)
        self._jumps: deque[float | None] = deque(maxlen=_POSES)

    def note(self, pose: Pose2) -> None:
        """Take the pose that is newest by its stamp."""
        self._last.append(pose)
        if len(self._last) < 3:
            return
        first, second, third = self._last
        forth, back = _distance(first, second), _distance(second, third)
        is_jump = min(forth, back) > 1.0
        is_back = is_jump and _distance(first, third) < _BACK_SHARE * min(forth, back)
        self._jumps.append(first.distance_to(*second.xy) if is_back else None)

    @property
    def words(self) -> str | None:
        """What is wrong, for people; None if the poses follow each other."""
        jumps = [jump for jump in self._jumps if jump is not None]
        if len(jumps) <= _MOST_BACK:
            return None
        return (
            f"its pose jumps forth and back by {sum(jumps) / len(jumps):.2f} m: two publishers, "
            "such as the wheels' driver beside a localisation (publish_tf off in one), or two "
            "robots in one domain with the same names of frames"
        )


def _distance(before: Pose2, now: Pose2) -> float:
    """How far apart poses are, in smallest jumps."""
    turned = abs(wrap_angle(now.yaw - before.yaw))
    return max(before.distance_to(*now.xy) / _LEAST_M, turned / _LEAST_RAD)


_MOST_WAITING = 10
"""Number of images of each kind that wait for their partners."""
_KEPT_S = 0.6
"""Largest age of kept pairs relative to the newest; odometry that comes later is too late."""


@dataclass(frozen=True, eq=False)
class ImagePair:
    """Two images that belong together.

    Attributes:
        colour: Message of the colour image.
        depth: Message of the depth image.
        stamp_s: Time of the colour image, on the robot's clock, seconds.
        received_s: Time at which both were there, on this machine's clock.
    """

    colour: Any
    depth: Any
    stamp_s: float
    received_s: float


class RgbdStream:
    """Pairs colour and depth as they arrive, in any order; a pair older than the newest is dropped.

    An image that the camera sends twice counts once.
    """

    def __init__(self, apart_s: float, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin without images.

        Args:
            apart_s: Largest difference of the times of two images that belong together, seconds.
            clock: Clock of this machine.
        """
        self._apart_s = apart_s
        self._clock = clock
        self._waiting: dict[str, dict[float, Any]] = {"colour": {}, "depth": {}}
        self._seen_s: dict[str, float] = {}
        self._changed = threading.Condition()
        self._pairs: deque[ImagePair] = deque()

    def add_colour(self, message: Any) -> None:
        """Take a colour image."""
        self._add(message, "colour", "depth")

    def add_depth(self, message: Any) -> None:
        """Take a depth image."""
        self._add(message, "depth", "colour")

    @property
    def latest(self) -> ImagePair | None:
        """The newest pair; None before the first."""
        return self.newest_until(math.inf)

    def newest_until(self, at_s: float) -> ImagePair | None:
        """The newest of the last pairs that is not newer than a time; None if there is none.

        Args:
            at_s: Time on the robot's clock, seconds.
        """
        with self._changed:
            return next((pair for pair in reversed(self._pairs) if pair.stamp_s <= at_s), None)

    def wait_for(self, is_enough: Callable[[], bool], timeout_s: float) -> bool:
        """Wait for a condition, checked whenever a pair arrives and at intervals.

        Args:
            is_enough: The condition.
            timeout_s: Longest wait, seconds.

        Returns:
            Whether it holds.
        """
        until_s = self._clock() + timeout_s
        with self._changed:
            while not is_enough():
                left_s = until_s - self._clock()
                if left_s <= 0.0:
                    return False
                self._changed.wait(min(left_s, 0.05))
        return True

    def described(self) -> str:
        """When the last images and the last pair came, for people."""
        now = self._clock()
        words = [
            f"{name} {now - seen:.1f} s ago" if (seen := self._seen_s.get(name)) else f"no {name}"
            for name in ("colour", "depth")
        ]
        paired = self.latest
        last = "no pair" if paired is None else f"a pair {now - paired.received_s:.1f} s ago"
        return f"{', '.join(words)}, {last}"

    def _add(self, message: Any, name: str, other: str) -> None:
        stamp = stamp_s(message.header)
        self._seen_s[name] = self._clock()
        waiting, partners = self._waiting[name], self._waiting[other]
        waiting[stamp] = message
        while len(waiting) > _MOST_WAITING:
            del waiting[min(waiting)]
        near = min(partners, key=lambda partner: abs(partner - stamp), default=None)
        if near is None or abs(near - stamp) > self._apart_s:
            return
        pair = {name: message, other: partners[near]}
        at_s = stamp if name == "colour" else near
        with self._changed:
            if not self._pairs or at_s > self._pairs[-1].stamp_s:
                self._pairs.append(ImagePair(pair["colour"], pair["depth"], at_s, self._clock()))
                while at_s - self._pairs[0].stamp_s > _KEPT_S:
                    self._pairs.popleft()
                self._changed.notify_all()


_MEMORY_S = 10.0
_LOOK_S = 0.2
_FoundT = TypeVar("_FoundT")


class Ros2Sensors:
    """A robot's sensors; times are on the robot's clock, which may differ from ours.

    Attributes:
        stream: Pairs of images.
        calibration: The camera.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config) -> None:
        """Find the topics and wait until all data arrives.

        Raises:
            TopicChoiceError: No topic fits, or several do.
            RosNetworkError: Images, calibration or frames don't come.
        """
        self._network, self._config = network, config
        self._tree, self._tree_lock = TransformTree(memory_s=_MEMORY_S), threading.Lock()
        self._odometry_s, self._clock = -1.0, RobotClock(config.timing.clock_drift)
        self._rivals = RivalOdometry()
        self._first_messages, self._ends_of_looks = dict[str, Any](), list[Callable[[], None]]()
        self.stream = RgbdStream(config.timing.apart_s)
        self._subscribe_frames()
        chosen = self._found(self._chosen)
        for end in self._ends_of_looks:
            end()
        self._ends_of_looks.clear()  # keeps the readers alive
        info = self._first_messages[chosen.camera_info.name]
        self.calibration: Calibration = calibration_of(info, rectified=is_rectified(chosen.colour))
        types = network.published()
        for topic, receive in (
            (chosen.colour.name, self.stream.add_colour),
            (chosen.depth.name, self.stream.add_depth),
        ):
            heard = partial(self._add_image, receive)
            network.subscribe(topic, ROS_TYPES[types[topic]], Quality.SENSOR, heard)
        self._found(self._first_pose)

    @property
    def robot_now_s(self) -> float:
        """The present time on the robot's clock, seconds."""
        return self._clock.now_s

    def is_fresh(self) -> bool:
        """Whether images and odometry are new enough to drive by them."""
        return self._fresh_pair() is not None

    def _fresh_pair(self) -> ImagePair | None:
        """The newest pair of images for whose time odometry is known, unless it is too old."""
        pair = self.stream.newest_until(self._odometry_s)
        if pair is None or self._clock.age_s(pair.stamp_s) > self._config.timing.fresh_s:
            return None
        return pair

    def wait_for_pair(
        self, *, received_after_s: float = 0.0, unless: Callable[[], bool] = lambda: False
    ) -> ImagePair | None:
        """The newest pair of images for whose time odometry is known; waits until it is fresh.

        Args:
            received_after_s: Time on this machine's clock after which it must have come.
            unless: Function that says whether to end the wait without a pair.

        Returns:
            The pair; None if the wait was ended.

        Raises:
            RosNetworkError: It takes longer than the patience.
            TransformMissingError: The odometry has two publishers.
        """
        with self._tree_lock:
            rivals = self._rivals.words
        if rivals is not None:
            frames = self._config.frames
            raise TransformMissingError(f"'{frames.base}' in '{frames.odom}': {rivals}")
        patience_s, found = self._config.timing.patience_s, None

        def is_over() -> bool:
            nonlocal found
            pair = self._fresh_pair()
            found = pair if pair is not None and pair.received_s > received_after_s else None
            return found is not None or unless()

        if not self.stream.wait_for(is_over, patience_s):
            raise RosNetworkError(
                f"no fresh images and odometry for {patience_s:g} s: {self.described()}; the "
                "robot stands still"
            )
        return found

    def described(self) -> str:
        """When images and odometry came last and how old they are, for people."""
        pair = self.stream.latest
        of_pair = (
            "" if pair is None else f", the pair of {self._clock.age_s(pair.stamp_s):.1f} s ago"
        )
        of_odometry = f"odometry of {self._clock.age_s(self._odometry_s):.1f} s ago"
        return f"{self.stream.described()}{of_pair}, {of_odometry}"

    def odometry(self, at_s: float | None = None) -> Pose2:
        """Pose of the base in the frame of the odometry, at a time or now.

        Raises:
            TransformMissingError: It is not known for that time.
        """
        frames = self._config.frames
        return _planar(self._pose(frames.base, frames.odom, at_s))

    def is_standing(self) -> bool:
        """Whether odometry is fresh and has shown no motion for ``nav2.still_s``."""
        newest_s, still = self._odometry_s, self._config.nav2
        if self._clock.age_s(newest_s) > self._config.timing.fresh_s:
            return False
        try:
            before, now = self.odometry(newest_s - still.still_s), self.odometry(newest_s)
        except TransformMissingError:  # not enough history yet
            return False
        turned = abs(wrap_angle(now.yaw - before.yaw))
        is_there = before.distance_to(*now.xy) < still.still_m
        return is_there and turned < math.radians(still.still_deg)

    def odom_to_map(self) -> Pose2:
        """Pose of the odometry in the map of the robot's localisation; the same without one.

        Raises:
            TransformMissingError: The localisation has published nothing yet.
        """
        frames = self._config.frames
        if frames.map is None:
            return Pose2(0.0, 0.0, 0.0)
        with self._tree_lock:
            newest_s = self._tree.newest_s(frames.odom, frames.map)
            at_s = self._odometry_s if newest_s is None else newest_s
            return _planar(self._tree.pose(frames.odom, frames.map, at_s))

    def camera_to_base(self, at_s: float) -> Transform:
        """Pose of the camera over the point of the floor that is below the base.

        Its height and tilt are those of that moment, also of a legged robot that sways.

        Raises:
            TransformMissingError: It is not known for that time.
        """
        frames = self._config.frames
        below = self.odometry(at_s).to_transform(frames.floor_z_m)
        return below.inverse() @ self._pose(self.calibration.frame, frames.odom, at_s)

    def _pose(self, frame: str, parent: str, at_s: float | None) -> Transform:
        with self._tree_lock:
            return self._tree.pose(frame, parent, self._odometry_s if at_s is None else at_s)

    def _subscribe_frames(self) -> None:
        subscribe, topics = self._network.subscribe, self._config.topics
        moving, static = (
            partial(self._add_frames, static=is_static) for is_static in (False, True)
        )
        subscribe(topics.tf, TFMessage, Quality.RELIABLE, moving)
        subscribe(topics.tf_static, TFMessage, Quality.STATIC, static)
        if topics.odometry is not None:
            subscribe(topics.odometry, Odometry, Quality.SENSOR, self._add_odometry)

    def _add_frames(self, message: TFMessage, *, static: bool) -> None:
        with self._tree_lock:
            self._tree.add_message(message, static=static)
            self._note_odometry()

    def _add_odometry(self, message: Odometry) -> None:
        with self._tree_lock:
            self._tree.add_odometry(message)
            self._note_odometry()

    def _add_image(self, receive: Callable[[Any], None], message: Any) -> None:
        """Images also set the clock: odometry's delay alone would look like a clock offset."""
        self._clock.hear(stamp_s(message.header))
        receive(message)

    def _note_odometry(self) -> None:
        newest_s = self._tree.newest_s(self._config.frames.base, self._config.frames.odom)
        if newest_s is not None and newest_s > self._odometry_s:
            self._odometry_s = newest_s
            self._clock.hear(newest_s)
            frames = self._config.frames
            with suppress(TransformMissingError):  # a frame between them lacks that time
                self._rivals.note(_planar(self._tree.pose(frames.base, frames.odom, newest_s)))

    def _found(self, find: Callable[[], _FoundT]) -> _FoundT:
        """The result of a function, which is called again until it raises nothing.

        Raises:
            HyPerNavError: The last error of the function.
        """
        until_s = time.monotonic() + self._config.timing.find_s
        while True:
            try:
                return find()
            except (TopicChoiceError, RosNetworkError, TransformMissingError):
                if time.monotonic() > until_s:
                    raise
                time.sleep(_LOOK_S)

    def _chosen(self) -> ChosenTopics:
        """The camera's topics, chosen by the first messages of all topics that may be its own.

        Raises:
            TopicChoiceError: None of the topics known so far fits, or several do.
        """
        topics, published = self._config.topics, self._network.published()
        wanted = CameraTopics(topics.colour, topics.depth, topics.camera_info)
        named = {topics.colour, topics.depth, topics.camera_info}
        cameras = [name for name, kind in published.items() if kind in CAMERA_TYPES]
        for name in cameras:
            if name not in self._first_messages and (None in named or name in named):
                self._first_messages[name] = None
                keep = partial(self._first_messages.__setitem__, name)
                kind = ROS_TYPES[published[name]]
                self._ends_of_looks.append(
                    self._network.subscribe(name, kind, Quality.SENSOR, keep)
                )
        firsts = [
            (name, first) for name, first in self._first_messages.items() if first is not None
        ]
        offers = [offered_topic(name, first) for name, first in firsts]
        try:
            if None in named and not self._network.is_settled:
                raise TopicChoiceError("too early to know all topics")
            chosen = choose_topics(offers, wanted, option_of=_option_of)
            silent = [name for name, first in self._first_messages.items() if first is None]
            if silent and topics.colour is None and chosen.colour.grey:
                raise TopicChoiceError(
                    f"{chosen.colour.name} is grey, and {', '.join(silent)} may be colour, but "
                    "sends nothing; name the topic with topics.colour of --config"
                )
            return chosen
        except TopicChoiceError as error:
            there = ", ".join(sorted(cameras)) or "none; is the domain (ROS_DOMAIN_ID) the same?"
            raise TopicChoiceError(f"{error}. Published topics of cameras: {there}") from error

    def _first_pose(self) -> None:
        """Look up all poses once.

        Raises:
            RosNetworkError: There is no pair of images yet.
            TransformMissingError: A frame is missing, or there is no odometry.
        """
        if self.stream.latest is None:
            raise RosNetworkError(
                "no colour and depth image with times that go together: "
                f"{self.stream.described()}; are they published, with the quality of sensor data, "
                f"and at most {self._config.timing.apart_s:g} s apart (timing.apart_s)?"
            )
        pair = self.stream.newest_until(self._odometry_s) or self.stream.latest
        if 0.0 <= self._odometry_s < pair.stamp_s:
            raise TransformMissingError(
                f"the odometry is {pair.stamp_s - self._odometry_s:.2f} s behind all images, "
                "expected odometry for their times; do the clocks of the computers agree (chrony)?"
            )
        self.camera_to_base(pair.stamp_s)
        self.odom_to_map()
        if self._odometry_s < 0.0:
            frames, topics = self._config.frames, self._config.topics
            raise TransformMissingError(
                f"'{frames.base}' has a fixed pose in '{frames.odom}', expected odometry that "
                f"changes, on '{topics.tf}' (topics.tf) or topics.odometry"
            )


def _option_of(role: str) -> str:
    return f"topics.{role} of --config"


def _planar(pose: Transform) -> Pose2:
    x, y, _ = pose.translation.tolist()
    return Pose2(x, y, pose.yaw)
