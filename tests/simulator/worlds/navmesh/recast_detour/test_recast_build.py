"""Laws of meshes that are computed from triangles."""

import numpy as np
import pytest

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import NavmeshError
from hypernav.simulator.worlds.navmesh.file_format import is_mesh_of, settings_for
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.recast_detour.recast_build import compute_navmesh

ROBOT = BodyConfig(radius_m=0.18, height_m=0.88)
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (1, 5, 7, 3), (0, 2, 6, 4))


def boxes(*corners: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Navmesh:
    """The mesh of boxes, each given by its lowest and highest corner, y up."""
    vertices, triangles = [], []
    for low, high in corners:
        bits = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
        first = 8 * len(vertices)
        vertices.append(np.where(bits, high, low))
        triangles += [
            [first + s[0], first + s[k], first + s[k + 1]] for s in _SIDES for k in (1, 2)
        ]
    content = compute_navmesh(
        np.concatenate(vertices).astype(np.float32),
        np.array(triangles, dtype=np.int32)[:, ::-1].copy(),
        settings_for(ROBOT),
    )
    return Navmesh(navmesh_of(content))


FLOOR = ((0.0, -0.2, 0.0), (4.0, 0.0, 4.0))


def test_a_floor_is_walkable_but_for_the_radius_at_its_edge() -> None:
    navmesh = boxes(FLOOR)
    # Four cells for the radius of 0.18 m, after one that is a ledge.
    assert navmesh.area_m2 == pytest.approx(3.5**2, rel=1e-4)
    assert navmesh.is_navigable((2.0, 0.0, 2.0))
    assert not navmesh.is_navigable((0.2, 0.0, 2.0))


def test_a_path_leads_around_a_box() -> None:
    navmesh = boxes(FLOOR, ((1.5, 0.0, 0.8), (2.5, 1.0, 3.2)))
    path = navmesh.shortest_path((1.0, 0.0, 2.0), (3.0, 0.0, 2.0))
    assert path.length_m > 3.0
    assert not navmesh.is_navigable((2.0, 0.0, 2.0))


def test_a_wall_makes_two_islands() -> None:
    navmesh = boxes(FLOOR, ((1.9, 0.0, 0.0), (2.1, 2.0, 4.0)))
    assert len(navmesh.areas_m2) == 2
    assert navmesh.shortest_path((1.0, 0.0, 2.0), (3.0, 0.0, 2.0)).length_m == np.inf


def test_a_robot_passes_under_what_is_higher_than_it() -> None:
    low, high = (
        boxes(FLOOR, ((1.0, bottom, 0.0), (3.0, 2.5, 4.0))).is_navigable((2.0, 0.0, 2.0))
        for bottom in (0.7, 1.3)
    )
    assert (low, high) == (False, True)


def test_two_storeys_are_two_islands_above_each_other() -> None:
    navmesh = boxes(FLOOR, ((0.0, 2.8, 0.0), (4.0, 3.0, 4.0)))
    assert len(navmesh.areas_m2) == 2
    assert navmesh.island_of((2.0, 0.0, 2.0)) != navmesh.island_of((2.0, 3.0, 2.0))


def test_steps_that_can_be_climbed_join_what_they_lead_to() -> None:
    stairs = [((1.0 + 0.3 * k, 0.0, 0.0), (4.0, 0.18 * (k + 1), 4.0)) for k in range(4)]
    navmesh = boxes(FLOOR, *stairs)
    assert navmesh.shortest_path((0.6, 0.0, 2.0), (3.0, 0.72, 2.0)).length_m < 3.0


def test_a_mesh_without_floor_is_refused() -> None:
    with pytest.raises(NavmeshError, match="found 0; is there a floor"):
        boxes(((0.0, 0.0, 0.0), (0.3, 1.0, 0.3)))


def test_a_scene_in_millimetres_is_refused() -> None:
    with pytest.raises(NavmeshError, match="are its units metres"):
        boxes(((0.0, 0.0, 0.0), (4000.0, 1.0, 4000.0)))


def test_a_mesh_belongs_to_robots_that_are_alike_in_voxels() -> None:
    settings = settings_for(ROBOT)
    assert is_mesh_of(settings, BodyConfig(radius_m=0.18, height_m=1.0))
    assert not is_mesh_of(settings, BodyConfig(radius_m=0.17, height_m=1.41))
    assert not is_mesh_of(None, ROBOT)
    assert is_mesh_of(None, BodyConfig(radius_m=0.1, height_m=1.5))
