"""Requests to a robot's server over HTTP."""

import json
from collections.abc import Iterator
from contextlib import closing, suppress
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np
from pydantic import BaseModel, ValidationError

from hypernav.core.errors import (
    HyPerNavError,
    LinkLostError,
    RequestRefusedError,
    RobotLinkError,
)
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import StepTrace
from hypernav.io.bounded_http import Deadline, Session
from hypernav.robot.client.server_address import ServerAddress
from hypernav.robot.wire.replies import ErrorBody, Reply, SearchOpened, Status
from hypernav.robot.wire.requests import CloseRequest, OpenSearch, StopRequest
from hypernav.robot.wire.values import SEARCHES
from hypernav.robot.wire.waiting import ROBOTS, GivenGoal

MessageT = TypeVar("MessageT", bound=BaseModel)
_CONNECT_S = 5.0
_LONGEST_REASON = 500
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
            raise LinkLostError(
                f"{self.address}: the answer is no {message.__name__}: {content[:100]!r}"
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
            raise LinkLostError(
                f"{self.address}: {str(error) or type(error).__name__}{hint}"
            ) from error
        if reply.status >= 400:
            raise refused(reply.status, reply.body)
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
