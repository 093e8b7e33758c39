"""Listens for the server's stop button, so that it takes effect in the middle of a motion."""

import threading
from collections.abc import Callable

from hypernav.core.errors import RequestRefusedError, RobotLinkError
from hypernav.robot.client.links import HttpServer, failure_words, give_up
from hypernav.robot.client.server_address import ServerAddress
from hypernav.robot.client.side_thread import SideThread
from hypernav.robot.wire.replies import SearchEnding

_WAIT_S = 1.0
_PAUSE_S = 0.2
_OUTSIDE = frozenset({SearchEnding.STOPPED, SearchEnding.CLOSED, SearchEnding.ROBOT_FAILED})
"""Endings that come while the robot may be in the middle of a motion."""


class StopListener(SideThread):
    """Waits beside a search until someone presses stop, over a connection of its own.

    It ends at most a second after the ``with`` block. If the block ends by an error, the server is
    told, so that its operator reads why.

    Examples:
        >>> with StopListener(address, opened.id, client.stop):  # doctest: +SKIP
        ...     for step in client:
        ...         print(step.reply.reason)
    """

    def __init__(self, address: ServerAddress, search_id: str, on_stop: Callable[[], None]) -> None:
        """Create it; it listens within a ``with`` block.

        Args:
            address: The server.
            search_id: The search.
            on_stop: Function to call, once, for example `RobotClient.stop`.
        """
        self._address = address
        self._server = HttpServer(address)
        self._search_id = search_id
        self._on_stop = on_stop

    def __exit__(self, *raised: object) -> None:
        """Wait until the work has ended, and tell the server of an error."""
        super().__exit__(*raised)
        error = next((one for one in raised if isinstance(one, BaseException)), None)
        if error is not None and not isinstance(error, RobotLinkError):
            give_up(self._address, self._search_id, failure_words(error))

    def _work_until(self, block_ended: threading.Event) -> None:
        version = -1
        while not block_ended.is_set():
            try:
                status = self._server.status(self._search_id, after=version, wait_s=_WAIT_S)
            except (RobotLinkError, RequestRefusedError):
                block_ended.wait(_PAUSE_S)  # the search itself notices what is wrong
                version = -1  # a restarted server counts its versions from the beginning
                continue
            version = status.version
            if status.ending in _OUTSIDE:
                self._on_stop()
            if status.ending is not None:
                break
        self._server.close()
