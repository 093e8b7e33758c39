"""Requests to a robot's server: its address, and links over HTTP and one WebSocket."""

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Protocol, TypeVar, runtime_checkable
from urllib.parse import urlsplit

import numpy as np
from pydantic import BaseModel, TypeAdapter, ValidationError

from hypernav.core.components.registry import require
from hypernav.core.errors import (
    HyPerNavError,
    LinkLostError,
    RequestRefusedError,
    RobotLinkError,
)
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import StepTrace
from hypernav.io.bounded_http import Deadline, Session
from hypernav.io.reading import read_file, text_of
from hypernav.io.secret import Secret
from hypernav.robot.wire.places import (
    GO_TO,
    NO_ENTRY,
    GoToPlace,
    GoToRequest,
    NoEntryArea,
    NoEntryRequest,
)
from hypernav.robot.wire.replies import ErrorBody, Reply, SearchOpened, Status, StreamMessage
from hypernav.robot.wire.requests import ROBOTS, CloseRequest, GivenGoal, OpenSearch, StopRequest
from hypernav.robot.wire.values import SEARCHES

_MOST_TOKEN_BYTES = 10_000


@dataclass(frozen=True)
class ServerAddress:
    """Where the server is, and the token for it.

    Attributes:
        host: Name or address of the machine.
        port: Port of the server.
        path: Prefix of all request paths; usually empty.
        is_secure: Whether the connection is encrypted (``https``).
        token: Token of the server; None sends none.
    """

    host: str
    port: int
    path: str = ""
    is_secure: bool = False
    token: str | None = field(default=None, repr=False)

    @staticmethod
    def of(url: str, token_file: Path | None = None) -> "ServerAddress":
        """Read an address such as ``http://192.168.1.5:8765``.

        Raises:
            RobotLinkError: The text is no such address, or the token file cannot be read.
        """
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise RobotLinkError(f"address of the server '{url:.100}': {error}") from error
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise RobotLinkError(
                f"address of the server '{url:.100}': expected one such as http://192.168.1.5:8765"
            )
        secure = parts.scheme == "https"
        token = None
        if token_file is not None:
            try:
                token = text_of(read_file(token_file, most=_MOST_TOKEN_BYTES)).strip()
            except (OSError, UnicodeDecodeError) as error:
                raise RobotLinkError(f"{token_file}: cannot read the token: {error}") from error
        return ServerAddress(
            parts.hostname, port or (443 if secure else 80), parts.path.rstrip("/"), secure, token
        )

    @cached_property
    def secret(self) -> Secret:
        """The token, to blank it in what the server says."""
        return Secret(self.token or "")

    @property
    def headers(self) -> dict[str, str]:
        """The headers of every request."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}

    def __str__(self) -> str:
        """The address for people, without the token."""
        return f"http{'s' * self.is_secure}://{self.host}:{self.port}{self.path}"


MessageT = TypeVar("MessageT", bound=BaseModel)
_AREAS = TypeAdapter(list[NoEntryArea])
_GOING_TO = TypeAdapter[GoToPlace | None](GoToPlace | None)
_CONNECT_S = 5.0
_LONGEST_REASON = 500
_MOST_QUOTED = 4096
_LARGEST_REPLY_BYTES = 256 * 2**20
"""Limit of a reply: the trace of a long search and the map of a large building are the largest."""


@runtime_checkable
class Link(Protocol):
    """Carries observations to the server, and replies back."""

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        """Send an observation and wait for its reply, which may be on hold.

        Raises:
            LinkLostError: The observation or the reply got lost, or took too long.
            RequestRefusedError: The server refuses the observation.
        """
        ...

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        """Wait once more for the reply to the latest observation, which was on hold.

        Raises:
            LinkLostError: The reply got lost.
            RequestRefusedError: The server has no such observation.
        """
        ...

    def give_up(self, reason: str) -> None:
        """Tell the server that the robot ends by an error; if it can't be reached, do nothing."""
        ...

    def close(self) -> None:
        """End the connection."""
        ...


class HttpServer:
    """All requests of the contract, over one connection, which is opened again if it breaks.

    One thread at a time may use it.

    Attributes:
        address: Where the server is.
    """

    def __init__(self, address: ServerAddress) -> None:
        """Remember the address; the first request connects."""
        self.address = address
        self._session = Session(largest_reply_bytes=_LARGEST_REPLY_BYTES)

    def open(self, request: OpenSearch) -> SearchOpened:
        """Open a search, or find the one that was opened with the same key."""
        body = request.model_dump_json(exclude_none=True).encode()  # older servers know less
        return self._asked(SearchOpened, "POST", SEARCHES, body)

    def observe(self, search_id: str, body: bytes, timeout_s: float) -> Reply:
        """Send an observation."""
        path = f"{SEARCHES}/{search_id}/observations"
        kind = "application/octet-stream"
        return self._asked(Reply, "POST", path, body, timeout_s=timeout_s, kind=kind)

    def reply(self, search_id: str, sequence: int, timeout_s: float) -> Reply:
        """Ask for the reply to an observation that was accepted."""
        path = f"{SEARCHES}/{search_id}/replies/{sequence}"
        return self._asked(Reply, "GET", path, timeout_s=timeout_s)

    def status(self, search_id: str, *, after: int = -1, wait_s: float = 0.0) -> Status:
        """State of a search, as soon as it is newer than `after`, or when `wait_s` has passed.

        Args:
            search_id: The search.
            after: Version that the caller already has.
            wait_s: Longest wait for a newer one, seconds.

        Raises:
            LinkLostError: No answer came within a little more than `wait_s`.
            RequestRefusedError: There is no such search.
        """
        query = f"after={after}&wait_s={wait_s:g}"
        path = f"{SEARCHES}/{search_id}?{query}"
        return self._asked(Status, "GET", path, timeout_s=wait_s + _CONNECT_S)

    def wait_for_goal(self, robot: str, *, wait_s: float = 5.0) -> GivenGoal:
        """Wait for a goal of the operator.

        Args:
            robot: Name of this robot.
            wait_s: Longest wait, seconds.

        Raises:
            LinkLostError: No answer; ask again after a pause.
            RequestRefusedError: Too many robots are waiting.
        """
        path = f"{ROBOTS}/{robot}/wait?wait_s={wait_s:g}"
        return self._asked(GivenGoal, "POST", path, timeout_s=wait_s + _CONNECT_S)

    def trace(self, search_id: str, *, since: int = 0) -> Iterator[StepTrace]:
        """The steps of a search, from a given step on."""
        text = self._request("GET", f"{SEARCHES}/{search_id}/trace?since={since}").decode()
        for line in text.splitlines():
            yield StepTrace.model_validate_json(line)

    def grid(self, search_id: str) -> OccupancyGrid:
        """The map of a search.

        Raises:
            RequestRefusedError: There is no map before the first answer.
        """
        message = json.loads(self._request("GET", f"{SEARCHES}/{search_id}/map.json"))
        info, states = message["info"], np.array(message["data"], dtype=np.int16)
        cells = np.full(states.shape, Cell.UNKNOWN, dtype=np.uint8)
        cells[states == 0], cells[states > 0] = Cell.FREE, Cell.OCCUPIED
        position = info["origin"]["position"]
        return OccupancyGrid(
            cells.reshape(info["height"], info["width"]),
            info["resolution"],
            (position["x"], position["y"]),
        )

    def stop(self, search_id: str, reason: str = "") -> Status:
        """Press stop."""
        body = StopRequest(reason=reason).model_dump_json().encode()
        return self._asked(Status, "POST", f"{SEARCHES}/{search_id}/stop", body)

    def no_entry(self, search_id: str) -> list[NoEntryArea]:
        """The places that the robot of a search is not to enter."""
        return _AREAS.validate_json(self._request("GET", f"{SEARCHES}/{search_id}/{NO_ENTRY}"))

    def close_area(self, search_id: str, request: NoEntryRequest) -> NoEntryArea:
        """Close a place to the robot of a search, from its next decision on.

        Raises:
            RequestRefusedError: The place is not on the map, the robot stands in it, or the search
                is over.
        """
        body = request.model_dump_json().encode()
        return self._asked(NoEntryArea, "POST", f"{SEARCHES}/{search_id}/{NO_ENTRY}", body)

    def open_area(self, search_id: str, number: int) -> list[NoEntryArea]:
        """Let the robot enter a place again; returns what stays closed.

        Raises:
            RequestRefusedError: No closed place has this number, or the search is over.
        """
        path = f"{SEARCHES}/{search_id}/{NO_ENTRY}/{number}"
        return _AREAS.validate_json(self._request("DELETE", path))

    def going_to(self, search_id: str) -> GoToPlace | None:
        """The last place that the robot was sent to; None without one, and if it was cancelled."""
        return _GOING_TO.validate_json(self._request("GET", f"{SEARCHES}/{search_id}/{GO_TO}"))

    def go_to(self, search_id: str, request: GoToRequest) -> GoToPlace:
        """Send the robot of a search to a place, from its next decision on; then it searches on.

        Raises:
            RequestRefusedError: The place is not on the map of the robot's floor or is closed, or
                the search is over.
        """
        body = request.model_dump_json().encode()
        return self._asked(GoToPlace, "PUT", f"{SEARCHES}/{search_id}/{GO_TO}", body)

    def cancel_go_to(self, search_id: str) -> None:
        """Let the robot search by itself again, from its next decision on.

        Raises:
            RequestRefusedError: It is on its way to no place, or the search is over.
        """
        self._request("DELETE", f"{SEARCHES}/{search_id}/{GO_TO}")

    def close_search(self, search_id: str, *, failure: str | None = None) -> None:
        """Tell the server that the search is no longer needed.

        Args:
            search_id: The search.
            failure: What the robot failed by, for the operator; None if nothing is wrong.
        """
        words = " ".join((failure or "").split())[:_LONGEST_REASON]
        body = CloseRequest(reason=words, failed=failure is not None).model_dump_json().encode()
        path = f"{SEARCHES}/{search_id}/close"
        self._request("POST", path, body, timeout_s=_CONNECT_S)

    def close(self) -> None:
        """End the connection."""
        self._session.close()

    def _asked(
        self,
        message: type[MessageT],
        method: str,
        path: str,
        body: bytes | None = None,
        *,
        timeout_s: float = 30.0,
        kind: str = "application/json",
    ) -> MessageT:
        content = self._request(method, path, body, timeout_s=timeout_s, kind=kind)
        try:
            return message.model_validate_json(content)
        except ValidationError as error:
            said = self.address.secret.blanked_bytes(content[:_MOST_QUOTED])[:100]
            raise LinkLostError(
                f"{self.address}: the answer is no {message.__name__}: {said!r}"
            ) from error

    def _request(
        self,
        method: str,
        path: str,
        body: bytes | None = None,
        *,
        timeout_s: float = 30.0,
        kind: str = "application/json",
    ) -> bytes:
        headers = self.address.headers | ({} if body is None else {"Content-Type": kind})
        try:
            reply = self._session.exchange(
                method,
                f"{self.address}{path}",
                headers=headers,
                body=body,
                deadline=Deadline(timeout_s),
                connect_limit_s=_CONNECT_S,
            )
        except (OSError, ValueError) as error:
            hint = "; is hypernav serve running there?" * isinstance(error, ConnectionRefusedError)
            said = self.address.secret.blanked(str(error)) or type(error).__name__
            raise LinkLostError(f"{self.address}: {said}{hint}") from error
        if reply.status >= 400:
            raise refused(reply.status, self.address.secret.blanked_bytes(reply.body))
        return reply.body


class HttpLink:
    """Observations as one HTTP request each."""

    def __init__(self, address: ServerAddress, search_id: str) -> None:
        """Carry the observations of one search."""
        self._server = HttpServer(address)
        self._search_id = search_id

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        """Send an observation and wait for its reply."""
        return self._server.observe(self._search_id, body, timeout_s)

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        """Wait once more for a reply that was on hold."""
        return self._server.reply(self._search_id, sequence, timeout_s)

    def give_up(self, reason: str) -> None:
        """Tell the server that the robot ends by an error."""
        give_up(self._server.address, self._search_id, reason)

    def close(self) -> None:
        """End the connection."""
        self._server.close()


def give_up(address: ServerAddress, search_id: str, reason: str) -> None:
    """Close a search because its robot failed; if the server can't be reached, do nothing.

    It uses a connection of its own, since another thread may wait for an answer on that of a link.
    """
    with (
        closing(HttpServer(address)) as server,
        suppress(RobotLinkError, RequestRefusedError),
    ):
        server.close_search(search_id, failure=reason)


def failure_words(error: BaseException | None) -> str:
    """What an operator reads about an error of the robot's program."""
    words = str(error)
    if isinstance(error, HyPerNavError):
        return words
    return f"the robot's program ended by {type(error).__name__}{': ' * bool(words)}{words}"


def refused(status: int, content: bytes) -> RequestRefusedError:
    """The error for a refusal; it quotes the response if that did not come from our server."""
    try:
        body = ErrorBody.model_validate(json.loads(content))
    except (ValueError, ValidationError):
        body = ErrorBody(error="unknown", message=f"HTTP {status}: {content[:200]!r}")
    return RequestRefusedError(
        body.message, error=body.error, status=status, expected=body.expected
    )


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
                text = text if isinstance(text, str) else text.decode("utf-8", "replace")
                message = StreamMessage.model_validate_json(self._address.secret.blanked(text))
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
        said = self._address.secret.blanked(str(error)) or type(error).__name__
        return LinkLostError(f"{self._url}: {said}")
