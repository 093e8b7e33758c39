"""The HTTP paths to watch searches and to stop them, and the map as files."""

import io
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Protocol, runtime_checkable

import numpy as np
from fastapi import APIRouter, Query, Request
from fastapi import Path as PathParameter
from fastapi.responses import JSONResponse, Response, StreamingResponse
from PIL import Image
from starlette.concurrency import run_in_threadpool

from hypernav.app.show.climbs import floor_words, stairs_by_step, typical_steps
from hypernav.core.errors import RequestRefusedError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import StepTrace, floor_of
from hypernav.robot.server.guard import API
from hypernav.robot.server.searches.threads import Bell
from hypernav.robot.wire.replies import Health, MapExtent, Status
from hypernav.robot.wire.requests import StopRequest
from hypernav.robot.wire.values import LONGEST_WAIT_S, SEARCHES
from hypernav.search.drawing.map_painter import StairsMark
from hypernav.search.mapping.ros_map import occupancy, save_ros_map

_COLORS = np.array([[128, 128, 128, 0], [255, 255, 255, 255], [30, 30, 30, 255]], dtype=np.uint8)


def map_png(grid: OccupancyGrid) -> bytes:
    """One pixel a cell, y up: free white, occupied black, unknown transparent."""
    encoded = io.BytesIO()
    Image.fromarray(_COLORS[grid.cells[::-1]]).save(encoded, "PNG", compress_level=1)
    return encoded.getvalue()


def map_server_file(grid: OccupancyGrid, name: str) -> bytes:
    """``map.pgm`` or ``map.yaml``, for Nav2's map_server."""
    with tempfile.TemporaryDirectory() as folder:
        save_ros_map(grid, Path(folder))
        return (Path(folder) / name).read_bytes()


def occupancy_grid(grid: OccupancyGrid) -> dict[str, object]:
    """The map with the fields of ``nav_msgs/OccupancyGrid``: -1 unknown, 0 free, 100 occupied."""
    rows, columns = grid.cells.shape
    x, y = (round(value, 6) for value in grid.origin)
    return {
        "header": {"frame_id": "map"},
        "info": {
            "resolution": grid.resolution_m,
            "width": columns,
            "height": rows,
            "origin": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        },
        "data": occupancy(grid).ravel().tolist(),
    }


Name = Annotated[str, PathParameter(pattern=r"^[0-9a-f]{32}$", description="Name of the search.")]
"""The name of a search, in a path."""

STOP_BODY = {
    "requestBody": {
        "required": False,
        "description": "A reason for people; whatever else is sent, even nothing, stops as well.",
        "content": {"application/json": {"schema": StopRequest.model_json_schema()}},
    }
}
"""The body of STOP in the OpenAPI document."""


@runtime_checkable
class Traces(Protocol):
    """What a search has decided, and how high its robot was."""

    def trace_lines(self, since: int) -> Iterator[str]:
        """The traces of the decisions as JSON, from a number on."""
        ...

    def height_of(self, number: int) -> float | None:
        """Height of the robot at an observation, metres above any level; None if unknown."""
        ...


@runtime_checkable
class ShownSearch(Protocol):
    """A search that can be looked at and stopped. Thread-safe."""

    @property
    def bell(self) -> Bell:
        """Bell that rings at every change of the status."""
        ...

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first."""
        ...

    @property
    def maps(self) -> Mapping[int, OccupancyGrid]:
        """Last map of every floor, by its number; empty before the first decision."""
        ...

    @property
    def has_memory_frame(self) -> bool:
        """Whether its map and that of the server's memory lie in one frame."""
        ...

    def map_of(self, floor: int) -> OccupancyGrid | None:
        """Last map of a floor; None if there is none."""
        ...

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first."""
        ...

    def colour_of(self, sequence: int) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image; None if it has not come."""
        ...

    def status(self) -> Status:
        """The present state."""
        ...

    def reading(self) -> AbstractContextManager[Traces]:
        """The decisions, to read them while the search goes on."""
        ...

    def stop(self, reason: str) -> None:
        """End the search from outside, at once; `write_end` writes that to disk."""
        ...

    def write_end(self) -> None:
        """Write the end of the search to disk, if it is over."""
        ...


@runtime_checkable
class ShownSearches(Protocol):
    """All searches that can be looked at."""

    def find(self, name: str) -> ShownSearch:
        """A search by its name.

        Raises:
            RequestRefusedError: There is none of this name.
        """
        ...

    def all(self) -> Sequence[ShownSearch]:
        """All searches, the latest first."""
        ...

    def stop_all(self, reason: str) -> Sequence[ShownSearch]:
        """Stop every robot at once.

        Returns:
            The searches that were under way.
        """
        ...


def watching_routes(searches: ShownSearches) -> APIRouter:
    """The HTTP paths to watch searches and to stop them.

    Args:
        searches: The searches.
    """
    routes = APIRouter()

    @routes.get(f"{API}/health")
    async def health() -> Health:
        """Whether the server is running, and its version."""
        return Health(version=version("hypernav"))

    @routes.get(SEARCHES)
    async def list_searches(
        most: Annotated[int, Query(ge=1, le=1000, description="Largest number of searches.")] = 100,
    ) -> list[Status]:
        """The latest searches, past ones included."""
        return [search.status() for search in searches.all()[:most]]

    @routes.get(f"{SEARCHES}/{{name}}")
    async def status(
        name: Name,
        after: Annotated[int, Query(ge=-1, le=2**53, description="Version known already.")] = -1,
        wait_s: Annotated[float, Query(ge=0.0, le=LONGEST_WAIT_S)] = 0.0,
    ) -> Status:
        """The state of a search, as soon as its version differs from the known one."""
        search = searches.find(name)
        await search.bell.until(lambda: search.status().version != after, wait_s)
        return search.status()

    @routes.post(f"{SEARCHES}/{{name}}/stop", openapi_extra=STOP_BODY)
    async def stop(name: Name, request: Request) -> Status:
        """Stop the robot permanently, whatever the body is."""
        search = searches.find(name)
        search.stop(StopRequest.of(await request.body()).reason)
        await run_in_threadpool(search.write_end)
        return search.status()

    @routes.get(f"{SEARCHES}/{{name}}/trace", response_class=Response)
    def trace(
        name: Name,
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
        name: Name,
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

    @routes.get(f"{SEARCHES}/{{name}}/floors")
    def floors(name: Name) -> dict[int, MapExtent]:
        """Where the map of every floor lies, by the number that a step's ``floor`` has."""
        maps = searches.find(name).maps
        return {floor: MapExtent.of(maps[floor]) for floor in sorted(maps)}

    @routes.get(f"{SEARCHES}/{{name}}/stairs")
    def stairs(name: Name) -> dict[int, dict[int, list[StairsMark]]]:
        """Ends of stairs that were taken or tried, by floor, from each step that changed them."""
        with searches.find(name).reading() as journal:
            lines = journal.trace_lines(0)
            return stairs_by_step(StepTrace.model_validate_json(line) for line in lines)

    @routes.get(f"{SEARCHES}/{{name}}/floors/words")
    def words_of_floors(name: Name) -> dict[int, str]:
        """The floors on which the robot was, for people, with their heights beside the start's."""
        with searches.find(name).reading() as journal:
            steps = [StepTrace.model_validate_json(line) for line in journal.trace_lines(0)]
            known = {
                floor: journal.height_of(number) for floor, number in typical_steps(steps).items()
            }
        heights_m = {floor: height for floor, height in known.items() if height is not None}
        floors = sorted(set(map(floor_of, steps)))
        return {floor: floor_words(floor, floor_of(steps[0]), heights_m) for floor in floors}

    @routes.get(f"{SEARCHES}/{{name}}/map.png", response_class=Response)
    def png(
        name: Name,
        floor: Annotated[
            int | None, Query(ge=1, le=1000, description="Floor; that of the robot if none.")
        ] = None,
    ) -> Response:
        """The map, one pixel a cell, y up; the status, or ``floors``, says where it lies."""
        search = searches.find(name)
        grid = search.grid if floor is None else search.map_of(floor)
        if grid is None:
            raise _nothing_yet("map" if floor is None else f"map of floor {floor}")
        return Response(map_png(grid), media_type="image/png", headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.json")
    def occupancy(name: Name) -> JSONResponse:
        """The map with the fields of nav_msgs/OccupancyGrid."""
        return JSONResponse(occupancy_grid(_grid(searches.find(name))), headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.yaml", response_class=Response)
    def yaml(name: Name) -> Response:
        """The map for Nav2's map_server: its description."""
        text = map_server_file(_grid(searches.find(name)), "map.yaml")
        return Response(text, media_type="application/yaml", headers=_LIVE)

    @routes.get(f"{SEARCHES}/{{name}}/map.pgm", response_class=Response)
    def pgm(name: Name) -> Response:
        """The map for Nav2's map_server: its image."""
        content = map_server_file(_grid(searches.find(name)), "map.pgm")
        return Response(content, media_type="image/x-portable-graymap", headers=_LIVE)

    return routes


_LIVE = {"cache-control": "no-store", "x-content-type-options": "nosniff"}


def _grid(search: ShownSearch) -> OccupancyGrid:
    grid = search.grid
    if grid is None:
        raise _nothing_yet("map")
    return grid


def _nothing_yet(what: str) -> RequestRefusedError:
    return RequestRefusedError(
        f"there is no {what} before the first answer", error="unknown", status=404
    )
