import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from drawn_grids import drawn
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.inflation import inflate
from hypernav.search.mapping.reachable_area import ReachableArea, find_frontiers

CONFIG = MappingConfig()
CLEARANCE_M = 0.22
OPEN_DOOR = """
    ##########
    #........#
    #.........
    #.........
    #.........
    #........#
    ##########
"""
CLOSED = OPEN_DOOR.replace(".........\n", "........#\n")
ROBOT = Pose2(0.6, 0.7, 0.0)


def test_a_closed_room_has_none():
    assert find_frontiers(drawn(CLOSED, scale=4), ROBOT, CONFIG, CLEARANCE_M) == []


def test_an_open_door_is_one():
    (frontier,) = find_frontiers(drawn(OPEN_DOOR, scale=4), ROBOT, CONFIG, CLEARANCE_M)
    assert frontier.size_m == pytest.approx(0.6, abs=0.05)
    assert frontier.points[:, 0] == pytest.approx(1.975)
    assert frontier.destination == pytest.approx((1.975, 0.7), abs=0.06)
    assert frontier.travel_m == pytest.approx(1.375, abs=0.06)


def test_a_gap_shorter_than_the_least_size_is_none():
    wide = MappingConfig(frontier_min_size_m=0.7)
    assert find_frontiers(drawn(OPEN_DOOR, scale=4), ROBOT, wide, CLEARANCE_M) == []


def test_what_cannot_be_reached_is_none():
    grid = drawn(OPEN_DOOR, scale=4)
    grid.cells[:, 20:22] = Cell.OCCUPIED
    assert find_frontiers(grid, ROBOT, CONFIG, CLEARANCE_M) == []


def test_a_gap_that_the_robot_does_not_fit_through_hides_what_lies_behind():
    grid = drawn(OPEN_DOOR, scale=4)
    grid.cells[:, 20:22] = Cell.OCCUPIED
    grid.cells[11:17, 20:22] = Cell.FREE  # 0.3 m
    assert find_frontiers(grid, ROBOT, CONFIG, CLEARANCE_M) == []


def test_they_come_from_bottom_to_top():
    grid = drawn(OPEN_DOOR, scale=4)
    grid.cells[:, 8:20][:4] = Cell.FREE
    grid.cells[-4:, 8:20] = Cell.FREE
    lowest = [f.points[:, 1].min() for f in find_frontiers(grid, ROBOT, CONFIG, CLEARANCE_M)]
    assert len(lowest) == 3
    assert lowest == sorted(lowest)


def test_a_robot_close_to_a_wall_still_finds_its_way():
    assert (
        len(find_frontiers(drawn(OPEN_DOOR, scale=4), Pose2(0.22, 0.7, 0.0), CONFIG, CLEARANCE_M))
        == 1
    )


def test_an_empty_map_has_none():
    nothing = OccupancyGrid(np.zeros((20, 20), np.uint8), 0.05, (0.0, 0.0))
    assert find_frontiers(nothing, Pose2(0.5, 0.5, 0.0), CONFIG, CLEARANCE_M) == []


@settings(deadline=None)
@given(arrays(np.uint8, (9, 11), elements=st.sampled_from([0, 1, 1, 1, 1, 2])), st.data())
def test_they_border_on_the_unknown_and_can_be_gone_to(coarse, data):
    cells = np.kron(coarse, np.ones((6, 6), np.uint8))
    grid = OccupancyGrid(cells, 0.05, (-1.0, 0.35))
    robot = Pose2(data.draw(st.floats(-1.0, 2.25)), data.draw(st.floats(0.4, 3.0)), 0.0)
    beside_unknown = inflate(
        np.pad(grid.cells == Cell.UNKNOWN, 1, constant_values=True), 0.05, 0.05
    )
    closed = inflate(grid.occupied, CLEARANCE_M, 0.05)
    for frontier in find_frontiers(grid, robot, CONFIG, CLEARANCE_M):
        rows, columns = grid.cells_of(frontier.points).T
        assert (grid.cells[rows, columns] == Cell.FREE).all()
        assert beside_unknown[rows + 1, columns + 1].all()
        assert frontier.size_m == pytest.approx(len(rows) * 0.05)
        assert frontier.size_m >= CONFIG.frontier_min_size_m
        destination = grid.cell_of(*frontier.destination)
        assert grid.cells[destination] == Cell.FREE
        assert not closed[destination]
        straight = robot.distance_to(*frontier.destination)
        assert np.isfinite(frontier.travel_m)
        # The path begins at the open cell nearest to the robot, up to 1 m off in each direction.
        assert frontier.travel_m >= straight - 1.5


def test_reach_measures_the_way_around_a_wall():
    grid = drawn(
        """
        .........
        .........
        .........
        ####.....
        .........
        .........
        .........
        """,
        scale=8,
    )
    reach = ReachableArea.of(grid, Pose2(0.2, 0.2, 0.0), CONFIG, CLEARANCE_M)
    offset = np.array(reach.grid.cell_of(0.2, 2.4))
    around = reach.travel_m[tuple(offset)]
    # The wall's end, a clearance away from it, then up and back.
    assert around == pytest.approx(2 * np.hypot(1.6 + 0.22 * 0.7, 1.0), rel=0.12)


def test_a_robot_on_unknown_ground_reaches_what_is_around_it():
    """Beside the robot lies a speck of free floor, and farther away a hall."""
    cells = np.full((60, 120), Cell.UNKNOWN, np.uint8)
    cells[30, 21] = Cell.FREE
    cells[5:55, 24:115] = Cell.FREE
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    robot = Pose2(1.02, 1.52, 0.0)
    for free_footprint in (True, False):
        config = MappingConfig(free_footprint=free_footprint)
        reach = ReachableArea.of(grid, robot, config, 0.22)
        assert (reach.reachable.sum() > 50 * 90) != free_footprint
        assert not reach.reachable[reach.grid.cells != Cell.FREE].any()
