"""What a robot stands on is told by heights, and by how much ground it has seen there."""

import math
from dataclasses import replace

import numpy as np
import pytest

from box_views import FLOOR, SolidBox, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.footing import Footing
from hypernav.search.memory.memory import Memory

CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))


def test_ground_that_nobody_has_seen_makes_no_floor():
    """Around the robot, where its camera sees no ground, a landing seems to go on behind walls."""
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CLIMBER.camera.intrinsics))
    ground = memory.ground_around((0.0, 0.0), down=False)
    footing = replace(memory.footing, floor_z=-1.5)
    assert footing.has_room(ground)
    assert ground.area_m2(ground.reached & ~ground.seen) > 1.0
    x, y = np.meshgrid(*(np.arange(side) for side in ground.seen.shape[::-1]))
    row, column = ground.grid.cell_of(0.0, 0.0)
    is_near = np.hypot(y - row, x - column) * ground.grid.resolution_m < 1.5
    assert not footing.has_room(replace(ground, seen=ground.seen & is_near))


@pytest.mark.parametrize(("length_m", "is_floor"), [(1.7, False), (4.0, True)])
def test_a_wide_half_landing_is_no_floor(length_m: float, is_floor: bool):
    """It lies between two flights of 1.5 m; a room at this height is a floor."""
    landing: SolidBox = ((0.0, 0.0, -0.2), (length_m, 3.2, 0.0))
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    for y, turn in ((0.4, 1.0), (2.8, -1.0)):
        for share in (0.0, 0.5, 1.0):
            pose = Pose2(0.4, y, turn * share * math.pi / 2.0)
            memory.follow(view_of([landing], pose, camera=CLIMBER.camera.intrinsics))
    ground = memory.ground_around((0.4, 2.8), down=False)
    assert replace(memory.footing, floor_z=-1.5).has_room(ground) is is_floor


def test_a_robot_that_can_hardly_move_a_storey_away_is_on_another_floor():
    footing = Footing.on_level_ground(Pose2(0.0, 0.0, 0.0), 0.0, 0.0)
    below = footing.after(Pose2(0.3, 0.0, 0.0), -2.6, 0.3)
    assert below.is_storey_away
    assert not below.may_be_another_floor
    assert below.as_if_walked().may_be_another_floor


def test_ground_that_seems_somewhat_higher_or_lower_than_the_robot_is_its_floor():
    """Poses are those of a body on a navigation mesh, which does not lie on the floor."""
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CLIMBER.camera.intrinsics))
    ground = memory.ground_around((0.0, 0.0), down=False)
    for z, is_its_own in ((0.13, True), (-0.13, True), (0.2, False), (-0.2, False)):
        footing = replace(memory.footing, floor_z=-2.6, z=z, level_z=z)
        assert footing.has_room(ground) == is_its_own


@pytest.mark.parametrize(("area_m2", "is_floor"), [(0.8, False), (1.2, True)])
def test_a_storey_away_a_square_metre_at_the_head_of_stairs_is_a_floor(
    area_m2: float, is_floor: bool
):
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CLIMBER.camera.intrinsics))
    ground = memory.ground_around((0.0, 0.0), down=False)
    level = ground.seen & ground.between(-0.05, 0.05)
    level.flat[np.flatnonzero(level)[round(area_m2 / ground.grid.resolution_m**2) :]] = False
    few = replace(ground, seen=level)
    assert replace(memory.footing, floor_z=-2.6).has_room(few) is is_floor
    assert not replace(memory.footing, floor_z=-1.5).has_room(few)
