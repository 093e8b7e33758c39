"""Shells, terminals and limits in which a search is started: it ends as it does elsewhere."""

import os
import shutil
import subprocess
import sys

import pytest

from eval_runs import SMALL, write_room

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed"),
]

SURROUNDINGS = {
    "closed standard input": "exec 0<&-",
    "all closed": "exec 0<&- 1>&- 2>&-",
    "a terminal of the seventies": "export TERM=dumb LANG=C LC_ALL=C PYTHONUTF8=0 COLUMNS=20",
    "few open files": "ulimit -n 16",
    "no home and no cache": "export HOME=/proc/nowhere HYPERNAV_CACHE=/proc/nowhere",
    "no folder for temporary files": "export TMPDIR=/proc/nowhere",
}


@pytest.mark.parametrize("surroundings", SURROUNDINGS)
def test_a_search_ends_as_elsewhere(surroundings, tmp_path):
    write_room(tmp_path / "room.glb")
    command = f"{sys.executable} -m hypernav find lamp --scene room.glb --max-steps 2 --out out"
    ended = subprocess.run(
        ["bash", "-c", f"{SURROUNDINGS[surroundings]}; {command} {' '.join(SMALL)}"],
        cwd=tmp_path,
        env=os.environ | {"HYPERNAV_CACHE": str(tmp_path)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert ended.returncode == 1, ended.stderr
    assert "Traceback" not in ended.stderr
    assert {"index.html", "result.json"} <= {path.name for path in (tmp_path / "out").iterdir()}
