"""Observations over one WebSocket, for high rates (extra ``robot``)."""

import time
from contextlib import ExitStack

from pydantic import ValidationError

from hypernav.core.components.registry import require
from hypernav.core.errors import LinkLostError, RequestRefusedError
from hypernav.robot.client.links import give_up
from hypernav.robot.client.server_address import ServerAddress
from hypernav.robot.wire.replies import Reply, StreamMessage
from hypernav.robot.wire.values import SEARCHES

_CONNECT_S = 5.0


class WebSocketLink:
    """Sends observations as binary messages; replies come as text, some of them unrequested."""

    def __init__(self, address: ServerAddress, search_id: str) -> None:
        """Carry the observations of one search; the connection opens with the first.

        Raises:
            MissingExtraError: The package websockets is not installed.
        """
        self._client = require("websockets.sync.client", extra="robot")
        self._exceptions = require("websockets.exceptions", extra="robot")
        scheme = "wss" if address.is_secure else "ws"
        self._url = (
            f"{scheme}://{address.host}:{address.port}{address.path}{SEARCHES}/{search_id}/stream"
        )
        self._address, self._search_id = address, search_id
        self._open = ExitStack()
        self._connection = None

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        """Send an observation and wait for its reply."""
        try:
            if self._connection is None:
                opening = self._client.connect(
                    self._url,
                    additional_headers=self._address.headers,
                    open_timeout=_CONNECT_S,
                    max_size=None,
                    compression=None,
                    proxy=None,
                )
                self._connection = self._open.enter_context(opening)
            self._connection.send(body)
        except (OSError, self._exceptions.WebSocketException) as error:
            raise self._lost(error) from error
        return self._next(sequence, timeout_s)

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        """Wait once more for a reply that was on hold; the server sends it without being asked."""
        return self._next(sequence, timeout_s)

    def give_up(self, reason: str) -> None:
        """Tell the server that the robot ends by an error."""
        give_up(self._address, self._search_id, reason)

    def close(self) -> None:
        """End the connection."""
        self._connection = None
        self._open.close()

    def _next(self, sequence: int, timeout_s: float) -> Reply:
        """The next message about an observation; messages about earlier ones are skipped."""
        if self._connection is None:
            raise LinkLostError(f"{self._url}: the connection was lost while the server decided")
        end = time.monotonic() + timeout_s
        while True:
            try:
                text = self._connection.recv(timeout=max(end - time.monotonic(), 0.001))
                message = StreamMessage.model_validate_json(text)
            except (OSError, self._exceptions.WebSocketException, ValidationError) as error:
                raise self._lost(error) from error
            if message.error is not None:
                error = message.error
                raise RequestRefusedError(
                    error.message, error=error.error, status=message.status, expected=error.expected
                )
            reply = message.reply
            if reply is not None and (reply.sequence == sequence or reply.done):
                return reply

    def _lost(self, error: Exception) -> LinkLostError:
        self.close()
        return LinkLostError(f"{self._url}: {error or type(error).__name__}")
