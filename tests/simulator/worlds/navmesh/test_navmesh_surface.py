"""A navigation mesh as the surface of a simulated robot."""

import math

import numpy as np
import pytest

from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from navmesh_files import content_of, navmesh_from, squares, two_floors

FLOORS = NavmeshSurface(navmesh_from(two_floors()))


def test_floors_are_told_apart_by_the_height() -> None:
    assert FLOORS.height_at(3.0, 1.0, 0.1) == pytest.approx(0.0)
    assert FLOORS.height_at(3.0, 1.0, 2.8) == pytest.approx(3.0)
    assert math.isnan(FLOORS.height_at(3.0, 1.0, 1.5))
    assert FLOORS.is_standable(3.0, 1.0, 3.0)
    assert not FLOORS.is_standable(1.0, 1.0, 3.0)
    assert FLOORS.nearest_standable(1.0, 1.0, 2.9) == pytest.approx((2.0, 1.0, 3.0))


def test_without_a_height_the_main_storey_is_meant() -> None:
    assert FLOORS.floor_z == pytest.approx(3.0)
    assert FLOORS.height_at(3.0, 1.0) == pytest.approx(3.0)
    rng = np.random.default_rng(0)
    assert all(FLOORS.is_standable(*FLOORS.random_point(rng)) for _ in range(20))


def test_far_away_the_nearest_point_of_the_largest_island() -> None:
    assert FLOORS.nearest_standable(-20.0, 1.0, 0.0) == pytest.approx((0.0, 1.0, 0.0), abs=0.05)


def test_the_robot_walks_up_the_ramp() -> None:
    position = (1.0, 1.0, 0.0)
    for _ in range(28):
        position = FLOORS.move(position, 0.0, 0.25)
    assert position == pytest.approx((1.0, 8.0, 3.0), abs=1e-4)
    assert FLOORS.move(position, 0.0, 0.25) == pytest.approx(position, abs=1e-4)
    x, y, z = FLOORS.move(position, 0.2, 0.25, sliding=True)
    assert (x, y, z) == pytest.approx((1.2, 8.0, 3.0), abs=1e-4)


def test_the_wall_that_ends_a_step_is_a_choice() -> None:
    ring = navmesh_from(squares(3, 3, holes=((1, 1),)))
    touched = NavmeshSurface(ring).move((0.6, 1.3, 0.0), 0.5, 0.03)
    assert NavmeshSurface(ring).move(touched, -0.25, 0.0) == pytest.approx((0.75, *touched[1:]))
    assert NavmeshSurface(ring, stop_at="last_wall").move(touched, -0.25, 0.0) == touched


def test_goals_on_several_floors() -> None:
    field = FLOORS.goal_field(np.array([[3.0, 1.0, 3.0], [3.5, 7.0, 3.0], [8.9, 0.5, 0.0]]))
    below = field.distance(3.0, 1.0, 0.0)
    corners = [(3.0, 1.0, 0.0), (2.0, 2.0, 0.0), (2.0, 6.0, 3.0)]
    up = math.dist(corners[0], corners[1]) + math.dist(corners[1], corners[2])
    assert below == pytest.approx(up + math.dist((2.0, 6.0), (3.5, 7.0)))
    assert field.distance(3.0, 1.0, 3.0) == pytest.approx(0.0, abs=1e-4)
    assert field.path(3.0, 1.0, 0.0) == [
        pytest.approx(p) for p in [(3.0, 1.0), (2.0, 2.0), (2.0, 6.0), (3.5, 7.0)]
    ]
    nothing = FLOORS.goal_field(np.zeros((0, 3)))
    assert nothing.distance(3.0, 1.0, 0.0) == math.inf
    assert nothing.path(3.0, 1.0, 0.0) == []


def test_parts_are_islands_by_area() -> None:
    assert FLOORS.component_of(3.0, 1.0, 0.0) == FLOORS.component_of(3.0, 1.0, 3.0) == 0
    assert FLOORS.component_of(8.8, 0.3, 0.0) == 1
    assert FLOORS.component_of(6.0, 0.5, 0.0) == -1
    # A point for every 5 cm, seen from above.
    assert len(FLOORS.centres(0)) * 0.05**2 == pytest.approx(8.0 + 8.0 + 8.0 + 12.0, rel=0.03)
    assert len(FLOORS.centres(1)) * 0.05**2 == pytest.approx(0.5, rel=0.2)


def test_floor_around_a_box() -> None:
    near = FLOORS.floor_near((3.0, 0.9, 0.5), (3.1, 1.1, 1.0), 0.5)
    assert {0.0} == {round(z, 6) for z in near[:, 2].tolist()}
    gaps = np.maximum(np.maximum([3.0, 0.9] - near[:, :2], near[:, :2] - [3.1, 1.1]), 0.0)
    assert np.linalg.norm(gaps, axis=1).max() <= 0.5


def test_a_mesh_without_anything_to_walk_on_is_refused() -> None:
    navmesh = navmesh_from(squares(1, 1))
    navmesh.mesh.walkable[:] = False
    with pytest.raises(SceneError, match="nothing to walk on"):
        NavmeshSurface(navmesh)


def test_it_is_read_from_a_file(tmp_path) -> None:
    path = tmp_path / "floors.navmesh"
    path.write_bytes(content_of(two_floors()))
    assert NavmeshSurface.load(path).distance((3.0, 1.0, 0.0), (3.0, 1.0, 3.0)) == pytest.approx(
        11.513, abs=1e-3
    )
