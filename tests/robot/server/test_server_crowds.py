"""Crowds of connections, which do not keep STOP out."""

import socket
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing

import pytest

from hypernav.robot.server import serving
from servers.robots import RobotLink

_STOP = (
    b"POST /v1/stop HTTP/1.1\r\nhost: localhost\r\n"
    b"content-type: application/json\r\ncontent-length: 2\r\n\r\n{}"
)


@pytest.fixture(autouse=True)
def patience(monkeypatch) -> None:
    """No connection of a test is closed for want of a request."""
    monkeypatch.setattr(serving, "_HEAD_S", 60.0)


def connected(link: RobotLink, opened: ExitStack, source: str = "127.0.0.1") -> socket.socket:
    """A connection that says nothing yet."""
    address = ("127.0.0.1", link.port)
    connection = socket.create_connection(address, timeout=20.0, source_address=(source, 0))
    return opened.enter_context(closing(connection))


@pytest.mark.slow
def test_stop_is_heard_among_hundreds_that_come_at_once(link, monkeypatch):
    is_held, may_go_on = threading.Event(), threading.Event()

    def slow(_: str) -> str:
        is_held.set()
        may_go_on.wait(20.0)
        return ""

    monkeypatch.setattr("hypernav.robot.server.app.version", slow)
    with ExitStack() as opened, ThreadPoolExecutor() as pool:
        pool.submit(link.call, "GET", "/v1/health")
        is_held.wait(20.0)
        stopping = connected(link, opened)
        stopping.sendall(_STOP)
        crowd = [connected(link, opened) for _ in range(300)]
        may_go_on.set()
        assert stopping.recv(100).startswith(b"HTTP/1.1 200")
        assert crowd[30].recv(1) == b""


def test_the_address_with_most_connections_gives_way(link, monkeypatch):
    monkeypatch.setattr(serving, "_MOST_CONNECTIONS", 4)
    with ExitStack() as opened:
        first = connected(link, opened)
        crowd = [connected(link, opened, source="127.0.0.2") for _ in range(10)]
        assert crowd[0].recv(1) == b""
        first.sendall(_STOP)
        assert first.recv(100).startswith(b"HTTP/1.1 200")


def test_requests_whose_bodies_never_come_give_way(link, monkeypatch):
    monkeypatch.setattr(serving, "_MOST_CONNECTIONS", 4)
    with ExitStack() as opened:
        crowd = [connected(link, opened) for _ in range(4)]
        for connection in crowd:
            connection.sendall(_STOP.removesuffix(b"{}").replace(b"/v1/stop", b"/v1/searches"))
        time.sleep(0.5)  # their heads are read
        stopping = connected(link, opened)
        stopping.sendall(_STOP)
        assert stopping.recv(100).startswith(b"HTTP/1.1 200")
        assert crowd[0].recv(1) == b""
