"""A robot and a navigation in other processes that speak nothing but DDS, on the loopback."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from loopback import DOMAIN

PATIENT = ("timing.find_s=200", f"domain={DOMAIN}")
"""Processes start slowly on a busy machine."""
_TESTS = Path(__file__).parent


class DdsRobot:
    """The robot's process."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def told(self, command: str) -> dict[str, Any]:
        """Give a command, and hear how the robot is."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{command}\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())


@contextmanager
def robot_in(
    scene: str,
    start: tuple[float, float, float],
    *options: str,
    camera: tuple[int, int] = (160, 120),
) -> Iterator[DdsRobot]:
    """A robot in a building; see `servers/dds_robot.py`."""
    words = ["--scene", scene, "--domain", DOMAIN, "--start", *start, "--camera", *camera]
    words += options
    with _running("dds_robot.py", *words) as process:
        yield DdsRobot(process)


@contextmanager
def nav2(*options: str) -> Iterator[None]:
    """A navigation; see `servers/dds_nav2.py`."""
    with _running("dds_nav2.py", "--domain", DOMAIN, *options):
        yield


@contextmanager
def driver(*assignments: str) -> Iterator[subprocess.Popen[str]]:
    """hypernav in a process that may be killed; see `servers/dds_driver.py`."""
    with _running("dds_driver.py", *PATIENT, *assignments) as process:
        yield process


@contextmanager
def _running(server: str, *words: object) -> Iterator[subprocess.Popen[str]]:
    path = os.pathsep.join([str(_TESTS), *filter(None, [os.environ.get("PYTHONPATH")])])
    with subprocess.Popen(
        [sys.executable, str(_TESTS / "servers" / server), *map(str, words)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": path},
    ) as process:
        try:
            yield process
        finally:
            process.kill()
