"""The built-in house, generated once for all tests of a process; it takes seconds."""

import pytest

from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.scenes.scene import Scene


@pytest.fixture(scope="session")
def builtin_scene() -> Scene:
    return generate(house(BUILTIN_HOUSE))
