"""The paths of the operator: the page, goals for robots that wait, and STOP for all."""

from contextlib import ExitStack
from pathlib import Path as FilePath
from typing import Annotated

from fastapi import APIRouter, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.responses import Response

from hypernav.core.goal import Goal
from hypernav.robot.server.operator.files import page_files
from hypernav.robot.server.operator.known_things import KnownThings
from hypernav.robot.server.operator.waiting import WaitingRobots
from hypernav.robot.server.watching.routes import STOP_BODY, ShownSearches
from hypernav.robot.wire.replies import Status
from hypernav.robot.wire.requests import StopRequest
from hypernav.robot.wire.waiting import (
    LONGEST_WAIT_FOR_GOAL_S,
    ROBOT_NAME,
    ROBOTS,
    STOP_ALL,
    THINGS,
    GivenGoal,
    GoalRequest,
    RememberedThing,
    WaitingRobot,
)

_Name = Annotated[str, Path(pattern=ROBOT_NAME, description="Name of the robot.")]


def operator_routes(
    searches: ShownSearches, waiting: WaitingRobots, memory: FilePath | None = None
) -> APIRouter:
    """The operator's paths.

    Args:
        searches: All searches.
        waiting: Robots that wait for a goal.
        memory: Folder of the memory; None if there is none.
    """
    routes = APIRouter()
    files, known = page_files(), KnownThings(memory)

    @routes.api_route("/", methods=["GET", "HEAD"], include_in_schema=False)
    async def page() -> Response:
        return files["index.html"]

    @routes.api_route("/page/{name}", methods=["GET", "HEAD"], include_in_schema=False)
    async def file(name: str) -> Response:
        if name not in files:
            raise HTTPException(404, "the page has no such file")
        return files[name]

    @routes.get(ROBOTS)
    async def robots() -> list[WaitingRobot]:
        """The robots that wait for a goal."""
        return waiting.all()

    @routes.post(f"{ROBOTS}/{{name}}/wait")
    async def wait(
        name: _Name,
        wait_s: Annotated[float, Query(ge=0.0, le=LONGEST_WAIT_FOR_GOAL_S)] = 0.0,
    ) -> GivenGoal:
        """For robots: wait for a goal; ask again if there is none."""
        return await waiting.wait(name, wait_s)

    @routes.post(f"{ROBOTS}/{{name}}/goal")
    async def give(name: _Name, request: GoalRequest) -> GivenGoal:
        """Give a goal to a robot that waits."""
        if request.thing is not None:
            await run_in_threadpool(known.check, request.thing)
        return waiting.give(name, Goal(request.goal), request.thing)

    @routes.get(THINGS)
    def things() -> list[RememberedThing]:
        """What the memory knew after the last search, without what is gone; none without one."""
        return known.all()

    @routes.post(STOP_ALL, openapi_extra=STOP_BODY)
    async def stop_all(request: Request) -> list[Status]:
        """Stop every robot permanently, and withdraw goals that no robot has taken up yet."""
        waiting.withdraw_all()
        stopped = searches.stop_all(StopRequest.of(await request.body()).reason)
        with ExitStack() as ends:  # if one fails, the others are still written
            for search in stopped:
                ends.callback(search.write_end)
            await run_in_threadpool(ends.close)
        return [search.status() for search in stopped]

    return routes
