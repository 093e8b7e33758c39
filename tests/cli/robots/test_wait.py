"""A simulated robot that waits for goals."""

import pytest

from eval_runs import write_room
from hypernav.cli.main import main
from hypernav.cli.robots import wait


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
