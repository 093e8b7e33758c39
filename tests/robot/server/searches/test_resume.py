"""A server that ended goes on where it was, whenever and however it ended."""

import json
import shutil
import struct
import zlib

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.errors import RunFolderError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import StepTrace, floor_of, without_timings
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.server.searches.searches import Searches
from hypernav.robot.wire.values import PlanarPose
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import (
    ScriptedAgent,
    body_of,
    drive,
    real_plan,
    robot_server,
    scripted_plan,
)


def trace_of(link, search) -> list:
    lines = link.call("GET", f"{search}/trace").content.decode().splitlines()
    return [without_timings(json.loads(line)) for line in lines]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory) -> tuple[list, list]:
    """Replies and trace of a search in one go."""
    with robot_server(tmp_path_factory.mktemp("state"), real_plan) as link:
        search = link.open(key="one-search")
        replies = drive(link, search, BoxRoom())
        return replies, trace_of(link, search)


@pytest.mark.parametrize("steps", [0, 1, 4])
def test_a_restarted_server_goes_on_as_if_nothing_had_been(tmp_path, uninterrupted, steps):
    room = BoxRoom()
    with robot_server(tmp_path, real_plan) as link:
        search = link.open(key="one-search")
        before = drive(link, search, room, most=steps)
    with robot_server(tmp_path, real_plan) as link:
        assert link.open(key="one-search") == search
        assert link.call("GET", search).json["next_sequence"] == steps
        if steps > 0:
            again = link.observe(search, body_of(steps - 1)).json
            assert again == before[-1]
        replies = before + drive(link, search, room, first=steps)
        assert (replies, trace_of(link, search)) == uninterrupted


def test_a_finished_search_can_be_looked_at_after_a_restart(tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom())
        paths = ("trace", "map.png", "map.yaml", "map.pgm", "map.json", "image")
        shown = [link.call("GET", f"{search}/{path}").content for path in paths]
        last = link.call("GET", search).json["last"]
    with robot_server(tmp_path, real_plan) as link:
        assert [link.call("GET", f"{search}/{path}").content for path in paths] == shown
        status = link.call("GET", search).json
        assert (status["state"], status["ending"]) == ("ended", "found")
        assert status["last"] == last
        assert link.observe(search, body_of(last["sequence"])).json == last
        assert [one["id"] for one in link.call("GET", "/v1/searches").json] == [status["id"]]


def test_stop_holds_after_a_restart(tmp_path):
    with robot_server(tmp_path) as link:
        search = link.open()
        link.observe(search, body_of(0))
        link.call("POST", f"{search}/stop", {"reason": "enough"})
    with robot_server(tmp_path) as link:
        reply = link.observe(search, body_of(1)).json
        assert (reply["action"], reply["ending"]) == (Action.STOP, "stopped")
        assert link.call("GET", search).json["detail"] == "enough"


@pytest.mark.slow
def test_an_accepted_observation_is_decided_after_a_restart(tmp_path, script):
    script.gate.clear()
    with robot_server(tmp_path, limits=ServerLimits()) as link:
        search = link.open(deadline_s=0.05)
        while not (status := link.call("GET", search).json)["next_sequence"]:
            link.observe(search, body_of(0))
        assert status["state"] == "deciding"
    # What the first server's thread does later is not what this is about.
    shutil.copytree(tmp_path, tmp_path / "copy")
    script.gate.set()
    with robot_server(tmp_path / "copy") as link:
        assert link.answer(search, 0)["action"] == Action.MOVE_FORWARD
        assert link.call("GET", search).json["next_sequence"] == 1


def test_a_search_killed_between_its_last_answer_and_its_end_is_over(tmp_path, script):
    script.length = 0
    with robot_server(tmp_path) as link:
        search = link.open()
        last = link.observe(search, body_of(0))
    (end,) = tmp_path.glob("searches/*/end.json")
    end.unlink()
    with robot_server(tmp_path) as link:
        assert link.observe(search, body_of(0)).content == last.content
        assert link.observe(search, body_of(1)).json["done"]
        while link.call("GET", search).json["state"] != "ended":
            pass
        assert end.exists()


def test_a_damaged_search_does_not_keep_others_from_going_on(tmp_path, caplog):
    with robot_server(tmp_path) as link:
        damaged, good = link.open(), link.open()
        unread = link.open()
        link.observe(unread, body_of(0))
    (tmp_path / "searches" / damaged.rpartition("/")[2] / "search.json").write_text("{")
    steps = tmp_path / "searches" / unread.rpartition("/")[2] / "steps.bin"
    text = b"no decision"
    steps.write_bytes(struct.pack("<II", len(text), zlib.crc32(text)) + text)
    (tmp_path / "searches" / "stray").mkdir()
    with robot_server(tmp_path) as link:
        assert link.call("GET", good).status == 200
        assert link.call("GET", damaged).status == 404
        assert link.call("GET", unread).status == 404
    assert "cannot be taken up" in caplog.text
    caplog.clear()


def test_one_server_at_a_time_uses_a_folder(tmp_path):
    limits = ServerLimits()
    with (
        robot_server(tmp_path),
        pytest.raises(RunFolderError, match="choose another --state"),
        Searches(tmp_path, scripted_plan, limits),
    ):
        pass


class ClimbingAgent(ScriptedAgent):
    """Goes to floor 2 after two steps; a floor's map is as many cells wide as its number says."""

    @property
    def last_step(self) -> StepTrace:
        trace = super().last_step
        return trace.model_copy(update={"floor": 2 if trace.step >= 2 else None})

    @property
    def grid(self) -> OccupancyGrid:
        cells = np.full((1, floor_of(self.last_step)), Cell.FREE, np.uint8)
        return OccupancyGrid(cells, 0.05, (0.0, 0.0))


@pytest.mark.parametrize("is_ended", [False, True])
def test_the_maps_of_all_floors_are_there_before_and_after_a_restart(
    tmp_path, monkeypatch, is_ended
):
    monkeypatch.setattr("servers.robots.ScriptedAgent", ClimbingAgent)
    paths = ("floors", "floors/words", "map.png", "map.png?floor=1", "map.png?floor=2")
    with robot_server(tmp_path) as link:
        search = link.open("quick")
        assert link.call("GET", f"{search}/floors").json == {}
        assert link.call("GET", f"{search}/floors/words").json == {}
        for number in range(4):
            raised = PlanarPose(z=1.5 * number)
            link.observe(search, body_of(number, odom_to_map=raised))
            link.answer(search, number)
        if is_ended:
            link.call("POST", f"{search}/close")
        extents = link.call("GET", f"{search}/floors").json
        assert extents["2"] == link.call("GET", search).json["map"]
        assert extents["2"]["columns"] == extents["1"]["columns"] + 1
        shown = [link.call("GET", f"{search}/{path}").content for path in paths]
        words = "Floor 2 (3.0 m above the start)"
        assert json.loads(shown[1]) == {"1": "Floor 1 (start)", "2": words}
        assert shown[2] == shown[4] != shown[3]
        assert link.call("GET", f"{search}/map.png?floor=3").status == 404
    with robot_server(tmp_path) as link:
        link.answer(search, 3)
        assert [link.call("GET", f"{search}/{path}").content for path in paths] == shown


def test_a_map_that_cannot_be_written_or_is_damaged_takes_no_other_with_it(tmp_path, monkeypatch):
    monkeypatch.setattr("servers.robots.ScriptedAgent", ClimbingAgent)
    with robot_server(tmp_path) as link:
        search = link.open("quick")
        folder = tmp_path / "searches" / search.rpartition("/")[2]
        (folder / "floor_1").write_text("no folder")
        (folder / "floor_plan").mkdir()
        (folder / "floor_plan" / "map.yaml").write_text("of a person")
        for number in range(4):
            link.observe(search, body_of(number))
            link.answer(search, number)
        link.call("POST", f"{search}/close")
        assert link.call("GET", f"{search}/map.png").status == 200
        assert list(link.call("GET", f"{search}/floors").json) == ["2"]
        (folder / "floor_1").unlink()
        (folder / "floor_1").mkdir()
        (folder / "floor_1" / "map.yaml").write_text("damaged")
        assert link.call("GET", f"{search}/map.png?floor=2").status == 200
