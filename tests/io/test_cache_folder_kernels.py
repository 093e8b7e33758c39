"""Kernels are kept somewhere, or for one run alone, which is said."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hypernav.io.cache_folder import choose_kernel_folder, kernels_are_kept, why_not_kept

VARIABLES = ("NUMBA_CACHE_DIR", "HYPERNAV_KERNELS_FOR_ONE_RUN", "HYPERNAV_CACHE", "XDG_CACHE_HOME")


@pytest.fixture
def nowhere(tmp_path, monkeypatch) -> Path:
    """A path at which nothing can be made, even by root: below a file."""
    for name in VARIABLES:
        monkeypatch.setenv(name, "")  # so that all are as they were afterwards
        monkeypatch.delenv(name)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file" / "cache"))
    return tmp_path / "file" / "package"


def test_a_place_that_numba_can_use_stays(nowhere, tmp_path, monkeypatch):
    choose_kernel_folder(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    choose_kernel_folder(nowhere)
    assert "NUMBA_CACHE_DIR" not in os.environ


def test_without_one_our_own_cache_keeps_them(nowhere, tmp_path, monkeypatch):
    monkeypatch.setenv("HYPERNAV_CACHE", str(tmp_path / "mine"))
    choose_kernel_folder(nowhere)
    assert os.environ["NUMBA_CACHE_DIR"] == str(tmp_path / "mine" / "kernels")
    assert kernels_are_kept()


def test_without_any_they_are_made_for_this_run_which_is_said(nowhere):
    choose_kernel_folder(nowhere)
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    assert folder.is_dir()
    assert not kernels_are_kept()
    assert "can be written; name a folder that can be in HYPERNAV_CACHE" in why_not_kept()
    folder.rmdir()


SCRIPT = """
import os
import hypernav.io.cache_folder as kernel_folder

kernel_folder.choose_kernel_folder(__import__("pathlib").Path(os.environ["NOWHERE"]))
from hypernav.app.warmup.background import warm_up_in_background

os.cpu_count = lambda: 1
with warm_up_in_background(print):
    print(os.environ["NUMBA_CACHE_DIR"])
"""


def test_the_first_line_of_a_search_says_so_and_nothing_is_left_behind(nowhere):
    environment = {**os.environ, "NOWHERE": str(nowhere)}
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    said, folder = ended.stdout.splitlines()
    assert said == why_not_kept()
    assert not Path(folder).exists()
