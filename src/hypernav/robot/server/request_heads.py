"""HTTP with a limited number of connections and a time limit for request heads.

Uvicorn limits neither, so idle connections could block STOP.

Uvicorn accepts a custom protocol class as its ``http`` setting, but has no public one to derive
from, and an application learns of a connection only when a whole head has come. So this class uses
undocumented attributes of `H11Protocol`: pyproject.toml bounds the version, and
``tests/robot/server/test_request_heads.py`` names what a release has changed.
"""

import asyncio
from collections import Counter
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

_HEAD_S = 10.0
_MOST_CONNECTIONS = 256


class TimedHeads(H11Protocol):
    """Closes connections whose request head does not arrive in time, and one if there are too many.

    A new connection is always accepted: it may carry STOP. If there are too many, one with an
    incomplete request, head or body, is closed: the oldest of the address that has most of them.
    Connections that wait for a response are limited by the guard (`ServerLimits.requests_at_once`).
    """

    _deadline: asyncio.TimerHandle | None = None
    _since_s = 0.0

    def connection_made(self, transport: Any) -> None:
        """Begin to wait for the first head."""
        super().connection_made(transport)
        self._wait_for_head()
        if len(self.connections) > _MOST_CONNECTIONS:
            self._give_way()

    def data_received(self, data: bytes) -> None:
        """Receive data; the rest of an incomplete head must come in time."""
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        """Wait for the next head."""
        super().on_response_complete()
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timer."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _give_way(self) -> None:
        others = [one for one in self.connections if isinstance(one, TimedHeads)]
        asking = [one for one in others if one is not self and one._is_asking]
        of_address = Counter(one._address for one in asking)
        most = max(of_address.values(), default=0)
        if most == 0:
            return
        crowd = [one for one in asking if of_address[one._address] == most]
        oldest = min(crowd, key=lambda one: one._since_s)
        oldest._stop_waiting()
        oldest.transport.abort()

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    @property
    def _is_asking(self) -> bool:
        """Whether a request is still to come or incomplete."""
        is_open = not self.transport.is_closing()
        return is_open and self.conn.their_state in (h11.IDLE, h11.SEND_BODY)

    def _watch(self) -> None:
        if self.conn.their_state is h11.IDLE:
            self._wait_for_head()
        elif self._deadline is not None:
            self._stop_waiting()
            self._since_s = self.loop.time()

    def _wait_for_head(self) -> None:
        if self._deadline is None:
            self._since_s = self.loop.time()
            self._deadline = self.loop.call_later(_HEAD_S, self.transport.close)

    def _stop_waiting(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None
