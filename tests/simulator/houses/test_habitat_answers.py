"""An exported house's navigation mesh, asked as habitat-sim 0.3.3 itself was once asked."""

import json
import math
from pathlib import Path

import pytest

from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.export.building_files import export_building
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh

ANSWERS = json.loads(Path(__file__).with_name("habitat_answers.json").read_text())


@pytest.fixture(scope="module")
def mesh(tmp_path_factory: pytest.TempPathFactory) -> Navmesh:
    files = export_building(house(BUILTIN_HOUSE), tmp_path_factory.mktemp("house") / "new")
    return Navmesh.load(files.navmesh)


def test_its_islands_are_habitats(mesh: Navmesh):
    assert mesh.areas_m2 == pytest.approx(ANSWERS["areas_m2"], rel=1e-5)


def test_geodesics_are_equal_to_the_last_bit(mesh: Navmesh):
    for start, end, length in ANSWERS["paths"]:
        expected = math.inf if length is None else length
        assert mesh.shortest_path(tuple(start), tuple(end)).length_m == expected


def test_snaps_are_equal_to_the_last_bit(mesh: Navmesh):
    for point, nearest in ANSWERS["snaps"]:
        assert mesh.nearest(tuple(point)) == tuple(nearest)


def test_steps_end_where_habitats_do(mesh: Navmesh):
    for start, end, slid, stopped in ANSWERS["steps"]:
        for sliding, reached in ((True, slid), (False, stopped)):
            assert mesh.try_step(tuple(start), tuple(end), sliding=sliding) == tuple(reached)
