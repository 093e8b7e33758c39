import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from drawn_grids import divide_into_blocks, drawn
from hypernav.core.exploring.floors import Drop, WayOut
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.blocks import drop_blocks, stairs_blocks
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.inflation import inflate
from hypernav.search.mapping.reachable_area import ReachableArea

CONFIG = MappingConfig()
CLEARANCE_M = 0.22
ORIGIN = Pose2(0.0, 0.0, 0.0)
FLOOR = np.full((100, 140), Cell.FREE, np.uint8)  # 7 m wide, 5 m high
CORNER = (-2.5, -1.0)


def test_numbers_run_as_one_reads():
    blocks = divide_into_blocks(
        OccupancyGrid(FLOOR, 0.05, CORNER), Pose2(0, 0, 0), CONFIG, CLEARANCE_M
    )
    assert [b.number for b in blocks] == list(range(1, len(blocks) + 1))
    corners = [(-b.y_min, b.x_min) for b in blocks]
    assert corners == sorted(corners)
    assert (blocks[0].x_min, blocks[0].y_min) == (-4.0, 2.0)
    assert len(blocks) == 5 * 3


def test_squares_stay_where_they_are_when_the_map_grows():
    small = divide_into_blocks(
        OccupancyGrid(FLOOR, 0.05, CORNER), Pose2(0, 0, 0), CONFIG, CLEARANCE_M
    )
    cells = np.pad(FLOOR, ((37, 20), (51, 10)), constant_values=Cell.FREE)
    corner = (CORNER[0] - 51 * 0.05, CORNER[1] - 37 * 0.05)
    large = divide_into_blocks(
        OccupancyGrid(cells, 0.05, corner), Pose2(0, 0, 0), CONFIG, CLEARANCE_M
    )
    assert {(b.x_min, b.y_min) for b in small} < {(b.x_min, b.y_min) for b in large}


def test_a_block_with_a_frontier_is_gone_to_there_and_another_in_its_middle():
    cells = FLOOR.copy()
    cells[60:, 120:] = Cell.UNKNOWN
    cells[:2], cells[-2:], cells[:, :2], cells[:, -2:] = (Cell.OCCUPIED,) * 4
    blocks = divide_into_blocks(
        OccupancyGrid(cells, 0.05, (0, 0)), Pose2(1, 1, 0), CONFIG, CLEARANCE_M
    )
    middle = next(b for b in blocks if (b.x_min, b.y_min) == (2.0, 2.0))
    assert middle.frontier_cells == 0
    assert middle.destination == pytest.approx((3.0, 3.0), abs=0.05)
    assert middle.free_cells == 1600
    corner = next(b for b in blocks if (b.x_min, b.y_min) == (4.0, 2.0))
    assert corner.frontier_cells > 0
    assert corner.destination == pytest.approx((5.95, 3.5), abs=0.3)


def test_what_the_robot_cannot_enter_gets_no_number():
    grid = drawn(
        """
        ..........####......
        ..........####......
        ..........####......
        ..........####......
        """,
        scale=10,
    )
    blocks = divide_into_blocks(grid, Pose2(1.0, 1.0, 0.0), CONFIG, CLEARANCE_M)
    assert max(b.x_min for b in blocks) < 5.0
    assert all(b.destination[0] < 5.0 for b in blocks)


def test_a_robot_that_is_walled_in_has_none():
    grid = OccupancyGrid(np.full((60, 60), Cell.OCCUPIED, np.uint8), 0.05, (0.0, 0.0))
    assert divide_into_blocks(grid, Pose2(1.5, 1.5, 0.0), CONFIG, CLEARANCE_M) == ()


@settings(deadline=None)
@given(arrays(np.uint8, (12, 14), elements=st.sampled_from([0, 1, 1, 1, 1, 2])), st.data())
def test_destinations_are_safe_and_blocks_cover_what_is_reached(coarse, data):
    grid = OccupancyGrid(np.kron(coarse, np.ones((6, 6), np.uint8)), 0.05, (-1.03, 0.37))
    robot = Pose2(data.draw(st.floats(-1.0, 3.1)), data.draw(st.floats(0.4, 3.9)), 0.0)
    closed = inflate(grid.occupied, CLEARANCE_M, 0.05)
    config = MappingConfig(block_size_m=1.0, block_min_area_m2=0.0025)
    blocks = divide_into_blocks(grid, robot, config, CLEARANCE_M)
    assert len({(b.x_min, b.y_min) for b in blocks}) == len(blocks)
    for block in blocks:
        row, column = grid.cell_of(*block.destination)
        assert grid.cells[row, column] == Cell.FREE
        assert not closed[row, column]
        assert np.isfinite(block.travel_m)
        # Beside a frontier the robot may stand a clearance outside the square.
        x, y = block.destination
        assert block.x_min - 0.3 <= x <= block.x_min + 1.3
        assert block.y_min - 0.3 <= y <= block.y_min + 1.3
        assert (block.x_min % 1.0, block.y_min % 1.0) == (0.0, 0.0)
        assert 0 < block.free_cells <= 400


def test_specks_of_the_unknown_are_no_boundary_and_the_longest_stretch_is_gone_to():
    cells = np.full((40, 60), Cell.FREE, np.uint8)
    cells[[0, -1]], cells[:, 0], cells[1:-1, -1] = Cell.OCCUPIED, Cell.OCCUPIED, Cell.UNKNOWN
    config = MappingConfig(block_size_m=4.0, frontier_min_size_m=0.5)

    def block():
        (only,) = divide_into_blocks(
            OccupancyGrid(cells, 0.05, (0, 0)), Pose2(1, 1, 0), config, CLEARANCE_M
        )
        return only

    clean = block()
    assert clean.frontier_cells == pytest.approx(38, abs=4)
    assert clean.destination == pytest.approx((2.9, 1.0), abs=0.1)
    cells[6:36:6, 6:48:6] = Cell.UNKNOWN
    speckled = block()
    assert speckled.frontier_cells == clean.frontier_cells
    assert speckled.destination == clean.destination
    cells[12:14, -4:] = Cell.OCCUPIED  # parts the boundary into a shorter and a longer stretch
    assert block().destination[1] == pytest.approx(1.3, abs=0.15)


@settings(deadline=None, max_examples=40)
@given(arrays(np.uint8, (10, 14), elements=st.sampled_from([0, 1, 1, 1, 2])))
def test_the_middle_of_a_block_is_gone_to_as_nearly_as_it_can_be(coarse):
    grid = OccupancyGrid(np.kron(coarse, np.ones((10, 10), np.uint8)), 0.05, CORNER)
    config = MappingConfig(block_destination="middle")
    reach = ReachableArea.of(grid, ORIGIN, config, CLEARANCE_M)
    points = reach.grid.centres_of(np.argwhere(reach.reachable))
    for block in divide_into_blocks(grid, ORIGIN, config, CLEARANCE_M):
        x, y = block.destination
        assert block.x_min < x < block.x_min + block.size_m
        assert block.y_min < y < block.y_min + block.size_m
        middle = np.array([block.x_min, block.y_min]) + block.size_m / 2
        inside = points[(np.abs(points - middle) < block.size_m / 2).all(axis=1)]
        nearest = np.linalg.norm(inside - middle, axis=1).min()
        assert np.hypot(x - middle[0], y - middle[1]) <= nearest + 0.08


def test_stairs_are_blocks_of_their_own_where_the_robot_can_reach_them():
    cells = FLOOR.copy()
    cells[:, 100:104] = Cell.OCCUPIED
    grid = OccupancyGrid(cells, 0.05, CORNER)
    reach = ReachableArea.of(grid, ORIGIN, CONFIG, CLEARANCE_M)
    near, behind = WayOut(3, 1.5, 1.0, "stairs up"), WayOut(4, 4.0, 1.0, "stairs down")
    (block,) = stairs_blocks(reach, [near, behind], 7)
    assert (block.number, block.connector, block.words) == (7, 3, "stairs up")
    assert block.travel_m == pytest.approx(math.hypot(1.5, 1.0), abs=0.3)
    assert block.holds(near.xy)


def test_another_floor_is_worth_more_the_more_was_seen_of_this_one():
    """So is where the floor ends, but less."""

    def worths(metres: int) -> tuple[float, float]:
        grid = OccupancyGrid(np.full((20 * metres, 20 * metres), np.uint8(Cell.FREE)), 0.05, CORNER)
        reach = ReachableArea.of(grid, ORIGIN, CONFIG, CLEARANCE_M)
        (stairs,) = stairs_blocks(reach, [WayOut(3, 0.0, 0.5, "stairs up")], 1)
        (edge,) = drop_blocks(reach, [Drop(0.0, 0.5)], 1)
        return stairs.beyond_m2, edge.beyond_m2

    few, many = worths(4), worths(12)
    assert all(less < more for less, more in zip(few, many, strict=True))
    assert all(edge < stairs for stairs, edge in (few, many))


def test_a_robot_turns_to_where_the_floor_ends():
    reach = ReachableArea.of(OccupancyGrid(FLOOR, 0.05, CORNER), ORIGIN, CONFIG, CLEARANCE_M)
    beyond = CORNER[0] - 0.3, 1.0
    (block,) = drop_blocks(reach, [Drop(*beyond)], 1)
    x, y = block.destination
    assert block.face == pytest.approx(math.atan2(beyond[1] - y, beyond[0] - x))


def test_where_the_floor_ends_is_a_block_if_the_robot_can_go_near():
    cells = FLOOR.copy()
    cells[:, 100:104] = Cell.OCCUPIED
    reach = ReachableArea.of(OccupancyGrid(cells, 0.05, CORNER), ORIGIN, CONFIG, CLEARANCE_M)
    (block,) = drop_blocks(reach, [Drop(4.0, 1.0), Drop(1.5, 1.0, axis=2.0)], 7)
    assert (block.number, block.connector, block.face) == (7, None, 2.0)
    assert block.holds((1.5, 1.0))
    assert block.destination == pytest.approx((1.5, 1.0), abs=0.1)
    assert block.beyond_m2 > 0.0
