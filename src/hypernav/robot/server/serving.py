"""Running the server: its socket, its token, its limited connections, its end.

Uvicorn limits neither the number of connections nor the time for a request's head, so idle
connections could block STOP. It accepts a custom protocol class as its ``http`` setting, but has no
public one to derive from, and an application learns of a connection only when a whole head has
come. So `TimedHeads` uses undocumented attributes of `H11Protocol`: pyproject.toml bounds the
version, and ``tests/robot/server/test_request_heads.py`` names what a release has changed.
"""

import asyncio
import resource
import socket
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h11
import uvicorn
from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool
from uvicorn.protocols.http.h11_impl import H11Protocol

from hypernav.core.errors import ConfigError
from hypernav.io.reading import read_file
from hypernav.robot.server.app import make_app
from hypernav.robot.server.guard import MOST_HEAD_BYTES, Access
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.server.searches.agents import PlanAgent
from hypernav.robot.server.searches.searches import Searches
from hypernav.robot.server.waiting_robots import WaitingRobots
from hypernav.robot.wire.frames import MOST_BODY_BYTES

_HEAD_S = 10.0
_MOST_CONNECTIONS = 256


class TimedHeads(H11Protocol):
    """Closes connections whose request head does not arrive in time, and one if there are too many.

    A new connection is always accepted: it may carry STOP. If there are too many, one with an
    incomplete request, head or body, is closed: the oldest of the address that has most of them.
    Connections that wait for a response are limited by the guard (`ServerLimits.requests_at_once`).
    """

    _deadline: asyncio.TimerHandle | None = None
    _since_s = 0.0

    def connection_made(self, transport: Any) -> None:
        """Begin to wait for the first head."""
        super().connection_made(transport)
        self._wait_for_head()
        if len(self.connections) > _MOST_CONNECTIONS:
            self._give_way()

    def data_received(self, data: bytes) -> None:
        """Receive data; the rest of an incomplete head must come in time."""
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        """Wait for the next head."""
        super().on_response_complete()
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the timer."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _give_way(self) -> None:
        others = [one for one in self.connections if isinstance(one, TimedHeads)]
        asking = [one for one in others if one is not self and one._is_asking]
        of_address = Counter(one._address for one in asking)
        most = max(of_address.values(), default=0)
        if most == 0:
            return
        crowd = [one for one in asking if of_address[one._address] == most]
        oldest = min(crowd, key=lambda one: one._since_s)
        oldest._stop_waiting()
        oldest.transport.abort()

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    @property
    def _is_asking(self) -> bool:
        """Whether a request is still to come or incomplete."""
        is_open = not self.transport.is_closing()
        return is_open and self.conn.their_state in (h11.IDLE, h11.SEND_BODY)

    def _watch(self) -> None:
        if self.conn.their_state is h11.IDLE:
            self._wait_for_head()
        elif self._deadline is not None:
            self._stop_waiting()
            self._since_s = self.loop.time()

    def _wait_for_head(self) -> None:
        if self._deadline is None:
            self._since_s = self.loop.time()
            self._deadline = self.loop.call_later(_HEAD_S, self.transport.close)

    def _stop_waiting(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


_LEAST_TOKEN = 16
_MOST_TOKEN_BYTES = 1000
_PATIENCE_S = 2
_ACCEPTED_AT_ONCE = 64
"""Connections accepted in one go, before the earlier ones are served."""
_MOST_QUEUED = 1024
"""Connections that the system queues until they are accepted."""
_OPEN_FILES = 4096
_LOOK_S = 1.0
"""Time between two looks for robots that fell silent, seconds."""


def read_token(path: Path) -> str:
    """The token in a file.

    Raises:
        ConfigError: The file cannot be read, others can read it, or it holds no good token.
    """
    try:
        text = read_file(path, most=_MOST_TOKEN_BYTES).decode("ascii").strip()
        mode = path.stat().st_mode
    except OSError as error:
        raise ConfigError(f"--token-file {path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"--token-file {path}: a token is plain ASCII text") from error
    if mode & 0o077:
        raise ConfigError(f"--token-file {path}: others can read it; chmod 600 {path}")
    if len(text) < _LEAST_TOKEN or not text.isprintable() or " " in text:
        raise ConfigError(
            f"--token-file {path}: expected one word of at least {_LEAST_TOKEN} characters; make "
            f"one with: openssl rand -hex 32 > {path}"
        )
    return text


def check_access(access: Access) -> None:
    """Refuse to serve a network without a token.

    Raises:
        ConfigError: The address is not local, and there is no token.
    """
    if not access.is_local and access.token is None:
        raise ConfigError(
            f"--host {access.host} lets the network in; give --token-file FILE with a secret that "
            "robots must know, or use --host 127.0.0.1"
        )


def serve(
    access: Access,
    port: int,
    state: Path,
    plan: PlanAgent,
    limits: ServerLimits,
    *,
    memory: Path | None = None,
    on_start: Callable[[str], object],
) -> None:
    """Serve until SIGINT or SIGTERM; the signal is raised again at the end.

    Args:
        access: Who may use the server.
        port: Port; 0 takes a free one.
        state: Folder of all searches.
        plan: Chooses the agent for a request.
        limits: Limits of the server.
        memory: Folder of the memory of the plan's agents, to show it; None if there is none.
        on_start: Function that is called with the server's URL once it answers.

    Raises:
        ConfigError: The address cannot be used.
        RunFolderError: Another server uses the folder, or it cannot be written.
    """
    check_access(access)
    _raise_open_files()
    with listening(access.host, port) as listener, Searches(state, plan, limits) as searches:
        host = f"[{access.host}]" if ":" in access.host else access.host
        on_start(f"http://{host}:{listener.getsockname()[1]}")
        RobotServer(searches, access, limits, memory).run(sockets=[listener])


class RobotServer(uvicorn.Server):
    """Uvicorn running the application."""

    def __init__(
        self,
        searches: Searches,
        access: Access,
        limits: ServerLimits,
        memory: Path | None = None,
    ) -> None:
        """Create it; `run` serves.

        Args:
            searches: Opened searches.
            access: Who may use the server.
            limits: Limits of the server.
            memory: Folder of the memory; None if there is none.
        """
        self._searches, self._waiting = searches, WaitingRobots()
        app = make_app(searches, self._waiting, access, limits, memory)
        super().__init__(server_config(app))

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen, and to look for robots that fell silent."""
        await super().startup(sockets)
        self._looking = asyncio.create_task(self._end_silent())
        for listener in sockets or ():
            listener.listen(_MOST_QUEUED)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End; requests that wait for an event are answered at once."""
        self._looking.cancel()
        for bell in (self._waiting.bell, *(search.bell for search in self._searches.all())):
            bell.close()
        await super().shutdown(sockets)

    async def _end_silent(self) -> None:
        while True:
            await asyncio.sleep(_LOOK_S)
            await run_in_threadpool(self._searches.end_silent)


def _raise_open_files() -> None:
    """Let this process open enough files for many searches and connections."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = _OPEN_FILES if hard == resource.RLIM_INFINITY else min(_OPEN_FILES, hard)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))


def server_config(app: FastAPI) -> uvicorn.Config:
    """How uvicorn runs an application."""
    return uvicorn.Config(
        app,
        http=TimedHeads,
        h11_max_incomplete_event_size=MOST_HEAD_BYTES,
        backlog=_ACCEPTED_AT_ONCE,
        ws="websockets-sansio",
        ws_max_size=MOST_BODY_BYTES,
        ws_per_message_deflate=False,  # images are compressed already
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,  # clients must not be able to set their own address
        lifespan="off",
        timeout_graceful_shutdown=_PATIENCE_S,
    )


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Args:
        host: Address.
        port: Port; 0 takes a free one.

    Raises:
        ConfigError: The address cannot be used.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # Named as TCP, so that asyncio switches off Nagle's algorithm, which delays answers by 40 ms.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen(_MOST_QUEUED)
    except OSError as error:
        listener.close()
        raise ConfigError(
            f"cannot listen on {host}, port {port}: {error.strerror or error}; choose another "
            "--port or --host"
        ) from error
    return listener
