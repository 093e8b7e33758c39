import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.spatial import KDTree

from box_views import CAMERA, FLOOR, distance_to_boxes, frame, room, turning, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.errors import ConfigError, MapError
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import (
    BUMP_PERSISTENCE,
    MAX_EVIDENCE,
    HeightBand,
    MappingConfig,
    memory_of,
)
from hypernav.search.mapping.top_down_map import TopDownMap, empty_arrays

CONFIG = MappingConfig()
EMBODIMENT = Embodiment()
BAND = (0.10, 0.95)
ROOM = [
    *room(6.0, 4.0),
    ((4.0, 2.5, 0.0), (4.6, 3.0, 0.4)),  # a low table
    ((2.5, 3.4, 0.0), (2.53, 3.43, 1.5)),  # a pole, thinner than a cell
]
TABLE = ((2.0, -0.4, 0.0), (2.8, 0.4, 0.45))
HERE = Pose2(0.0, 0.0, 0.0)


def map_of(boxes, poses, *, config=CONFIG, **view):
    world_map = TopDownMap(config, EMBODIMENT)
    for pose in poses:
        world_map.integrate(view_of(boxes, pose, **view))
    return world_map


def points(world_map, state):
    grid = world_map.grid
    return grid.centres_of(np.argwhere(grid.cells == state))


def known(world_map):
    """All that is known, whatever the size of the grid: state by (row, column) of the frame."""
    grid = world_map.grid
    cells = np.argwhere(grid.cells != Cell.UNKNOWN)
    first = np.round(np.array(grid.origin)[::-1] / grid.resolution_m).astype(int)
    states = grid.cells[cells[:, 0], cells[:, 1]]
    return {(r, c): s for (r, c), s in zip((cells + first).tolist(), states.tolist(), strict=True)}


def moved(boxes, x, y):
    """The same boxes in a frame whose origin lies elsewhere."""
    return [tuple((c[0] + x, c[1] + y, c[2]) for c in box) for box in boxes]


@pytest.mark.parametrize(
    "view",
    [{}, {"height_m": 1.3, "pitch_deg": 20.0}, {"height_m": 0.5}, {"pitch_deg": -5.0}],
    ids=["level", "high and tilted down", "low", "tilted up"],
)
def test_the_map_of_a_room_agrees_with_the_room(view):
    world_map = map_of(ROOM, [*turning(1.5, 1.5), *turning(4.5, 1.2)], **view)
    occupied, free = points(world_map, Cell.OCCUPIED), points(world_map, Cell.FREE)
    assert distance_to_boxes(occupied, ROOM, *BAND).max() < 0.05
    inside = distance_to_boxes(free, [((0, 0, 0), (6, 4, 1))], *BAND) == 0.0
    assert inside.mean() > 0.995  # but for rays that graze a corner of a wall cell
    assert len(free) * 0.05**2 > 0.8 * 6.0 * 4.0
    wall = np.array([(x, y) for x in np.arange(0.3, 5.7, 0.05) for y in (0.0, 4.0)])
    nearest, _ = KDTree(occupied).query(wall)
    assert np.mean(nearest < 0.05) > 0.9


@pytest.mark.parametrize(("min_m", "max_m"), [(0.5, 4.7), (0.5, 3.3), (0.3, 5.0), (0.6, 5.0)])
def test_depth_that_a_sensor_clips_is_no_obstacle(min_m, max_m):
    """Its limits in single precision lie on either side of what the configuration says."""
    limits = {"min_depth_m": min_m, "max_depth_m": max_m}
    camera = EMBODIMENT.camera.model_copy(update=limits)
    clipping = TopDownMap(CONFIG, EMBODIMENT.model_copy(update={"camera": camera}))
    for limit_m in (min_m, max_m):
        for pose in turning(1.5, 1.5):
            seen = view_of(ROOM, pose)
            depth = np.full_like(seen.depth, limit_m)
            clipping.integrate(replace(seen, depth=depth))
    assert not clipping.grid.occupied.any()


def test_a_thin_pole_and_a_low_table_are_drawn():
    grid = map_of(ROOM, turning(1.5, 1.5)).grid
    assert grid.state_at(2.51, 3.41) == Cell.OCCUPIED
    assert grid.state_at(4.02, 2.6) == Cell.OCCUPIED


def test_at_eye_level_there_are_walls_and_poles_and_no_tables():
    world_map = map_of(ROOM, turning(1.5, 1.5))
    before = world_map.grid.copy()
    everywhere = before.centres_of(np.argwhere(np.ones(before.cells.shape)))
    eye_level = world_map.eye_level(everywhere)
    assert eye_level.state_at(2.51, 3.41) == Cell.OCCUPIED
    assert eye_level.state_at(4.02, 2.6) == Cell.FREE
    assert eye_level.occupied.sum() < before.occupied.sum()
    np.testing.assert_array_equal(eye_level.explored, before.explored)
    np.testing.assert_array_equal(world_map.grid.cells, before.cells)
    walls = eye_level.centres_of(np.argwhere(eye_level.occupied))
    assert distance_to_boxes(walls, ROOM, 0.8, 0.95).max() < 0.05
    around = np.array([[2.01, 3.01], [2.99, 3.99]])
    near = ((everywhere >= (2.0, 3.0)) & (everywhere <= (3.0, 4.0))).all(axis=1)
    part = world_map.eye_level(around)
    np.testing.assert_array_equal(
        part.cells.ravel(), np.where(near, eye_level.cells.ravel(), Cell.UNKNOWN)
    )


@pytest.mark.parametrize("far", [3.0, 4.5])
def test_a_chair_leg_survives_being_seen_from_far(far):
    leg = ((far, 0.1, 0.0), (far + 0.03, 0.13, 0.5))
    world_map = map_of([FLOOR, leg], [Pose2(0.0, 0.0, yaw) for yaw in (0.0, 0.1, -0.1, 0.2)])
    assert distance_to_boxes(points(world_map, Cell.OCCUPIED), [leg], *BAND).max() < 0.05
    assert len(points(world_map, Cell.OCCUPIED)) > 0


def test_a_wall_seen_at_a_grazing_angle_has_no_gaps_nearby():
    wall = ((0.0, 0.6, 0.0), (6.0, 0.8, 2.0))
    grid = map_of([FLOOR, wall], [Pose2(0.05 * k, 0.0, 0.0) for k in range(5)]).grid
    drawn = [grid.state_at(x, 0.62) == Cell.OCCUPIED for x in np.arange(1.2, 3.0, 0.05)]
    assert np.mean(drawn) > 0.95


def test_ceilings_and_what_hangs_above_the_robot_are_ignored():
    lamp = ((2.0, -0.5, 1.1), (2.6, 0.5, 1.4))
    shelf = ((-3.0, -3.0, 2.0), (3.0, 3.0, 2.05))
    world_map = map_of([FLOOR, lamp, shelf], turning(0.0, 0.0))
    assert len(points(world_map, Cell.OCCUPIED)) == 0
    assert world_map.grid.state_at(2.3, 0.0) == Cell.FREE


def test_rugs_and_sills_are_floor():
    world_map = map_of([FLOOR, ((1.5, -1.0, 0.0), (3.0, 1.0, 0.04))], [HERE])
    assert len(points(world_map, Cell.OCCUPIED)) == 0
    assert world_map.grid.state_at(2.2, 0.0) == Cell.FREE


def test_the_floor_before_the_first_visible_one_is_free_where_the_lowest_ray_passes():
    grid = map_of([FLOOR], [HERE]).grid
    for x in (0.7, 1.0, 1.3):
        assert grid.state_at(x, 0.0) == Cell.FREE
    assert grid.state_at(-1.0, 0.0) == Cell.UNKNOWN


def test_behind_an_obstacle_nothing_is_known():
    wall = ((2.0, -3.0, 0.0), (2.1, 3.0, 0.8))  # lower than the camera: rays pass above it
    grid = map_of([FLOOR, wall], [HERE]).grid
    assert grid.state_at(2.02, 0.0) == Cell.OCCUPIED
    assert [grid.state_at(x, 0.0) for x in (2.3, 3.0, 4.0)] == [Cell.UNKNOWN] * 3


@pytest.mark.parametrize("value", [0.0, math.nan, math.inf, -math.inf, -1.0, 5.0, 65.5, 0.5])
def test_depth_that_is_no_measurement_says_nothing(value):
    before = map_of([FLOOR, TABLE], [HERE])
    after = map_of([FLOOR, TABLE], [HERE])
    after.integrate(frame(np.full((CAMERA.height, CAMERA.width), value, np.float32), HERE))
    assert set(known(before).values()) == {Cell.FREE, Cell.OCCUPIED}
    assert known(after) == known(before)


def test_a_code_says_nothing_to_a_camera_of_long_range_either():
    far_sighted = Embodiment.model_validate({"camera": {"max_depth_m": 30.0}})
    before, after = (TopDownMap(CONFIG, far_sighted) for _ in range(2))
    for world_map in (before, after):
        world_map.integrate(view_of([FLOOR, TABLE], HERE))
    after.integrate(frame(np.full((CAMERA.height, CAMERA.width), 65.535, np.float32), HERE))
    assert set(known(before).values()) == {Cell.FREE, Cell.OCCUPIED}
    assert known(after) == known(before)


@cache
def room_views():
    return [view_of(ROOM, pose) for pose in turning(1.5, 1.5)]


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_scattered_broken_pixels_leave_the_map_sound(seed):
    rng = np.random.default_rng(seed)
    world_map = TopDownMap(CONFIG, EMBODIMENT)
    for view in room_views():
        depth = view.depth.copy()
        broken = rng.random(depth.shape) < 0.3
        depth[broken] = rng.choice([0.0, np.nan, np.inf, 5.0, 0.2, 70.0], broken.sum())
        world_map.integrate(frame(depth, view.robot))
    occupied = points(world_map, Cell.OCCUPIED)
    assert distance_to_boxes(occupied, ROOM, *BAND).max() < 0.05
    assert len(points(world_map, Cell.FREE)) * 0.05**2 > 10.0


def test_single_noisy_pixels_draw_nothing_that_lasts():
    rng = np.random.default_rng(1)
    world_map = TopDownMap(CONFIG, EMBODIMENT)
    for _ in range(8):
        depth = view_of([FLOOR], HERE).depth.copy()
        noisy = rng.random(depth.shape) < 0.002
        depth[noisy] = rng.uniform(0.6, 4.0, noisy.sum())
        world_map.integrate(frame(depth, HERE))
    assert len(points(world_map, Cell.OCCUPIED)) <= 2


def test_an_obstacle_that_is_carried_away_disappears():
    wall = ((3.8, -4.0, 0.0), (4.0, 4.0, 2.0))  # rays that meet nothing in range tell nothing
    world_map = map_of([FLOOR, wall, TABLE], [HERE] * 10)
    assert world_map.grid.state_at(2.02, 0.0) == Cell.OCCUPIED
    for _ in range(MAX_EVIDENCE):
        world_map.integrate(view_of([FLOOR, wall], HERE))
    assert points(world_map, Cell.OCCUPIED)[:, 0].min() > 3.7
    assert world_map.grid.state_at(2.3, 0.0) == Cell.FREE


def test_merged_plainly_what_was_drawn_once_stays():
    wall = ((3.8, -4.0, 0.0), (4.0, 4.0, 2.0))
    world_map = map_of([FLOOR, wall, TABLE], [HERE], config=MappingConfig(pass_weight=0))
    before = {cell for cell, state in known(world_map).items() if state == Cell.OCCUPIED}
    for _ in range(20):
        world_map.integrate(view_of([FLOOR, wall], HERE))
    assert before <= {cell for cell, state in known(world_map).items() if state == Cell.OCCUPIED}


def test_looking_over_a_low_table_does_not_clear_it():
    world_map = map_of([FLOOR, TABLE], [HERE])
    close = Pose2(1.4, 0.0, 0.0)  # only what lies beyond the table is in the image
    before = {cell for cell, state in known(world_map).items() if state == Cell.OCCUPIED}
    for _ in range(10):
        world_map.integrate(view_of([FLOOR, TABLE], close))
    assert before <= {cell for cell, state in known(world_map).items() if state == Cell.OCCUPIED}


PERSON = ((2.0, -0.2, 0.0), (2.4, 0.2, 1.7))
DISTANT_WALL = ((7.0, -9.0, 0.0), (7.2, 9.0, 2.5))


def test_who_stood_before_a_distant_wall_and_left_is_forgotten():
    """The wall is measured, but too far away to be drawn."""
    world_map = map_of([FLOOR, DISTANT_WALL, PERSON], [HERE], max_depth_m=10.0)
    assert len(points(world_map, Cell.OCCUPIED)) > 0
    for _ in range(MAX_EVIDENCE):
        world_map.integrate(view_of([FLOOR, DISTANT_WALL], HERE, max_depth_m=10.0))
    assert len(points(world_map, Cell.OCCUPIED)) == 0
    assert world_map.grid.state_at(2.1, 0.0) == Cell.FREE


def test_where_nothing_is_measured_nobody_has_left():
    """No return may also mean that something is too near."""
    world_map = map_of([FLOOR, DISTANT_WALL, PERSON], [HERE])
    before = points(world_map, Cell.OCCUPIED)
    for _ in range(MAX_EVIDENCE):
        world_map.integrate(view_of([FLOOR, DISTANT_WALL], HERE))
    np.testing.assert_array_equal(points(world_map, Cell.OCCUPIED), before)


def test_what_is_too_near_to_be_measured_is_kept():
    wall = ((1.0, -2.0, 0.0), (1.2, 2.0, 2.0))
    world_map = map_of([FLOOR, wall], [HERE])
    before = known(world_map)
    near = Pose2(0.7, 0.0, 0.0)
    depth = view_of([FLOOR, wall], near).depth
    for value in (0.0, EMBODIMENT.camera.min_depth_m):  # no return, or clamped as Habitat does
        world_map.integrate(frame(np.where(depth < 0.5, np.float32(value), depth), near))
    lost = {c for c, s in before.items() if s == Cell.OCCUPIED and known(world_map)[c] != s}
    assert not lost


def test_the_robot_stands_on_free_floor():
    world_map = map_of([FLOOR, TABLE], [HERE])
    world_map.integrate(view_of([FLOOR], Pose2(2.4, 0.0, 0.0)))
    assert world_map.grid.state_at(2.4, 0.0) == Cell.FREE
    assert world_map.grid.state_at(2.1, 0.3) == Cell.OCCUPIED


def test_where_the_robot_stands_may_stay_as_it_was_drawn():
    world_map = map_of([FLOOR, TABLE], [HERE], config=MappingConfig(free_footprint=False))
    assert world_map.grid.state_at(-0.1, 0.0) == Cell.UNKNOWN
    world_map.integrate(view_of([FLOOR], Pose2(2.05, 0.0, math.pi)))
    assert world_map.grid.state_at(2.02, 0.0) == Cell.OCCUPIED


def test_a_bump_outlasts_clear_views_but_not_for_ever():
    world_map = map_of([FLOOR], [HERE])
    world_map.mark_occupied(np.array([[2.0, 0.0]]))
    for _ in range(BUMP_PERSISTENCE - 1):
        world_map.integrate(view_of([FLOOR], HERE))
    assert world_map.grid.state_at(2.0, 0.0) == Cell.OCCUPIED
    world_map.integrate(view_of([FLOOR], HERE))
    assert world_map.grid.state_at(2.0, 0.0) == Cell.FREE


def test_a_bump_stays_while_nobody_looks_and_goes_when_the_robot_stands_there():
    world_map = map_of([FLOOR], [HERE])
    world_map.mark_occupied(np.array([[-0.4, 0.0], [0.2, 0.0]]))
    for _ in range(40):
        world_map.integrate(view_of([FLOOR], HERE))
    assert world_map.grid.state_at(-0.4, 0.0) == Cell.OCCUPIED
    assert world_map.grid.state_at(0.2, 0.0) == Cell.OCCUPIED  # beside the robot, not under it
    world_map.integrate(view_of([FLOOR], Pose2(-0.4, 0.0, 0.0)))
    assert world_map.grid.state_at(-0.4, 0.0) == Cell.FREE


def test_a_forgotten_bump_leaves_what_the_camera_saw():
    plain, bumped = (map_of([FLOOR], [HERE]) for _ in range(2))
    bumped.mark_occupied(np.array([[2.0, 0.0], [-0.4, 0.0]]))
    bumped.forget_bumps()
    for position in ((2.0, 0.0), (-0.4, 0.0)):
        assert bumped.grid.state_at(*position) == plain.grid.state_at(*position)
    bumped.integrate(view_of([FLOOR], HERE))
    plain.integrate(view_of([FLOOR], HERE))
    assert np.array_equal(bumped.grid.cells, plain.grid.cells)


UPSTAIRS = [  # floor up to x = 2, then stairs down, in a well with a wall at its end
    ((-30.0, -30.0, -0.3), (2.0, 30.0, 0.0)),
    *(((2.0 + 0.28 * k, -0.6, -3.0), (2.28 + 0.28 * k, 0.6, -0.18 * (k + 1))) for k in range(8)),
    ((2.0, -0.8, -3.0), (4.5, -0.6, 1.5)),
    ((2.0, 0.6, -3.0), (4.5, 0.8, 1.5)),
    ((4.3, -0.8, -3.0), (4.5, 0.8, 1.5)),
]
TOWARDS_STAIRS = [Pose2(0.1 * k, 0.0, 0.0) for k in range(-2, 6)]
DROP = np.array([[x, y] for x in (2.1, 2.3, 2.8) for y in (-0.2, 0.0, 0.2)])
EDGE = np.array([[1.9, y] for y in (-0.3, 0.0, 0.3)])


def states(world_map, positions):
    return {world_map.grid.state_at(*one) for one in positions}


def test_where_rays_pass_below_the_floor_there_is_none():
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    assert states(world_map, DROP) == {Cell.OCCUPIED}
    assert states(world_map, EDGE) == {Cell.FREE}


def test_drops_are_known_where_they_are():
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    assert all(world_map.has_drop(one[None]) for one in DROP)
    assert not world_map.has_drop(EDGE)
    assert not world_map.has_drop(np.array([[99.0, 0.0]]))


def test_a_drop_is_kept_when_bumps_are_forgotten_and_as_long_as_no_floor_is_seen():
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    world_map.forget_bumps()
    for x in (-2.0, -1.5, 1.5) * 5:  # too far to be sure, and so near that it is below the image
        world_map.integrate(view_of(UPSTAIRS, Pose2(x, 0.0, 0.0)))
    assert states(world_map, DROP[:3]) == {Cell.OCCUPIED}


def test_a_bump_on_a_drop_leaves_the_drop():
    world_map = map_of([FLOOR], [HERE])  # as a hatch that is opened
    for pose in TOWARDS_STAIRS:
        world_map.integrate(view_of(UPSTAIRS, pose))
    world_map.mark_occupied(DROP)
    world_map.forget_bumps()
    assert states(world_map, DROP) == {Cell.OCCUPIED}


def test_a_drop_is_forgotten_where_floor_is_seen():
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    for _ in range(3):
        world_map.integrate(view_of([FLOOR], HERE))
    assert states(world_map, DROP) == {Cell.FREE}


def test_of_an_older_map_drops_and_bumps_are_known():
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    world_map.mark_occupied(EDGE)
    state = world_map.state
    older = {name: array for name, array in state.items() if name != "drops"}
    older["bumps"] = np.where(state["drops"] > 0, 128 + state["drops"], state["bumps"])
    read = TopDownMap(CONFIG, EMBODIMENT)
    read.restore(older)
    assert all(np.array_equal(read.state[name], array) for name, array in state.items())


def test_unseen_ground_right_before_a_drop_is_none():
    world_map = map_of(UPSTAIRS, [Pose2(1.2, 0.0, 0.0)])
    assert states(world_map, DROP[:3]) == {Cell.OCCUPIED}
    assert world_map.grid.state_at(1.2, 0.0) == Cell.FREE
    came_by = map_of(UPSTAIRS, [*TOWARDS_STAIRS, Pose2(1.2, 0.0, 0.0)])
    assert states(came_by, EDGE) == {Cell.FREE}


CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))


def map_of_a_climber(boxes, poses):
    world_map = TopDownMap(CONFIG, CLIMBER)
    for pose in poses:
        world_map.integrate(view_of(boxes, pose))
    return world_map


def test_the_robot_of_the_paper_sees_no_drops():
    published = TopDownMap(MappingConfig(sees_drops=False), EMBODIMENT)
    for pose in TOWARDS_STAIRS:
        published.integrate(view_of(UPSTAIRS, pose))
    assert states(published, DROP[:6]) == {Cell.FREE}


def test_to_a_robot_that_climbs_a_drop_is_unknown():
    assert states(map_of_a_climber(UPSTAIRS, TOWARDS_STAIRS), DROP) == {Cell.UNKNOWN}


def test_holes_in_the_depth_leave_a_drop_unknown_to_a_robot_that_climbs():
    x, y = np.meshgrid(np.arange(2.3, 4.5, 0.05), np.arange(-0.4, 0.4, 0.05))
    well = np.stack([x.ravel(), y.ravel()], axis=1)
    rng = np.random.default_rng(0)
    world_map, whole = TopDownMap(CONFIG, CLIMBER), TopDownMap(CONFIG, CLIMBER)
    for pose in TOWARDS_STAIRS:
        view = view_of(UPSTAIRS, pose)
        whole.integrate(view)
        view.depth[rng.random(view.depth.shape) < 0.02] = 0.0
        world_map.integrate(view)
    some, all_ = (
        sum(one.grid.state_at(*at) is Cell.UNKNOWN for at in well) for one in (world_map, whole)
    )
    assert some > 0.9 * all_


def test_the_wall_of_a_stairwell_shows_from_afar_that_there_is_no_floor():
    far = [Pose2(-1.0, 0.0, 0.0)]
    assert states(map_of_a_climber(UPSTAIRS, far), np.array([[3.0, 0.0]])) == {Cell.UNKNOWN}


def test_a_robot_that_climbs_knows_where_the_floor_ends():
    edges = map_of_a_climber(UPSTAIRS, TOWARDS_STAIRS).edges_to_drops()
    assert len(edges) > 0.5 / CONFIG.cell_size_m
    assert edges[:, 0].min() == pytest.approx(2.0, abs=0.1)
    assert len(map_of(UPSTAIRS, TOWARDS_STAIRS).edges_to_drops()) == 0
    assert len(map_of_a_climber([FLOOR], [HERE]).edges_to_drops()) == 0


def test_an_edge_is_forgotten_where_floor_is_seen():
    world_map = map_of_a_climber(UPSTAIRS, TOWARDS_STAIRS)
    world_map.integrate(view_of([FLOOR], HERE))
    assert states(world_map, DROP) == {Cell.FREE}
    assert len(world_map.edges_to_drops()) == 0


def test_ground_two_steps_lower_is_floor_to_a_robot_that_climbs():
    lower = [((-30.0, -30.0, -1.0), (2.0, 30.0, 0.0)), ((2.0, -30.0, -1.0), (30.0, 30.0, -0.35))]
    world_map = map_of_a_climber(lower, TOWARDS_STAIRS)
    assert states(world_map, np.array([[2.8, 0.0], [3.4, 0.2]])) == {Cell.FREE}


def test_a_step_down_and_a_floor_that_odometry_raises_are_no_drops():
    lower = [((-30.0, -30.0, -1.0), (2.0, 30.0, 0.0)), ((2.0, -30.0, -1.0), (30.0, 30.0, -0.1))]
    assert len(points(map_of(lower, [HERE]), Cell.OCCUPIED)) == 0
    raised = [((-30.0, -30.0, -1.0), (30.0, 30.0, -0.12))]
    assert len(points(map_of(raised, [HERE]), Cell.OCCUPIED)) == 0


def test_a_few_points_below_the_floor_are_noise():
    view = view_of([FLOOR], HERE)
    view.depth[170:172, 150:154] *= 1.5
    world_map = TopDownMap(CONFIG, EMBODIMENT)
    world_map.integrate(view)
    assert len(points(world_map, Cell.OCCUPIED)) == 0


def test_where_the_robot_stands_there_is_a_floor():
    robot = Pose2(2.6, 0.0, 0.0)
    world_map = map_of(UPSTAIRS, TOWARDS_STAIRS)
    world_map.integrate(view_of([FLOOR], robot))
    assert world_map.grid.state_at(*robot.xy) == Cell.FREE


@settings(max_examples=20, deadline=None)
@given(
    st.lists(st.tuples(st.integers(-1500, 1500), st.integers(-1500, 1500)), min_size=1, max_size=4)
)
def test_growing_keeps_what_is_known(cells):
    world_map = map_of([FLOOR, TABLE], [HERE])
    before = known(world_map)
    for row, column in cells:
        world_map.mark_occupied(np.array([[0.05 * (column + 0.5), 0.05 * (row + 0.5)]]))
    assert known(world_map) == before | dict.fromkeys(cells, Cell.OCCUPIED)


@settings(max_examples=15, deadline=None)
@given(st.integers(-400, 400), st.integers(-400, 400))
def test_the_map_does_not_depend_on_where_the_frame_begins(row, column):
    # A position whole cells away, and a hair's breadth off the cells' edges against rounding.
    x, y = 0.05 * column, 0.05 * row
    here, boxes = Pose2(0.013, 0.017, 0.3), [FLOOR, TABLE]
    there = Pose2(0.013 + x, 0.017 + y, 0.3)
    first, second = map_of(boxes, [here]), map_of(moved(boxes, x, y), [there])
    a, b = known(first), known(second)
    shifted = {(r + row, c + column): state for (r, c), state in a.items()}
    different = {cell for cell in shifted | b if shifted.get(cell) != b.get(cell)}
    assert len(different) < 0.01 * len(a)


def test_the_grid_is_a_view_that_cannot_be_written():
    world_map = map_of([FLOOR], [HERE])
    first, second = world_map.grid, world_map.grid
    assert np.shares_memory(first.cells, second.cells)
    with pytest.raises(ValueError, match="read-only"):
        first.cells[0, 0] = Cell.FREE


def test_a_new_map_knows_nothing_and_can_be_asked():
    grid = TopDownMap(CONFIG, EMBODIMENT).grid
    assert not grid.explored.any()
    assert grid.state_at(0.0, 0.0) == Cell.UNKNOWN


@pytest.mark.parametrize(
    ("robot", "camera_x", "words"),
    [
        (Pose2(math.nan, 0.0, 0.0), 0.0, "finite"),
        (HERE, math.inf, "finite"),
        (Pose2(1e6, 0.0, 0.0), 0.0, "at most 500 m"),
    ],
)
def test_an_impossible_pose_is_refused_and_changes_nothing(robot, camera_x, words):
    world_map = map_of([FLOOR], [HERE])
    before = known(world_map)
    good = view_of([FLOOR], HERE)
    pose = Transform(good.camera_to_map.rotation, np.array([camera_x, 0.0, 0.88]))
    with pytest.raises(MapError, match=words):
        world_map.integrate(Observation(good.rgb, good.depth, good.camera, pose, robot))
    assert known(world_map) == before


def test_a_bump_nowhere_is_refused():
    with pytest.raises(MapError, match="finite"):
        TopDownMap(CONFIG, EMBODIMENT).mark_occupied(np.array([[math.nan, 0.0]]))
    TopDownMap(CONFIG, EMBODIMENT).mark_occupied(np.zeros((0, 2)))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"cell_size": 0.1}, "cell_size"),
    ],
)
def test_a_wrong_configuration_says_why(wrong, words):
    with pytest.raises(ValidationError, match=words):
        MappingConfig(**wrong)


def test_things_as_low_as_the_robot_drives_over_are_floor():
    assert CONFIG.height_band(BodyConfig(max_step_m=0.2)).bottom_m == pytest.approx(0.2)
    assert CONFIG.height_band(BodyConfig(max_step_m=0.0)).bottom_m == CONFIG.floor_noise_m


def test_a_taller_robot_looks_higher_for_obstacles():
    assert CONFIG.height_band(BodyConfig()).layers == 17
    assert CONFIG.height_band(BodyConfig(height_m=1.5)).layers == 27


@pytest.mark.parametrize(
    ("config", "body", "words"),
    [
        (MappingConfig(voxel_height_m=0.01), BodyConfig(), "larger mapping.voxel_height_m"),
        (MappingConfig(headroom_m=-0.9), BodyConfig(), "make the band higher"),
    ],
)
def test_a_map_that_cannot_hold_the_robot_says_why(config, body, words):
    with pytest.raises(ConfigError, match=words):
        TopDownMap(config, Embodiment(body=body))


@pytest.mark.parametrize("layers", [1, 12])
def test_a_map_takes_as_many_bytes_as_are_told_before_it_is_made(layers):
    band = HeightBand(0.1, layers)
    assert memory_of(20 * 30, band) == sum(one.nbytes for one in empty_arrays(20, 30, band))
