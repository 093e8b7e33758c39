"""The same conversation over one WebSocket."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from hypernav.core.embodiment import Action
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.wire.frames import MOST_BODY_BYTES
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import TOKEN, RobotLink, body_of, drive, real_plan, robot_server


@contextmanager
def stream(link: RobotLink, search: str, **more: Any) -> Iterator[ClientConnection]:
    with connect(f"ws://127.0.0.1:{link.port}{search}/stream", proxy=None, **more) as socket:
        yield socket


def said(socket: ClientConnection) -> dict[str, Any]:
    return json.loads(socket.recv(timeout=30.0))


def test_a_search_over_a_websocket_is_that_over_http(tmp_path):
    room, replies = BoxRoom(), []
    with robot_server(tmp_path, real_plan) as link:
        expected = drive(link, link.open(), BoxRoom())
        search = link.open()
        with stream(link, search) as socket:
            while not replies or not replies[-1]["done"]:
                socket.send(body_of(len(replies), room))
                reply = said(socket)["reply"]
                while reply["hold"]:
                    reply = said(socket)["reply"]
                replies.append(reply)
                room.step(Action(reply["action"]))
    assert replies == expected


def test_hold_comes_first_and_the_answer_on_its_own(link, script):
    script.gate.clear()
    search = link.open(deadline_s=0.05)
    with stream(link, search) as socket:
        socket.send(body_of(0))
        assert said(socket)["reply"]["hold"]
        socket.send(body_of(0))
        assert said(socket)["reply"]["hold"]
        script.gate.set()
        assert said(socket)["reply"]["action"] == Action.MOVE_FORWARD
        socket.send(body_of(1))
        assert said(socket)["reply"]["sequence"] == 1


def test_stop_is_pushed_at_once(link):
    search = link.open()
    with stream(link, search) as socket:
        socket.send(body_of(0))
        said(socket)
        stopping = threading.Thread(target=link.call, args=("POST", f"{search}/stop", {}))
        stopping.start()
        reply = said(socket)["reply"]
        stopping.join()
        assert (reply["action"], reply["ending"]) == (Action.STOP, "stopped")
        socket.send(body_of(1))
        assert said(socket)["reply"]["ending"] == "stopped"


def test_a_mistake_is_said_and_the_conversation_goes_on(link):
    search = link.open()
    with stream(link, search) as socket:
        socket.send("text")
        assert said(socket)["status"] == 422
        socket.send(b"\x00" * 100)
        assert said(socket)["error"]["error"] == "invalid"
        socket.send(body_of(5))
        refused = said(socket)
        assert (refused["status"], refused["error"]["expected"]) == (409, 0)
        socket.send(body_of(0))
        assert said(socket)["reply"]["sequence"] == 0


def test_a_message_too_long_ends_the_connection_and_nothing_else(link):
    search = link.open()
    with stream(link, search) as socket:
        with suppress(ConnectionClosed):  # it may hang up before it has heard all
            socket.send(bytes(MOST_BODY_BYTES + 1))
        with pytest.raises(ConnectionClosed):
            socket.recv(timeout=10.0)
    assert link.observe(search, body_of(0)).status == 200


def test_a_robot_reconnects(link):
    search = link.open()
    for number in range(3):
        with stream(link, search) as socket:
            socket.send(body_of(number))
            assert said(socket)["reply"]["sequence"] == number


@pytest.mark.parametrize("name", ["0" * 32, "x", ".."])
def test_a_search_that_is_not_there(link, name):
    with stream(link, f"/v1/searches/{name}") as socket:
        assert said(socket)["status"] == 404
        with pytest.raises(ConnectionClosed):
            socket.recv(timeout=10.0)


def test_strangers_are_not_accepted(tmp_path):
    with robot_server(tmp_path, token=TOKEN) as link:
        search = link.open()
        for headers in ({}, {"authorization": f"Bearer {TOKEN}x"}):
            with pytest.raises(InvalidStatus), stream(link, search, additional_headers=headers):
                pass
        right = {"authorization": f"Bearer {TOKEN}"}
        with (
            pytest.raises(InvalidStatus),
            stream(link, search, additional_headers=right, origin="http://evil.example"),
        ):
            pass
        with stream(link, search, additional_headers=right) as socket:
            socket.send(body_of(0))
            assert said(socket)["reply"]["action"] == Action.MOVE_FORWARD


def test_too_many_messages_are_told_to_wait(tmp_path):
    limits, statuses = ServerLimits(requests_per_s=0.001, burst=3), []
    with robot_server(tmp_path, limits=limits) as link, stream(link, link.open()) as socket:
        for _ in range(4):
            socket.send(b"x")
            statuses.append(said(socket)["status"])
    assert statuses == [422, 422, 429, 429]
