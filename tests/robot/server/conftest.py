"""A server of robots for each test."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from servers import robots


@pytest.fixture(autouse=True)
def script(monkeypatch) -> robots.Script:
    """What scripted agents do in the test: by default answer at once."""
    script = robots.Script()
    script.gate.set()
    monkeypatch.setattr(robots, "SCRIPT", script)
    return script


@pytest.fixture
def link(tmp_path: Path) -> Iterator[robots.RobotLink]:
    """A client of a server whose agents are scripted."""
    with robots.robot_server(tmp_path) as link:
        yield link
