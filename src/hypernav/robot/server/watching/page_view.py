"""The operator's page for a search of this program, to watch and stop it in a browser."""

import threading
from collections.abc import Callable, Mapping
from typing import Any

import uvicorn

from hypernav.core.errors import ConfigError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace
from hypernav.robot.server.access import Access
from hypernav.robot.server.app import guarded_app
from hypernav.robot.server.limits import Allowances, ServerLimits
from hypernav.robot.server.operator.routes import operator_routes
from hypernav.robot.server.operator.waiting import WaitingRobots
from hypernav.robot.server.serving import listening, server_config
from hypernav.robot.server.watching.live_search import LiveSearch, OnlySearch
from hypernav.robot.server.watching.routes import watching_routes
from hypernav.show.frame_data import colour_jpeg
from hypernav.show.video_frame import EpisodeInfo

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
        """Show a step; see `hypernav.core.view.View`."""
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
