"""Meshes that habitat-sim computed for four robots in a real house: the same in every polygon."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hypernav.simulator.worlds.navmesh.file_format import TILE_ARRAYS, NavmeshFile
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of, read_navmesh
from hypernav.simulator.worlds.navmesh.recast_detour.recast_build import compute_navmesh
from hypernav.simulator.worlds.navmesh.robot_navmesh import habitat_vertices
from hypernav.simulator.worlds.scenes.gltf import read_gltf
from hypernav.simulator.worlds.scenes.mesh_parts import SceneObject, assemble
from hypernav.simulator.worlds.scenes.scene import Scene

ROBOTS = ("r18_h088", "r17_h141", "r10_h150", "r18_h100")


@pytest.fixture(scope="module")
def scene(small_house: Path) -> Scene:
    """habitat-sim took this file for z up, as it takes every GLB without a configuration."""
    parts, materials = read_gltf(small_house, up="z")
    whole = SceneObject("house", frozenset(part.node for part in parts), None)
    scene = assemble("small_house", parts, [whole], materials, smooth=False)
    return replace(scene, stored_z_up=True)


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def theirs(test_data: Path, robot: str) -> NavmeshFile:
    return read_navmesh(test_data / "habitat" / "simulator" / f"small_house_{robot}.navmesh")


@pytest.fixture(scope="module")
def ours(scene: Scene, theirs: NavmeshFile) -> NavmeshFile:
    settings = np.array(theirs.settings)
    return navmesh_of(compute_navmesh(habitat_vertices(scene), scene.faces, settings))


def test_every_polygon_and_every_height_are_the_same(
    ours: NavmeshFile, theirs: NavmeshFile
) -> None:
    assert ours.header == theirs.header
    assert ours.settings == theirs.settings
    (mine,), (known,) = ours.tiles, theirs.tiles
    assert mine.header == known.header
    # The links, which begin with the first one of every polygon, are made when a file is loaded.
    mine.polygons["first_link"] = known.polygons["first_link"]
    for array in TILE_ARRAYS:
        if array.name != "links":
            assert np.array_equal(getattr(mine, array.name), getattr(known, array.name))


def test_areas_islands_and_geodesics_are_those_of_habitat_sim(
    test_data: Path, ours: NavmeshFile, robot: str
) -> None:
    text = (test_data / "habitat" / "simulator" / "simulator_truth.json").read_text()
    answers: list[dict[str, Any]] = json.loads(text)["scenes"]["small_house"]["recomputed"]
    (answer,) = (a for a in answers if a["navmesh"] == f"small_house_{robot}.navmesh")
    navmesh = Navmesh(ours)
    assert navmesh.area_m2 == pytest.approx(answer["area_m2"], rel=1e-5)
    assert len(navmesh.areas_m2) == answer["islands"]
    for pair in answer["pairs"]:
        path = navmesh.shortest_path(tuple(pair["start"]), tuple(pair["end"]))
        known = np.inf if pair["geodesic_m"] is None else pair["geodesic_m"]
        assert path.length_m == pytest.approx(known, rel=1e-5)
