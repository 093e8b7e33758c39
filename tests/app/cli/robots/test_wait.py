"""A simulated robot that waits for goals."""

from dataclasses import replace

import pytest

from eval_runs import write_room
from hypernav.app.cli.main import main
from hypernav.app.cli.robots import wait
from hypernav.robot.client.links import HttpServer
from hypernav.robot.wire.requests import GivenGoal
from hypernav.search.memory.store.memory_reader import read_index
from servers.robots import real_plan, robot_server


def test_a_server_that_is_not_there_is_named_again_and_again(tmp_path, monkeypatch, capsys):
    glb = write_room(tmp_path / "room.glb")
    now_s = [0.0]

    def pass_time(seconds: float) -> None:
        now_s[0] += seconds
        if now_s[0] > 11.0:
            raise KeyboardInterrupt

    monkeypatch.setattr(wait.time, "sleep", pass_time)
    monkeypatch.setattr(wait.time, "monotonic", lambda: now_s[0])
    with pytest.raises(SystemExit, match="130"):
        main(["robot", "wait", "--server", "http://nohost.invalid", "--scene", str(glb)])
    said = capsys.readouterr().err
    assert said.count("finds no server at http://nohost.invalid") == 3  # at 0, 5 and 10 s
    assert "trying again" in said


@pytest.mark.slow
def test_it_keeps_its_place_in_the_memory_from_search_to_search(tmp_path, monkeypatch):
    glb, home = write_room(tmp_path / "room.glb"), tmp_path / "home"
    goals = iter([GivenGoal(goal="bed", key=f"key-of-search-{k}") for k in range(2)])

    def next_goal(server: HttpServer, name: str) -> GivenGoal:
        if (given := next(goals, None)) is None:
            raise KeyboardInterrupt
        return given

    monkeypatch.setattr(HttpServer, "wait_for_goal", next_goal)
    monkeypatch.setattr(wait, "_PACE", None)
    start = ("--start", "1.0", "1.5", "180")
    with robot_server(
        tmp_path / "state", lambda request: replace(real_plan(request), memory=home), memory=home
    ) as link:
        address = f"http://127.0.0.1:{link.port}"
        with pytest.raises(SystemExit, match="130"):
            main(["robot", "wait", "--server", address, "--scene", str(glb), *start])
    index = read_index(home)
    assert index is not None
    assert [one.outcome for one in index.history] == ["found", "found"]
