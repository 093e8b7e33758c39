"""Compiled kernels before any time limit, and an agent that is slow enough to be interrupted."""

from pathlib import Path

import pytest

from hostile.commands import run

_TIRED = '''
import time

from hypernav.build.agents import build_agent
from hypernav.build.presets import preset

class Tired:
    """The agent of this package, slow enough to be interrupted."""

    def __init__(self, embodiment):
        config = preset("default").model_copy(update={"embodiment": embodiment})
        self._agent = build_agent(config).agent

    def reset(self, goal):
        self._agent.reset(goal)

    def act(self, observation):
        time.sleep(0.05)
        return self._agent.act(observation)

    @property
    def last_step(self):
        return self._agent.last_step

    @property
    def grid(self):
        return self._agent.grid
'''


@pytest.fixture(scope="session", autouse=True)
def compiled(tmp_path_factory):
    """A search before all others: the first on a machine compiles, which no limit allows for."""
    folder = tmp_path_factory.mktemp("first")
    ended = run(["find", "bed", "--out", folder, "--quiet"], folder, seconds=300.0)
    assert ended.status == 0, ended.err


@pytest.fixture(scope="session")
def tired(tmp_path_factory) -> Path:
    """The module ``tired``, for ``--agent tired:Tired``."""
    path = tmp_path_factory.mktemp("agents") / "tired.py"
    path.write_text(_TIRED)
    return path
