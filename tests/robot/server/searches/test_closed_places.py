"""Places that people close to a robot: it keeps out of them, also after a restart."""

import json
import math
from contextlib import closing

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.errors import RequestRefusedError
from hypernav.core.geometry.closed_area import ClosedArea, with_closed
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.robot.client.links import HttpServer, ServerAddress
from hypernav.robot.wire.places import NoEntryRequest
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import RobotLink, body_of, drive, real_plan, robot_server

AHEAD = {"x": 1.5, "y": 0.0, "radius_m": 0.5}


def driven(link: RobotLink, search: str, room: BoxRoom, first: int) -> tuple[float, str]:
    """The nearest that the robot comes to the middle of the area, and how the search ends."""
    nearest_m = math.inf
    for sequence in range(first, 400):
        reply = link.observe(search, body_of(sequence, room)).json
        if reply["hold"]:
            reply = link.answer(search, sequence)
        if reply["done"]:
            return nearest_m, reply["ending"]
        room.step(Action(reply["action"]))
        nearest_m = min(nearest_m, math.hypot(room.pose.x - AHEAD["x"], room.pose.y - AHEAD["y"]))
    raise AssertionError("the search has no end")


@pytest.mark.slow
@pytest.mark.parametrize("is_restarted", [False, True])
def test_a_search_drives_around_a_closed_place(tmp_path, is_restarted):
    room = BoxRoom()
    with robot_server(tmp_path, real_plan) as link:
        port, search = link.port, link.open()
        drive(link, search, room, most=1)
        closed = link.call("POST", f"{search}/no-entry", AHEAD)
        assert closed.status == 201, closed.content
        assert closed.json == AHEAD | {"floor": 1, "number": 0}
        end = None if is_restarted else driven(link, search, room, 1)
    if end is None:
        with robot_server(tmp_path, real_plan, port=port) as link:
            assert link.call("GET", f"{search}/no-entry").json == [closed.json]
            end = driven(link, search, room, 1)
    nearest_m, ending = end
    assert nearest_m >= AHEAD["radius_m"]
    assert ending == "found"


def test_the_way_leads_through_the_place_where_it_is_open_again(tmp_path):
    room = BoxRoom()
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, room, most=1)
        link.call("POST", f"{search}/no-entry", AHEAD)
        assert link.call("DELETE", f"{search}/no-entry/0").json == []
        nearest_m, ending = driven(link, search, room, 1)
        assert link.call("POST", f"{search}/no-entry", AHEAD).status == 409  # it is over
    assert nearest_m < AHEAD["radius_m"]
    assert ending == "found"


@pytest.mark.parametrize(
    ("changes", "status", "words"),
    [
        ({"x": 100.0}, 422, "is not on the map of floor 1"),
        ({"floor": 2}, 422, "is not on the map of floor 2"),
        ({"x": 0.2}, 422, "the robot stands in that area"),
        ({"x": 1e9}, 422, "x: "),
        ({"radius_m": 0.0}, 422, "radius_m: "),
        ({"radius_m": None}, 422, "radius_m: "),
    ],
)
def test_what_can_not_be_closed_is_refused_in_one_line(tmp_path, changes, status, words):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(), most=1)
        refused = link.call("POST", f"{search}/no-entry", AHEAD | changes)
        assert refused.status == status
        assert words in refused.json["message"]
        assert "\n" not in refused.json["message"]
        assert link.call("GET", f"{search}/no-entry").json == []


def test_not_a_number_is_no_place(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        body, kind = json.dumps(AHEAD | {"x": math.nan}).encode(), "application/json"
        answer = link.call("POST", f"{search}/no-entry", body, headers={"content-type": kind})
        assert 400 <= answer.status < 500


def test_an_agent_that_can_not_keep_out_says_so(tmp_path):
    with robot_server(tmp_path) as link:  # scripted
        answer = link.call("POST", f"{link.open('quick')}/no-entry", AHEAD)
    assert answer.status == 409
    assert "can't be told where not to go" in answer.json["message"]


def test_stop_ends_a_search_with_closed_places(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(), most=1)
        link.call("POST", f"{search}/no-entry", AHEAD)
        link.call("POST", "/v1/stop", {})
        assert link.observe(search, body_of(1)).json["ending"] == "stopped"


def test_the_python_client_closes_and_opens_places(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(), most=1)
        name = search.rpartition("/")[2]
        address = ServerAddress.of(f"http://127.0.0.1:{link.port}")
        with closing(HttpServer(address)) as server:
            area = server.close_area(name, NoEntryRequest.model_validate(AHEAD))
            assert server.no_entry(name) == [area]
            with pytest.raises(RequestRefusedError, match="no closed area has the number 7"):
                server.open_area(name, 7)
            assert server.open_area(name, area.number) == []


def test_a_map_without_closed_places_is_itself_and_with_them_another():
    grid = OccupancyGrid(np.full((40, 40), Cell.FREE, np.uint8), 0.05, (0.0, 0.0))
    assert with_closed(grid, ()) is grid
    closed = with_closed(grid, [ClosedArea(1, 1.0, 1.0, 0.5)])
    assert closed.state_at(1.0, 1.45) is Cell.OCCUPIED
    assert closed.state_at(1.0, 1.6) is Cell.FREE
    assert grid.state_at(1.0, 1.0) is Cell.FREE
