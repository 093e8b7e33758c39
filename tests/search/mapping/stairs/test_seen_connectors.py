"""Stairs are seen in both directions, and furniture is no stairs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from box_views import FLOOR, SolidBox, room, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.elevation_map import Ground, UnseenGround, reach
from hypernav.search.mapping.stairs.connectors import Connector, Passage
from hypernav.search.mapping.stairs.seen_connectors import connectors_in, reliable, without_sides
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_index import ConnectorRecord
from stair_views import (
    CAMERA,
    CLIMBER,
    FIRST_X,
    MIDDLE_Y,
    RISE_M,
    SIDES_Y,
    TREAD_M,
    before_stairs,
    edge,
    memory_after,
    stairs_down,
    stairs_up,
    stairwell,
    usable,
)


@pytest.mark.parametrize(("goes_up", "distances_m"), [(True, (3.0, 2.5, 2.0)), (False, (2.0, 1.8))])
@pytest.mark.parametrize("yaw", [0.0, 0.25])
def test_stairs_ahead_are_seen_with_their_end_and_axis(
    goes_up: bool, distances_m: tuple[float, ...], yaw: float
):
    boxes = [FLOOR, *stairs_up()] if goes_up else stairs_down()
    (found,) = usable(memory_after(boxes, *before_stairs(*distances_m, yaw=yaw)))
    assert found.goes_up is goes_up
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.4
    assert abs(found.axis) < math.radians(15.0)


@pytest.mark.parametrize("distance_m", [0.6, 0.8, 1.0, 1.2, 1.3])
def test_stairs_up_are_seen_where_their_first_step_is_out_of_sight(distance_m: float):
    poses = before_stairs(distance_m, distance_m)
    (found,) = usable(memory_after([FLOOR, *stairs_up()], *poses))
    assert found.goes_up
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.7
    assert abs(found.axis) < math.radians(15.0)


@pytest.mark.parametrize("off_m", [-0.13, 0.13])
def test_stairs_down_are_seen_by_a_robot_that_is_not_as_high_as_it_is_said_to_be(off_m: float):
    """As on a mesh, or by odometry that has drifted: images show how high the floor is."""
    walk = before_stairs(3.2, 2.8, 2.4, 2.0, 1.6, 1.2, 1.1)
    memory = memory_after(stairs_down(), *walk, z=off_m)
    assert memory.ground_m == pytest.approx(off_m)
    (found,) = usable(memory)
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.4


@pytest.mark.parametrize("goes_up", [True, False])
@pytest.mark.parametrize("off_m", [-0.13, -0.05, 0.05, 0.09, 0.13, 0.19])
def test_stairs_are_seen_from_a_floor_that_is_lower_than_the_robot_is_said_to_stand(
    goes_up: bool, off_m: float
):
    """As on a mesh that floats, or sinks, all the time, or with a camera that is mounted wrong."""
    memory = memory_after([])
    boxes = [FLOOR, *stairs_up()] if goes_up else stairs_down()
    height_m = CLIMBER.camera.height_m + off_m
    for x in np.linspace(0.5, 3.0 if goes_up else 2.4, 7):
        for yaw in (-0.5, 0.0, 0.5):
            seen = view_of(boxes, Pose2(x, MIDDLE_Y, yaw), camera=CAMERA, height_m=height_m)
            at = seen.camera_to_map
            lower = replace(at, translation=at.translation - np.array([0.0, 0.0, off_m]))
            memory.follow(replace(seen, camera_to_map=lower))
    (found,) = memory.connectors
    assert found.is_usable
    assert found.goes_up is goes_up
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.2


@pytest.mark.parametrize("drift_m", [-0.3, -0.1, 0.1, 0.3])
def test_stairs_are_seen_while_odometry_drifts_up_or_down(drift_m: float):
    memory = memory_after([])
    for k, x in enumerate(np.linspace(0.5, 2.4, 21)):
        yaw = (-0.5, 0.0, 0.5)[k % 3]
        seen = view_of(stairs_down(), Pose2(x, MIDDLE_Y, yaw), camera=CAMERA)
        at = seen.camera_to_map
        off = replace(at, translation=at.translation + np.array([0.0, 0.0, drift_m * k / 21]))
        memory.follow(replace(seen, camera_to_map=off))
    (found,) = memory.connectors
    assert found.is_usable
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.2


@pytest.mark.parametrize("nothing_m", [0.0, math.nan, math.inf, 5.0, 9.0])
def test_stairs_down_are_seen_whatever_a_sensor_says_where_nothing_in_range_comes_back(
    nothing_m: float,
):
    memory = memory_after([])
    for pose in before_stairs(2.6, 2.3, 2.0, 1.7):
        seen = view_of(stairs_down(), pose, camera=CAMERA)
        dark = np.where(seen.depth == 0.0, np.float32(nothing_m), seen.depth)
        memory.follow(replace(seen, depth=dark))
    (found,) = usable(memory)
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.4


def test_a_raised_room_does_not_tell_how_high_the_robot_stands():
    """It takes up most of what the robot sees, but a part is as high as the robot is said to be."""
    raised: SolidBox = ((2.0, 0.0, 0.0), (8.0, 6.0, 0.18))
    poses = [Pose2(1.8, 3.0, yaw) for yaw in np.arange(-2.0, 2.1, 0.5)]
    memory = memory_after([*room(8.0, 6.0), raised], *poses)
    assert memory.elevation is not None
    assert memory.elevation.ground_z == pytest.approx(0.0, abs=0.01)
    assert not memory.connectors


def test_the_long_side_of_a_stairwell_is_no_head_of_stairs():
    beside = [Pose2(3.0, y, yaw) for y in (0.0, 0.3, 0.6) for yaw in (1.2, math.pi / 2.0, 1.9)]
    assert not usable(memory_after(stairwell(), *beside))
    across = usable(memory_after(stairwell(beyond_m=4.0), *beside))
    assert any(one.end[1] == pytest.approx(2.0, abs=0.2) for one in across)


def test_the_head_of_stairs_in_an_open_well_is_seen_from_before_it():
    before = [Pose2(x, 2.55, math.pi) for x in (7.2, 7.0, 6.8)]
    (found,) = usable(memory_after(stairwell(), *before))
    assert math.dist(found.end, (5.0, 2.55)) < 0.4
    assert abs(wrap_angle(found.axis - math.pi)) < math.radians(20.0)


@pytest.mark.parametrize("steps", [2, 3])
def test_a_few_steps_down_to_a_wall_or_a_lower_floor_are_stairs(steps: int):
    """A quarter landing after them, or a lower level of a split floor, between walls."""
    before = [Pose2(4.0 - away_m, 2.0, 0.0) for away_m in (2.6, 2.2, 1.8, 1.5)]
    low, high = 1.4, 2.6
    treads: list[SolidBox] = [
        ((4.0 + k * TREAD_M, low, -3.0), (4.0 + (k + 1) * TREAD_M, high, -(k + 1) * RISE_M))
        for k in range(steps)
    ]
    boxes: list[SolidBox] = [
        ((-8.0, -8.0, -3.0), (4.0, 8.0, 0.0)),
        *treads,
        ((4.0, -8.0, -3.0), (12.0, 8.0, -(steps + 1) * RISE_M)),
        ((4.0, -8.0, -3.0), (4.1, low, 2.5)),
        ((4.0, high, -3.0), (4.1, 8.0, 2.5)),
        ((5.4, -8.0, -3.0), (5.5, 8.0, 2.5)),
    ]
    (found,) = usable(memory_after(boxes, *before))
    assert math.dist(found.end, (4.0, 2.0)) < 0.4


@pytest.mark.parametrize("landing_m", [0.9, 1.1])
def test_a_head_of_stairs_that_was_seen_whole_stays_where_it_is(landing_m: float):
    """From 0.6 m away only its ends are in sight, and one may seem to be all of it."""
    low, high, far = *SIDES_Y, FIRST_X + 5 * TREAD_M
    treads: list[SolidBox] = [
        (
            (FIRST_X + k * TREAD_M, low, -3.0),
            (FIRST_X + (k + 1) * TREAD_M, high, -(k + 1) * RISE_M),
        )
        for k in range(5)
    ]
    onwards: list[SolidBox] = [
        (
            (far, high + k * TREAD_M, -3.0),
            (far + landing_m, high + (k + 1) * TREAD_M, -(k + 7) * RISE_M),
        )
        for k in range(8)
    ]
    boxes: list[SolidBox] = [
        ((-8.0, -8.0, -3.0), (FIRST_X, 8.0, 0.0)),
        *treads,
        ((far, low, -3.0), (far + landing_m, high, -6 * RISE_M)),
        *onwards,
        ((FIRST_X, -8.0, -3.0), (FIRST_X + 0.1, low, 2.5)),
        ((FIRST_X, high, -3.0), (far, 8.0, 0.0)),
        ((far - 0.05, high, -3.0), (far, 8.0, 2.5)),
        ((FIRST_X, low - 0.1, -3.0), (far + landing_m, low, 2.5)),
        ((far + landing_m, -8.0, -3.0), (far + landing_m + 0.1, 8.0, 2.5)),
    ]
    (found,) = usable(memory_after(boxes, *before_stairs(4.0, 3.0, 2.2, 1.8, 1.4, 1.0, 0.6)))
    assert math.dist(found.end, (FIRST_X, MIDDLE_Y)) < 0.4


def test_what_turns_out_to_be_the_side_of_a_stairwell_counts_no_longer():
    memory = memory_after(stairwell(beyond_m=4.0), *(Pose2(3.0, y, 1.57) for y in (0.0, 0.3)))
    (side,) = usable(memory)
    ground = memory.ground_around((3.0, 0.3), down=True)
    walled = memory.floor.map.grid
    along = np.stack([np.arange(1.0, 5.0, 0.05), np.full(80, side.end[1] + 1.0)], axis=1)
    grid = OccupancyGrid(np.full((200, 200), Cell.UNKNOWN, np.uint8), 0.05, (-2.0, -2.0))
    assert without_sides([side], 0, ground, 0.0, walled) == (side,)
    grid.cells[grid.mask_of(along)] = Cell.OCCUPIED
    (now,) = without_sides([side], 0, ground, 0.0, grid)
    assert not now.is_usable
    assert not now.is_doubtful
    assert ConnectorRecord.of(now).connector() == now  # as a memory keeps it
    taken = replace(side, passage=Passage.USED)
    assert without_sides([taken], 0, ground, 0.0, grid) == (taken,)


def test_floor_that_nobody_saw_beyond_a_railing_is_not_before_the_stairs():
    """Stairs lead from the floor at x = 4.2 towards -x, below the railing at y = 2."""
    shape, cell_m = (70, 110), 0.05
    unseen, is_presumed = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    heights = np.zeros(shape, dtype=np.float32)
    cells = np.full(shape, Cell.FREE, dtype=np.uint8)
    cells[40:43, :72] = cells[63:] = Cell.OCCUPIED
    is_presumed[43:63, :72] = True
    is_presumed[48:53, 40:52], unseen[48:53, 40:52] = False, True
    for k in range(2):
        tread = slice(84 - 6 * (k + 1), 84 - 6 * k)
        heights[40:63, tread] = -RISE_M * (k + 1)
    unseen[43:63, 70:72], is_presumed[43:63, 70:72] = True, False
    grid = OccupancyGrid(cells, cell_m, (0.0, 0.0))
    around = np.where(is_presumed | unseen, np.nan, heights).astype(np.float32)
    around[:, 70:72] = -3.0 * RISE_M
    seen = ~(is_presumed | unseen)
    ground = Ground(
        grid,
        np.where(unseen, np.nan, heights),
        seen,
        reach(grid, (2.0, 1.0), 0.1),
        is_presumed,
        0.1,
        UnseenGround(unseen, around),
        np.zeros(shape, dtype=bool),
    )
    (found,) = connectors_in(ground, 0, 0.0)
    assert not found.goes_up
    assert math.dist(found.end, (4.2, 2.6)) < 0.5
    assert math.cos(found.axis - math.pi) > math.cos(math.radians(20.0))


FURNITURE: dict[str, SolidBox] = {
    "bed": ((3.0, 0.5, 0.0), (5.0, 2.1, 0.5)),
    "stool": ((3.0, 1.8, 0.0), (3.4, 2.2, 0.4)),
    "step": ((3.0, 0.0, 0.0), (6.0, 4.0, 0.18)),
    "table": ((3.0, 1.0, 0.7), (4.6, 2.0, 0.75)),
}


@pytest.mark.parametrize("name", sorted(FURNITURE))
def test_furniture_and_single_steps_are_no_stairs(name: str):
    towards = [Pose2(x, 2.0, yaw) for x in (1.0, 2.0) for yaw in (-0.5, 0.0, 0.5)]
    assert not usable(memory_after([*room(6.0, 4.0), FURNITURE[name]], *towards))


def test_an_edge_behind_a_wall_leads_nowhere():
    wall: SolidBox = ((FIRST_X - 0.1, -10.0, 0.0), (FIRST_X, 10.0, 0.85))
    assert not usable(memory_after([*stairs_down(), wall], *before_stairs(3.0, 2.5, 2.0)))


@pytest.mark.parametrize("pitch_deg", [-40.0, -31.7, -20.0, 20.0, 70.0])
def test_a_tilted_camera_knows_no_more_ground_than_its_range(pitch_deg: float):
    camera = CLIMBER.camera.model_copy(update={"pitch_deg": pitch_deg})
    memory = Memory(MappingConfig(), Embodiment(body=CLIMBER.body, camera=camera))
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CAMERA, pitch_deg=pitch_deg))
    ground = memory.ground_around((0.0, 0.0), down=True)
    away = ground.distances_m((0.0, 0.0))[ground.reached]
    assert away.max() <= camera.max_depth_m + 0.5


@pytest.mark.parametrize(("side_m", "is_ground"), [(0.3, True), (1.0, False)])
def test_a_spot_without_depth_in_the_midst_of_the_floor_is_no_hole(side_m: float, is_ground: bool):
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    seen = view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CAMERA)
    x, y = seen.camera.ray_slopes()
    ahead_m = CLIMBER.camera.height_m / np.maximum(y, 1e-6)[:, None]
    dark = (np.abs(ahead_m - 2.5) < side_m / 2.0) & (np.abs(x * ahead_m) < side_m / 2.0)
    memory.follow(replace(seen, depth=np.where(dark, np.float32(0.0), seen.depth)))
    ground = memory.ground_around((0.0, 0.0), down=False)
    assert ground.reached[ground.grid.cell_of(2.5, 0.0)] == is_ground


@pytest.mark.parametrize("height_m", [0.45, 1.0])
def test_stairs_up_are_seen_by_a_low_robot_with_a_mast_too(height_m: float):
    robot = Embodiment(body=BodyConfig(max_step_m=0.2, height_m=height_m))
    boxes = [FLOOR, *stairs_up()]
    memory = memory_after(boxes, *before_stairs(2.5, 2.0), robot=robot)
    assert [one.goes_up for one in memory.connectors] == [True]
    ground = memory.ground_around((FIRST_X - 2.0, MIDDLE_Y), down=True, under=True)
    assert np.nanmax(np.where(ground.seen, ground.measured, np.nan)) <= height_m


def test_an_edge_that_is_too_near_to_be_seen_whole_counts_as_what_is_known_there():
    known, near, far = [edge(0.0)], (0.5, 0.0), (2.0, 0.0)
    ground = memory_after([FLOOR], Pose2(0.5, 0.0, 0.0)).ground_around(near, down=True)
    assert reliable([edge(0.2, x=0.1), edge(1.0)], known, near, ground, 0.0) == known
    assert reliable([edge(0.2), edge(1.0)], known, far, ground, 0.0) == [edge(0.2), edge(1.0)]
    assert reliable([edge(0.0, x=3.0)], known, (3.0, 0.5), ground, 0.0) == []
    up = Connector(0, True, (0.0, 0.0), 0.0)
    assert reliable([up], [], near, ground, 0.0) == [up]


def test_a_near_edge_counts_if_steps_beyond_it_were_seen():
    steps_and_wall = stairs_down()[:-1]
    gallery: SolidBox = ((FIRST_X, SIDES_Y[1], -3.0), (12.0, 10.0, 0.0))
    across = [Pose2(FIRST_X + 0.2, SIDES_Y[1] + away_m, -math.pi / 2.0) for away_m in (2.4, 2.0)]
    before, near = (FIRST_X - 0.4, MIDDLE_Y), Connector(0, False, (FIRST_X, MIDDLE_Y), 0.0)
    ground = memory_after([*steps_and_wall, gallery], *across).ground_around(before, down=True)
    assert reliable([near], [], before, ground, 0.0) == [near]
    unseen = memory_after(stairs_down(), *before_stairs(2.0, 0.4)).ground_around(before, down=True)
    assert reliable([near], [], before, unseen, 0.0) == []


@pytest.mark.parametrize(
    ("cell_m", "width_m", "is_ground"),
    [(0.05, 0.08, True), (0.05, 0.7, False), (0.2, 0.12, True), (0.2, 0.5, False)],
)
def test_what_was_seen_below_a_landing_leaves_no_pits_in_it(
    cell_m: float, width_m: float, is_ground: bool
):
    below: SolidBox = ((-9.0, -9.0, -3.0), (9.0, 9.0, -1.4))
    gap_x = 3.4
    landing: list[SolidBox] = [
        ((-9.0, -9.0, -3.0), (gap_x, 9.0, 0.0)),
        ((gap_x + width_m, -9.0, -3.0), (9.0, 9.0, 0.0)),
    ]
    memory = Memory(MappingConfig(cell_size_m=cell_m), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([below], Pose2(-1.0, 0.0, 0.0), camera=CAMERA))
    for x in (0.2, 0.6, 1.0, 1.4, 1.8):
        memory.follow(view_of([below, *landing], Pose2(x, 0.0, 0.0), camera=CAMERA))
    ground = memory.ground_around((1.8, 0.0), down=False)
    beyond = ground.grid.cell_of(gap_x + width_m + 0.4, 0.0)
    assert ground.seen[beyond]
    assert ground.reached[beyond] == is_ground
