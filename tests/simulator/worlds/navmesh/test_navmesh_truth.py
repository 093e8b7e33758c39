"""habitat-sim's own answers on real navigation meshes: the same to single precision."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hypernav.core.embodiment import BodyConfig
from hypernav.lab.datasets.habitat_format import positions_from_habitat
from hypernav.simulator.worlds.config import StopChoice
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh, Point
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of, read_navmesh
from hypernav.simulator.worlds.navmesh.navmesh_writer import PolygonMesh, navmesh_bytes

FILES = (
    "apt_2",
    "v3_sc3_staging_17",
    "house_100_coarse",
    "house_100_fine",
    "small_house_coarse",
)


@pytest.fixture(scope="module")
def answers(test_data: Path) -> dict[str, Any]:
    text = (test_data / "habitat" / "navmesh_truth.json").read_text()
    return json.loads(text)["files"]


@pytest.fixture(scope="module", params=FILES)
def name(request: pytest.FixtureRequest) -> str:
    return f"{request.param}.navmesh"


@pytest.fixture(scope="module")
def truth(answers: dict[str, Any], name: str) -> dict[str, Any]:
    return answers[name]


@pytest.fixture(scope="module")
def navmesh(test_data: Path, name: str) -> Navmesh:
    return Navmesh.load(test_data / "habitat" / name)


def _point(values: list[float]) -> Point:
    x, y, z = values
    return float(x), float(y), float(z)


def test_islands_and_bounds(navmesh: Navmesh, truth: dict[str, Any]) -> None:
    assert len(navmesh.areas_m2) == truth["islands"]
    assert navmesh.areas_m2 == pytest.approx(truth["island_area"], rel=1e-5, abs=1e-6)
    assert navmesh.area_m2 == pytest.approx(truth["area_total"], rel=1e-5)
    assert (navmesh.bounds == np.array(truth["bounds"], dtype=np.float32)).all()


def test_geodesics_and_paths(navmesh: Navmesh, truth: dict[str, Any]) -> None:
    for pair in truth["pairs"]:
        start, end = _point(pair["start"]), _point(pair["end"])
        path = navmesh.shortest_path(start, end)
        expected = math.inf if pair["geodesic"] is None else pair["geodesic"]
        assert path.length_m == pytest.approx(expected, rel=1e-6)
        assert path.points == pytest.approx(np.array(pair["path"]).reshape(-1, 3), abs=1e-6)
        assert navmesh.island_of(start) == pair["start_island"]
        assert navmesh.island_of(end) == pair["end_island"]


def test_snaps(navmesh: Navmesh, truth: dict[str, Any]) -> None:
    for snap in truth["snaps"]:
        point = _point(snap["point"])
        found = navmesh.nearest(point)
        if snap["snapped"][0] is None:
            assert found is None
        else:
            assert found == pytest.approx(snap["snapped"], abs=1e-6)
            assert navmesh.island_of(point) == snap["island"]
        assert navmesh.is_navigable(point) == snap["navigable"]


@pytest.mark.parametrize("stop_at", ["first_wall", "last_wall"])
@pytest.mark.parametrize(("answer", "sliding"), [("slide", True), ("no_slide", False)])
def test_steps(
    navmesh: Navmesh, truth: dict[str, Any], answer: str, sliding: bool, stop_at: StopChoice
) -> None:
    for step in truth["try_steps"]:
        start, end = _point(step["start"]), _point(step["end"])
        reached = navmesh.try_step(start, end, sliding=sliding, stop_at=stop_at)
        assert reached == pytest.approx(step[answer], abs=1e-6)


def test_a_step_that_goes_on_to_the_last_wall_ends_at_it(test_data: Path) -> None:
    folder = test_data / "habitat"
    known = json.loads((folder / "step_without_sliding.json").read_text())
    navmesh = Navmesh.load(folder / known["navmesh"])
    step = known["step"]
    start, end = _point(step["start"]), _point(step["end"])
    for answer, sliding in (("slide", True), ("no_slide", False)):
        reached = navmesh.try_step(start, end, sliding=sliding, stop_at="last_wall")
        assert reached == pytest.approx(step[answer], abs=1e-6)


def test_several_goals_at_once(navmesh: Navmesh, truth: dict[str, Any]) -> None:
    paths = GoalPaths(navmesh, np.array(truth["multi"]["ends"], dtype=np.float64))
    for query in truth["multi"]["queries"]:
        goal, path = paths.nearest(_point(query["start"]))
        expected = math.inf if query["geodesic"] is None else query["geodesic"]
        assert path.length_m == pytest.approx(expected, rel=1e-6)
        if query["geodesic"] is not None:
            assert goal == query["closest"]


def test_the_writer_makes_of_its_polygons_what_habitat_sim_made(test_data: Path, name: str) -> None:
    (theirs,) = read_navmesh(test_data / "habitat" / name).tiles
    polygons = [p["vertices"][: p["vertex_count"]].tolist() for p in theirs.polygons]
    vertices = positions_from_habitat(theirs.vertices.astype(np.float64))
    (ours,) = navmesh_of(navmesh_bytes(PolygonMesh.of(vertices, polygons), BodyConfig())).tiles
    assert (ours.vertices == theirs.vertices).all()
    for key in ("neighbours", "vertex_count", "area_and_type"):
        assert (ours.polygons[key] == theirs.polygons[key]).all()
    for key in ("magic", "version", "x", "y", "layer", "polygons", "vertices", "off_mesh_base"):
        assert ours.header[key] == theirs.header[key]
    # Detour's tree has room for one node more than it needs.
    assert len(ours.tree) == 2 * len(polygons) - 1 == len(theirs.tree) - 1
    assert sorted(ours.tree["index"][ours.tree["index"] >= 0]) == list(range(len(polygons)))
    inner = ours.tree["index"] < 0
    assert (ours.tree["index"][inner] + 2 * len(polygons) - 1 >= 0).all()
