"""A goal goes from the operator to a robot that waits, once, and STOP takes it back."""

import threading

import pytest

from hypernav.robot.server import waiting_robots
from servers.robots import RobotLink, body_of

WAIT = "/v1/robots/anna/wait"
GOAL = "/v1/robots/anna/goal"


def waits(link: RobotLink, wait_s: float = 0.0):
    answer = link.call("POST", f"{WAIT}?wait_s={wait_s}")
    assert answer.status == 200, answer.content
    return answer.json


def test_a_goal_reaches_a_robot_that_waits_already(link):
    found = []
    robot = threading.Thread(target=lambda: found.append(waits(link, 10.0)))
    robot.start()
    answer = link.call("POST", GOAL, {"goal": "bed"})
    while answer.status == 404:
        answer = link.call("POST", GOAL, {"goal": "bed"})
    robot.join(20.0)
    assert answer.status == 200
    assert found == [answer.json]


def test_the_goal_stays_the_same_until_its_search_is_opened(link):
    assert waits(link) == {"goal": None, "key": None}
    given = link.call("POST", GOAL, {"goal": "bed"}).json
    assert waits(link) == waits(link) == given
    assert link.call("GET", "/v1/robots").json == [{"name": "anna", "given": given, "refused": ""}]
    search = link.open(**given)
    assert link.open(**given) == search
    assert link.call("GET", "/v1/robots").json == []
    assert waits(link)["goal"] is None
    assert link.call("GET", search).json["state"] == "waiting"


def test_only_a_robot_that_waits_and_has_no_goal_can_be_given_one(link):
    assert link.call("POST", GOAL, {"goal": "bed"}).status == 404
    waits(link)
    assert link.call("POST", GOAL, {"goal": ""}).status == 422
    assert link.call("POST", GOAL, {"goal": "bed"}).status == 200
    again = link.call("POST", GOAL, {"goal": "sofa"})
    assert again.status == 409
    assert "anna was told to find bed" in again.json["message"]


@pytest.mark.parametrize("name", ["a%20b", "-a", "a" * 41, "..%2f..", "%C3%A4"])
def test_names_that_are_none_are_refused(link, name):
    path = f"/v1/robots/{name}/wait"
    assert link.call("POST", path).status in (404, 422)


def test_a_robot_that_went_away_is_forgotten_with_its_goal(link, monkeypatch):
    waits(link)
    link.call("POST", GOAL, {"goal": "bed"})
    monkeypatch.setattr(waiting_robots, "_FORGOTTEN_S", -1.0)
    assert link.call("GET", "/v1/robots").json == []
    assert waits(link)["goal"] is None


def test_the_number_of_robots_is_limited(link, monkeypatch):
    monkeypatch.setattr(waiting_robots, "_MOST_ROBOTS", 2)
    assert [link.call("POST", f"/v1/robots/r{n}/wait?wait_s=0").status for n in range(3)] == [
        200,
        200,
        429,
    ]
    assert len(link.call("GET", "/v1/robots").json) == 2


def test_the_operator_hears_why_a_search_could_not_be_opened(link):
    waits(link)
    given = link.call("POST", GOAL, {"goal": "bed"}).json
    camera = {"camera": {"width": 2000, "height": 2000}}
    request = given | {"embodiment": camera}
    assert link.call("POST", "/v1/searches", request).status == 422
    (robot,) = link.call("GET", "/v1/robots").json
    assert robot["given"] is None
    assert "2000 × 2000" in robot["refused"]
    assert waits(link)["goal"] is None


def test_stop_ends_every_search_and_takes_goals_back(link):
    searches = [link.open("door"), link.open("quick")]
    link.observe(searches[1], body_of(0))
    waits(link)
    given = link.call("POST", GOAL, {"goal": "bed"}).json
    stopped = link.call("POST", "/v1/stop", {"reason": "fire"}).json
    assert {status["id"] for status in stopped} == {path.split("/")[-1] for path in searches}
    for search in searches:
        status = link.call("GET", search).json
        assert (status["ending"], status["detail"]) == ("stopped", "fire")
    assert link.observe(searches[1], body_of(1)).json["action"] == 0
    assert waits(link)["goal"] is None
    late = link.open(**given)  # the robot had the goal already
    assert link.observe(late, body_of(0)).json["ending"] == "stopped"
    assert link.call("POST", "/v1/stop", {}).json == []


def test_a_search_that_is_being_opened_is_stopped_as_well(tmp_path):
    from servers.robots import robot_server, scripted_plan

    is_planning, go_on = threading.Event(), threading.Event()

    def slow_plan(request):
        is_planning.set()
        go_on.wait(20.0)
        return scripted_plan(request)

    with robot_server(tmp_path, slow_plan) as link:
        found = []
        robot = threading.Thread(target=lambda: found.append(link.open()))
        robot.start()
        assert is_planning.wait(20.0)
        assert link.call("POST", "/v1/stop", {}).json == []
        go_on.set()
        robot.join(20.0)
        assert link.call("GET", found[0]).json["ending"] == "stopped"


def test_images_of_all_observations_can_be_seen_again(link):
    search = link.open("quick")
    assert link.call("GET", f"{search}/image?sequence=0").status == 404
    for sequence in range(2):
        link.observe(search, body_of(sequence))
    for _ in range(2):
        images = [link.call("GET", f"{search}/image?sequence={n}") for n in range(3)]
        assert [image.status for image in images] == [200, 200, 404]
        assert images[1].content == link.call("GET", f"{search}/image").content
        link.call("POST", f"{search}/close")
