"""On a flight of stairs the robot keeps to its axis, and does not go the way back."""

import math
from dataclasses import replace

import numpy as np
import pytest

from box_views import FLOOR, SolidBox, view_of
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.elevation_map import Ground, UnseenGround
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.mapping.stairs.flights import (
    first_ahead,
    first_flight,
    flight_down,
    flight_from,
    flight_underfoot,
    from_front,
    landing_z,
    on_flight,
    stairs_ahead,
)
from hypernav.search.mapping.stairs.seen_connectors import connectors_in
from stair_views import (
    CLIMBER,
    FIRST_X,
    MIDDLE_Y,
    RISE_M,
    SIDES_Y,
    TREAD_M,
    memory_after,
    stairs_down,
    stairs_up,
)

HEAD = Pose2(FIRST_X - 0.3, MIDDLE_Y, 0.0)
FLIGHT = Connector(0, False, (FIRST_X, MIDDLE_Y), 0.0)


def before_the_edge() -> list[Pose2]:
    return [Pose2(FIRST_X - away_m, MIDDLE_Y, 0.0) for away_m in (2.0, 1.5, 0.8, 0.3)]


def open_stairs() -> list[SolidBox]:
    """The stairs down without the wall at their left, where the lower room is."""
    return [box for box in stairs_down() if not (box[0][1] == SIDES_Y[1] and box[1][1] == 10.0)]


def test_beside_the_axis_of_a_flight_down_is_no_ground():
    memory = memory_after(open_stairs(), *before_the_edge())
    ground = memory.ground_around(HEAD.xy, down=True)
    beside_m = np.abs(ground.positions(ground.reached & ~ground.seen)[:, 1] - MIDDLE_Y)
    assert beside_m.max() > 1.0
    way = on_flight(ground, HEAD, 0.0, FLIGHT, goes_up=False)
    x, y = way.positions(way.reached & ~way.seen).T
    assert np.abs(y[x > FIRST_X + 0.1] - MIDDLE_Y).max() < (SIDES_Y[1] - SIDES_Y[0]) / 2.0 - 0.2
    ahead = way.positions(stairs_ahead(way, HEAD, 0.0, FLIGHT, goes_up=False, on_slope=False))
    assert (ahead[:, 0] > FIRST_X).all()
    assert np.abs(ahead[:, 1] - MIDDLE_Y).max() < 0.2


def test_the_way_down_does_not_lead_up_again():
    memory = memory_after([FLOOR, *stairs_up()], *(Pose2(x, MIDDLE_Y, 0.0) for x in (2.0, 2.5)))
    robot = Pose2(2.5, MIDDLE_Y, 0.0)
    ground = memory.ground_around(robot.xy, down=True)
    assert ground.between(0.4, 2.0).any()
    way = on_flight(ground, robot, 0.0, None, goes_up=False)
    assert not way.between(0.4, 2.0).any()
    assert way.between(-0.1, 0.1).any()


@pytest.mark.parametrize("off_m", [-0.13, 0.0, 0.13])
def test_a_landing_is_as_high_as_it_looks(off_m: float):
    poses = [Pose2(0.0, 0.0, yaw) for yaw in np.arange(0.0, 2.0 * math.pi, math.pi / 6.0)]
    wall: SolidBox = ((2.0, -9.0, 0.0), (2.1, 9.0, 2.0))
    memory = memory_after([FLOOR, wall], *poses, Pose2(1.0, 0.0, 0.0), z=off_m)
    robot = Pose2(1.0, 0.0, 0.0)
    ground = memory.ground_around(robot.xy, down=True)
    assert landing_z(ground, robot, memory.footing.z) == pytest.approx(0.0, abs=0.03)


@pytest.mark.parametrize(("off_m", "is_its_own"), [(0.25, True), (-0.25, True), (0.4, False)])
def test_ground_much_more_than_a_step_off_is_not_the_robot_s_landing(
    off_m: float, is_its_own: bool
):
    """A mesh is off by up to a step; what is farther off is other ground, such as treads."""
    memory = memory_after([FLOOR], Pose2(0.0, 0.0, 0.0))
    robot = Pose2(1.5, 0.0, 0.0)
    ground = memory.ground_around(robot.xy, down=True)
    looks_z = 0.0 if is_its_own else off_m
    assert landing_z(ground, robot, off_m) == pytest.approx(looks_z, abs=0.03)


@pytest.mark.parametrize("off_m", [-0.13, 0.13])
def test_where_the_robot_has_stood_tells_not_how_high_a_landing_is(off_m: float):
    """It walks where no image shows the ground, on a mesh that is off."""
    around = [Pose2(0.0, 0.0, yaw) for yaw in np.arange(0.0, 2.0 * math.pi, math.pi / 6.0)]
    walk = [Pose2(0.1 * k, y, math.pi / 2.0) for y in (-0.4, -0.2, 0.0, 0.2) for k in range(-3, 10)]
    wall: SolidBox = ((-9.0, 1.2, 0.0), (9.0, 1.3, 2.0))
    memory = memory_after([FLOOR, wall], *around, *walk, z=off_m)
    robot = walk[-1]
    ground = memory.ground_around(robot.xy, down=True)
    assert (ground.seen & ground.stood).sum() > 100
    assert landing_z(ground, robot, memory.footing.z) == pytest.approx(0.0, abs=0.03)


@pytest.mark.parametrize("quarters", [-1, 0, 1, 2])
def test_the_next_flight_is_parallel_or_at_right_angles_to_the_first(quarters: int):
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    first = replace(FLIGHT, end=(9.0, 9.0), axis=quarters * math.pi / 2.0 + 0.1)
    found = flight_down(ground, robot, 0.0, None, first)
    assert found is not None
    assert math.dist(found.end, FLIGHT.end) < 0.4
    assert math.cos(found.axis) == pytest.approx(math.cos(0.1))
    assert flight_down(ground, robot, 0.0, None, replace(first, axis=math.pi / 4.0)) is None


def test_a_flight_that_begins_here_is_not_taken_for_another_one():
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    here = replace(FLIGHT, end=(robot.x, robot.y - 1.2), axis=-math.pi / 2.0)
    assert flight_down(ground, robot, 0.0, here, FLIGHT) is here
    across = replace(FLIGHT, axis=math.pi / 2.0)
    assert flight_down(ground, robot, 0.0, across, FLIGHT) is across


def test_a_spot_that_is_lowest_does_not_hide_the_tread_above_it():
    ground = memory_after([FLOOR], HEAD).ground_around(HEAD.xy, down=False)
    ahead_m, beside_m = ground.along(HEAD.xy, 0.0)
    measured = ground.measured.copy()
    tread = ground.seen & ground.reached & (np.abs(ahead_m - 2.0) < 0.14) & (beside_m < 0.5)
    measured[tread] = -0.18
    spot = ground.seen & ground.reached & (np.abs(ahead_m - 3.0) < 0.1) & (beside_m < 0.1)
    measured[spot] = -0.3
    assert 0 < spot.sum() < tread.sum()
    seen = replace(ground, measured=measured)
    to = stairs_ahead(seen, HEAD, 0.0, None, goes_up=False, on_slope=False)
    assert to[tread].all()


def test_a_flight_that_leads_towards_the_robot_is_not_the_next_one():
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    (edge,) = [one for one in connectors_in(ground, 0, 0.0) if not one.goes_up]
    assert flight_down(ground, robot, 0.0, None, FLIGHT) is not None
    beyond = Pose2(edge.end[0] + 0.5, edge.end[1], math.pi)  # where the stairs would be level
    assert flight_down(ground, beyond, 0.0, None, FLIGHT) is None


def test_a_flight_that_the_robot_has_passed_on_level_ground_is_none():
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    across = replace(FLIGHT, end=robot.ahead(0.5).xy, axis=math.pi / 2.0)
    assert flight_down(ground, robot, 0.0, across, FLIGHT) is across
    passed = replace(across, end=(robot.x + 0.5, robot.y - 0.5))
    found = flight_down(ground, robot, 0.0, passed, FLIGHT)
    assert found is not None
    assert math.cos(found.axis) == pytest.approx(1.0)


def test_from_a_landing_presumed_stairs_count_beside_the_few_steps_that_are_seen():
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    presumed = ground.presumed & ground.reached
    few = np.zeros_like(presumed)
    few[tuple(np.argwhere(presumed)[:12].T)] = True
    partly = replace(
        ground,
        measured=np.where(few, np.float32(-0.18), ground.measured),
        seen=ground.seen | few,
        presumed=ground.presumed & ~few,
    )
    to = stairs_ahead(partly, robot, 0.0, None, goes_up=False, on_slope=False)
    assert (to & partly.presumed).sum() > few.sum()


@pytest.mark.parametrize("goes_up", [True, False])
@pytest.mark.parametrize("count", [5, 30])
def test_a_spot_off_the_floor_is_no_stairs(count: int, goes_up: bool):
    """Where heights err, a corner of a landing may look as much lower as a tread does."""
    ground = memory_after([FLOOR], HEAD).ground_around(HEAD.xy, down=False)
    few = np.zeros_like(ground.seen)
    few[tuple(np.argwhere(ground.seen & ground.reached)[-count:].T)] = True
    height = np.float32(0.2 if goes_up else -0.2)
    specks = replace(ground, measured=np.where(few, height, ground.measured))
    assert not stairs_ahead(specks, HEAD, 0.0, None, goes_up=goes_up, on_slope=False).any()


def test_the_flight_of_a_connector_leads_where_the_robot_goes():
    assert flight_from(FLIGHT, goes_up=False) is FLIGHT
    back = flight_from(FLIGHT, goes_up=True)
    assert (back.goes_up, back.end) == (True, FLIGHT.end)
    assert math.cos(back.axis) == pytest.approx(-1.0)


def test_a_robot_between_two_treads_can_go_on():
    """The mesh that it stands on is not as high as the tread, which no image shows."""
    low, high = SIDES_Y
    hole = 0.28
    boxes: list[SolidBox] = [
        ((-10.0, -10.0, -3.0), (FIRST_X, 10.0, 0.0)),
        ((FIRST_X + hole, low, -3.0), (FIRST_X + 3.0, high, -0.36)),
        ((-10.0, -10.0, -3.0), (20.0, 10.0, -2.0)),
    ]
    memory = memory_after(boxes)
    camera, height_m = CLIMBER.camera.intrinsics, CLIMBER.camera.height_m
    for x, z, pitch_deg in ((FIRST_X - 0.5, 0.0, 30.0), (FIRST_X + hole / 2.0, -0.1, 0.0)):
        pose = Pose2(x, MIDDLE_Y, 0.0)
        memory.follow(
            view_of(boxes, pose, camera=camera, height_m=height_m + z, pitch_deg=pitch_deg)
        )
    ground = memory.ground_around(pose.xy, down=True)
    ahead = [ground.grid.cell_of(pose.x + 0.05 * k, pose.y) for k in range(4, 12)]
    assert all(ground.reached[cell] for cell in ahead)


def test_a_floor_counts_at_the_height_at_which_the_robot_walks_on_it():
    floor_z = -3.09
    boxes: list[SolidBox] = [((-30.0, -30.0, -4.0), (30.0, 30.0, floor_z))]
    memory = memory_after(boxes)
    camera, height_m = CLIMBER.camera.intrinsics, CLIMBER.camera.height_m
    for k, z in enumerate((-2.93, -2.97, -3.0, -3.0, -3.0)):
        pose = Pose2(0.5 * k, 0.0, 0.0)
        memory.follow(view_of(boxes, pose, camera=camera, height_m=height_m + z))
    assert memory.number == 1
    assert memory.floor.z == pytest.approx(-3.0)
    assert not memory.on_stairs
    ground = memory.ground_around((2.0, 0.0), down=False)
    far = memory.footing.way_on(ground, -2.93, 2.0, ())
    assert (far & ground.seen).any()


def test_the_way_on_is_ahead_where_there_is_one():
    robot = Pose2(0.0, 0.0, 0.0)
    memory = memory_after([((-30.0, -30.0, -1.0), (30.0, 30.0, 0.0))], robot)
    ground = memory.ground_around(robot.xy, down=False)
    away = ground.distances_m(robot.xy)
    clear = ground.reached & (away >= 0.8)
    points = ground.positions(first_ahead(ground, robot, clear))
    assert len(points)
    assert (points[:, 0] > np.abs(points[:, 1]) - 0.1).all()
    behind = clear & (ground.along(robot.xy, 0.0)[0] < 0.0)
    assert (first_ahead(ground, robot, behind) == behind).all()
    assert not first_ahead(ground, robot, ground.reached).any()


@pytest.mark.parametrize(("below_m", "is_away"), [(1.5, False), (2.5, True)])
def test_a_storey_lies_farther_down_than_a_landing(below_m: float, is_away: bool):
    memory = memory_after([FLOOR], Pose2(0.0, 0.0, 0.0), z=-below_m)
    assert memory.footing.is_storey_away == is_away


@pytest.mark.parametrize("quarters", [-1, 0, 1])
def test_the_first_flight_leads_where_most_of_it_was_seen(quarters: int):
    memory = memory_after(stairs_down(), *before_the_edge())
    ground = memory.ground_around(HEAD.xy, down=True)
    askew = replace(FLIGHT, axis=quarters * math.pi / 2.0)
    assert first_flight(ground, askew, 0.0).axis == pytest.approx(0.0)


def elsewhere(ground: Ground, z: float) -> Ground:
    """The ground where x and y are exchanged, so many metres higher."""
    grid, (x, y) = ground.grid, ground.grid.origin
    turned = OccupancyGrid(grid.cells.T.copy(), grid.resolution_m, (y, x))
    masks = (ground.seen, ground.reached, ground.presumed, ground.unseen.cells, ground.stood)
    seen, reached, presumed, unseen, stood = (one.T.copy() for one in masks)
    heights, around = ((one.T + np.float32(z)) for one in (ground.measured, ground.unseen.around))
    return Ground(
        turned,
        heights,
        seen,
        reached,
        presumed,
        ground.least_m,
        UnseenGround(unseen, around),
        stood,
    )


@pytest.mark.parametrize("goes_up", [True, False])
def test_the_first_flight_is_the_same_in_another_direction_on_another_floor(goes_up: bool):
    boxes = [FLOOR, *stairs_up()] if goes_up else stairs_down()
    ground = memory_after(boxes, *before_the_edge()[1:3]).ground_around(HEAD.xy, down=not goes_up)
    for axis in (-math.pi / 2.0, 0.0, math.pi / 2.0):
        one = Connector(0, goes_up, (FIRST_X, MIDDLE_Y + 0.3), axis)
        along_x = first_flight(ground, one, 0.0)
        assert along_x.axis == pytest.approx(0.0)
        assert along_x.end[1] == pytest.approx(MIDDLE_Y, abs=0.11)
        other = replace(one, end=one.end[::-1], axis=math.pi / 2.0 - axis)
        for z in (-3.0, 0.0, 3.0):
            along_y = first_flight(elsewhere(ground, z), other, z)
            assert along_y.axis == pytest.approx(math.pi / 2.0)
            assert along_y.end == pytest.approx(along_x.end[::-1])


@pytest.mark.parametrize("off_m", [-0.45, 0.0, 0.45])
@pytest.mark.parametrize("goes_up", [True, False])
def test_the_first_flight_begins_in_the_middle_of_the_edge_before_it(off_m: float, goes_up: bool):
    boxes = [FLOOR, *stairs_up()] if goes_up else stairs_down()
    memory = memory_after(boxes, *before_the_edge()[:3])
    ground = memory.ground_around(HEAD.xy, down=not goes_up)
    first = Connector(0, goes_up, (FIRST_X - 0.05, MIDDLE_Y + off_m), 0.0)
    assert first_flight(ground, first, 0.0).end[1] == pytest.approx(MIDDLE_Y, abs=0.11)


def test_on_a_platform_without_sides_it_begins_where_it_was_seen():
    platform: SolidBox = ((-10.0, -10.0, -3.0), (FIRST_X, 10.0, 0.0))
    below: SolidBox = ((FIRST_X, -10.0, -3.0), (30.0, 10.0, -1.8))
    memory = memory_after([platform, below], *before_the_edge()[:3])
    ground = memory.ground_around(HEAD.xy, down=True)
    first = replace(FLIGHT, end=(FIRST_X - 0.05, MIDDLE_Y + 0.3))
    assert first_flight(ground, first, 0.0).end == first.end


def test_from_the_front_a_robot_does_not_go_over_the_side_of_the_first_steps():
    memory = memory_after([FLOOR, *stairs_up()], *before_the_edge()[:3])
    ground = memory.ground_around(HEAD.xy, down=False)
    flight = Connector(0, True, (FIRST_X, MIDDLE_Y), 0.0)
    way = from_front(ground, HEAD, flight)
    x, y = way.positions(way.reached).T
    assert x.max() > FIRST_X + 0.5
    assert np.abs(y[x > FIRST_X - 0.15] - MIDDLE_Y).max() < 0.3


def test_a_flight_is_none_where_the_landing_was_seen_to_go_on():
    memory = memory_after(stairs_down(), *before_the_edge()[:2])
    robot = before_the_edge()[1]
    ground = memory.ground_around(robot.xy, down=True)
    level = replace(FLIGHT, end=(FIRST_X - 0.3, MIDDLE_Y), axis=math.pi / 2.0)
    assert ground.seen[ground.grid.cell_of(FIRST_X - 0.3, MIDDLE_Y + 0.6)]
    found = flight_down(ground, robot, 0.0, level, FLIGHT)
    assert found is not None
    assert found.axis == pytest.approx(0.0)


def test_a_step_down_tells_which_flight_the_robot_is_on():
    robot = Pose2(0.4, 0.1, 0.0)
    way = [(0.0, 0.0, 0.0), (*robot.xy, -0.2)]
    known = replace(FLIGHT, end=(0.0, 0.5), axis=0.0)
    beside = flight_underfoot(known, FLIGHT, way, robot)
    assert beside.axis == known.axis
    assert 0.0 < beside.end[1] - robot.y < 0.2
    near = replace(known, end=(0.0, 0.15))
    assert flight_underfoot(near, FLIGHT, way, robot) == near
    for other in (None, replace(FLIGHT, axis=math.pi / 2.0), replace(FLIGHT, axis=math.pi)):
        across = flight_underfoot(other, replace(FLIGHT, axis=math.pi / 2.0), way, robot)
        assert across.end == robot.xy
        assert math.cos(across.axis) == pytest.approx(1.0)


def test_an_axis_stays_that_tells_how_the_ground_fell():
    """Heights on stairs err: these four steps seem to lead down 40 degrees to one side of it."""
    way = [(0.0, 0.0, 0.0), (0.5, 0.05, -0.27), (1.0, 0.1, -0.59), (1.45, -0.14, -1.06)]
    robot = Pose2(1.45, -0.14, 0.0)
    assert flight_underfoot(FLIGHT, FLIGHT, way, robot).axis == pytest.approx(FLIGHT.axis)


def test_an_axis_that_leads_up_tells_nothing_of_a_way_down():
    way = [(0.0, 0.0, 0.0), (0.4, 0.3, -0.26), (0.8, 0.0, -0.52), (1.2, 0.3, -0.78)]
    back = replace(FLIGHT, axis=math.pi)
    robot = Pose2(1.2, 0.3, 0.0)
    assert flight_underfoot(back, FLIGHT, way, robot).axis == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("askew_deg", [-50.0, -40.0, 40.0, 50.0])
def test_steps_down_to_and_fro_tell_where_the_stairs_lead(askew_deg: float):
    """Each of them is nearly as far off the wrong axis as off the right one."""
    known = replace(FLIGHT, axis=math.radians(askew_deg))
    way = [(0.0, 0.0, 0.0), (0.4, 0.3, -0.26), (0.8, 0.0, -0.52), (1.2, 0.3, -0.78)]
    robot = Pose2(1.2, 0.3, 0.0)
    assert flight_underfoot(known, known, way, robot).axis == pytest.approx(0.0, abs=0.01)
    straight = [(0.4 * k, 0.3 * k, -0.26 * k) for k in range(4)]  # tells nothing about its sides
    assert flight_underfoot(replace(known, axis=0.0), known, straight, robot).axis == 0.0


@pytest.mark.parametrize(("fall_m", "is_on_stairs"), [(0.29, False), (0.3, True), (0.31, True)])
def test_only_steps_as_steep_as_stairs_tell_where_these_lead(fall_m: float, is_on_stairs: bool):
    """Of less steep ones, on a mesh that slopes, the latest alone tells which flight it is."""
    across = replace(FLIGHT, axis=math.pi / 2.0)
    way = [(0.0, 0.0, 2.0 * fall_m), (0.6, 0.8, fall_m), (1.2, 0.0, 0.0)]
    found = flight_underfoot(across, across, way, Pose2(1.2, 0.0, -0.9)).axis
    assert found == pytest.approx(0.0 if is_on_stairs else -across.axis, abs=0.01)


@pytest.mark.parametrize("off_m", [-0.2, 0.0, 0.4])
def test_a_robot_said_to_stand_higher_than_it_does_is_not_cut_off(off_m: float):
    """A navigation mesh may lie two steps above the stairs."""
    boxes = [FLOOR, *stairs_up()]
    memory = memory_after(boxes, *(Pose2(x, MIDDLE_Y, 0.0) for x in (2.0, 2.5, 3.0, 3.5)))
    camera, height_m = CLIMBER.camera.intrinsics, CLIMBER.camera.height_m
    treads = [Pose2(FIRST_X + (k + 0.5) * TREAD_M, MIDDLE_Y, 0.0) for k in range(3)]
    for k, tread in enumerate(treads):
        seen = view_of(boxes, tread, camera=camera, height_m=height_m + (k + 1) * RISE_M)
        memory.follow(seen)
    robot, z = treads[-1], 3 * RISE_M
    ground = memory.ground_around(robot.xy, down=False)
    way = on_flight(ground, robot, z + off_m, None, goes_up=True)
    ahead = [way.grid.cell_of(robot.x + 0.05 * k, robot.y) for k in range(12)]
    assert all(way.reached[cell] for cell in ahead)


def test_on_a_landing_the_way_on_leads_away_from_where_the_robot_has_looked():
    memory = memory_after([FLOOR], Pose2(0.0, 0.0, 0.0), Pose2(0.5, 0.0, 0.0))
    ground = memory.ground_around((0.5, 0.0), down=False)
    looked = (1.5, 0.0)
    way_on = ground.positions(memory.footing.way_on(ground, 0.0, 0.8, [looked]))
    assert len(way_on)
    for place in ((0.0, 0.0), looked):
        assert np.linalg.norm(way_on - place, axis=1).min() >= 0.75


@pytest.mark.parametrize("goes_up", [True, False])
@pytest.mark.parametrize(("off_m", "is_stairs"), [(0.09, False), (0.15, True)])
def test_ground_is_level_up_to_the_same_difference_up_and_down(
    off_m: float, is_stairs: bool, goes_up: bool
):
    ground = memory_after([FLOOR], HEAD).ground_around(HEAD.xy, down=False)
    x = np.full(ground.seen.shape, np.nan)
    x[ground.seen] = ground.positions(ground.seen)[:, 0]
    with np.errstate(invalid="ignore"):
        beyond = x > FIRST_X + 0.5
    height = np.float32(off_m if goes_up else -off_m)
    stepped = replace(ground, measured=np.where(beyond, height, ground.measured))
    ahead = stairs_ahead(stepped, HEAD, 0.0, None, goes_up=goes_up, on_slope=False)
    assert ahead.any() == is_stairs
