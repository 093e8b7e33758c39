"""The lines of libraries stay off the command line; those of a user's own code do not."""

import os
import subprocess
import sys

import pytest

from hypernav.app.cli.main import main

SCRIPT = """
import logging, sysconfig, warnings
from hypernav.app.cli.main import silence_libraries

silence_libraries()
theirs = sysconfig.get_path("purelib") + "/trimesh/load.py"
for file, said in ((theirs, "theirs"), ("my.py", "mine")):
    warnings.warn_explicit(f"{said} warns", UserWarning, file, 1)
    record = logging.LogRecord("a", logging.WARNING, file, 1, f"{said} logs", (), None)
    logging.getLogger("a").handle(record)
"""


def test_only_a_users_own_code_is_heard():
    plain = {key: value for key, value in os.environ.items() if key != "PYTHONWARNINGS"}
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=plain, capture_output=True, text=True, check=True
    )
    assert ended.stderr == "my.py:1: UserWarning: mine warns\nmine logs\n"


def test_the_program_silences_them_and_a_call_of_it_does_not(monkeypatch):
    called = []
    monkeypatch.setattr("hypernav.app.cli.main.silence_libraries", lambda: called.append(True))
    monkeypatch.setattr("hypernav.app.cli.main._status", lambda _: 0)
    monkeypatch.setattr("hypernav.app.cli.main._end_without_threads", lambda _: None)
    for arguments in ([], None):
        with pytest.raises(SystemExit):
            main(arguments)
    assert called == [True]
