"""What a robot stands on is told by heights, and by how much ground it has seen there."""

from dataclasses import replace

import numpy as np

from box_views import FLOOR, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.footing import Footing
from hypernav.mapping.memory.memory import Memory

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
