"""Limits of the server, and what is counted to keep to them.

So no request exhausts its memory or time.
"""

import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable
from statistics import median

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.errors import RequestRefusedError
from hypernav.core.trace import StepTrace

_MOST_ADDRESSES = 1000
_WINDOW_S = 10.0
_RANKING = "rank images"
_LEAST = 20
"""Number of answers in the window from which on it says something."""


class ServerLimits(RoomConfig):
    """Limits of a server.

    Attributes:
        searches: Searches under way at once, each with a thread and a map.
        idle_s: Time without a message of its robot after which a search ends, seconds.
        answer_s: Median time of the answers above which no other search is opened, seconds; the
            time of chat models, and that of ranking remembered images, isn't counted. By default
            that after which `RobotClient` stands still and waits.
        kept: Searches in the state folder, finished ones included.
        pixels: Pixels of a camera image.
        requests_per_s: Requests and messages of one address a second, on average.
        burst: Requests of one address at once, after a pause.
        requests_at_once: Requests of one kind that are worked on at once: those of robots, those
            that wait for news, and all others. STOP has no limit.
        body_s: Time for the body of a request to arrive, seconds.
    """

    searches: int = Field(default=16, ge=1, le=1000)
    idle_s: float = Field(default=600.0, ge=0.0, le=1e9)
    answer_s: float = Field(default=0.5, gt=0.0, le=1e9)
    kept: int = Field(default=10_000, ge=1, le=1_000_000)
    pixels: int = Field(default=2_100_000, ge=64, le=10_000_000)
    requests_per_s: float = Field(default=200.0, gt=0.0, le=1e6)
    burst: int = Field(default=400, ge=1, le=1_000_000)
    requests_at_once: int = Field(default=64, ge=1, le=10_000)
    body_s: float = Field(default=30.0, gt=0.0, le=3600.0)


class Allowances:
    """How many more requests each address may make: a token bucket for its robots, one for others.

    So whoever watches can't use up what a robot of the same address needs.
    """

    def __init__(self, limits: ServerLimits) -> None:
        """Begin with full buckets."""
        self._limits = limits
        self._buckets: OrderedDict[tuple[str, bool], tuple[float, float]] = OrderedDict()

    def take(self, address: str, *, is_robot: bool) -> None:
        """Account for one request.

        Args:
            address: Where it comes from.
            is_robot: Whether it is the message of a robot.

        Raises:
            RequestRefusedError: The bucket is empty.
        """
        rate, burst = self._limits.requests_per_s, float(self._limits.burst)
        now = time.monotonic()
        left, before = self._buckets.pop((address, is_robot), (burst, now))
        left = min(left + (now - before) * rate, burst)
        self._buckets[address, is_robot] = (max(left - 1.0, 0.0), now)
        while len(self._buckets) > _MOST_ADDRESSES:
            self._buckets.popitem(last=False)
        if left < 1.0:
            raise RequestRefusedError(
                f"more than {rate:g} requests a second come from this address; send fewer",
                error="busy",
                status=429,
            )


class Pace:
    """The time that the answers of the last seconds took, that of models left out.

    A chat model's server is somebody else's, and waiting for it takes none of this server's time.
    Remembered images are ranked once in a search, which says nothing of its next answers.
    Thread-safe.
    """

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        """Begin without answers.

        Args:
            now_s: Clock, seconds.
        """
        self._now_s = now_s
        self._lock = threading.Lock()
        self._answers: deque[tuple[float, float]] = deque()

    def note(self, trace: StepTrace | None, offered_s: float) -> None:
        """Count an answer that was given just now.

        Args:
            trace: The decision; None if nothing had to be decided.
            offered_s: Time at which its observation had come, on the clock.
        """
        asked = [] if trace is None else trace.exchanges
        models_s = sum(one.seconds for one in asked if one.by_model or one.kind == _RANKING)
        now_s = self._now_s()
        with self._lock:
            self._answers.append((now_s, now_s - offered_s - models_s))
            self._forget(now_s)

    def median_s(self) -> float | None:
        """Median of the answers of the last seconds; None if they are too few to judge."""
        with self._lock:
            self._forget(self._now_s())
            if len(self._answers) < _LEAST:
                return None
            return median(took_s for _, took_s in self._answers)

    def _forget(self, now_s: float) -> None:
        while self._answers and self._answers[0][0] < now_s - _WINDOW_S:
            self._answers.popleft()
