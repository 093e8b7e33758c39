import math

import numpy as np
import pytest

from certainty import certain
from drawn_grids import drawn
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.verify import position_on_other_side
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.goal_area import GoalArea

CONFIG = MappingConfig()
THING = (4.0, 3.0)
FROM_THE_LEFT = (1.5, 3.0)
ROBOT = Pose2(3.2, 3.0, 0.0)


def hall_with_a_thing():
    grid = drawn("................\n" * 12, scale=10)
    grid.cells[56:64, 76:84] = Cell.OCCUPIED
    return grid


def area_of(points):
    return certain(
        GoalArea.from_points(
            points, resolution_m=0.05, kernel=5, iterations=3, largest_cluster_only=False
        )
    )


def area_of_the_thing():
    x, y = np.meshgrid(np.arange(3.8, 4.2, 0.02), np.arange(2.8, 3.2, 0.02))
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.4)], axis=1)
    return area_of(points)


def test_it_lies_on_another_side_near_enough_and_in_sight():
    position = position_on_other_side(
        hall_with_a_thing(), ROBOT, area_of_the_thing(), FROM_THE_LEFT, CONFIG, 0.22
    )
    away = np.array(position) - THING
    assert 1.5 <= np.hypot(*away) <= 3.0
    before = np.array(FROM_THE_LEFT) - THING
    cosine = away @ before / np.hypot(*away) / np.hypot(*before)
    assert math.degrees(math.acos(cosine)) >= 60.0


@pytest.mark.parametrize("robot", [(3.2, 4.6), (3.2, 1.4), (6.5, 5.2), (7.2, 0.8), (0.7, 5.2)])
def test_of_all_such_positions_it_is_nearest_to_the_robot(robot):
    area = area_of_the_thing()
    found = position_on_other_side(
        hall_with_a_thing(), Pose2(robot[0], robot[1], 0.0), area, FROM_THE_LEFT, CONFIG, 0.22
    )
    turns, away_m = np.meshgrid(np.radians(np.arange(62.0, 299.0)), np.linspace(1.55, 2.95, 30))
    x, y = THING[0] - away_m * np.cos(turns), THING[1] - away_m * np.sin(turns)
    inside = (abs(x - 4.0) < 3.7) & (abs(y - 3.0) < 2.7)
    nearest_m = np.hypot(x[inside] - robot[0], y[inside] - robot[1]).min()
    assert math.dist(certain(found), robot) == pytest.approx(nearest_m, abs=0.25)


def test_a_side_that_a_wall_hides_does_not_count():
    grid = hall_with_a_thing()
    area = area_of_the_thing()
    free = certain(position_on_other_side(grid, ROBOT, area, FROM_THE_LEFT, CONFIG, 0.22))
    below = free[1] < THING[1]
    rows = slice(46, 48) if below else slice(72, 74)
    grid.cells[rows, 30:130] = Cell.OCCUPIED
    other = certain(position_on_other_side(grid, ROBOT, area, FROM_THE_LEFT, CONFIG, 0.22))
    assert (other[1] < THING[1]) != below or abs(other[1] - THING[1]) < 0.8


def test_in_a_niche_there_is_no_other_side():
    grid = hall_with_a_thing()
    grid.cells[:50], grid.cells[70:], grid.cells[:, 86:] = (Cell.OCCUPIED,) * 3
    position = position_on_other_side(grid, ROBOT, area_of_the_thing(), FROM_THE_LEFT, CONFIG, 0.22)
    assert position is None


@pytest.mark.parametrize("shift", [0.0, -7.35])
def test_the_origin_of_the_map_does_not_matter(shift):
    grid = hall_with_a_thing()
    moved = type(grid)(grid.cells, grid.resolution_m, (shift, 0.0))
    area = area_of_the_thing()
    area = area_of(
        np.column_stack(
            [area.seen_points + np.array([shift, 0.0]), np.full(len(area.seen_points), 0.4)]
        )
    )
    robot = Pose2(ROBOT.x + shift, ROBOT.y, 0.0)
    seen_from = (FROM_THE_LEFT[0] + shift, FROM_THE_LEFT[1])
    x, y = certain(position_on_other_side(moved, robot, area, seen_from, CONFIG, 0.22))
    expected = position_on_other_side(grid, ROBOT, area_of_the_thing(), FROM_THE_LEFT, CONFIG, 0.22)
    assert (x - shift, y) == pytest.approx(expected, abs=0.25)
