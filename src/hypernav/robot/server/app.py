"""The HTTP application: every path, its request and its response."""

import logging
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path as FilePath
from typing import Annotated, Any

from fastapi import APIRouter, FastAPI, Path, Request, WebSocket
from starlette.concurrency import run_in_threadpool

from hypernav.core.errors import HyPerNavError
from hypernav.robot.server.access import API, Access
from hypernav.robot.server.guard import Guard
from hypernav.robot.server.limits import Allowances, ServerLimits
from hypernav.robot.server.operator.routes import operator_routes
from hypernav.robot.server.operator.waiting import WaitingRobots
from hypernav.robot.server.searches import Searches
from hypernav.robot.server.stream import Stream
from hypernav.robot.server.watching.refusals import REFUSALS, add_refusals
from hypernav.robot.server.watching.routes import Name, watching_routes
from hypernav.robot.wire.replies import Reply, SearchEnding, SearchOpened, Status
from hypernav.robot.wire.requests import CloseRequest, ObservationHeader, OpenSearch
from hypernav.robot.wire.values import SEARCHES

_LOG = logging.getLogger(__name__)
_Number = Annotated[int, Path(ge=0, le=1_000_000, description="Number of the observation.")]
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

    @routes.post(f"{SEARCHES}/{{name}}/close")
    async def close(name: Name, request: CloseRequest | None = None) -> Status:
        """End a search that is no longer needed; its files can still be read."""
        search, why = searches.find(name), request or CloseRequest()
        ending = SearchEnding.ROBOT_FAILED if why.failed else SearchEnding.CLOSED
        search.stop(why.reason or "closed", ending)
        await run_in_threadpool(search.write_end)
        return search.status()

    return routes
