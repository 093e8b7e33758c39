"""Stairs are seen in both directions, and furniture is no stairs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from box_views import FLOOR, SolidBox, room, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.exploring.floors import Drop
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.ground import Ground, UnseenGround, reach
from hypernav.mapping.memory.connectors import (
    Connector,
    Passage,
    connectors_in,
    reliable,
    relied_on,
    with_sightings,
)
from hypernav.mapping.memory.drops import drops_to_look_at
from hypernav.mapping.memory.index import ConnectorRecord
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.stair_edges import without_sides
from hypernav.mapping.memory.ways import (
    known_floors,
    ways_out,
    ways_to_new_floors,
    ways_to_unseen,
)
from stair_views import (
    FIRST_X,
    RISE_M,
    SIDES_Y,
    TREAD_M,
    stairs_down,
    stairs_up,
    stairwell,
)

CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))
CAMERA = CLIMBER.camera.intrinsics
MIDDLE_Y = sum(SIDES_Y) / 2.0


def memory_after(boxes: list[SolidBox], *poses: Pose2, robot: Embodiment = CLIMBER) -> Memory:
    memory = Memory(MappingConfig(), robot)
    memory.begin_search(sees_stairs=True)
    for pose in poses:
        memory.follow(view_of(boxes, pose, camera=CAMERA))
    return memory


def before_stairs(*distances_m: float, yaw: float = 0.0) -> list[Pose2]:
    return [Pose2(FIRST_X - away_m, MIDDLE_Y, yaw) for away_m in distances_m]


def usable(memory: Memory) -> list[Connector]:
    return [one for one in memory.connectors if one.is_usable]


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


def test_one_image_is_not_enough_to_rely_on_stairs():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(2.5))
    assert memory.connectors
    assert not ways_out(memory)


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


def test_a_robot_that_cannot_climb_looks_for_no_stairs():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(2.5, 2.0), robot=Embodiment())
    assert memory.elevation is None
    assert not memory.connectors
    assert not memory.on_stairs


def test_stairs_without_a_path_are_a_way_again_once_exploration_begins_anew():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5, 2.0))
    (way,) = ways_out(memory)
    memory.search.unreached.add(way.connector)
    assert not ways_out(memory)
    memory.search.forget_exploration()
    assert ways_out(memory) == [way]


def test_stairs_that_were_refuted_are_no_way_out_however_often_they_are_seen():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    assert len(ways_out(memory)) == 1
    memory.give_up(0)
    for pose in before_stairs(2.5, 2.4):
        memory.follow(view_of([FLOOR, *stairs_up()], pose, camera=CAMERA))
    assert not ways_out(memory)


def test_where_the_floor_ends_is_looked_at_from_near_unless_stairs_are_known_there():
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    memory = memory_after([FLOOR])
    floor = memory.floor

    def look_from(*distances_m: float, yaw: float = 0.0):
        for pose in before_stairs(*distances_m, yaw=yaw):
            floor.integrate(view_of(well, pose, camera=CAMERA))

    look_from(3.0, 2.5, 2.0)
    (edge,) = drops_to_look_at(memory)
    assert edge.xy == pytest.approx((FIRST_X, MIDDLE_Y), abs=0.7)
    assert edge.axis is None
    for is_up in (True, False):
        memory.connectors = (Connector(0, is_up, (FIRST_X, MIDDLE_Y), 0.0, sightings=2),)
        assert not drops_to_look_at(memory)
    memory.connectors = (Connector(1, False, (FIRST_X, MIDDLE_Y), 0.0, sightings=2),)
    assert drops_to_look_at(memory) == [edge]
    memory.connectors = (Connector(0, False, (FIRST_X, MIDDLE_Y), 0.1, sightings=1),)
    doubtful = memory.connectors
    assert drops_to_look_at(memory) == [Drop(FIRST_X, MIDDLE_Y, axis=0.1)]
    look_from(1.0, 0.5, 0.2, yaw=math.pi)
    for known in ((), doubtful):
        memory.connectors = known
        assert drops_to_look_at(memory)
    look_from(1.0, 0.5, 0.2)
    for known in ((), doubtful):
        memory.connectors = known
        assert not drops_to_look_at(memory)


@pytest.mark.parametrize("height_m", [0.45, 1.0])
def test_stairs_up_are_seen_by_a_low_robot_with_a_mast_too(height_m: float):
    robot = Embodiment(body=BodyConfig(max_step_m=0.2, height_m=height_m))
    boxes = [FLOOR, *stairs_up()]
    memory = memory_after(boxes, *before_stairs(2.5, 2.0), robot=robot)
    assert [one.goes_up for one in memory.connectors] == [True]
    ground = memory.ground_around((FIRST_X - 2.0, MIDDLE_Y), down=True, under=True)
    assert np.nanmax(np.where(ground.seen, ground.measured, np.nan)) <= height_m


def test_behind_a_railing_the_floor_ends_for_nobody():
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    bars = [
        ((FIRST_X - 0.1, y, 0.0), (FIRST_X - 0.05, y + 0.03, 0.9))
        for y in np.arange(MIDDLE_Y - 1.5, MIDDLE_Y + 1.5, 0.12)
    ]
    for boxes, expected in ((well, 1), ([*well, *bars], 0)):
        memory = memory_after([FLOOR])
        for pose in before_stairs(3.0, 2.5, 2.0):
            memory.floor.integrate(view_of(boxes, pose, camera=CAMERA))
        assert len(memory.floor.map.edges_to_drops()) > 0
        assert len(drops_to_look_at(memory)) == expected


@pytest.mark.parametrize(
    ("storey_m", "is_known"), [(-0.9, False), (-1.8, True), (-3.0, True), (-5.6, False)]
)
def test_where_the_robot_knows_the_next_floor_down_no_edge_is_looked_at(
    storey_m: float, is_known: bool
):
    """Of a floor two storeys down it knows only that there is one between."""
    well = [*stairs_down(), ((5.2, -10.0, -3.0), (12.0, 10.0, 2.5))]
    memory = memory_after([FLOOR])
    for pose in before_stairs(3.0, 2.5, 2.0):
        memory.floor.integrate(view_of(well, pose, camera=CAMERA))
    memory.add_floor(storey_m)
    assert drops_to_look_at(memory)
    far = (FIRST_X, MIDDLE_Y - 3.0)
    taken = Connector(0, False, far, 0.0, Passage.USED, other_floor=1, sightings=2)
    memory.connectors = (taken,)
    assert bool(drops_to_look_at(memory)) is not is_known


@pytest.mark.parametrize("goes_up", [True, False])
def test_new_stairs_towards_the_floor_that_the_robot_came_from_lead_to_no_new_one(goes_up: bool):
    memory = memory_after([FLOOR])
    down, up = (Connector(0, one, (5.0, 0.0), 0.0, sightings=2) for one in (False, True))
    memory.connectors = (down, up)
    assert [one.connector for one in ways_to_new_floors(memory)] == [0, 1]
    memory.add_floor(2.6 if goes_up else -2.6)
    used = replace(up if goes_up else down, end=(9.0, 0.0), passage=Passage.USED, other_floor=1)
    memory.connectors = (down, up, used)
    assert [one.connector for one in ways_to_new_floors(memory)] == [0 if goes_up else 1]
    assert [one.connector for one in ways_to_unseen(memory)] == [0 if goes_up else 1, 2]
    memory.number = 1
    memory.connectors = (*memory.connectors, replace(used, floor=1, other_floor=0))
    (left,) = known_floors(memory)
    assert [one.connector for one in left.stairs] == [0 if goes_up else 1, 2]
    memory.number = 0
    memory.give_up(2)
    assert [one.connector for one in ways_to_new_floors(memory)] == [0, 1]


def test_used_stairs_are_known_from_both_ends_and_lead_on_until_all_is_explored():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    there, back = memory.connectors
    assert (there.floor, there.other_floor, there.goes_up) == (0, 1, True)
    assert (back.floor, back.other_floor, back.goes_up) == (1, 0, False)
    assert [one.connector for one in ways_out(memory)] == [1]
    assert not ways_to_new_floors(memory)
    memory.floors[0].was_explored = memory.floors[0].search.is_explored = True
    assert not ways_out(memory)


def test_a_floor_that_an_earlier_search_explored_is_not_unseen_and_yet_left_to_this_one():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    memory.floors[0].was_explored = True
    memory.begin_search(sees_stairs=True)
    assert not ways_to_unseen(memory)
    assert [one.connector for one in ways_out(memory)] == [1]


def test_the_way_to_what_is_unseen_is_the_one_over_the_fewest_stairs():
    """Else a robot between two such ways might go to and fro."""
    memory = memory_after([FLOOR], Pose2(0.0, 0.0, 0.0))
    memory.add_floor(1.8)
    up = Connector(0, True, (1.0, 0.0), 0.0, Passage.USED, other_floor=1, sightings=2)
    back = replace(up, floor=1, goes_up=False, other_floor=0)
    new = Connector(0, False, (5.0, 0.0), 0.0, sightings=2)
    memory.connectors = (up, back, replace(new, floor=1, goes_up=True))
    memory.floors[0].was_explored = memory.floors[1].was_explored = True
    assert [one.connector for one in ways_to_unseen(memory)] == [0]
    memory.connectors = (*memory.connectors, new)
    assert [one.connector for one in ways_to_unseen(memory)] == [3]
    memory.give_up(3)
    memory.floors[1].search.given_up.add(2)
    assert not ways_to_unseen(memory)


def test_stairs_that_were_taken_stay_a_way_though_a_search_fails_on_them():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.number = memory.add_floor(1.8)
    memory.crossed(0)
    memory.give_up(1)
    assert not ways_out(memory)
    memory.begin_search(sees_stairs=True)
    assert [one.connector for one in ways_out(memory)] == [1]
    assert {one.passage for one in memory.connectors} == {Passage.USED}


def test_stairs_to_another_level_of_the_floor_are_stairs_and_no_way_out():
    memory = memory_after([FLOOR, *stairs_up()], *before_stairs(3.0, 2.5))
    memory.reached_level(0)
    assert memory.connectors[0].passage is Passage.USED
    assert not ways_out(memory)


def edge(axis: float, *, x: float = 0.0) -> Connector:
    return Connector(0, False, (x, 0.0), axis)


def test_an_edge_that_is_too_near_to_be_seen_whole_counts_if_it_agrees_with_what_is_known():
    known, near, far = [edge(0.0)], (0.5, 0.0), (2.0, 0.0)
    ground = memory_after([FLOOR], Pose2(0.5, 0.0, 0.0)).ground_around(near, down=True)
    assert reliable([edge(0.2), edge(1.0)], known, near, ground, 0.0) == [edge(0.2)]
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


def test_the_axis_is_the_mean_of_sightings_that_agree():
    (known,) = with_sightings([edge(0.0)], [edge(0.2)])
    assert known.axis == pytest.approx(0.1)
    (known,) = with_sightings([known], [edge(0.1 + math.tau)])
    assert known.axis == pytest.approx(0.1)
    (known,) = with_sightings([known], [edge(1.5)])
    assert known.axis == 1.5


def test_stairs_that_the_robot_is_on_count_however_seldom_they_were_seen():
    here = Connector(0, False, (3.0, 1.0), 0.0)
    once = replace(here, end=(3.4, 1.0), axis=0.2, sightings=1)
    known, number = relied_on([once], here)
    assert (number, [one.end for one in known]) == (0, [once.end])
    assert known[0].is_new
    known, number = relied_on([], here)
    assert number == 0
    assert known[0].is_new


@pytest.mark.parametrize("passage", [Passage.USED, Passage.REFUTED])
def test_stairs_that_were_tried_are_not_relied_on_anew(passage):
    floor = 1 if passage is Passage.USED else None
    tried = Connector(0, False, (3.0, 1.0), 0.0, passage=passage, other_floor=floor)
    assert relied_on([tried], replace(tried, passage=Passage.UNTRIED)) == ((tried,), None)


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
