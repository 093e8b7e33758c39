"""Colour and depth images of a live camera, paired by their times."""

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypernav.robot.ros.messages import stamp_s

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
