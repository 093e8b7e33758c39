import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError, StartError
from hypernav.core.world import Walkable
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

RADIUS = BodyConfig().radius_m
CELL = 0.05


def a_walkable(walkable: Walkable) -> Walkable:
    return walkable


def test_it_is_a_walkable():
    walkable = a_walkable(WalkableGrid.from_scene(scene_of(*room_boxes())))
    assert walkable.is_standable(3.0, 2.0)


def test_the_robot_keeps_its_radius_from_walls():
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(6.0, 4.0)))
    for x in np.arange(0.01, 6.0, 0.03):
        clearance = min(x, 6.0 - x)
        if clearance < RADIUS - CELL:
            assert not walkable.is_standable(float(x), 2.0)
        if clearance > RADIUS + CELL:
            assert walkable.is_standable(float(x), 2.0)
    assert not walkable.is_standable(3.0, -5.0)
    assert not walkable.is_standable(400.0, 2.0)
    assert walkable.area_m2() == pytest.approx((6 - 2 * RADIUS) * (4 - 2 * RADIUS), rel=0.03)


def test_walls_on_cell_borders_lose_no_space_on_either_side():
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(6.0, 4.0)))
    columns = np.flatnonzero(walkable.standable.any(axis=0))
    left = walkable.origin[0] + columns[0] * CELL
    right = walkable.origin[0] + (columns[-1] + 1) * CELL
    assert left == pytest.approx(6.0 - right, abs=1e-6)


def test_a_table_blocks_and_its_top_is_no_floor():
    table = [
        ("table", (2.0, 1.5, 0.7), (3.5, 2.5, 0.75)),
        ("table", (2.0, 1.5, 0.0), (2.05, 1.55, 0.7)),
    ]
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(), *table))
    assert not walkable.is_standable(2.75, 2.0)
    assert not walkable.is_standable(2.0 - 0.1, 2.0)
    assert walkable.is_standable(2.0 - RADIUS - CELL, 2.0)
    assert walkable.components.max() == 0


def test_a_bed_a_hollow_cupboard_and_a_shelf_are_no_floor():
    bed = ("bed", (1.0, 1.0, 0.0), (3.0, 3.0, 0.45))
    cupboard = ("cupboard", (4.0, 1.0, 0.02), (5.4, 2.2, 1.9))
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(), bed, cupboard))
    assert not walkable.is_standable(2.0, 2.0)
    assert not walkable.is_standable(4.7, 1.6)
    assert walkable.is_standable(3.5, 3.5)


def test_what_hangs_high_enough_does_not_block_and_what_hangs_lower_does():
    lamp = ("lamp", (1.0, 1.0, 1.1), (1.5, 1.5, 1.3))
    shelf = ("shelf", (4.0, 1.0, 0.9), (4.5, 1.5, 1.0))
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(), lamp, shelf))
    assert walkable.is_standable(1.25, 1.25)
    assert not walkable.is_standable(4.25, 1.25)
    low = WalkableGrid.from_scene(scene_of(*room_boxes(), lamp), BodyConfig(height_m=1.2))
    assert not low.is_standable(1.25, 1.25)


def test_a_rug_is_walked_on_and_a_high_step_is_not():
    rug = ("rug", (1.0, 1.0, 0.0), (2.0, 2.0, 0.03))
    hovering = ("rug", (1.0, 2.5, 0.02), (2.0, 3.5, 0.021))
    plinth = ("plinth", (4.0, 1.0, 0.0), (5.0, 2.0, 0.15))
    scene = scene_of(*room_boxes(), rug, hovering, plinth)
    walkable = WalkableGrid.from_scene(scene)
    assert walkable.height_at(1.5, 1.5) == pytest.approx(0.03, abs=1e-5)
    assert walkable.height_at(1.5, 3.0) == pytest.approx(0.021, abs=1e-5)
    assert walkable.distance((0.5, 1.5), (1.5, 1.5)) == pytest.approx(1.0, abs=1e-3)
    assert not walkable.is_standable(4.5, 1.5)
    assert math.isnan(walkable.height_at(4.5, 1.5))
    climber = WalkableGrid.from_scene(scene, BodyConfig(max_step_m=0.2))
    assert climber.height_at(4.5, 1.5) == pytest.approx(0.15, abs=1e-5)
    assert climber.distance((3.5, 1.5), (4.5, 1.5)) == pytest.approx(1.0, abs=1e-3)


def test_a_door_joins_two_rooms_and_a_closed_one_does_not():
    wall = [(None, (2.9, 0.0, 0.0), (3.0, 1.5, 2.5)), (None, (2.9, 2.4, 0.0), (3.0, 4.0, 2.5))]
    leaf = ("door", (2.92, 1.5, 0.01), (2.96, 2.4, 2.0))
    opened = WalkableGrid.from_scene(scene_of(*room_boxes(), *wall))
    assert math.isfinite(opened.distance((1.0, 2.0), (5.0, 2.0)))
    closed = WalkableGrid.from_scene(scene_of(*room_boxes(), *wall, leaf))
    assert closed.distance((1.0, 2.0), (5.0, 2.0)) == math.inf
    assert {closed.component_of(1.0, 2.0), closed.component_of(5.0, 2.0)} == {0, 1}
    assert closed.area_m2(0) >= closed.area_m2(1) > 4.0
    x, y, _ = closed.nearest_standable(2.95, 0.7)
    assert closed.component_of(x, y) == 0
    assert math.dist((x, y), (2.95, 0.7)) < RADIUS + 2 * CELL


def test_the_storey_is_chosen_by_the_height_of_its_floor():
    upper = [
        (None, (-0.1, -0.1, 2.6), (6.1, 4.1, 2.8)),
        (None, (-0.1, -0.1, 2.8), (6.1, 0.0, 5.0)),
        ("bed", (1.0, 1.0, 2.8), (3.0, 3.0, 3.3)),
        (None, (-0.1, -0.1, 5.0), (6.1, 4.1, 5.1)),
    ]
    scene = scene_of(*room_boxes(ceiling=False), *upper)
    ground = WalkableGrid.from_scene(scene)
    assert ground.floor_z == pytest.approx(0.0, abs=1e-3)
    above = WalkableGrid.from_scene(scene, floor_z=2.8)
    assert above.floor_z == pytest.approx(2.8, abs=1e-3)
    assert not above.is_standable(2.0, 2.0)
    with pytest.raises(SceneError, match=r"storey at 9\.00 m; it could stand at .*2\.80"):
        WalkableGrid.from_scene(scene, floor_z=9.0)


def test_a_thing_is_reached_from_its_own_storey():
    gallery = [
        (None, (-0.1, -0.1, 2.6), (6.1, 2.0, 2.8)),
        ("bed", (1.0, 1.5, 2.8), (2.0, 2.0, 3.3)),
        ("chair", (1.0, 2.2, 0.0), (1.5, 2.6, 0.8)),
        (None, (-0.1, -0.1, 5.0), (6.1, 4.1, 5.1)),
    ]
    scene = replace(scene_of(*room_boxes(ceiling=False), *gallery), storeys=(0.0, 2.8))
    bed, chair = (next(i for i in scene.instances if i.name.startswith(n)) for n in ("bed", "ch"))
    lower, upper = (WalkableGrid.from_scene(scene, floor_z=z) for z in scene.storeys)
    for grid, own, other in ((lower, chair, bed), (upper, bed, chair)):
        assert len(grid.floor_near(own.box_min, own.box_max, 1.0)) > 0
        assert len(grid.floor_near(other.box_min, other.box_max, 1.0)) == 0
    unknown = WalkableGrid.from_scene(replace(scene, storeys=()), floor_z=0.0)
    assert len(unknown.floor_near(bed.box_min, bed.box_max, 1.0)) > 0


def test_a_roof_is_not_taken_for_the_floor():
    much = [("crate", (x, 0.5, 0.0), (x + 0.8, 3.5, 1.0)) for x in (0.6, 2.2, 3.8)]
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(), *much))
    assert walkable.floor_z == pytest.approx(0.0, abs=1e-3)


def test_a_scene_without_room_for_the_robot_says_so():
    crawl = scene_of(*room_boxes(), ("slab", (-0.1, -0.1, 0.5), (6.1, 4.1, 2.5)))
    with pytest.raises(SceneError, match="fits nowhere"):
        WalkableGrid.from_scene(crawl, BodyConfig(radius_m=3.5))
    with pytest.raises(SceneError, match="are its units metres"):
        WalkableGrid.from_scene(scene_of(("floor", (0, 0, 0), (9000, 9000, 1))))


def test_random_points_are_standable_uniform_and_seeded():
    walls = [(None, (2.9, 0.0, 0.0), (3.0, 4.0, 2.5))]
    walkable = WalkableGrid.from_scene(scene_of(*room_boxes(9.0, 4.0), *walls))
    rng = np.random.default_rng(5)
    points = np.array([walkable.random_point(rng) for _ in range(4000)])
    assert all(walkable.component_of(*map(float, p)) == 0 for p in points)
    assert (points[:, 0] > 6.0).mean() == pytest.approx((3 - RADIUS) / (6 - 2 * RADIUS), abs=0.03)
    assert (points[:, 1] > 2.0).mean() == pytest.approx(0.5, abs=0.03)
    again = np.random.default_rng(5)
    assert walkable.random_point(again) == tuple(points[0])


def test_no_random_point_on_an_empty_grid():
    empty = WalkableGrid.from_mask(np.zeros((3, 3), dtype=bool))
    with pytest.raises(StartError, match="no standable cell"):
        empty.random_point(np.random.default_rng(0))


def test_a_step_reaches_its_target_or_stops_at_the_contact():
    walkable = WalkableGrid.from_mask(np.ones((20, 20), dtype=bool), cell_m=0.1)
    assert walkable.step(1.0, 1.0, 0.3, 0.4) == (1.3, 1.4)
    x, y = walkable.step(1.0, 1.0, 2.0, 0.4)
    assert x == pytest.approx(2.0, abs=1e-3)
    assert y == pytest.approx(1.2, abs=1e-3)
    assert walkable.step(5.0, 5.0, 0.1, 0.0) == pytest.approx((5.0, 5.0))


def test_a_sliding_step_follows_the_wall():
    walkable = WalkableGrid.from_mask(np.ones((20, 20), dtype=bool), cell_m=0.1)
    x, y = walkable.step(1.8, 1.0, 0.4, 0.4, sliding=True)
    assert (x, y) == pytest.approx((2.0, 1.4), abs=1e-3)
    slope = WalkableGrid.from_mask(np.tri(20, dtype=bool), cell_m=0.1)
    x, y = slope.step(0.75, 1.0, 0.5, 0.0, sliding=True)
    assert x > 1.0
    assert y > 1.1


masks = hnp.arrays(
    np.int8, st.tuples(st.integers(3, 9), st.integers(3, 9)), elements=st.integers(0, 3)
).map(lambda m: m != 0)
offsets = st.floats(-4.0, 4.0).map(lambda offset: round(offset, 6))
PUSHED_CELLS = 0.5
"""So far a corner pushes a robot aside that grazes it."""


@settings(max_examples=300, deadline=None)
@given(masks, st.floats(0.0, 1.0), st.floats(0.0, 1.0), offsets, offsets)
def test_a_step_never_leaves_the_floor_and_hardly_the_line(mask, u, v, dx, dy):
    walkable = WalkableGrid.from_mask(mask, cell_m=1.0)
    x, y = u * mask.shape[1], v * mask.shape[0]
    end = walkable.step(x, y, dx, dy)
    if not walkable.is_standable(x, y):
        assert end == pytest.approx((x, y))
        return
    assert walkable.component_of(*end) == walkable.component_of(x, y)
    length = math.hypot(dx, dy)
    if length < 1e-6:
        return
    along = ((end[0] - x) * dx + (end[1] - y) * dy) / length
    aside = ((end[0] - x) * dy - (end[1] - y) * dx) / length
    assert -1e-6 <= along <= length + 1e-6
    assert abs(aside) <= PUSHED_CELLS + 1e-6
    for t in np.linspace(0.001, 0.999, 200):
        between = np.array([x + t * (end[0] - x), y + t * (end[1] - y)])
        around = [(0.0, 0.0)]
        if abs(aside) > 1e-6:
            around += [(PUSHED_CELLS * a, PUSHED_CELLS * b) for a in (-1, 0, 1) for b in (-1, 0, 1)]
        near_border = min(between % 1.0) < 1e-6 or max(between % 1.0) > 1 - 1e-6
        assert near_border or any(walkable.is_standable(*(between + shift)) for shift in around)
    if along < length - 1e-6:
        beyond = [end[0] + 2e-3 * dx / length, end[1] + 2e-3 * dy / length]
        at_corner = all(min(c % 1.0, 1 - c % 1.0) < 5e-3 for c in beyond)
        assert at_corner or not walkable.is_standable(*beyond) or length - along < 2e-3


STAIRS = WalkableGrid.from_mask(np.tri(40, dtype=bool), cell_m=0.05)
"""A smooth wall from corner to corner, as cells draw it: free where x is less than y."""


@settings(max_examples=200, deadline=None)
@given(st.floats(1.0, 1.2), st.floats(0.0, 2.0 * math.pi), st.floats(0.4, math.pi - 0.4))
def test_a_robot_that_touches_a_slanting_wall_gets_away_from_it(along, into, away):
    contact = STAIRS.step(along - 0.1, along + 0.1, 0.3 * math.cos(into), 0.3 * math.sin(into))
    angle = math.pi / 4 + away
    end = STAIRS.step(*contact, 0.3 * math.cos(angle), 0.3 * math.sin(angle))
    assert math.dist(contact, end) == pytest.approx(0.3, abs=0.01)


def test_a_step_that_grazes_a_corner_passes_it_and_one_that_meets_it_does_not():
    mask = np.ones((20, 20), dtype=bool)
    mask[10:12, :10] = False
    walkable = WalkableGrid.from_mask(mask, cell_m=1.0)
    assert walkable.step(9.7, 5.0, 0.0, 10.0)[1] == pytest.approx(10.0, abs=2e-3)
    x, y = walkable.step(8.6, 8.0, 2.0, 3.0)
    assert 0.01 < math.dist((x, y), (10.6, 11.0)) <= PUSHED_CELLS
    assert walkable.step(7.7, 8.0, 2.0, 3.0)[1] == pytest.approx(10.0, abs=2e-3)


@settings(max_examples=300, deadline=None)
@given(masks, st.floats(0.0, 1.0), st.floats(0.0, 1.0), offsets, offsets)
def test_sliding_gets_at_least_as_near_and_stays_connected(mask, u, v, dx, dy):
    walkable = WalkableGrid.from_mask(mask, cell_m=1.0)
    x, y = u * mask.shape[1], v * mask.shape[0]
    stopped = walkable.step(x, y, dx, dy)
    slid = walkable.step(x, y, dx, dy, sliding=True)
    target = (x + dx, y + dy)
    assert math.dist(slid, target) <= math.dist(stopped, target) + 1e-9
    assert walkable.component_of(*slid) == walkable.component_of(x, y)
    assert math.dist((x, y), slid) <= math.hypot(dx, dy, PUSHED_CELLS) + 1e-6
