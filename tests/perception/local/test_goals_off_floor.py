"""A goal that is seen below or above the room of the robot's floor is on another floor."""

import numpy as np
import pytest

from box_views import CAMERA, view_of
from certainty import certain
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.memory import Memory
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.depth_cut import DepthCutSegmenter
from hypernav.perception.local.local_perception import LocalPerception

GOAL, ROBOT = Goal("thing"), Pose2(1.0, 2.0, 0.5)
BELOW, ABOVE = -1.6, 3.3
"""Heights of a thing's middle, metres: on the floor below, and on the one above."""


class Shows:
    """Shows the goal in one box of every image, with its mask."""

    def __init__(self, box: Box, score: float = 0.9):
        self.box, self.score = box, score

    def detect(self, observation, goal):
        mask = self.box.mask(observation.camera.width, observation.camera.height)
        return [Detection(self.box, self.score, "thing", mask)]


def looked_at(away_m: float, height_m: float, *, tells_floors: bool = True, score: float = 0.9):
    """The floor and the record after an image of a cube straight ahead of the robot."""
    x, y = ROBOT.x + away_m * np.cos(ROBOT.yaw), ROBOT.y + away_m * np.sin(ROBOT.yaw)
    cube = ((x - 0.3, y - 0.3, height_m - 0.3), (x + 0.3, y + 0.3, height_m + 0.3))
    seen = view_of([cube], ROBOT)
    row = CAMERA.cy + CAMERA.fy * (0.88 - height_m) / away_m
    box = Box(CAMERA.cx - 6.0, row - 6.0, CAMERA.cx + 6.0, row + 6.0)
    floor = Memory(MappingConfig(), Embodiment()).floor
    local = LocalPerception(
        Shows(box, score),
        DepthCutSegmenter(),
        LocalConfig(),
        CameraConfig(),
        cell_size_m=0.05,
        tells_floors=tells_floors,
    )
    (record,) = local.look(seen, GOAL, floor)
    return floor, record


@pytest.mark.parametrize("height_m", [BELOW, ABOVE])
def test_it_is_no_candidate_here_and_its_position_is_kept(height_m: float):
    floor, record = looked_at(4.5, height_m)
    assert not record.accepted
    assert "another floor" in record.reason
    assert floor.search.evidence.candidates == ()
    x, y, z = certain(floor.search.seen_off_floor)
    assert np.hypot(x - ROBOT.x, y - ROBOT.y) == pytest.approx(4.5, abs=0.4)
    assert z == pytest.approx(height_m, abs=0.3)


@pytest.mark.parametrize("height_m", [-0.3, 0.4, 2.7])
def test_what_is_in_the_room_is_a_candidate(height_m: float):
    floor, record = looked_at(4.0, height_m)
    assert record.accepted
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize("height_m", [BELOW, ABOVE])
def test_floors_are_told_apart_only_where_it_is_wanted(height_m: float):
    floor, record = looked_at(4.5, height_m, tells_floors=False)
    assert record.accepted
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize(("height_m", "away_m"), [(-2.3, 8.0), (3.4, 6.0)])
def test_out_of_range_its_line_of_sight_tells_the_floor(height_m: float, away_m: float):
    """It ends a storey away: nothing else tells how far away the goal is."""
    floor, record = looked_at(away_m, height_m)
    assert not record.accepted
    assert floor.search.evidence.far_position is None
    x, y, z = certain(floor.search.seen_off_floor)
    assert np.hypot(x - ROBOT.x, y - ROBOT.y) == pytest.approx(away_m, abs=0.2)
    assert z == pytest.approx(height_m, abs=0.1)


def test_out_of_range_what_may_be_in_the_room_is_far_away():
    floor, _ = looked_at(8.0, 0.4)
    assert floor.search.seen_off_floor is None
    assert floor.search.evidence.far_position is not None


@pytest.mark.parametrize("away_m", [4.5, 8.0])
def test_a_doubtful_detection_leads_to_no_other_floor(away_m: float):
    floor, _ = looked_at(away_m, -2.3 if away_m > 5.0 else BELOW, score=0.2)
    assert floor.search.seen_off_floor is None
