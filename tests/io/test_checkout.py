"""Of which commit a run is said to be."""

import subprocess
from pathlib import Path

import pytest

import hypernav
from hypernav.io import checkout

ROOT = Path(hypernav.__file__).parents[2]


def git(*words: str) -> str:
    return subprocess.run(
        ["git", "-C", str(ROOT), *words], check=True, capture_output=True, text=True
    ).stdout


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="the package is not a checkout's")
def test_what_runs_from_a_checkout_is_of_its_commit() -> None:
    said = checkout.commit.__wrapped__()
    name = said.removesuffix("+")
    assert len(name) >= 4
    assert git("rev-parse", "HEAD").startswith(name)
    assert said.endswith("+") == bool(git("status", "--porcelain", "--untracked-files=no"))


def test_another_projects_commit_is_not_ours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").mkdir()
    monkeypatch.setattr(checkout, "_PACKAGE", tmp_path / ".venv" / "site-packages" / "hypernav")
    assert checkout.commit.__wrapped__() == ""
