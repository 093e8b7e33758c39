"""Laws of what a navigation mesh answers."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.errors import StartError
from hypernav.simulator.worlds.navmesh.file_format import EXTERNAL
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh, Point
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from navmesh_files import FileParts, content_of, navmesh_from, squares, two_floors

RING = navmesh_from(squares(3, 3, holes=((1, 1),)))
FLOORS = navmesh_from(two_floors())
inside = st.floats(0.0, 3.0, width=32)
ring_points = st.builds(lambda x, y: (x, 0.0, -y), inside, inside)


def test_a_floor_is_told_by_its_height() -> None:
    assert FLOORS.nearest((3.0, 0.4, -1.0)) == pytest.approx((3.0, 0.0, -1.0))
    assert FLOORS.nearest((3.0, 2.6, -1.0)) == pytest.approx((3.0, 3.0, -1.0))
    assert FLOORS.nearest((1.0, 1.7, -4.0)) == pytest.approx((1.0, 1.5, -4.0), abs=1e-6)


def test_a_path_climbs_the_stairs_to_the_floor_above() -> None:
    path = FLOORS.shortest_path((3.0, 0.0, -1.0), (3.0, 3.0, -1.0))
    corners = [(3.0, 0.0, -1.0), (2.0, 0.0, -2.0), (2.0, 3.0, -6.0), (3.0, 3.0, -1.0)]
    assert path.points == pytest.approx(np.array(corners), abs=1e-6)
    lengths = [math.dist(a, b) for a, b in itertools.pairwise(corners)]
    assert path.length_m == pytest.approx(sum(lengths))


def test_no_path_leads_to_another_island() -> None:
    start, island = (3.0, 0.0, -1.0), (8.8, 0.0, -0.3)
    assert FLOORS.island_of(start) != FLOORS.island_of(island)
    assert FLOORS.shortest_path(start, island).length_m == math.inf
    assert FLOORS.try_step(start, island, sliding=True) == start
    goals = GoalPaths(FLOORS, np.array([island, (90.0, 0.0, 0.0)]))
    assert goals.nearest(start)[0] == -1
    assert goals.nearest(start)[1].length_m == math.inf


def test_far_away_and_nowhere_is_off_the_mesh() -> None:
    for point in ((20.0, 0.0, 0.0), (math.nan, 0.0, 0.0), (0.0, math.inf, 0.0)):
        assert FLOORS.nearest(point) is None
        assert FLOORS.island_of(point) == -1
        assert not FLOORS.is_navigable(point)
        assert FLOORS.shortest_path((1.0, 0.0, -1.0), point).length_m == math.inf
        assert FLOORS.try_step((1.0, 0.0, -1.0), point, sliding=True) == (1.0, 0.0, -1.0)


def test_one_island_can_be_asked_for() -> None:
    island = FLOORS.island_of((8.8, 0.0, -0.3))
    between = (5.5, 0.0, -0.5)
    assert FLOORS.nearest(between) == pytest.approx((4.0, 0.0, -0.5))
    assert FLOORS.nearest((6.5, 0.0, -0.5), island) == pytest.approx((8.0, 0.0, 0.0))
    assert FLOORS.nearest(between, island) is None
    rng = np.random.default_rng(0)
    assert all(FLOORS.island_of(FLOORS.random_point(rng, island)) == island for _ in range(20))


def test_areas() -> None:
    assert RING.areas_m2 == pytest.approx([8.0])
    assert FLOORS.areas_m2 == pytest.approx([8.0 + 10.0 + 8.0 + 12.0, 0.5])


@given(ring_points, ring_points)
def test_a_path_goes_around_the_hole(start: Point, end: Point) -> None:
    path = RING.shortest_path(start, end)
    corners = path.points.astype(np.float64)
    sides = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    assert path.length_m == pytest.approx(sides.sum(), rel=1e-5, abs=1e-4)
    for a, b in itertools.pairwise(corners):
        along = a + (b - a) * np.linspace(0.0, 1.0, 30)[:, None]
        in_hole = (np.abs(along[:, [0, 2]] - [1.5, -1.5]) < 0.5 - 1e-4).all(axis=1)
        assert not in_hole.any()


@given(ring_points, ring_points)
def test_a_step_stays_on_the_mesh(start: Point, end: Point) -> None:
    on_mesh = RING.nearest(start)
    assert on_mesh is not None
    for sliding in (False, True):
        reached = RING.try_step(on_mesh, end, sliding=sliding)
        assert RING.is_navigable(reached)


@given(ring_points, st.floats(-math.pi, math.pi))
def test_sliding_ends_nearer_to_the_target(start: Point, angle: float) -> None:
    on_mesh = RING.nearest(start)
    assert on_mesh is not None
    end = (on_mesh[0] + 0.25 * math.cos(angle), 0.0, on_mesh[2] + 0.25 * math.sin(angle))
    slid = RING.try_step(on_mesh, end, sliding=True)
    stopped = RING.try_step(on_mesh, end, sliding=False)
    assert math.dist(slid, end) <= math.dist(stopped, end) + 1e-4
    assert math.dist(on_mesh, stopped) <= 0.25 + 1e-4


def test_a_robot_that_touches_a_wall_leaves_it_by_every_heading_into_the_open() -> None:
    touched = RING.try_step((0.6, 0.0, -1.3), (1.1, 0.0, -1.33), sliding=False)
    x, y, z = touched
    assert x == pytest.approx(1.0)
    for angle in np.radians(np.arange(95.0, 270.0, 10.0)):
        end = (x + 0.25 * math.cos(angle), y, z + 0.25 * math.sin(angle))
        assert RING.try_step(touched, end, sliding=False) == pytest.approx(end, abs=1e-6)
        assert RING.try_step(touched, end, sliding=False, stop_at="last_wall") == touched


@given(st.lists(ring_points, min_size=1, max_size=5), st.lists(ring_points, min_size=1, max_size=4))
def test_the_nearest_of_several_goals(goals: list[Point], starts: list[Point]) -> None:
    goals = [on_mesh for goal in goals if (on_mesh := RING.nearest(goal)) is not None]
    paths = GoalPaths(RING, np.array(goals))
    for number, start in enumerate(starts):
        goal, path = paths.nearest(start)
        lengths = [RING.shortest_path(start, goal).length_m for goal in goals]
        assert path.length_m == pytest.approx(lengths[goal])
        if number == 0 and RING.is_navigable(start):
            assert path.length_m == pytest.approx(min(lengths))


def test_random_points_are_seeded_and_spread_over_the_area() -> None:
    points = [RING.random_point(np.random.default_rng(7)) for _ in range(2)]
    assert points[0] == points[1]
    rng = np.random.default_rng(1)
    drawn = np.array([RING.random_point(rng) for _ in range(4000)])
    cells = np.floor(np.stack([drawn[:, 0], -drawn[:, 2]], axis=1)).astype(int)
    counts = np.bincount(np.clip(cells, 0, 2) @ [1, 3], minlength=9)
    assert counts[4] == 0
    assert np.delete(counts, 4) == pytest.approx(np.full(8, 500.0), rel=0.2)


def test_nothing_can_be_drawn_where_nothing_is_walkable() -> None:
    parts = FileParts.of(content_of(squares(2, 1)))
    parts.tiles[0].arrays["polygons"]["flags"] = 0
    navmesh = Navmesh(navmesh_of(parts.content()))
    assert navmesh.nearest((0.5, 0.0, -0.5)) is None
    with pytest.raises(StartError, match="nothing to walk on"):
        navmesh.random_point(np.random.default_rng(0))


def test_the_edges_of_a_polygon_count_where_none_is_marked_as_boundary() -> None:
    parts = FileParts.of(content_of(squares(2, 1)))
    parts.tiles[0].arrays["detail_triangles"][:, 3] = 0
    navmesh = Navmesh(navmesh_of(parts.content()))
    assert navmesh.nearest((-0.5, 0.0, -0.25)) == pytest.approx((0.0, 0.0, -0.25))


def test_two_tiles_are_walked_as_one() -> None:
    halves = [FileParts.of(content_of(squares(2, 2))) for _ in range(2)]
    parts = halves[0]
    parts.tiles += halves[1].tiles
    left, right = parts.tiles
    right.arrays["vertices"][:, 0] += 2.0
    for key in ("lowest", "highest"):
        right.header[key][:, 0] += 2.0
    right.header["x"] = 1
    # Edges against the clock from below: to +x is the second one, to -x the last one.
    left.arrays["polygons"]["neighbours"][[1, 3], 1] = EXTERNAL | 0
    right.arrays["polygons"]["neighbours"][[0, 2], 3] = EXTERNAL | 4
    parts.header["tiles"] = parts.header["most_tiles"] = 2
    left.reference["reference"], right.reference["reference"] = 0b1000, 0b1100
    tiled, whole = Navmesh(navmesh_of(parts.content())), navmesh_from(squares(4, 2))
    assert len(tiled.areas_m2) == 1
    rng = np.random.default_rng(3)
    for _ in range(50):
        start, end = whole.random_point(rng), whole.random_point(rng)
        for navmesh in (tiled, whole):
            # Detour's polygons on the way are not always those that a straight line crosses.
            length = navmesh.shortest_path(start, end).length_m
            assert length == pytest.approx(math.dist(start, end), rel=0.1, abs=1e-4)
        assert tiled.nearest(end) == pytest.approx(whole.nearest(end))
        for sliding in (False, True):
            assert tiled.try_step(start, end, sliding=sliding) == pytest.approx(end, abs=1e-6)
