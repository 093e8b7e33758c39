"""`hypernav robot simulate` beside a server with a memory."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from box_scenes import room_glb
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.cli.main import main
from hypernav.lab.episodes.recorder import EpisodeRecorder
from hypernav.robot.server.searches.agents import AgentPlan, PlanAgent
from hypernav.robot.wire.requests import OpenSearch
from hypernav.search.memory.store.memory_reader import read_index
from servers.robots import real_plan, robot_server

SMALL = ["--set", "embodiment.camera.width=160", "embodiment.camera.height=120"]


def searched(tmp_path: Path, port: int, *start: float, status: int = 0) -> dict[str, Any]:
    """The result of a search for the bed, which ends with an exit status."""
    out = tmp_path / f"out-{start[0]}"
    command = ["robot", "simulate", "bed", "--scene", str(tmp_path / "room.glb")]
    command += ["--server", f"http://127.0.0.1:{port}", "--out", str(out), *SMALL]
    with pytest.raises(SystemExit) as end:
        main([*command, "--start", *map(str, start)])
    assert end.value.code == status
    return json.loads((out / "result.json").read_text())


@pytest.fixture
def plan(tmp_path: Path) -> PlanAgent:
    """Searches with a memory in which robots don't know their start; makes their room, too."""
    room_glb(tmp_path / "room.glb")

    def lost(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home", relocalize=True)

    return lost


@pytest.mark.slow
def test_robots_from_all_starts_share_one_memory_in_the_frame_of_the_building(tmp_path):
    room_glb(tmp_path / "room.glb")

    def remembering(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home")

    with robot_server(tmp_path / "state", remembering) as link:
        searched(tmp_path, link.port, 1.0, 2.0, 0.0)
        after_one = things(tmp_path / "home")
        searched(tmp_path, link.port, 2.5, 2.5, 200.0)
    after_two = things(tmp_path / "home")
    assert [label for label, _ in after_two] == [label for label, _ in after_one]
    scene = load_scene(str(tmp_path / "room.glb"))
    (bed,) = [one for one in scene.instances if one.label and one.label.category == "bed"]
    (at,) = [middle for label, middle in after_two if label == "bed"]
    assert all(bed.box_min[k] <= at[k] <= bed.box_max[k] for k in range(2))


def things(folder: Path) -> list[tuple[str, tuple[float, ...]]]:
    """Label and middle of all that is remembered, ``map`` frame of the memory, metres."""
    index = read_index(folder)
    assert index is not None
    known = [one.thing() for floor in index.floors for one in floor.things]
    return sorted((one.label, tuple(one.position)) for one in known)


@pytest.mark.slow
def test_a_second_robot_finds_its_start_in_the_memory_of_the_first(tmp_path, plan, capsys):
    with robot_server(tmp_path / "state", plan) as link:
        first = searched(tmp_path, link.port, 1.0, 2.0, 0.0)
        assert "found_start" not in first
        assert first["memory"] == {"earlier_searches": 0}
        result = searched(tmp_path, link.port, 2.5, 2.5, 200.0)
    found = result["found_start"]
    assert (found["sure"], found["floor"], found["turns"]) == (True, 1, 11)
    page = (tmp_path / "out-2.5" / "index.html").read_text()
    assert "found on floor 1 by one turn" in page
    assert result["memory"] == {"earlier_searches": 1}
    assert "a building where it had been in 1 earlier search" in page
    assert "start found on floor 1 of the memory by one turn" in capsys.readouterr().err
    lines = (tmp_path / "out-2.5" / "trace.jsonl").read_text().splitlines()
    first, last = json.loads(lines[0]), json.loads(lines[-1])
    assert result["steps"] == len(lines)
    assert first["step"] == 11  # those of the turn before have no trace
    assert last["action"] == 0


@pytest.mark.slow
def test_a_robot_that_is_stopped_while_it_turns_has_made_no_step_with_the_memory(
    tmp_path, plan, monkeypatch
):
    def stopped(client, robot, server, opened, views, status):
        ending = None
        for step in client:
            if step.reply.sequence == 3:
                link.call("POST", f"/v1/searches/{opened.id}/stop")
            ending = step.reply.ending
        return ending, None

    with robot_server(tmp_path / "state", plan) as link:
        searched(tmp_path, link.port, 1.0, 2.0, 0.0)
        monkeypatch.setattr("hypernav.app.cli.robots.simulate._search", stopped)
        result = searched(tmp_path, link.port, 2.5, 2.5, 200.0, status=1)
    assert result["steps"] == 0
    assert "memory" not in result
    assert "found_start" not in result
    page = (tmp_path / "out-2.5" / "index.html").read_text()
    assert "The search ended before its first step." in page


@pytest.mark.slow
def test_an_interrupted_search_leaves_its_page(tmp_path, monkeypatch):
    room_glb(tmp_path / "room.glb")
    add, steps = EpisodeRecorder.add, list[int]()

    def interrupted(recorder: EpisodeRecorder, *given: Any) -> None:
        add(recorder, *given)
        steps.append(1)
        if len(steps) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(EpisodeRecorder, "add", interrupted)
    with robot_server(tmp_path / "state", real_plan) as link:
        result = searched(tmp_path, link.port, 1.0, 2.0, 0.0, status=130)
        (known,) = link.call("GET", "/v1/searches").json
    assert (result["outcome"], result["steps"]) == ("interrupted", 3)
    assert (tmp_path / "out-1.0" / "index.html").exists()
    assert known["ending"] == "closed"
