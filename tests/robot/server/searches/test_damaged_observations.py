"""Thousands of damaged observations: refusals, never an error of ours, and no leak."""

import os
import re
import zlib
from pathlib import Path

import numpy as np
import pytest

from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import RobotLink, robot_server

FREELY = ServerLimits(requests_per_s=1e6, burst=1_000_000, searches=500)
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


def memory_bytes() -> int:
    """Memory that this process has, the server in it included."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * _PAGE_BYTES


def observation(sequence: int, *, kind: int) -> bytes:
    """A valid observation, in one of the formats."""
    seen = BoxRoom(labels=kind != 1).observe()
    facts = ObservationFacts(sequence=sequence, stamp_s=float(sequence), base_to_odom=PlanarPose())
    quality = None if kind == 2 else 90
    return pack_observation(
        facts, seen.rgb, seen.depth, seen.truth, jpeg_quality=quality, raw_depth=kind == 1
    )


def repaired(body: bytes) -> bytes:
    """The checksums of all PNG chunks made right again, so that what is in them is decoded."""
    data = bytearray(body)
    for match in re.finditer(rb"IHDR|IDAT|IEND", body):
        at = match.start()
        length = int.from_bytes(data[at - 4 : at], "big")
        end = at + 4 + length
        if end + 4 <= len(data):
            data[end : end + 4] = zlib.crc32(data[at:end]).to_bytes(4, "big")
    return bytes(data)


def mutated(body: bytes, rng: np.random.Generator) -> bytes:
    """Damage in the images, and now and then in the header."""
    data = bytearray(body)
    first = 0 if rng.random() < 0.1 else body.index(b"\n") + 1
    for _ in range(int(rng.integers(1, 12))):
        at = int(rng.integers(first, len(data)))
        match rng.integers(3):
            case 0:
                data[at] = int(rng.integers(256))
            case 1:
                size = min(int(rng.integers(1, 40)), len(data) - at)
                data[at : at + size] = rng.bytes(size)
            case _:
                size = min(int(rng.integers(1, 400)), len(data) - at)
                other = int(rng.integers(first, len(data) - size + 1))
                data[at : at + size] = data[other : other + size]
    return repaired(bytes(data)) if rng.random() < 0.5 else bytes(data)


def bombard(link: RobotLink, count: int) -> dict[int, int]:
    """Send damaged observations; how many answers of each status came."""
    rng, statuses = np.random.default_rng(16), dict[int, int]()
    search, accepted = link.open("unicorn", max_steps=100_000, deadline_s=20.0), 0
    for number in range(count):
        body = mutated(observation(accepted, kind=number % 3), rng)
        answer = link.observe(search, body)
        statuses[answer.status] = statuses.get(answer.status, 0) + 1
        assert answer.status < 500, answer.content
        assert b"Traceback" not in answer.content
        status = link.call("GET", search).json
        accepted = status["next_sequence"]
        if status["ending"] is not None:  # a pose or a time that can't be right, or the same images
            assert status["ending"] == "robot failed", status["detail"]
            search, accepted = link.open("unicorn", max_steps=100_000, deadline_s=20.0), 0
    assert link.observe(search, observation(accepted, kind=0)).status == 200
    return statuses


def test_damaged_images_are_refused(tmp_path):
    with robot_server(tmp_path, limits=FREELY) as link:
        statuses = bombard(link, 60)
    assert statuses[422] > 20


@pytest.mark.slow
def test_two_thousand_damaged_images_leave_memory_flat(tmp_path):
    with robot_server(tmp_path, limits=FREELY) as link:
        bombard(link, 300)
        before = memory_bytes()
        statuses = bombard(link, 2000)
        grown = memory_bytes() - before
    assert statuses[422] > 800
    assert statuses.keys() <= {200, 409, 422}
    assert grown < 40_000_000
