import hashlib
import os
import subprocess
import sys

import pytest

from hypernav.simulator.houses.assembly import CompactScene
from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.generator import build_compact, plan_of
from hypernav.simulator.houses.textures.library import texture

_SCRIPT = """
from hypernav.simulator.houses.building import house
from hypernav.simulator.houses.generator import build_compact
import test_house_bytes
print(test_house_bytes.digest(build_compact(house({number}))))
"""


def digest(house: CompactScene) -> str:
    """Digest of everything that a house consists of, texture images included."""
    sha = hashlib.sha256()
    for array in (house.positions, house.normals, house.uv, house.faces):
        sha.update(array.tobytes())
    for array in (house.face_material, house.face_instance):
        sha.update(array.tobytes())
    sha.update(repr((house.finishes, house.names, house.rooms, house.labels)).encode())
    for key in dict.fromkeys(f.texture for f in house.finishes if f.texture):
        sha.update(texture(key).tobytes())
    return sha.hexdigest()


def elsewhere(number: int, hash_seed: str) -> str:
    """Digest that another process computes, with another order of sets and hashes."""
    paths = (os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")]))
    run = subprocess.run(
        [sys.executable, "-c", _SCRIPT.format(number=number)],
        env={**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=True,
    )
    return run.stdout.strip()


@pytest.mark.slow
def test_two_processes_build_the_same_bytes():
    assert elsewhere(BUILTIN_HOUSE, "1") == digest(build_compact(house(BUILTIN_HOUSE)))


@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 11, 1002, 123_456])
def test_more_processes_build_the_same_bytes(number: int):
    assert elsewhere(number, "1") == elsewhere(number, "2")


def test_other_numbers_are_other_houses():
    assert plan_of(house(3)) != plan_of(house(4))


@pytest.mark.freeze
def test_500_houses_in_a_row_can_be_built():
    for number in range(10_000, 10_500):
        assert len(build_compact(house(number)).names) > 40
