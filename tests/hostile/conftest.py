"""Compiled kernels before any time limit, and an agent that is slow enough to be interrupted."""

from pathlib import Path

import pytest

from hostile.commands import run


@pytest.fixture(scope="session", autouse=True)
def compiled(tmp_path_factory):
    """A search before all others: the first on a machine compiles, which no limit allows for."""
    folder = tmp_path_factory.mktemp("first")
    ended = run(["find", "bed", "--out", folder, "--quiet"], folder, seconds=300.0)
    assert ended.status == 0, ended.err


@pytest.fixture
def tired() -> Path:
    """The module ``tired``, to be copied for ``--agent tired:Tired``."""
    return Path(__file__).parents[1] / "tired.py"
