"""Alike things on both sides of a wall are two, and one thing seen from two sides is one."""

import math

import numpy as np
import pytest

from box_views import CAMERA, SolidBox, room, turning, view_of
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.thing import Thing
from hypernav.search.memory.things import Things

SENSOR = CameraConfig(width=CAMERA.width, height=CAMERA.height)
HALL = room(8.0, 6.0)
WALL: SolidBox = ((3.95, 0.0, 0.0), (4.05, 6.0, 2.5))
WEST, EAST = Pose2(2.0, 3.0, 0.0), Pose2(6.0, 3.0, math.pi)
SIDES = (WEST, EAST)


def hanging(x: float) -> SolidBox:
    """A mirror, 3 cm thick."""
    return ((x - 0.015, 2.7, 1.2), (x + 0.015, 3.3, 1.8))


def seen_from(
    *robots: Pose2,
    solids: list[SolidBox],
    around: list[SolidBox],
    looked_around: bool = False,
) -> tuple[Thing, ...]:
    """The things that a robot knows, which names all of some solids a mirror, sofa or shelf."""
    things, floor_map = Things(), TopDownMap(MappingConfig(), Embodiment(camera=SENSOR))
    for robot in robots:
        for pose in [*turning(*robot.xy, turns=6), robot] if looked_around else [robot]:
            seen, without = view_of([*around, *solids], pose), view_of(around, pose)
            floor_map.integrate(seen)
            rows, columns = np.nonzero(seen.depth != without.depth)
            found = []
            if len(rows):
                low, high = (columns.min(), rows.min()), (columns.max() + 1, rows.max() + 1)
                mask = seen.depth != without.depth
                found = [Detection(Box(*map(float, (*low, *high))), 1.0, "thing", mask)]
            things = things.after_image(seen, found, SENSOR, search=1, floor_map=floor_map)
    return things.known


@pytest.mark.parametrize(("order", "looked_around"), [(1, False), (-1, False), (1, True)])
def test_mirrors_on_both_sides_of_a_wall_are_two(order: int, looked_around: bool):
    west, east = seen_from(
        *SIDES[::order],
        solids=[hanging(3.93), hanging(4.07)],
        around=[*HALL, WALL],
        looked_around=looked_around,
    )[::order]
    assert west.high[0] < 4.0 < east.low[0]


def test_each_is_known_again_from_its_own_side():
    again = (Pose2(2.0, 4.5, -0.6), Pose2(6.0, 1.5, 2.5), WEST, EAST)
    known = seen_from(*SIDES, *again, solids=[hanging(3.93), hanging(4.07)], around=[*HALL, WALL])
    assert len(known) == 2
    assert all(one.seen >= 3 for one in known)


STANDING: dict[str, SolidBox] = {
    "a table": ((3.8, 2.4, 0.0), (4.2, 3.6, 0.75)),
    "a shelf in the midst of a room": ((3.85, 2.0, 0.0), (4.15, 4.0, 1.9)),
    "a shelf that ends at a wall": ((3.85, 0.0, 0.0), (4.15, 2.2, 1.9)),
}


@pytest.mark.parametrize("name", STANDING)
def test_what_stands_free_is_one_thing_from_both_sides(name: str):
    solid = STANDING[name]
    y = (solid[0][1] + solid[1][1]) / 2.0
    sides = [Pose2(x, y, yaw) for x, yaw in ((2.0, 0.0), (6.0, math.pi))]
    (one,) = seen_from(*sides, solids=[solid], around=HALL)
    assert one.low[0] == pytest.approx(solid[0][0], abs=0.1)
    assert one.high[0] == pytest.approx(solid[1][0], abs=0.1)


def test_a_wall_that_ends_right_beside_it_parts_nothing():
    end: SolidBox = ((3.95, 0.0, 0.0), (4.05, 3.5, 2.5))
    assert len(seen_from(*SIDES, solids=[hanging(3.93), hanging(4.07)], around=[*HALL, end])) == 1
