"""The HTTP application: every path, its request and its response.

Over one WebSocket a robot that sends many observations a second has the same conversation.
"""

import asyncio
import logging
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path as FilePath
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Path, Request, WebSocket, WebSocketDisconnect
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException

from hypernav.core.errors import HyPerNavError, RequestRefusedError, RunFolderError, WireError
from hypernav.robot.server.guard import API, Access, Guard, refusal
from hypernav.robot.server.limits import Allowances, ServerLimits
from hypernav.robot.server.operator_page import operator_routes
from hypernav.robot.server.searches.search import Search
from hypernav.robot.server.searches.searches import Searches
from hypernav.robot.server.searches.standing import Turn
from hypernav.robot.server.waiting_robots import WaitingRobots
from hypernav.robot.server.watching import Name, watching_routes
from hypernav.robot.wire.places import (
    GO_TO,
    NO_ENTRY,
    GoToPlace,
    GoToRequest,
    NoEntryArea,
    NoEntryRequest,
)
from hypernav.robot.wire.replies import (
    ErrorBody,
    Reply,
    SearchEnding,
    SearchOpened,
    Status,
    StreamMessage,
)
from hypernav.robot.wire.requests import CloseRequest, ObservationHeader, OpenSearch
from hypernav.robot.wire.values import SEARCHES

_LOG = logging.getLogger(__name__)

REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": ErrorBody, "description": words}
    for status, words in {
        400: "The request cannot be read.",
        401: "The token is missing or wrong.",
        403: "This page or host may not use this server.",
        404: "There is no such search, or nothing to show yet.",
        405: "This path takes another method.",
        408: "The body did not arrive in time.",
        409: "Another observation is expected, see expected; or a key is that of another goal.",
        413: "The body is too large.",
        422: "A value is wrong; the message says which.",
        429: "Too many requests or searches.",
        431: "The path or the headers are too long.",
        500: "An error of the server; its log says more.",
        503: "The memory cannot be read now; the message says why.",
        507: "The disk of the server is full.",
    }.items()
}
"""The statuses of refusals, for the OpenAPI document."""


def add_refusals(app: FastAPI) -> None:
    """Let an application answer errors with refusals."""
    app.add_exception_handler(RequestRefusedError, _refused)
    app.add_exception_handler(RunFolderError, _storage)
    app.add_exception_handler(HyPerNavError, _invalid)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _internal)


async def _refused(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestRefusedError)
    return refusal(error.error, str(error), error.status, error.expected)


async def _storage(_: Request, error: Exception) -> Response:
    _LOG.error("%s", error)
    return refusal(
        "storage",
        "the server cannot write its state; its log says more. A stop holds until the server ends; "
        "send it again when there is room",
        507,
    )


async def _invalid(_: Request, error: Exception) -> Response:
    return refusal("invalid", str(error), 422)


async def _malformed(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    kind = request.headers.get("content-type", "none")
    if first["loc"] == ("body",) and "json" not in kind:
        expected = f"expected the header content-type: application/json, got {kind[:80]!a}"
        return refusal("invalid", expected, 422)
    where = ".".join(str(part) for part in first["loc"])
    return refusal("invalid", f"{where[:100]}: {str(first['msg'])[:300]}", 422)


async def _http(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    words = {404: "unknown", 405: "method"}.get(error.status_code, "invalid")
    response = refusal(words, str(error.detail), error.status_code)
    response.headers.update(error.headers or {})
    return response


async def _internal(_: Request, error: Exception) -> Response:
    return refusal("internal", "an error of the server; its log says more", 500)


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


_Number = Annotated[int, Path(ge=0, le=1_000_000, description="Number of the observation or area.")]
_OBSERVATION_BODY = {
    "requestBody": {
        "required": True,
        "description": (
            "One line of JSON, the ObservationHeader of components/schemas, a line feed, and then "
            "the images that it announces, one directly after the other: colour, depth and, in "
            "simulation, labels."
        ),
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


def make_app(
    searches: Searches,
    waiting: WaitingRobots,
    access: Access,
    limits: ServerLimits,
    memory: FilePath | None = None,
) -> FastAPI:
    """The application around the searches of a server.

    Args:
        searches: Opened searches.
        waiting: Robots that wait for a goal.
        access: Who may use the server.
        limits: Limits of the server.
        memory: Folder of the memory; None if there is none.
    """
    allowances = Allowances(limits)
    routers = (
        _routes(searches, waiting, allowances),
        watching_routes(searches),
        operator_routes(searches, waiting, memory),
    )
    return guarded_app(routers, access, limits, allowances)


def guarded_app(
    routers: Iterable[APIRouter], access: Access, limits: ServerLimits, allowances: Allowances
) -> FastAPI:
    """An application behind the guard, whose refusals say what was expected.

    Args:
        routers: Its paths.
        access: Who may use the server.
        limits: Limits of the server.
        allowances: Requests that each address may still make.
    """
    app = FastAPI(
        title="hypernav",
        description="Guides robots to the things that they are told to find. See docs/robot.md.",
        version=version("hypernav"),
        openapi_url=f"{API}/openapi.json",
        docs_url=None,  # its page loads scripts from other sites
        redoc_url=None,
    )
    for router in routers:
        app.include_router(router, responses=REFUSALS)
    add_refusals(app)
    _document_observations(app)
    app.add_middleware(Guard, access=access, limits=limits, allowances=allowances)
    return app


def _document_observations(app: FastAPI) -> None:
    """Add the header of an observation to the OpenAPI document, which no path names by itself."""
    describe = app.openapi

    def described() -> dict[str, Any]:
        document = describe()
        schemas = document.setdefault("components", {}).setdefault("schemas", {})
        if "ObservationHeader" not in schemas:
            header = ObservationHeader.model_json_schema(
                ref_template="#/components/schemas/{model}"
            )
            schemas |= header.pop("$defs") | {"ObservationHeader": header}
        return document

    app.openapi = described


def _routes(searches: Searches, waiting: WaitingRobots, allowances: Allowances) -> APIRouter:
    routes = APIRouter()

    # Robots refuse what they don't know: without a memory older ones get what they always got.
    @routes.post(SEARCHES, status_code=201, response_model_exclude_none=True)
    async def open_search(request: OpenSearch) -> SearchOpened:
        """Begin a search, or return that of the same key."""
        thing = waiting.meant(request.key) or request.thing
        request = request.model_copy(update={"thing": thing})
        try:
            search = await run_in_threadpool(searches.open, request)
        except HyPerNavError as error:
            waiting.refuse(request.key, str(error))
            raise
        if not waiting.take_up(request.key):
            search.stop("stopped before it began")
            await run_in_threadpool(search.write_end)
        status = search.status()
        return SearchOpened(
            id=status.id,
            next_sequence=status.next_sequence,
            version=version("hypernav"),
            words=status.words,
            earlier_searches=search.record.earlier_searches,
        )

    @routes.post(f"{SEARCHES}/{{name}}/observations", openapi_extra=_OBSERVATION_BODY)
    async def observe(name: Name, request: Request) -> Reply:
        """Receive an observation and say what to do."""
        search = searches.find(name)
        return await search.answer_of(search.offer(await request.body()))

    @routes.get(f"{SEARCHES}/{{name}}/replies/{{sequence}}")
    async def reply(name: Name, sequence: _Number) -> Reply:
        """The answer to the last observation, if the first reply said ``hold``."""
        search = searches.find(name)
        return await search.answer_of(search.turn(sequence))

    @routes.websocket(f"{SEARCHES}/{{name}}/stream")
    async def stream(name: str, socket: WebSocket) -> None:
        await Stream(searches, name, socket, allowances).run()

    @routes.post(f"{SEARCHES}/{{name}}/pause")
    async def pause(name: Name) -> Status:
        """Keep the robot waiting for its next decision; it stands after its present action."""
        return await run_in_threadpool(paused, name, is_paused=True)

    @routes.post(f"{SEARCHES}/{{name}}/resume")
    async def resume(name: Name) -> Status:
        """Let a paused robot go on."""
        return await run_in_threadpool(paused, name, is_paused=False)

    def paused(name: str, *, is_paused: bool) -> Status:
        search = searches.find(name)
        search.pause(is_paused=is_paused)
        return search.status()

    @routes.get(f"{SEARCHES}/{{name}}/{NO_ENTRY}")
    async def no_entry(name: Name) -> list[NoEntryArea]:
        """The places that the robot is not to enter."""
        return list(searches.find(name).closed)

    @routes.post(f"{SEARCHES}/{{name}}/{NO_ENTRY}", status_code=201)
    def close_area(name: Name, request: NoEntryRequest) -> NoEntryArea:
        """Close a place to the robot, from its next decision on."""
        return searches.find(name).close_area(request)

    @routes.delete(f"{SEARCHES}/{{name}}/{NO_ENTRY}/{{number}}")
    def open_area(name: Name, number: _Number) -> list[NoEntryArea]:
        """Let the robot enter a place again; the answer is what stays closed."""
        return list(searches.find(name).open_area(number))

    @routes.get(f"{SEARCHES}/{{name}}/{GO_TO}")
    async def going_to(name: Name) -> GoToPlace | None:
        """The last place that the robot was sent to; null without one, and if it was cancelled."""
        return searches.find(name).going_to

    @routes.put(f"{SEARCHES}/{{name}}/{GO_TO}")
    def go_to(name: Name, request: GoToRequest) -> GoToPlace:
        """Send the robot to a place, from its next decision on; then it searches by itself."""
        return searches.find(name).go_to(request)

    @routes.delete(f"{SEARCHES}/{{name}}/{GO_TO}")
    def cancel_go_to(name: Name) -> None:
        """Let the robot search by itself again, from its next decision on."""
        searches.find(name).cancel_go_to()

    @routes.post(f"{SEARCHES}/{{name}}/close")
    async def close(name: Name, request: CloseRequest | None = None) -> Status:
        """End a search that is no longer needed; its files can still be read."""
        search, why = searches.find(name), request or CloseRequest()
        ending = SearchEnding.ROBOT_FAILED if why.failed else SearchEnding.CLOSED
        search.stop(why.reason or "closed", ending)
        await run_in_threadpool(search.write_end)
        return search.status()

    return routes
