"""The same conversation over one WebSocket, for robots that send many observations a second."""

import asyncio

from fastapi import WebSocket, WebSocketDisconnect

from hypernav.core.errors import RequestRefusedError, RunFolderError, WireError
from hypernav.robot.server.limits import Allowances
from hypernav.robot.server.search import Search
from hypernav.robot.server.searches import Searches
from hypernav.robot.server.standing import Turn
from hypernav.robot.wire.replies import ErrorBody, Reply, SearchEnding, StreamMessage

_UNKNOWN = 4404
_ENDED_OUTSIDE = frozenset({SearchEnding.STOPPED, SearchEnding.CLOSED, SearchEnding.ROBOT_FAILED})


class Stream:
    """One connection of one robot."""

    def __init__(
        self, searches: Searches, name: str, socket: WebSocket, allowances: Allowances
    ) -> None:
        """Create it with a connection that is not accepted yet.

        Args:
            searches: All searches.
            name: Name of the one that the robot asks for.
            socket: The connection.
            allowances: Messages that each address may still send.
        """
        self._searches = searches
        self._name = name
        self._socket = socket
        self._allowances = allowances
        self._sending = asyncio.Lock()
        self._followed: set[Turn] = set()

    async def run(self) -> None:
        """Answer observations until the robot leaves."""
        await self._socket.accept()
        try:
            search = self._searches.find(self._name)
        except RequestRefusedError as refused:
            await self._send(_error(refused.error, str(refused), refused.status))
            await self._socket.close(_UNKNOWN)
            return
        try:
            async with asyncio.TaskGroup() as tasks:
                pushing = tasks.create_task(self._push_stop(search))
                await self._answer_all(search, tasks)
                pushing.cancel()
        except* WebSocketDisconnect:
            pass

    async def _answer_all(self, search: Search, tasks: asyncio.TaskGroup) -> None:
        address = self._socket.client.host if self._socket.client else ""
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                raise WebSocketDisconnect
            try:
                self._allowances.take(address, is_robot=True)
                body = message.get("bytes")
                if body is None:
                    raise WireError("observations are binary messages, got a text message")
                turn = search.offer(body)
            except RequestRefusedError as refused:
                error = _error(refused.error, str(refused), refused.status, refused.expected)
                await self._send(error)
            except WireError as error:
                await self._send(_error("invalid", str(error), 422))
            else:
                tasks.create_task(self._answer(search, turn))

    async def _answer(self, search: Search, turn: Turn) -> None:
        """Send the answer; if it takes longer than the deadline, send ``hold`` first."""
        deadline_s = search.record.request.deadline_s
        if not await search.bell.until(lambda: turn.is_answered, deadline_s):
            await self._send_result(turn)
            if turn in self._followed:
                return
            self._followed.add(turn)
            is_answered = await search.bell.until(lambda: turn.is_answered, None)
            self._followed.discard(turn)
            if not is_answered:
                return
        await self._send_result(turn)

    async def _push_stop(self, search: Search) -> None:
        """Tell the robot at once when someone presses stop."""
        await search.bell.until(lambda: search.is_over, None)
        if search.status().ending in _ENDED_OUTSIDE:
            await self._send(StreamMessage(reply=search.end_reply))

    async def _send_result(self, turn: Turn) -> None:
        try:
            reply: Reply = turn.result()
        except WireError as error:
            await self._send(_error("invalid", str(error), 422))
        except RunFolderError as error:
            await self._send(_error("storage", str(error), 507))
        else:
            await self._send(StreamMessage(reply=reply))

    async def _send(self, message: StreamMessage) -> None:
        async with self._sending:
            await self._socket.send_text(message.model_dump_json())


def _error(error: str, message: str, status: int, expected: int | None = None) -> StreamMessage:
    body = ErrorBody(error=error, message=message, expected=expected)
    return StreamMessage(error=body, status=status)
