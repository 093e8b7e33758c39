"""Names of floors, for models and people."""

import numpy as np
import pytest

from hypernav.core.exploring.floors import KnownFloor
from hypernav.core.geometry.grid import OccupancyGrid


@pytest.mark.parametrize(
    ("above_m", "words"),
    [
        (3.0, "floor 2, 3.0 m higher"),
        (0.4, "floor 2, 0.4 m higher"),
        (-2.64, "floor 2, 2.6 m lower"),
    ],
)
def test_a_floor_is_named_by_its_number_and_height(above_m: float, words: str):
    grid = OccupancyGrid(np.zeros((1, 1), np.uint8), 0.05, (0.0, 0.0))
    assert KnownFloor(1, above_m, grid, (), (), (), (), (), (0.0, 0.0)).words == words
