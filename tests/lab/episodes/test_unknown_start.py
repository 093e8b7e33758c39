"""Searches of a robot that doesn't know where it starts in its memory."""

import json
import math
from pathlib import Path

import pytest

from hypernav.app.build.agents import build_search
from hypernav.app.build.memories.building_memory import open_memory
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

CONFIG = small_config()
LIVING_ROOM = Pose2(2.5, 1.0, 1.5)
BEDROOM = Pose2(6.0, 3.0, 0.4)


def run(folder: Path | None, goal: str, start: Pose2, most: int, *, relocalize: bool = False):
    """A search and its actions, in the memory of a folder."""
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    episode = episode_from(start, goal, max_steps=most)
    if folder is None:
        search = EpisodeRun(agent, two_rooms(), episode)
        return search, [step.trace.action for step in search]
    with open_memory(folder, CONFIG) as memory:
        search = EpisodeRun(agent, two_rooms(), episode, memory=memory, relocalize=relocalize)
        return search, [step.trace.action for step in search]


def history(folder: Path) -> list[str]:
    return [one["goal"] for one in json.loads((folder / "memory.json").read_text())["history"]]


@pytest.fixture(scope="module")
def both_rooms(tmp_path_factory) -> Path:
    """The memory of a search through both rooms, in vain."""
    folder = tmp_path_factory.mktemp("home")
    run(folder, "piano", LIVING_ROOM, 200)
    return folder


def test_a_robot_finds_its_start_and_goes_on_with_the_memory(both_rooms):
    search, actions = run(both_rooms, "sofa", BEDROOM, 200, relocalize=True)
    found = search.found_start
    assert found is not None
    assert found.place is not None
    assert found.as_dict() == {
        "sure": True,
        "doubt": "",
        "turns": 11,
        "floor": 1,
        "evidence": round(found.place.evidence, 3),
        "rival": round(found.place.rival, 3),
    }
    assert history(both_rooms) == ["piano", "sofa"]
    assert search.result().metrics.success
    _, without = run(None, "sofa", BEDROOM, 200)
    assert len(actions) < len(without)


def test_the_frame_that_it_finds_is_the_memorys(both_rooms):
    search, _ = run(both_rooms, "bed", BEDROOM, 1, relocalize=True)
    true = LIVING_ROOM.to_transform()
    assert search.found_start is not None
    assert search.found_start.place is not None
    found = BEDROOM.to_transform() @ search.found_start.place.own_to_map.inverse()
    assert math.dist(found.translation, true.translation) < 0.1
    assert abs(found.yaw - true.yaw) < math.radians(2.0)


def test_where_its_place_is_not_clear_the_search_begins_anew_and_the_memory_stays(tmp_path):
    run(tmp_path, "piano", Pose2(1.5, 1.0, math.pi), 2)  # a corner of the living room
    before = {one: one.read_bytes() for one in tmp_path.rglob("*") if one.is_file()}
    search, actions = run(tmp_path, "bed", BEDROOM, 200, relocalize=True)
    assert search.found_start is not None
    assert search.found_start.doubt
    assert search.found_start.as_dict()["sure"] is False
    assert {one: one.read_bytes() for one in tmp_path.rglob("*") if one.is_file()} == before
    _, without = run(None, "bed", BEDROOM, 200)
    assert actions == without


def test_where_the_map_contradicts_a_sure_place_the_search_begins_anew(both_rooms, monkeypatch):
    monkeypatch.setattr("hypernav.search.memory.start.start_check._SURE_AT_ONCE", -1e6)
    before = {one: one.read_bytes() for one in both_rooms.rglob("*") if one.is_file()}
    search, actions = run(both_rooms, "bed", BEDROOM, 200, relocalize=True)
    assert search.found_start is not None
    assert search.found_start.place is not None
    assert search.found_start.place.doubt == ""
    assert "contradicts the map" in search.found_start.doubt
    assert search.found_start.as_dict()["sure"] is False
    assert {one: one.read_bytes() for one in both_rooms.rglob("*") if one.is_file()} == before
    _, without = run(None, "bed", BEDROOM, 200)
    assert actions == without


def test_a_new_memory_begins_where_the_robot_stands(tmp_path):
    search, actions = run(tmp_path, "bed", BEDROOM, 200, relocalize=True)
    assert search.found_start is None
    assert history(tmp_path) == ["bed"]
    assert actions == run(None, "bed", BEDROOM, 200)[1]
