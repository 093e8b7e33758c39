"""What is remembered from another level of a floor lies as high above the floor as it does."""

import numpy as np
import pytest

from box_views import CAMERA, FLOOR, view_of
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import Floor, counted_from
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception

GOAL, ROBOT = Goal("chest"), Pose2(1.0, 2.0, 0.0)
CHEST = ((3.0, 1.6, 0.0), (3.6, 2.4, 0.6))
LEVELS = [0.3, 0.6, 0.9, -0.6]


class Shows:
    """Shows the goal wherever the image differs from one without it."""

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        mask = observation.depth != view_of([FLOOR], ROBOT).depth
        rows, columns = np.nonzero(mask)
        if not len(rows):
            return []
        corner = (columns.max() + 1.0, rows.max() + 1.0)
        return [
            Detection(Box(float(columns.min()), float(rows.min()), *corner), 0.9, "chest", mask)
        ]


def remembers() -> Floor:
    floor = Memory(MappingConfig(), Embodiment(camera=CameraConfig())).floor
    floor.begin_search(1, lasts=True)
    return floor


def look(floor: Floor, ground_m: float, *, shows: bool = True) -> None:
    """Look from the floor, as if the robot's ground were so high above the floor below it."""
    local = LocalPerception(
        Shows(),
        DepthCutSegmenter(),
        LocalConfig(),
        CameraConfig(width=CAMERA.width, height=CAMERA.height),
        cell_size_m=0.05,
        tells_floors=True,
    )
    seen = view_of([FLOOR, CHEST] if shows else [FLOOR], ROBOT)
    local.look(counted_from(ground_m, seen), GOAL, floor, ground_m=ground_m)


@pytest.mark.parametrize("ground_m", LEVELS)
def test_a_thing_is_one_from_all_levels_and_as_high(ground_m: float):
    level, split = remembers(), remembers()
    look(level, 0.0)
    look(split, 0.0)
    look(split, ground_m)
    (there,), (again,) = level.things.known, split.things.known
    assert again.seen == 2
    assert (*again.low, *again.high) == pytest.approx((*there.low, *there.high), abs=0.01)


@pytest.mark.parametrize("ground_m", LEVELS)
def test_an_image_without_a_thing_misses_it_from_all_levels(ground_m: float):
    floor = remembers()
    look(floor, 0.0)
    look(floor, ground_m, shows=False)
    assert [one.missed for one in floor.things.known] == [1]
