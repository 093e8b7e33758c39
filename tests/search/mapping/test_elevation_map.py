"""The map of heights around the robot shows the ground where it is, and moves with the robot."""

import numpy as np
import pytest

from box_views import FLOOR, SolidBox, view_of
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.elevation_map import ElevationMap, _shifted, filled
from stair_views import CAMERA, CLIMBER

SIDE_M = 0.05


def looking(*poses: Pose2, boxes: list[SolidBox] | None = None) -> ElevationMap:
    """The map of a robot that has looked from these poses at the floor and boxes on it."""
    seen = ElevationMap(CLIMBER, SIDE_M)
    for pose in poses:
        height_m = CLIMBER.camera.height_m
        seen.integrate(view_of([FLOOR, *(boxes or [])], pose, camera=CAMERA, height_m=height_m))
    return seen


@pytest.mark.parametrize("i", [-9, -3, 0, 2, 9])
@pytest.mark.parametrize("j", [-12, -4, 0, 5, 12])
def test_a_window_that_moves_keeps_what_it_still_shows(i: int, j: int):
    before = np.arange(63, dtype=np.float32).reshape(7, 9)
    moved = _shifted(before, (i, j), np.float32(-1.0))
    for row, column in np.ndindex(moved.shape):
        was = (row + i, column + j)
        is_kept = 0 <= was[0] < 7 and 0 <= was[1] < 9
        assert moved[row, column] == (before[was] if is_kept else -1.0)


anywhere = pytest.mark.parametrize(
    "robot", [Pose2(0.0, 0.0, 0.0), Pose2(7.32, -3.41, 0.0), Pose2(-5.13, 9.27, 2.2)]
)


@anywhere
def test_ground_is_as_high_as_it_was_seen_wherever_the_robot_looks_from(robot: Pose2):
    (x, y), size_m = robot.ahead(2.5).xy, 0.5
    tread: SolidBox = ((x - size_m, y - size_m, 0.0), (x + size_m, y + size_m, 0.18))
    ground = looking(robot, boxes=[tread]).ground_from(robot.xy)
    known = ground.seen & ~ground.stood & ~np.isnan(ground.measured)
    away = np.abs(ground.positions(known) - (x, y)).max(axis=1)
    heights = ground.measured[known]
    on_tread, beside = away < size_m - 2 * SIDE_M, away > size_m + 2 * SIDE_M
    assert on_tread.sum() > 80
    assert beside.sum() > 500
    np.testing.assert_allclose(heights[on_tread], 0.18, atol=0.01)
    np.testing.assert_allclose(heights[beside], 0.0, atol=0.01)
    x, y = (ground.positions(known) - robot.xy).T
    assert np.cos(np.arctan2(y, x) - robot.yaw).min() > 0.7  # it saw none outside of its view


@anywhere
@pytest.mark.parametrize(("height_m", "is_hit"), [(0.1, False), (0.7, True)])
def test_what_stands_on_the_ground_is_an_obstacle_where_it_stands(
    robot: Pose2, height_m: float, is_hit: bool
):
    (x, y), half_m = robot.ahead(1.9).xy, 0.1
    post: SolidBox = ((x - half_m, y - half_m, 0.0), (x + half_m, y + half_m, height_m))
    found = looking(robot, boxes=[post]).obstacles
    hits = found.centres_of(np.argwhere(found.occupied))
    assert (len(hits) > 3) == is_hit
    assert not is_hit or np.abs(hits - (x, y)).max() <= half_m + SIDE_M


@pytest.mark.parametrize("quarters", range(4))
def test_beyond_an_edge_where_no_depth_comes_back_stairs_down_are_presumed(quarters: int):
    robot = Pose2(7.32, -3.41, quarters * np.pi / 2.0)
    edge_m, far_m = 1.9, 3.5  # up to where a floor would be seen for certain
    corners = np.array([[-30.0, -9.0, 0.0], [edge_m, 9.0, 0.0]])
    platform = robot.to_transform().apply(corners)[:, :2]
    boxes: list[SolidBox] = [((*platform.min(axis=0), -9.0), (*platform.max(axis=0), 0.0))]
    seen = ElevationMap(CLIMBER, SIDE_M)
    seen.integrate(view_of(boxes, robot, camera=CAMERA, height_m=CLIMBER.camera.height_m))
    assert not seen.ground_from(robot.xy).presumed.any()
    ground = seen.ground_from(robot.xy, down=True)
    there = ground.positions(ground.presumed)
    there = np.column_stack([there, np.zeros(len(there))])
    x, y, _ = robot.to_transform().inverse().apply(there).T
    assert len(x) > 500
    assert edge_m - SIDE_M < x.min() < edge_m + 3 * SIDE_M
    assert far_m - 6 * SIDE_M < x.max() < far_m + SIDE_M
    assert (np.abs(y) <= x).all()


def test_a_robot_knows_the_ground_under_it_that_its_camera_does_not_see():
    robot = Pose2(2.02, -1.03, 0.4)
    ground = looking(robot).ground_from(robot.xy)
    row, column = ground.grid.cell_of(*robot.xy)
    rows, columns = np.nonzero(ground.stood)
    for ours, here in ((rows, row), (columns, column)):
        assert (ours.min(), ours.max()) == (here - 2, here + 2)
    assert len(rows) == 25
    assert not ground.measured[ground.stood].any()


@pytest.mark.parametrize("looks", [True, False])
def test_a_bump_closes_the_ground_where_it_was_and_nowhere_else(looks: bool):
    robot, bump = Pose2(0.52, 0.78, 0.0), (0.88, 0.93)
    seen = looking(*[robot] * looks)
    before = seen.ground_from(robot.xy)
    seen.mark_occupied(np.array([bump]))
    after = seen.ground_from(robot.xy)
    assert np.argwhere(before.grid.free & ~after.grid.free).tolist() == [
        list(after.grid.cell_of(*bump))
    ]


def test_gaps_in_even_ground_are_filled_with_its_height():
    random = np.random.default_rng(0)
    ground = np.full((160, 160), np.nan, dtype=np.float32)
    for corner in np.ndindex(5, 5):  # one known cell in every square of 32 by 32
        ground[tuple(32 * np.array(corner) + random.integers(0, 32, 2))] = 2.5
    np.testing.assert_allclose(filled(ground), 2.5, atol=1e-5)


def test_gaps_are_filled_alike_along_rows_and_columns():
    random = np.random.default_rng(0)
    ground = random.uniform(0.0, 1.0, (64, 160)).astype(np.float32)
    ground[random.random(ground.shape) < 0.9] = np.nan
    np.testing.assert_allclose(filled(ground.T), filled(ground).T, atol=1e-5)


def test_a_gap_is_filled_between_the_lowest_and_the_highest_around_it_on_every_storey():
    random = np.random.default_rng(0)
    low = np.full((160, 160), np.nan, dtype=np.float32)
    low[:12, 40:60] = random.uniform(-0.2, 0.2, (12, 20))  # far from most of the map
    for z in (0.0, 3.0, -6.0):
        whole = filled(low + np.float32(z))
        assert (
            np.nanmin(low) - 1e-5 <= (whole - z).min() <= (whole - z).max() <= np.nanmax(low) + 1e-5
        )
        np.testing.assert_allclose(whole - z, filled(low), atol=1e-5)


@pytest.mark.parametrize(("width_m", "is_filled"), [(0.1, True), (0.4, False)])
def test_only_pits_too_narrow_for_a_foot_are_filled(width_m: float, is_filled: bool):
    beside: list[SolidBox] = [
        ((1.2, -1.0, 0.0), (3.2, -width_m / 2.0, 0.4)),
        ((1.2, width_m / 2.0, 0.0), (3.2, 1.0, 0.4)),
    ]
    ground = looking(Pose2(0.0, 0.0, 0.0), boxes=beside).ground_from((0.0, 0.0))
    known = ~np.isnan(ground.measured)
    x, y = ground.positions(known).T
    heights = ground.measured[known][(abs(y) < SIDE_M / 2.0) & (x > 1.4) & (x < 2.4)]
    assert len(heights) > 5
    np.testing.assert_allclose(heights, 0.4 if is_filled else 0.0, atol=0.02)
