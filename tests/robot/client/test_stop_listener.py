"""A robot on HTTP hears of a stop while it drives."""

import socket
import threading
from typing import Any

import pytest

from hypernav.robot.client import links
from hypernav.robot.client.links import ServerAddress
from hypernav.robot.client.robot_client import StopListener
from servers.robots import Script, body_of, robot_server


def test_it_hears_of_a_stop_and_only_once(tmp_path, monkeypatch):
    heard = threading.Semaphore(0)
    with robot_server(tmp_path) as link:
        search = link.open()
        address = ServerAddress("127.0.0.1", link.port)
        with StopListener(address, search.rpartition("/")[2], heard.release):
            assert not heard.acquire(timeout=0.1)
            link.call("POST", f"{search}/stop", {})
            assert heard.acquire(timeout=20.0)
        assert not heard.acquire(timeout=0.1)


def test_an_end_by_the_agent_is_no_stop(tmp_path, monkeypatch):
    script = Script(length=0)
    script.gate.set()
    monkeypatch.setattr("servers.robots.SCRIPT", script)
    heard = threading.Event()
    with robot_server(tmp_path) as link:
        search = link.open()
        address = ServerAddress("127.0.0.1", link.port)
        with StopListener(address, search.rpartition("/")[2], heard.set):
            assert link.observe(search, body_of(0)).json["ending"] == "found"
    assert not heard.is_set()


def test_it_listens_through_an_outage_of_the_server(tmp_path):
    heard = threading.Event()
    with robot_server(tmp_path) as link:
        search, port = link.open(), link.port
    address = ServerAddress("127.0.0.1", port)
    with StopListener(address, search.rpartition("/")[2], heard.set):
        assert not heard.wait(0.1)
        with robot_server(tmp_path, port=port) as link:
            link.call("POST", f"{search}/stop", {})
            assert heard.wait(20.0)


def test_it_is_not_deaf_for_long_on_a_connection_of_which_nothing_comes(tmp_path, monkeypatch):
    monkeypatch.setattr(links, "_CONNECT_S", 0.2)
    heard = threading.Event()
    with robot_server(tmp_path) as link, socket.create_server(("127.0.0.1", 0)) as mute:
        search = link.open()
        link.call("POST", f"{search}/stop", {})
        # The first connection leads to somebody who takes it and never says a word.
        ports = iter([mute.getsockname()[1]])
        connect = socket.create_connection

        def to_mute_first(address: tuple[str, int], *rest: Any, **options: Any) -> socket.socket:
            return connect((address[0], next(ports, address[1])), *rest, **options)

        address = ServerAddress("127.0.0.1", link.port)
        monkeypatch.setattr(socket, "create_connection", to_mute_first)
        with StopListener(address, search.rpartition("/")[2], heard.set):
            assert heard.wait(10.0)


def test_the_server_is_told_of_an_error_of_the_block(tmp_path):
    with robot_server(tmp_path) as link:
        search = link.open()
        address = ServerAddress("127.0.0.1", link.port)
        with (
            pytest.raises(ZeroDivisionError),
            StopListener(address, search.rpartition("/")[2], lambda: None),
        ):
            raise ZeroDivisionError("no wheels")
        status = link.call("GET", search).json
    assert status["ending"] == "robot failed"
    assert status["detail"] == "the robot's program ended by ZeroDivisionError: no wheels"
