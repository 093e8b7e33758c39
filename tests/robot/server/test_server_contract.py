"""Laws of the contract: who is answered what, whatever comes, in whatever order, however often."""

import json
import threading
import time
from typing import Any

import pytest

from hypernav.core.embodiment import Action
from hypernav.core.errors import ModelUnavailableError, RunFolderError
from hypernav.io.writing import AppendOnlyFile
from hypernav.robot.server.searches.journal import Journal
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import body_of, drive, real_plan, robot_server


def test_a_search_drives_to_its_goal(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search, room = link.open(), BoxRoom()
        replies = drive(link, search, room)
        status = link.call("GET", search).json
        lines = link.call("GET", f"{search}/trace").content.decode().splitlines()
    assert replies[-1]["action"] == Action.STOP
    assert replies[-1]["ending"] == status["ending"] == "found"
    assert room.pose.x > 2.0
    assert [reply["sequence"] for reply in replies] == list(range(len(lines)))
    assert status["state"] == "ended"
    assert status["map"]["rows"] > 10


def test_the_agent_decides_as_it_would_without_a_network(tmp_path):
    from hypernav.app.build.agents import build_agent
    from hypernav.core.goal import Goal
    from hypernav.robot.wire.frames import decode_observation, unpack_observation
    from hypernav.robot.wire.requests import OpenSearch

    request = OpenSearch(goal="door", embodiment=BoxRoom().embodiment)
    plan, room, lens = real_plan(request), BoxRoom(), request.embodiment.camera
    agent = build_agent(plan.config, plan.specs).agent
    agent.reset(Goal("door"))
    actions = []
    while not actions or actions[-1] not in (Action.STOP, None):
        packed = unpack_observation(body_of(0, room))
        seen = decode_observation(packed, lens.intrinsics, lens.camera_to_base)
        actions.append(agent.act(seen))
        room.step(actions[-1] or Action.STOP)
    with robot_server(tmp_path, real_plan) as link:
        replies = drive(link, link.open(), BoxRoom())
    assert [reply["action"] for reply in replies] == actions


def test_a_repetition_gets_the_same_answer_and_changes_nothing(link, script):
    search, body = link.open(), body_of(0)
    first = link.observe(search, body)
    version = link.call("GET", search).json["version"]
    other = body_of(0, BoxRoom(labels=False), base_to_odom={"x": 1.0})
    for again in (body, other):
        assert link.observe(search, again).content == first.content
    assert script.seen == 1
    assert link.call("GET", search).json["version"] == version
    assert link.call("GET", f"{search}/replies/0").content == first.content


@pytest.mark.parametrize(
    ("stamp_s", "words"),
    [(12.4, "went back from 12.500000 to 12.400000"), (12.5, "is that of observation 0 again")],
)
def test_images_that_are_not_newer_end_the_search(tmp_path, stamp_s, words):
    with robot_server(tmp_path) as link:
        search = link.open()
        link.observe(search, body_of(0, stamp_s=12.5))
    with robot_server(tmp_path) as link:  # a restart forgets no time
        reply = link.observe(search, body_of(1, stamp_s=stamp_s)).json
        assert (reply["action"], reply["done"]) == (Action.STOP, True)
        assert reply["ending"] == link.call("GET", search).json["ending"] == "robot failed"
        assert words in reply["reason"]
        assert reply["reason"] == link.call("GET", search).json["detail"]


@pytest.mark.parametrize("sequence", [0, 3, 999_999])
def test_another_number_is_refused_with_the_expected_one(link, sequence):
    search = link.open()
    for number in (0, 1):
        link.observe(search, body_of(number))
    answer = link.observe(search, body_of(sequence))
    assert answer.status == 409
    assert answer.json["error"] == "sequence"
    assert answer.json["expected"] == 2
    assert link.observe(search, body_of(2)).status == 200


def test_a_slow_decision_is_held_and_comes(link, script):
    script.gate.clear()
    search = link.open(deadline_s=0.05)
    assert link.observe(search, body_of(0)).json["hold"]
    assert link.observe(search, body_of(0)).json["hold"]
    assert link.call("GET", search).json["state"] == "deciding"
    refused = link.observe(search, body_of(1))
    assert (refused.status, refused.json["error"], refused.json["expected"]) == (409, "pending", 0)
    script.gate.set()
    assert link.answer(search, 0)["action"] == Action.MOVE_FORWARD
    assert script.seen == 1


def test_an_answer_is_not_older_than_its_question(link):
    search = link.open()
    answer = link.call("GET", f"{search}/replies/0")
    assert (answer.status, answer.json["expected"]) == (409, 0)


def test_a_broken_observation_does_not_count(link, script):
    search, body = link.open(labels=False), body_of(0, BoxRoom(labels=False))
    broken = body[:-400] + bytes(400)
    answer = link.observe(search, broken)
    assert answer.status == 422
    assert "broken" in answer.json["message"]
    assert link.call("GET", search).json["next_sequence"] == 0
    assert link.observe(search, body).status == 200
    assert script.seen == 1


def test_stop_answers_what_is_pending_and_all_that_comes(link, script):
    script.gate.clear()
    search = link.open(deadline_s=20.0)
    answers = []
    waiting = threading.Thread(target=lambda: answers.append(link.observe(search, body_of(0))))
    waiting.start()
    while script.seen == 0:
        time.sleep(0.01)
    stopped = link.call("POST", f"{search}/stop", {"reason": "red button"})
    waiting.join()
    script.gate.set()
    assert stopped.json["ending"] == "stopped"
    for number in (0, 1, 7):
        answers.append(link.observe(search, body_of(number)))
    answers.append(link.observe(search, body_of(1)[:-400] + bytes(400)))
    answers.append(link.observe(search, b"no observation"))
    for answer in answers:
        assert answer.status == 200
        assert answer.json["action"] == Action.STOP
        assert (answer.json["done"], answer.json["ending"]) == (True, "stopped")
    assert link.call("GET", search).json["detail"] == "red button"
    assert link.call("POST", f"{search}/close").json["ending"] == "stopped"


def test_a_reason_that_cannot_be_written_stops_all_the_same(link):
    searches = link.open(), link.open()
    body = rb'{"reason": "half a \ud800 character"}'
    for path in (f"{searches[0]}/stop", "/v1/stop"):
        assert link.call("POST", path, body).status == 200
    for search in searches:
        status = link.call("GET", search)
        assert (status.status, status.json["ending"]) == (200, "stopped")
    assert "half a ? character" in link.call("GET", searches[0]).json["detail"]


def test_a_search_over_is_answered_by_stop(link, script):
    script.length = 1
    search = link.open()
    link.observe(search, body_of(0))
    last = link.observe(search, body_of(1))
    assert last.json["ending"] == "found"
    assert link.observe(search, body_of(1)).content == last.content
    later = link.observe(search, body_of(2))
    assert (later.json["action"], later.json["ending"]) == (Action.STOP, "found")
    assert script.seen == 2


def test_the_step_limit_ends_a_search(link, script):
    search = link.open(max_steps=2)
    endings = [link.observe(search, body_of(number)).json["ending"] for number in range(3)]
    assert endings == [None, None, "gave up"]
    assert script.seen == 2
    assert len(link.call("GET", f"{search}/trace").content.splitlines()) == 2


def test_a_model_that_is_gone_ends_the_search_and_says_so(link, script):
    script.error = ModelUnavailableError("no answer for 120 s")
    search = link.open()
    answer = link.observe(search, body_of(0)).json
    assert (answer["action"], answer["ending"]) == (Action.STOP, "model unavailable")
    assert answer["reason"] == "no answer for 120 s"


def test_a_full_disk_takes_no_observation_and_has_room_for_a_stop(
    link, script, monkeypatch, tmp_path, caplog
):
    search = link.open()

    folder = tmp_path / "searches" / search.rpartition("/")[2]
    kept = (folder / ".end.json.new").stat()

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(AppendOnlyFile, "append", full)
        answer = link.observe(search, body_of(0))
        assert (answer.status, answer.json["error"]) == (507, "storage")
    assert script.seen == 0
    assert "No space left" in caplog.text
    caplog.clear()
    assert link.observe(search, body_of(0)).json["action"] == Action.MOVE_FORWARD
    link.call("POST", f"{search}/stop", {})
    assert kept.st_size == 4096
    assert (folder / "end.json").stat().st_ino == kept.st_ino


def test_a_stop_that_cannot_be_written_holds_and_is_written_when_sent_again(
    link, monkeypatch, tmp_path
):
    searches = [link.open("quick"), link.open("quick")]
    ends = [tmp_path / "searches" / one.rpartition("/")[2] / "end.json" for one in searches]
    latest, write_end = ends[-1].parent, Journal.write_end

    def fail(journal: Journal, *end: Any) -> None:
        if journal.folder == latest:
            raise RunFolderError("no room")
        write_end(journal, *end)

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "write_end", fail)
        answer = link.call("POST", "/v1/stop", {})
        assert answer.status == 507
        assert "A stop holds until the server ends" in answer.json["message"]
        assert [end.exists() for end in ends] == [True, False]
    assert [link.observe(one, body_of(0)).json["ending"] for one in searches] == ["stopped"] * 2
    (written,) = link.call("POST", "/v1/stop", {}).json
    assert written["id"] == latest.name
    assert ends[-1].exists()


def test_an_error_of_ours_stops_the_robot_and_tells_no_secrets(link, script, caplog):
    script.error = ZeroDivisionError("inner workings")
    search = link.open()
    answer = link.observe(search, body_of(0))
    assert (answer.json["action"], answer.json["ending"]) == (Action.STOP, "failed")
    assert b"inner workings" not in answer.content + link.call("GET", search).content
    assert link.observe(search, body_of(1)).json["ending"] == "failed"
    assert "ZeroDivisionError: inner workings" in caplog.text


def test_a_robot_that_sees_no_depth_is_not_told_to_drive(link, script):
    search, room = link.open("quick", deadline_s=20.0), BoxRoom()
    replies = [link.observe(search, body_of(n, room, depth=0.0)).json for n in range(24)]
    assert all(reply["action"] != Action.MOVE_FORWARD for reply in replies)
    assert "no depth" in replies[0]["reason"]
    assert replies[0]["velocity"]["linear_m_s"] == 0.0
    assert replies[-1]["ending"] == "robot failed"
    assert "24 images without any depth between" in replies[-1]["reason"]
    trace = link.call("GET", f"{search}/trace").content.splitlines()
    assert [json.loads(step)["action"] for step in trace] == [r["action"] for r in replies[:-1]]


def test_opening_again_with_a_key_gives_the_same_search(link):
    first, again = link.open(key="robot-7-tuesday"), link.open(key="robot-7-tuesday")
    assert first == again
    assert link.open() != first


def test_a_key_belongs_to_one_goal(link):
    link.open("door", key="robot-7-tuesday")
    request = {"goal": "chair", "key": "robot-7-tuesday", "labels": True}
    robot = BoxRoom().embodiment.model_dump()
    refused = link.call("POST", "/v1/searches", request | {"embodiment": robot})
    assert refused.status == 409
    assert "a search for 'door'" in refused.json["message"]


def test_a_key_belongs_to_one_robot(link):
    link.open("door", key="robot-7-tuesday")
    robot = BoxRoom().embodiment.model_dump()
    robot["camera"]["height_m"] += 0.1
    request = {"goal": "door", "key": "robot-7-tuesday", "labels": True, "embodiment": robot}
    refused = link.call("POST", "/v1/searches", request)
    assert refused.status == 409
    assert "another body, camera or step" in refused.json["message"]


def test_labels_that_were_promised_must_come(link):
    search = link.open(labels=True)
    refused = link.observe(search, body_of(0, BoxRoom(labels=False)))
    assert refused.status == 422
    assert "opened with labels: true" in refused.json["message"]
    assert link.observe(search, body_of(0)).status == 200


def test_the_status_waits_for_news(link):
    search = link.open()
    version = link.call("GET", search).json["version"]
    news = []
    path = f"{search}?after={version}&wait_s=20"
    waiting = threading.Thread(target=lambda: news.append(link.call("GET", path).json))
    waiting.start()
    link.observe(search, body_of(0))
    waiting.join(timeout=15.0)
    assert news[0]["version"] > version
    while link.call("GET", search).json["state"] != "waiting":
        pass
    version = link.call("GET", search).json["version"]
    unchanged = link.call("GET", f"{search}?after={version}&wait_s=0.05").json
    assert unchanged["version"] == version


def test_what_a_robot_says_about_being_blocked_is_in_the_trace(link):
    search = link.open()
    link.observe(search, body_of(0, blocked=True))
    trace = link.call("GET", f"{search}/trace").json
    assert any("blocked" in event for event in trace["events"])


def test_robots_do_not_wait_for_each_other(link, script):
    script.gate.clear()
    slow = link.open("slow", deadline_s=0.05)
    assert link.observe(slow, body_of(0)).json["hold"]
    for _ in range(3):
        quick = link.open("quick", deadline_s=20.0)
        for number in range(3):
            assert not link.observe(quick, body_of(number)).json["hold"]
    assert link.observe(slow, body_of(0)).json["hold"]
    script.gate.set()
    assert link.answer(slow, 0)["action"] == Action.MOVE_FORWARD


def test_a_paused_robot_waits_until_it_may_go_on(tmp_path):
    with robot_server(tmp_path) as link:
        search = link.open("quick")
        link.observe(search, body_of(0))
        assert link.call("POST", f"{search}/pause").json["detail"] == "paused by the operator"
        held = link.observe(search, body_of(1)).json
        assert held["hold"]
        assert not held["done"]
        assert link.call("GET", f"{search}/replies/1").json["hold"]
        assert link.call("POST", f"{search}/resume").json["detail"] == ""
        while (reply := link.call("GET", f"{search}/replies/1").json)["hold"]:
            time.sleep(0.01)
        assert reply["sequence"] == 1
        assert not reply["done"]


def test_stop_ends_a_paused_search_at_once_and_it_stays_stopped(tmp_path):
    with robot_server(tmp_path) as link:
        search = link.open("quick")
        link.call("POST", f"{search}/pause")
        assert link.observe(search, body_of(0)).json["hold"]
        link.call("POST", "/v1/stop", {"reason": "enough"})
        reply = link.call("GET", f"{search}/replies/0").json
        assert reply["done"]
        assert reply["action"] == Action.STOP
        link.call("POST", f"{search}/resume")
        assert link.observe(search, body_of(1)).json["ending"] == "stopped"


@pytest.mark.slow
def test_a_restarted_server_lets_no_paused_robot_go(tmp_path):
    with robot_server(tmp_path) as link:
        search, port = link.open("quick"), link.port
        link.observe(search, body_of(0))
        link.call("POST", f"{search}/pause")
        link.observe(search, body_of(1))
    with robot_server(tmp_path, port=port) as link:
        assert link.call("GET", search).json["detail"] == "paused by the operator"
        assert link.call("GET", f"{search}/replies/1").json["hold"]
        link.call("POST", f"{search}/resume")
        while (reply := link.call("GET", f"{search}/replies/1").json)["hold"]:
            time.sleep(0.01)
        assert reply["sequence"] == 1
