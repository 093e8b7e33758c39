"""Places that people send a robot to: it drives there, also after a restart, and searches on."""

import json
import logging
import math
from collections.abc import Callable
from contextlib import closing

import pytest

from hypernav.core.embodiment import Action
from hypernav.core.errors import RequestRefusedError
from hypernav.core.exploring.operator_place import PlaceState
from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.client.links import HttpServer, ServerAddress
from hypernav.robot.wire.places import GoToRequest
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import RobotLink, body_of, drive, real_plan, robot_server

BEHIND = Pose2(0.0, 0.0, math.pi)
"""A start that sees nothing of the door."""
PLACE = {"x": -1.5, "y": 0.5}


def send(link: RobotLink, search: str, place: dict[str, float]) -> None:
    sent = link.call("PUT", f"{search}/go-to", place)
    assert sent.status == 200, sent.content
    assert sent.json == {"floor": 1, "state": "on its way", "away_m": None} | place


def place_of(link: RobotLink, search: str) -> dict:
    return link.call("GET", f"{search}/go-to").json


def follow(
    link: RobotLink, search: str, room: BoxRoom, first: int, until: Callable[[], object]
) -> int:
    """Drive until something is so; the number of the next observation."""
    for sequence in range(first, 200):
        if until():
            return sequence
        (reply,) = drive(link, search, room, first=sequence, most=1)
        assert not reply["done"], reply
    raise AssertionError("it never is")


def events_of(link: RobotLink, search: str) -> list[str]:
    lines = link.call("GET", f"{search}/trace").content.decode().splitlines()
    events = [event for line in lines for event in json.loads(line)["events"]]
    return [one for one in events if one in {state.event for state in PlaceState}]


@pytest.mark.parametrize("restart_at", [None, "on its way", "reached"])
def test_a_robot_goes_to_the_place_and_then_searches_on(tmp_path, caplog, restart_at):
    room, replies = BoxRoom(BEHIND), []
    with robot_server(tmp_path, real_plan) as link:
        port, search = link.port, link.open()
        drive(link, search, room, most=1)
        send(link, search, PLACE)
        following = follow(link, search, room, 1, lambda: events_of(link, search))
        if restart_at != "on its way":
            is_there = lambda: place_of(link, search)["state"] == "reached"  # noqa: E731
            following = follow(link, search, room, following, is_there)
        before = place_of(link, search)
        if restart_at is None:
            replies = drive(link, search, room, first=following)
    if restart_at is not None:
        with caplog.at_level(logging.WARNING), robot_server(tmp_path, real_plan, port=port) as link:
            assert place_of(link, search) == before
            replies = drive(link, search, room, first=following)
            assert not caplog.records  # every action is repeated
            assert (place := place_of(link, search))["state"] == "reached"
            assert place["away_m"] <= room.embodiment.motion.forward_m
            assert events_of(link, search) == [
                "place chosen on the map: on its way",
                "place chosen on the map: reached",
            ]
    assert replies[-1]["ending"] == "found"


def test_without_a_path_it_says_so_once_and_searches_on(tmp_path):
    room = BoxRoom(BEHIND)
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, room, most=1)
        send(link, search, {"x": 0.0, "y": 1.6})  # unknown, more than 1 m from what is known
        replies = drive(link, search, room, first=1)
        assert place_of(link, search)["state"] == "no path over what is known"
        assert events_of(link, search)[1:] == [PlaceState.NO_PATH.event]
    assert replies[-1]["ending"] == "found"


def test_a_place_in_the_unknown_is_gone_to_as_near_as_is_known(tmp_path):
    room = BoxRoom()
    with robot_server(tmp_path, real_plan) as link:
        search = link.open("piano")
        drive(link, search, room, most=1)
        send(link, search, {"x": 4.0, "y": 1.4})  # a wall
        follow(link, search, room, 1, lambda: place_of(link, search)["state"] != "on its way")
        assert (place := place_of(link, search))["state"] == "reached"
        assert 0.2 < place["away_m"] < 1.0


def test_the_way_leads_around_a_closed_place(tmp_path):
    room, area = BoxRoom(), {"x": 1.5, "y": 0.0, "radius_m": 0.5}
    nearest_m = math.inf
    with robot_server(tmp_path, real_plan) as link:
        search = link.open("piano")
        drive(link, search, room, most=1)
        link.call("POST", f"{search}/no-entry", area)
        refused = link.call("PUT", f"{search}/go-to", {"x": 1.6, "y": 0.1})
        assert (refused.status, refused.json["error"]) == (422, "go-to")
        assert "closed to the robot" in refused.json["message"]
        send(link, search, {"x": 3.0, "y": 0.0})

        def is_there() -> bool:
            nonlocal nearest_m
            nearest_m = min(nearest_m, math.hypot(room.pose.x - area["x"], room.pose.y))
            return place_of(link, search)["state"] != "on its way"

        follow(link, search, room, 1, is_there)
        assert place_of(link, search)["state"] == "reached"
    assert nearest_m >= area["radius_m"]


def test_a_sure_sighting_of_the_goal_goes_first(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        room, search = BoxRoom(), link.open()
        drive(link, search, room, most=1)
        send(link, search, {"x": 2.0, "y": 1.2})
        assert drive(link, search, room, first=1)[-1]["ending"] == "found"
        assert link.call("PUT", f"{search}/go-to", PLACE).status == 409  # it is over


def test_the_last_of_two_clients_counts_and_either_can_cancel(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        room, search = BoxRoom(), link.open("piano")
        drive(link, search, room, most=1)
        send(link, search, {"x": 3.0, "y": 1.0})
        drive(link, search, room, first=1, most=2)
        other = RobotLink(link.port)
        send(other, search, {"x": 2.5, "y": -1.0})
        (reply,) = drive(link, search, room, first=3, most=1)
        assert reply["destination"] == [2.5, -1.0]
        assert link.call("DELETE", f"{search}/go-to").status == 200
        assert place_of(other, search) is None
        (reply,) = drive(link, search, room, first=4, most=1)
        assert reply["destination"] != [2.5, -1.0]
        refused = other.call("DELETE", f"{search}/go-to")
        assert (refused.status, refused.json["error"]) == (404, "unknown")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"x": 100.0}, "is not on the map of floor 1"),
        ({"floor": 2}, "is not on the map of floor 2"),
        ({"x": 1e9}, "x: "),
        ({"y": None}, "y: "),
        ({"radius_m": 0.5}, "radius_m: "),
    ],
)
def test_where_a_robot_can_not_be_sent_is_refused_in_one_line(tmp_path, changes, words):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(BEHIND), most=1)
        refused = link.call("PUT", f"{search}/go-to", PLACE | changes)
        assert refused.status == 422
        assert words in refused.json["message"]
        assert "\n" not in refused.json["message"]
        body, kind = json.dumps(PLACE | {"x": math.nan}).encode(), "application/json"
        answer = link.call("PUT", f"{search}/go-to", body, headers={"content-type": kind})
        assert 400 <= answer.status < 500
        assert place_of(link, search) is None


def test_an_agent_that_can_not_be_sent_says_so(tmp_path):
    with robot_server(tmp_path) as link:  # scripted
        answer = link.call("PUT", f"{link.open('quick')}/go-to", PLACE)
    assert (answer.status, answer.json["error"]) == (409, "go-to")
    assert "can't be sent to a place" in answer.json["message"]


def test_a_change_during_a_decision_counts_for_the_next_one(tmp_path):
    room = BoxRoom()
    with robot_server(tmp_path, real_plan) as link:
        search = link.open("piano")
        drive(link, search, room, most=1)
        link.call("POST", f"{search}/pause", {})
        assert link.observe(search, body_of(1, room)).json["hold"]
        send(link, search, {"x": 3.0, "y": 1.0})
        link.call("POST", f"{search}/resume", {})
        assert link.answer(search, 1)["destination"] == [3.0, 1.0]


def test_the_python_client_sends_a_robot_and_calls_it_back(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(BEHIND), most=1)
        name = search.rpartition("/")[2]
        address = ServerAddress.of(f"http://127.0.0.1:{link.port}")
        with closing(HttpServer(address)) as server:
            assert server.going_to(name) is None
            place = server.go_to(name, GoToRequest.model_validate(PLACE))
            assert server.going_to(name) == place
            server.cancel_go_to(name)
            assert server.going_to(name) is None
            with pytest.raises(RequestRefusedError, match="not on its way"):
                server.cancel_go_to(name)


def test_stop_ends_a_search_whose_robot_is_on_its_way(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(BEHIND), most=1)
        send(link, search, PLACE)
        link.call("POST", "/v1/stop", {})
        reply = link.observe(search, body_of(1)).json
        assert (reply["ending"], reply["action"]) == ("stopped", Action.STOP)
