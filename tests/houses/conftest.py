"""The built-in house, generated once for all tests of a process; it takes seconds."""

import pytest

from hypernav.houses.building import BUILTIN_HOUSE, house
from hypernav.houses.generator import generate
from hypernav.worlds.scenes.scene import Scene


@pytest.fixture(scope="session")
def builtin_scene() -> Scene:
    return generate(house(BUILTIN_HOUSE))
