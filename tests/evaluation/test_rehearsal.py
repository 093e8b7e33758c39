import os
import subprocess
import sys

import pytest

from hypernav.evaluation import rehearsal as module
from hypernav.evaluation.rehearsal import FIRST_RUN, rehearsal, rehearse

ENTER = (
    "from hypernav.evaluation.rehearsal import is_compiled, rehearsal\n"
    "print(is_compiled())\n"
    "with rehearsal(print): pass"
)


def test_an_agent_can_rehearse():
    rehearse()


def test_a_machine_that_has_compiled_hears_nothing_and_starts_no_process(monkeypatch):
    monkeypatch.setattr(module, "is_compiled", lambda: True)
    monkeypatch.setattr(subprocess, "Popen", None)
    said = []
    with rehearsal(said.append):
        pass
    assert said == []


def test_an_empty_cache_is_a_first_run_and_leaves_no_process(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    ended = subprocess.run(
        [sys.executable, "-c", ENTER],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert ended.stdout.splitlines() == ["False", FIRST_RUN]


def test_an_error_ends_the_rehearsal(monkeypatch):
    started = []

    class Noted(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            started.append(self)

    monkeypatch.setattr(module, "is_compiled", lambda: False)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(subprocess, "Popen", Noted)
    with pytest.raises(KeyboardInterrupt), rehearsal(lambda words: None):
        raise KeyboardInterrupt
    assert [process.poll() is not None for process in started] == [True]
