"""Limits of the server, so that no request exhausts its memory or time."""

from pydantic import Field

from hypernav.core.config import RoomConfig


class ServerLimits(RoomConfig):
    """Limits of a server.

    Attributes:
        searches: Searches under way at once, each with a thread and a map.
        idle_s: Time without a message of its robot after which a search ends, seconds.
        answer_s: Median time of the answers above which no other search is opened, seconds; the
            time of chat models isn't counted. By default that after which `RobotClient` stands
            still and waits.
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
