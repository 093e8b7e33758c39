"""The HTTP application: every path, what it takes and what it gives."""

import logging
from collections.abc import Iterator
from importlib.metadata import version
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Path, Query, Request, WebSocket
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response, StreamingResponse
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException

from hypernav.core.errors import HyPerNavError, RequestRefusedError, RunFolderError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.guard import API, Access, Allowances, Guard, refusal
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.server.maps import map_png, map_server_file, occupancy_grid
from hypernav.robot.server.operator.routes import operator_routes
from hypernav.robot.server.operator.waiting import WaitingRobots
from hypernav.robot.server.search import Search
from hypernav.robot.server.searches import Searches
from hypernav.robot.server.stream import Stream
from hypernav.robot.wire.replies import ErrorBody, Health, Reply, SearchEnding, SearchOpened, Status
from hypernav.robot.wire.requests import OpenSearch, StopRequest
from hypernav.robot.wire.values import LONGEST_WAIT_S, SEARCHES

_LOG = logging.getLogger(__name__)
_Name = Annotated[str, Path(pattern=r"^[0-9a-f]{32}$", description="Name of the search.")]
_Number = Annotated[int, Path(ge=0, le=1_000_000, description="Number of the observation.")]
_REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": ErrorBody, "description": words}
    for status, words in {
        400: "The request cannot be read.",
        401: "The token is missing or wrong.",
        403: "The page or host may not use this server.",
        404: "There is no such search, or nothing to show yet.",
        408: "The body did not arrive in time.",
        409: "Another observation is expected, see expected.",
        413: "The body is too large.",
        422: "A value is wrong; the message says which.",
        429: "Too many requests or searches.",
        507: "The disk of the server is full.",
    }.items()
}
_OBSERVATION_BODY = {
    "requestBody": {
        "required": True,
        "description": "One line of JSON (ObservationHeader), a line feed, and the images.",
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


def make_app(
    searches: Searches, waiting: WaitingRobots, access: Access, limits: ServerLimits
) -> FastAPI:
    """The application around the searches of a server.

    Args:
        searches: Opened searches.
        waiting: Robots that wait for a goal.
        access: Who may come in.
        limits: Limits of the server.
    """
    app = FastAPI(
        title="hypernav",
        description="Sends a robot to what it is told to find. See docs/robot.md.",
        version=version("hypernav"),
        openapi_url=f"{API}/openapi.json",
        docs_url=None,  # its page would load programs from elsewhere
        redoc_url=None,
    )
    allowances = Allowances(limits)
    app.include_router(_routes(searches, waiting, allowances), responses=_REFUSALS)
    app.include_router(operator_routes(searches, waiting), responses=_REFUSALS)
    app.add_exception_handler(RequestRefusedError, _refused)
    app.add_exception_handler(RunFolderError, _storage)
    app.add_exception_handler(HyPerNavError, _invalid)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _internal)
    app.add_middleware(Guard, access=access, limits=limits, allowances=allowances)
    return app


def _routes(searches: Searches, waiting: WaitingRobots, allowances: Allowances) -> APIRouter:
    routes = APIRouter()

    @routes.get(f"{API}/health")
    async def health() -> Health:
        """Whether the server is there, and which version it is."""
        return Health(version=version("hypernav"))

    @routes.post(SEARCHES, status_code=201)
    async def open_search(request: OpenSearch) -> SearchOpened:
        """Begin a search, or return that of the same key."""
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
        )

    @routes.get(SEARCHES)
    async def list_searches(
        most: Annotated[int, Query(ge=1, le=1000, description="Largest number of searches.")] = 100,
    ) -> list[Status]:
        """The latest searches, past ones included."""
        return [search.status() for search in searches.all()[:most]]

    @routes.get(f"{SEARCHES}/{{name}}")
    async def status(
        name: _Name,
        after: Annotated[int, Query(ge=-1, le=2**53, description="Version known already.")] = -1,
        wait_s: Annotated[float, Query(ge=0.0, le=LONGEST_WAIT_S)] = 0.0,
    ) -> Status:
        """The state of a search, as soon as its version is another than that known already."""
        search = searches.find(name)
        await search.bell.until(lambda: search.status().version != after, wait_s)
        return search.status()

    @routes.post(f"{SEARCHES}/{{name}}/observations", openapi_extra=_OBSERVATION_BODY)
    async def observe(name: _Name, request: Request) -> Reply:
        """Take an observation and say what to do."""
        search = searches.find(name)
        turn = search.offer(await request.body())
        await search.bell.until(lambda: turn.is_answered, search.record.request.deadline_s)
        return turn.result()

    @routes.get(f"{SEARCHES}/{{name}}/replies/{{sequence}}")
    async def reply(name: _Name, sequence: _Number) -> Reply:
        """The answer to the last observation, after a ``hold``."""
        search = searches.find(name)
        turn = search.turn(sequence)
        await search.bell.until(lambda: turn.is_answered, search.record.request.deadline_s)
        return turn.result()

    @routes.websocket(f"{SEARCHES}/{{name}}/stream")
    async def stream(name: str, socket: WebSocket) -> None:
        await Stream(searches, name, socket, allowances).run()

    @routes.post(f"{SEARCHES}/{{name}}/stop")
    async def stop(name: _Name, request: StopRequest) -> Status:
        """Stop the robot for good."""
        search = searches.find(name)
        search.stop(request.reason)
        await run_in_threadpool(search.write_end)
        return search.status()

    @routes.post(f"{SEARCHES}/{{name}}/close")
    async def close(name: _Name) -> Status:
        """End a search that nobody needs any more; what is on disk can still be read."""
        search = searches.find(name)
        search.stop("closed", SearchEnding.CLOSED)
        await run_in_threadpool(search.write_end)
        return search.status()

    @routes.get(f"{SEARCHES}/{{name}}/trace", response_class=Response)
    def trace(
        name: _Name,
        since: Annotated[int, Query(ge=0, le=2**53, description="Number of the first step.")] = 0,
    ) -> StreamingResponse:
        """One `StepTrace` as JSON a line, from a step on."""
        search = searches.find(name)

        def lines() -> Iterator[str]:
            with search.reading() as journal:
                yield from journal.trace_lines(since)

        return StreamingResponse(lines(), media_type="application/x-ndjson")

    @routes.get(f"{SEARCHES}/{{name}}/image", response_class=Response)
    def image(
        name: _Name,
        sequence: Annotated[
            int | None, Query(ge=0, le=1_000_000, description="Observation; the last one if none.")
        ] = None,
    ) -> Response:
        """The colour image of an observation, as the robot sent it."""
        search = searches.find(name)
        colour = search.colour if sequence is None else search.colour_of(sequence)
        if colour is None:
            raise _nothing_yet("image")
        return Response(colour[1], media_type=f"image/{colour[0]}", headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.png", response_class=Response)
    def png(name: _Name) -> Response:
        """The map, one pixel a cell, y up; the status says where it lies."""
        return Response(map_png(_grid(searches.find(name))), media_type="image/png", headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.json")
    def occupancy(name: _Name) -> JSONResponse:
        """The map with the fields of nav_msgs/OccupancyGrid."""
        return JSONResponse(occupancy_grid(_grid(searches.find(name))), headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.yaml", response_class=Response)
    def yaml(name: _Name) -> Response:
        """The map for Nav2's map_server: its description."""
        text = map_server_file(_grid(searches.find(name)), "map.yaml")
        return Response(text, media_type="application/yaml", headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.pgm", response_class=Response)
    def pgm(name: _Name) -> Response:
        """The map for Nav2's map_server: its image."""
        content = map_server_file(_grid(searches.find(name)), "map.pgm")
        return Response(content, media_type="image/x-portable-graymap", headers=_LIVE)

    return routes


_LIVE = {"cache-control": "no-store", "x-content-type-options": "nosniff"}


def _grid(search: Search) -> OccupancyGrid:
    if search.grid is None:
        raise _nothing_yet("map")
    return search.grid


def _nothing_yet(what: str) -> RequestRefusedError:
    return RequestRefusedError(
        f"there is no {what} before the first answer", error="unknown", status=404
    )


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
