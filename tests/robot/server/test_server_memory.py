"""A server with a memory: what one search learns of the building, the next one knows."""

import io
import json
import math
import shutil
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from hypernav.app.build.memories.building_memory import open_memory
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.embodiment import Action
from hypernav.core.errors import ModelUnavailableError, RunFolderError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.robot.server.searches.agents import AgentPlan, PlanAgent
from hypernav.robot.server.searches.journal import Journal
from hypernav.robot.wire.requests import OpenSearch
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.search.memory.store.memory_index import GoalRecord, Index
from hypernav.search.memory.store.memory_reader import read_index
from hypernav.simulator.worlds.box_room import BoxRoom
from memory_folders import files_of
from servers.robots import RobotLink, body_of, drive, real_plan, robot_server, scripted_plan

FACING_AWAY = Pose2(2.0, 0.0, math.pi)


@pytest.fixture
def plan(tmp_path: Path) -> PlanAgent:
    def with_memory(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home")

    return with_memory


def first_reason(link: RobotLink, search: str) -> str:
    return json.loads(link.call("GET", f"{search}/trace").content.decode().splitlines()[0])[
        "reason"
    ]


def known(folder: Path) -> Index:
    index = read_index(folder)
    assert index is not None
    return index


def outcomes(folder: Path) -> list[tuple[str, str]]:
    return [(one.goal, one.outcome) for one in known(folder).history]


def test_the_next_search_goes_to_what_the_last_one_saw(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        search = link.open()
        replies = drive(link, search, BoxRoom(FACING_AWAY))
        assert first_reason(link, search) == "on the way to a door seen before"
        assert replies[-1]["ending"] == "found"
    assert outcomes(tmp_path / "home") == [("door", "found"), ("door", "found")]


def test_a_robot_is_told_in_how_many_earlier_searches_the_memory_was_there(tmp_path, plan):
    request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
    with robot_server(tmp_path / "state", plan) as link:
        first = link.call("POST", "/v1/searches", request | {"key": "a" * 32}).json
        drive(link, f"/v1/searches/{first['id']}", BoxRoom())
        second = link.call("POST", "/v1/searches", request | {"key": "b" * 32}).json
    with robot_server(tmp_path / "state", plan) as link:
        again = link.call("POST", "/v1/searches", request | {"key": "b" * 32}).json
    assert [one["earlier_searches"] for one in (first, second, again)] == [0, 1, 1]


def test_without_a_memory_older_robots_are_told_nothing_that_they_do_not_know(tmp_path):
    request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
    with robot_server(tmp_path / "state", real_plan) as link:
        opened = link.call("POST", "/v1/searches", request).json
    assert opened.keys() == {"id", "next_sequence", "version", "words"}


def test_one_search_at_a_time_has_the_memory(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        search = link.open()
        request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
        refused = link.call("POST", "/v1/searches", request)
        assert (refused.status, refused.json["error"]) == (409, "memory")
        assert "close it by POST" in refused.json["message"]
        link.call("POST", f"{search}/close")
        link.open()


@pytest.mark.slow
def test_a_search_that_is_stopped_leaves_what_it_saw(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(), most=2)
        link.call("POST", f"{search}/stop")
        link.open()  # waits for the memory
    assert outcomes(tmp_path / "home") == [("door", "stopped")]
    assert any(one.label == "door" for one in known(tmp_path / "home").floors[0].things)


def test_a_search_that_fails_in_its_first_step_leaves_nothing(tmp_path, plan, monkeypatch):
    def out_of_reach(agent, observation):
        raise ModelUnavailableError("no answer")

    with robot_server(tmp_path / "state", plan) as link:
        with monkeypatch.context() as model:
            model.setattr("hypernav.search.agents.search.SearchAgent.act", out_of_reach)
            search = link.open()
            drive(link, search, BoxRoom(), most=1)
        assert link.call("GET", search).json["ending"] == "model unavailable"
        link.open()  # waits for the memory
    assert read_index(tmp_path / "home") is None


@pytest.mark.slow
def test_a_restarted_server_adds_a_search_to_the_memory_once(tmp_path, plan):
    def without_times(index: Index) -> Index:
        history = [one.model_copy(update={"began": ""}) for one in index.history]
        return index.model_copy(update={"history": tuple[GoalRecord, ...](history)})

    with robot_server(tmp_path / "whole", plan) as link:
        drive(link, link.open(), BoxRoom())
    whole = without_times(known(tmp_path / "home"))
    shutil.rmtree(tmp_path / "home")
    room = BoxRoom()
    with robot_server(tmp_path / "state", plan) as link:
        search = link.open()
        drive(link, search, room, most=3)
    assert read_index(tmp_path / "home") is None
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, search, room, first=3)
    assert without_times(known(tmp_path / "home")) == whole


def test_a_restarted_server_goes_on_with_no_other_memory(tmp_path, plan):
    home, room = tmp_path / "home", BoxRoom()
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        search = link.open()
        drive(link, search, room, most=3)
    with open_memory(home, plan_config(plan)) as memory:
        memory.save()
    with robot_server(tmp_path / "state", plan) as link:
        now = link.call("GET", search).json
        assert now["ending"] == "failed"
        assert "no longer the one that the search began with" in now["detail"]
        link.open()  # the memory is free


def test_a_memory_that_was_learned_in_simulation_is_refused_when_a_search_is_opened(tmp_path, plan):
    with open_memory(tmp_path / "home", plan_config(plan)) as memory:
        place = {"building": "house", "map_to_scene": Transform.identity()}
        memory.begin(Goal("door"), BoxRoom().observe(), **place)
        memory.end("found", steps=1)
    with robot_server(tmp_path / "state", plan) as link:
        request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
        for _ in range(2):  # nothing keeps the memory
            refused = link.call("POST", "/v1/searches", request)
            assert refused.status == 422
            assert "is simulated; name another folder for a robot" in refused.json["message"]


def plan_config(plan: PlanAgent) -> HyPerNavConfig:
    """The configuration of the searches of the box room."""
    return plan(OpenSearch(goal="door", embodiment=BoxRoom().embodiment)).config


def test_a_server_that_ends_waits_until_the_memory_is_saved(tmp_path, plan, monkeypatch):
    def slow(folder, outcome, *, steps):
        time.sleep(0.5)
        save(folder, outcome, steps=steps)

    save = MemoryFolder.end
    monkeypatch.setattr(MemoryFolder, "end", slow)
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
    assert outcomes(tmp_path / "home") == [("door", "found")]


def test_a_robot_that_stands_elsewhere_is_told_so(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        search = link.open()
        before_a_wall = BoxRoom(Pose2(2.5, 0.0, 0.0))
        body = body_of(0, before_a_wall, base_to_odom={"x": 0.0, "y": 0.0, "yaw": 0.0})
        reply = link.observe(search, body).json
        assert (reply["action"], reply["ending"]) == (Action.STOP, "failed")
        assert "is not what" in link.call("GET", search).json["detail"]


def test_a_robot_that_turns_out_to_stand_elsewhere_leaves_the_memory_as_it_was(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        search = link.open()  # waits for the memory
        before = files_of(tmp_path / "home")
        (reply,) = drive(link, search, BoxRoom(), most=1)
        for sequence in range(1, 12):
            assert reply["ending"] is None
            yaw = math.radians(30.0 * sequence)
            elsewhere, said = BoxRoom(Pose2(2.5, 0.0, yaw)), {"x": 0.0, "y": 0.0, "yaw": yaw}
            body = body_of(sequence, elsewhere, base_to_odom=said, blocked=True)
            reply = link.observe(search, body).json
            if reply["done"]:
                break
        assert (reply["action"], reply["ending"]) == (Action.STOP, "failed")
        assert "let --relocalize find" in link.call("GET", search).json["detail"]
        link.open()  # waits for the memory
    assert files_of(tmp_path / "home") == before


def test_another_robot_is_refused_when_it_opens_a_search(tmp_path, plan):
    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        robot = BoxRoom().embodiment.model_dump()
        robot["body"]["radius_m"] += 0.1
        request = {"goal": "door", "labels": True, "embodiment": robot}
        refused = link.call("POST", "/v1/searches", request)
        assert refused.status == 422
        assert "embodiment.body.radius_m" in refused.json["message"]


def test_a_search_that_cannot_be_written_leaves_the_memory_to_the_next_one(
    tmp_path, plan, monkeypatch
):
    def full(folder, record):
        raise RunFolderError("the disk is full")

    kept = list[object]()  # else the garbage collector would let go of the memory
    monkeypatch.setattr(AgentPlan, "open_memory", _kept(AgentPlan.open_memory, kept))
    with robot_server(tmp_path / "state", plan) as link:
        with monkeypatch.context() as disk:
            disk.setattr(Journal, "create", full)
            request = {
                "goal": "door",
                "labels": True,
                "embodiment": BoxRoom().embodiment.model_dump(),
            }
            assert link.call("POST", "/v1/searches", request).status == 507
        link.open()
    assert len(kept) == 2


def _kept(open_memory: Callable[[AgentPlan], object], kept: list[object]):
    def opened(plan: AgentPlan) -> object:
        kept.append(open_memory(plan))
        return kept[-1]

    return opened


def test_an_agent_without_memory_is_refused(tmp_path):
    def forgetful(request: OpenSearch) -> AgentPlan:
        return replace(scripted_plan(request), memory=tmp_path / "home")

    with robot_server(tmp_path / "state", forgetful) as link:
        request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
        refused = link.call("POST", "/v1/searches", request)
        assert refused.status == 422
        assert "keeps no memory" in refused.json["message"]


def test_an_operator_sends_a_robot_to_one_of_the_remembered_things(tmp_path, plan):
    home = tmp_path / "home"
    with robot_server(tmp_path / "state", plan, memory=home) as link:
        assert link.call("GET", "/v1/things").json == []
        drive(link, link.open(), BoxRoom())
        (door,) = [one for one in things_of(link) if one["label"] == "door"]
        assert door["thing"]["floor"] == 1
        assert door["chance"] > 0.5
        link.call("POST", "/v1/robots/anna/wait")
        asked = {"goal": "door", "thing": door["thing"]}
        given = link.call("POST", "/v1/robots/anna/goal", asked).json
        search = link.open(key=given["key"])
        drive(link, search, BoxRoom(FACING_AWAY))
        assert first_reason(link, search) == "on the way to a door seen before"
    with closing(Journal(tmp_path / "state" / "searches" / search.rpartition("/")[2])) as journal:
        record = journal.record
    assert record.request.thing is not None
    assert record.request.thing.model_dump() == door["thing"]


def test_a_remembered_thing_is_shown_by_its_picture_and_on_the_map_of_its_building(tmp_path, plan):
    home = tmp_path / "home"
    with robot_server(tmp_path / "state", plan, memory=home) as link:
        first = link.open()
        drive(link, first, BoxRoom())
        (door,) = [one for one in things_of(link) if one["label"] == "door"]
        assert door["has_image"]
        (left, bottom), (right, top) = door["outline"]
        assert left <= door["position"][0] <= right
        assert bottom <= door["position"][1] <= top
        path = "/v1/things/{floor}/{number}/image".format(**door["thing"])
        picture = Image.open(io.BytesIO(link.call("GET", path).content))
        assert max(picture.size) <= 160
        assert link.call("GET", "/v1/things/1/999/image").status == 409
        assert link.call("GET", "/v1/things/7/0/image").status == 409
        assert link.call("GET", first.replace("searches", "things/of")).json == things_of(link)
        for file in home.glob("**/*.jpg"):
            file.write_bytes(b"something else")
        refused = link.call("GET", path)
        assert refused.status == 503
        assert ".jpg" in refused.json["message"]


def test_a_search_without_the_memory_shows_none_of_its_things(tmp_path):
    with robot_server(tmp_path / "state", memory=tmp_path / "home") as link:
        search = link.open("quick")
        assert link.call("GET", search.replace("searches", "things/of")).json == []


def things_of(link: RobotLink) -> list[dict[str, Any]]:
    """The remembered things, once there are some: a memory is saved after the last answer."""
    while not (things := link.call("GET", "/v1/things").json):
        time.sleep(0.02)
    return things


def test_a_broken_memory_is_said_to_the_operator_until_it_is_mended(tmp_path, plan):
    home = tmp_path / "home"
    with robot_server(tmp_path / "state", plan, memory=home) as link:
        drive(link, link.open(), BoxRoom())
        things = things_of(link)
        whole = (home / "memory.json").read_bytes()
        (home / "memory.json").write_bytes(whole[:100])
        for _ in range(2):
            refused = link.call("GET", "/v1/things")
            assert refused.status == 503
            assert "memory.json" in refused.json["message"]
        (home / "memory.json").write_bytes(whole)
        assert link.call("GET", "/v1/things").json == things


def test_the_memory_is_read_for_the_operator_only_when_it_has_changed(tmp_path, plan, monkeypatch):
    home, read = tmp_path / "home", list[Path]()

    def counted(folder: Path) -> Index | None:
        read.append(folder)
        return read_index(folder)

    monkeypatch.setattr("hypernav.robot.server.operator_page.read_index", counted)
    with robot_server(tmp_path / "state", plan, memory=home) as link:
        drive(link, link.open(), BoxRoom())
        things_of(link)  # may have looked just before the index was saved, and read it just after
        things = things_of(link)
        read.clear()
        assert [link.call("GET", "/v1/things").json for _ in range(3)] == [things] * 3
        assert read == []
        (home / "memory.json").write_bytes(b"{}")
        assert [link.call("GET", "/v1/things").status for _ in range(3)] == [503] * 3
        assert read == [home]


@pytest.mark.parametrize("climbs", [False, True])
def test_a_floor_without_a_way_from_the_last_searchs_end_is_noted_not_refused(
    tmp_path, plan, climbs
):
    home = tmp_path / "home"
    with robot_server(tmp_path / "state", plan, memory=home) as link:
        drive(link, link.open(), BoxRoom())
        things_of(link)
        index = json.loads((home / "memory.json").read_text())
        floor = index["floors"][0]
        state = floor["state"] | {"name": "floor-2/state-1.npz"}
        shutil.copytree(home / "floor-1", home / "floor-2")
        index["floors"].append(floor | {"z": 3.0, "state": state})
        index["robot"]["body"]["max_step_m"] = 0.2 if climbs else 0.03
        (home / "memory.json").write_text(json.dumps(index))
        above = next(one for one in things_of(link) if one["thing"]["floor"] == 2)
        here = next(one for one in things_of(link) if one["thing"]["floor"] == 1)
        assert here["no_way"] == ""
        note = "a robot on floor 1, where the last search ended, has no way there"
        assert above["no_way"] == note
        link.call("POST", "/v1/robots/anna/wait")
        asked = {"goal": "door", "thing": above["thing"]}
        assert link.call("POST", "/v1/robots/anna/goal", asked).status == 200
        stairs = {"floor": 0, "goes_up": True, "end": [1.0, 0.0], "axis": 0.0}
        stairs |= {"passage": "used", "other_floor": 1, "sightings": 3}
        index["connectors"] = [stairs]
        (home / "memory.json").write_text(json.dumps(index))
        assert {one["no_way"] for one in things_of(link)} == ({""} if climbs else {"", note})


def test_a_memory_that_takes_long_to_read_keeps_no_robot_waiting(tmp_path, plan, monkeypatch):
    home, reading, may_end = tmp_path / "home", threading.Event(), threading.Event()

    def slow(folder: Path) -> Index | None:
        reading.set()
        assert may_end.wait(30.0)
        return read_index(folder)

    with robot_server(tmp_path / "state", plan, memory=home) as link:
        drive(link, link.open(), BoxRoom())
        thing = things_of(link)[0]["thing"]
        link.call("POST", "/v1/robots/anna/wait")
        monkeypatch.setattr("hypernav.robot.server.operator_page.read_index", slow)
        (home / "memory.json").write_bytes((home / "memory.json").read_bytes() + b" ")
        with ThreadPoolExecutor(1) as pool:
            asked = {"goal": "door", "thing": thing}
            given = pool.submit(link.call, "POST", "/v1/robots/anna/goal", asked)
            try:
                assert reading.wait(30.0)
                assert link.call("GET", "/v1/robots").status == 200
            finally:
                may_end.set()
            assert given.result().status == 200


def test_nobody_is_sent_to_a_thing_that_the_memory_does_not_have(tmp_path, plan):
    with robot_server(tmp_path / "state", plan, memory=tmp_path / "home") as link:
        drive(link, link.open(), BoxRoom())
        things_of(link)
        link.call("POST", "/v1/robots/anna/wait")
        asked = {"goal": "door", "thing": {"floor": 7, "number": 99}}
        refused = link.call("POST", "/v1/robots/anna/goal", asked)
        assert (refused.status, refused.json["error"]) == (409, "memory")
        assert "no thing 99 on floor 7" in refused.json["message"]


@pytest.mark.parametrize("unknown", [{"floor": 7, "number": 0}, {"floor": 1, "number": 99}])
def test_no_search_begins_for_a_thing_that_the_memory_does_not_have(tmp_path, plan, unknown):
    with robot_server(tmp_path / "state", plan, memory=tmp_path / "home") as link:
        drive(link, link.open(), BoxRoom())
        known = things_of(link)[0]["thing"]
        request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
        refused = link.call("POST", "/v1/searches", request | {"thing": unknown})
        assert (refused.status, refused.json["error"]) == (409, "memory")
        assert f"no thing {unknown['number']} on floor" in refused.json["message"]
        opened = link.call("POST", "/v1/searches", request | {"thing": known})
        assert opened.status == 201  # and the memory was let go


def test_without_a_memory_there_are_no_things(tmp_path):
    with robot_server(tmp_path / "state", scripted_plan) as link:
        assert link.call("GET", "/v1/things").json == []


def test_without_a_memory_nobody_is_sent_to_a_thing_of_it(tmp_path):
    thing = {"floor": 1, "number": 0}
    with robot_server(tmp_path / "state", scripted_plan) as link:
        request = {"goal": "door", "labels": True, "embodiment": BoxRoom().embodiment.model_dump()}
        link.call("POST", "/v1/robots/anna/wait")
        given = link.call("POST", "/v1/robots/anna/goal", {"goal": "door", "thing": thing})
        for refused in (given, link.call("POST", "/v1/searches", request | {"thing": thing})):
            assert refused.status == 409
            assert refused.json["error"] == "memory"
            assert "start it with --memory" in refused.json["message"]
        assert link.call("POST", "/v1/searches", request).status == 201
