"""A link that loses, delays, duplicates and reorders messages, like a bad network."""

import time

import numpy as np
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.errors import LinkLostError, RequestRefusedError
from hypernav.robot.client.links import Link
from hypernav.robot.wire.replies import Reply


class NetworkFaults(RoomConfig):
    """What a network does to observations and replies; nothing by default.

    Attributes:
        loss_share: Share of the messages, in either direction, that get lost.
        jitter_s: Largest delay of a message, seconds; each delay is random.
        duplicate_share: Share of the observations that arrive twice.
        reorder_share: Share of the observations after which a copy of an earlier one arrives.
    """

    loss_share: float = Field(default=0.0, ge=0.0, lt=1.0)
    jitter_s: float = Field(default=0.0, ge=0.0, le=60.0)
    duplicate_share: float = Field(default=0.0, ge=0.0, lt=1.0)
    reorder_share: float = Field(default=0.0, ge=0.0, lt=1.0)


class FaultyLink:
    """A `Link` with faults around a good one.

    Attributes:
        lost: Number of messages that got lost.
        doubled: Number of observations that arrived twice.
        reordered: Number of earlier observations that arrived late.
    """

    def __init__(self, link: Link, faults: NetworkFaults, rng: np.random.Generator) -> None:
        """Put faults around a link."""
        self._link = link
        self._faults = faults
        self._rng = rng
        self._earlier: tuple[bytes, int] | None = None
        self._latest: tuple[bytes, int] | None = None
        self.lost = self.doubled = self.reordered = 0

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        """Send an observation, possibly lost, twice, or after a copy of an earlier one."""
        if self._latest is None or self._latest[1] != sequence:
            self._earlier, self._latest = self._latest, (body, sequence)
        self._carry("the observation")
        if self._happens(self._faults.duplicate_share):
            self.doubled += 1
            self._copy(body, sequence, timeout_s)
        reply = self._link.ask(body, sequence, timeout_s)
        if self._earlier is not None and self._happens(self._faults.reorder_share):
            self.reordered += 1
            self._copy(*self._earlier, timeout_s)
        self._carry("the reply")
        return reply

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        """Wait once more for a reply."""
        self._carry("the question")
        reply = self._link.ask_again(sequence, timeout_s)
        self._carry("the reply")
        return reply

    def give_up(self, reason: str) -> None:
        """Tell the server that the robot ends by an error; this always arrives."""
        self._link.give_up(reason)

    def close(self) -> None:
        """End the connection."""
        self._link.close()

    def _copy(self, body: bytes, sequence: int, timeout_s: float) -> None:
        """Send a copy and discard its answer."""
        try:
            self._link.ask(body, sequence, timeout_s)
        except (LinkLostError, RequestRefusedError):
            return

    def _carry(self, what: str) -> None:
        time.sleep(float(self._rng.uniform(0.0, self._faults.jitter_s)))
        if self._happens(self._faults.loss_share):
            self.lost += 1
            raise LinkLostError(f"{what} got lost (a simulated fault)")

    def _happens(self, share: float) -> bool:
        return bool(self._rng.random() < share)
