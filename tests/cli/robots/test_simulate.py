"""`hypernav robot simulate` beside a server that finds the robot's start in its memory."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from box_scenes import room_glb
from hypernav.cli.main import main
from hypernav.robot.server.agents import AgentPlan
from hypernav.robot.wire.requests import OpenSearch
from servers.robots import real_plan, robot_server

SMALL = ["--set", "embodiment.camera.width=160", "embodiment.camera.height=120"]


def searched(tmp_path: Path, port: int, *start: float) -> dict[str, Any]:
    """The result of a search for the bed."""
    out = tmp_path / f"out-{start[0]}"
    command = ["robot", "simulate", "bed", "--scene", str(tmp_path / "room.glb")]
    command += ["--server", f"http://127.0.0.1:{port}", "--out", str(out), *SMALL]
    with pytest.raises(SystemExit) as end:
        main([*command, "--start", *map(str, start)])
    assert end.value.code == 0
    return json.loads((out / "result.json").read_text())


def test_a_second_robot_finds_its_start_in_the_memory_of_the_first(tmp_path, capsys):
    def plan(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home", relocalize=True)

    room_glb(tmp_path / "room.glb")
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
