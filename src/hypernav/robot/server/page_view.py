"""The operator's page for a search of this program, to watch and stop it in a browser."""

import secrets
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import uvicorn

from hypernav.app.show import captions
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers.frame_data import colour_jpeg
from hypernav.core.episode import Outcome
from hypernav.core.errors import ConfigError, RequestRefusedError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace, floor_of
from hypernav.robot.server.app import guarded_app
from hypernav.robot.server.guard import Access
from hypernav.robot.server.limits import Allowances, ServerLimits
from hypernav.robot.server.operator_page import operator_routes
from hypernav.robot.server.searches.threads import Bell
from hypernav.robot.server.serving import listening, server_config
from hypernav.robot.server.waiting_robots import WaitingRobots
from hypernav.robot.server.watching import watching_routes
from hypernav.robot.wire.replies import MapExtent, SearchEnding, SearchState, Status

_ENDINGS = {
    Outcome.FOUND: SearchEnding.FOUND,
    Outcome.WRONG_PLACE: SearchEnding.FOUND,  # by the agent's own claim
    Outcome.NOT_FOUND: SearchEnding.GAVE_UP,
    Outcome.UNREACHABLE: SearchEnding.GAVE_UP,
    Outcome.MODEL_UNAVAILABLE: SearchEnding.MODEL_UNAVAILABLE,
    Outcome.INTERRUPTED: SearchEnding.STOPPED,
}


class LiveSearch:
    """A search in memory that is given its steps one by one. Thread-safe.

    Attributes:
        bell: Bell that rings at every change of the status.
        grid: Map after the last step; None before the first.
        maps: Last map of every floor, by its number.
        colour: Format and bytes of the last colour image; None before the first.
    """

    def __init__(self, info: EpisodeInfo, on_stop: Callable[[], object]) -> None:
        """Create it before the first step.

        Args:
            info: Goal and components of the search.
            on_stop: Function that ends the search, called from another thread.
        """
        self.bell = Bell()
        self.grid: OccupancyGrid | None = None
        self.maps: dict[int, OccupancyGrid] = {}
        self.colour: tuple[str, bytes] | None = None
        self._name, self._opened_s = secrets.token_hex(16), time.time()
        self._info = info
        self._on_stop = on_stop
        self._lock = threading.RLock()
        self._version = 0
        self._traces: list[StepTrace] = []
        self._images: dict[int, bytes] = {}
        self._heights_m: dict[int, float] = {}
        self._ending: SearchEnding | None = None
        self._detail = ""

    def add(
        self,
        step: StepTrace,
        grid: OccupancyGrid | None,
        image: bytes | None,
        height_m: float | None = None,
    ) -> None:
        """Add a step.

        Args:
            step: Trace of the step.
            grid: The agent's map, which may change afterwards; None if it has none.
            image: The colour image, JPEG; None if nobody kept it.
            height_m: Height of the camera, metres; None if it is unknown.
        """
        with self._lock:
            self._traces.append(step)
            if height_m is not None:
                self._heights_m[step.step] = height_m
            if image is not None:
                self.colour = ("jpeg", image)
                self._images[step.step] = image
            if grid is not None:
                self.grid = grid.cropped().copy()
                self.maps = {**self.maps, floor_of(step): self.grid}
        self._note_change()

    @property
    def has_memory_frame(self) -> bool:
        """Whether its map and that of a server's memory lie in one frame; there is no server."""
        return False

    def map_of(self, floor: int) -> OccupancyGrid | None:
        """Last map of a floor; None if there is none."""
        return self.maps.get(floor)

    def finish(self, result: Mapping[str, Any]) -> None:
        """Note how the search ended, unless somebody stopped it.

        Args:
            result: Content of ``result.json``.
        """
        with self._lock:
            if self._ending is None:
                outcome = Outcome(result["outcome"])
                self._ending = _ENDINGS[outcome]
                claims_more = outcome is not Outcome.FOUND
                self._detail = captions.headline(result).text if claims_more else ""
        self._note_change()

    def stop(self, reason: str) -> None:
        """End the search because someone pressed STOP."""
        with self._lock:
            if self._ending is not None:
                return
            self._ending, self._detail = SearchEnding.STOPPED, reason
        self._note_change()
        self._on_stop()

    def write_end(self) -> None:
        """Do nothing: the result is written elsewhere."""

    def status(self) -> Status:
        """The present state."""
        with self._lock:
            count = len(self._traces)
            return Status(
                id=self._name,
                version=self._version,
                goal=self._info.goal,
                words=f"detector {self._info.detector}, reasoner {self._info.reasoner}",
                opened_s=self._opened_s,
                state=SearchState.WAITING if self._ending is None else SearchState.ENDED,
                next_sequence=count,
                pose=self._traces[-1].pose if count else None,
                map=None if self.grid is None else MapExtent.of(self.grid),
                ending=self._ending,
                detail=self._detail,
            )

    def colour_of(self, sequence: int) -> tuple[str, bytes] | None:
        """Format and bytes of a step's colour image; None if there is none."""
        image = self._images.get(sequence)
        return None if image is None else ("jpeg", image)

    def height_of(self, number: int) -> float | None:
        """Height of the camera at a step, metres; None if it is unknown."""
        return self._heights_m.get(number)

    @contextmanager
    def reading(self) -> Iterator["LiveSearch"]:
        """The search itself, which can be read at any time."""
        yield self

    def trace_lines(self, since: int) -> Iterator[str]:
        """The steps as JSON, from a number on."""
        for trace in list(self._traces):
            if trace.step >= since:  # the first one has a later number where a robot turned before
                yield trace.model_dump_json() + "\n"

    def _note_change(self) -> None:
        with self._lock:
            self._version += 1
        self.bell.ring()


class OnlySearch:
    """The one search of a program, with the interface of a server's searches.

    Attributes:
        was_asked: Whether a page has asked for it.
    """

    def __init__(self, search: LiveSearch) -> None:
        """Create it around the search."""
        self._search = search
        self.was_asked = False

    def find(self, name: str) -> LiveSearch:
        """The search, if that is its name.

        Raises:
            RequestRefusedError: Its name is another.
        """
        if name != self._search.status().id:
            raise RequestRefusedError(f"there is no search {name}", error="unknown", status=404)
        return self._search

    def all(self) -> list[LiveSearch]:
        """The search."""
        self.was_asked = True
        return [self._search]

    def stop_all(self, reason: str) -> list[LiveSearch]:
        """Stop the search."""
        self._search.stop(reason)
        return [self._search]


_HOST, _PORT = "127.0.0.1", 8765
_PATIENCE_S = 5.0


class PageView:
    """A search in the browser, on an address of this machine: a `WatchedView`."""

    def __init__(self, info: EpisodeInfo, on_stop: Callable[[], object]) -> None:
        """Begin to serve, on the usual port or, if that is taken, on another.

        Args:
            info: Goal and components of the search.
            on_stop: Function that ends the search when someone presses STOP; it is called from
                another thread.

        Raises:
            ConfigError: No port is free.
        """
        self._search = LiveSearch(info, on_stop)
        self._shown = OnlySearch(self._search)
        limits = ServerLimits()
        routers = (watching_routes(self._shown), operator_routes(self._shown, WaitingRobots()))
        app = guarded_app(routers, Access(_HOST), limits, Allowances(limits))
        try:
            self._listener = listening(_HOST, _PORT)
        except ConfigError:
            self._listener = listening(_HOST, 0)
        self._server = uvicorn.Server(server_config(app))
        self._thread = threading.Thread(
            target=self._server.run, args=([self._listener],), name="operator's page", daemon=True
        )
        self._thread.start()

    @property
    def address(self) -> str:
        """The page's address."""
        return f"http://{_HOST}:{self._listener.getsockname()[1]}/ in a browser"

    def has_watcher(self) -> bool:
        """Whether a page has asked for the search."""
        return self._shown.was_asked

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Show a step; see `hypernav.core.trace.View`."""
        if observation is None:
            self._search.add(step, grid, None)
            return
        camera_z = float(observation.camera_to_map.translation[2])
        self._search.add(step, grid, colour_jpeg(observation), camera_z)

    def finish(self, result: Mapping[str, Any]) -> None:
        """Show how the search ended."""
        self._search.finish(result)

    def close(self) -> None:
        """Stop serving; pages that wait for an event are answered at once."""
        self._search.bell.close()
        self._server.should_exit = True
        self._thread.join(_PATIENCE_S)
        self._listener.close()
