"""Compare buildings with stairs in habitat-sim and here: islands, and paths between storeys.

    python benchmarks/stairs_in_habitat.py 3004 3005 3008

Needs habitat-sim. Every building is exported. habitat-sim walks once on the exported mesh and once
on one that it computes itself; here the robot walks on the mesh of the generated building.
"""

import math
import tempfile
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.export.building_files import ExportedBuilding, export_building
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.config import NavmeshChoice
from hypernav.simulator.worlds.habitat import HabitatRenderer, require_habitat
from hypernav.simulator.worlds.navmesh.navmesh import Point
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.navmesh.robot_navmesh import robot_navmesh
from hypernav.simulator.worlds.scenes.loading import read_scene

ROBOT = BENCHMARKS["hm3d"].embodiment
MESHES: dict[NavmeshChoice, str] = {"file": "exported mesh", "robot": "its own mesh"}


def main(numbers: tyro.conf.Positional[tuple[int, ...]], pairs: int = 30, seed: int = 0) -> None:
    """Print a line for every building and mesh.

    Args:
        numbers: Numbers of the buildings.
        pairs: Number of pairs of positions, each on two storeys.
        seed: Seed of the positions.
    """
    for number in numbers:
        building = Building("storeys", number)
        scene = generate(building)
        navmesh = robot_navmesh(scene, ROBOT.body, "auto")
        assert navmesh is not None
        floor = NavmeshSurface(navmesh).floor
        storeys = [floor[np.abs(floor[:, 2] - z) < 0.1] for z in scene.storeys]
        ends = drawn(storeys, pairs, np.random.default_rng(seed))
        ours = np.array([navmesh.shortest_path(a, b).length_m for a, b in ends])
        print(f"{building.scene}, here: {islands(navmesh.areas_m2)}, {len(scene.storeys)} storeys")
        with tempfile.TemporaryDirectory() as folder:
            files = export_building(building, Path(folder))
            for choice, words in MESHES.items():
                theirs = habitat_lengths(files, choice, ends)
                gaps = np.abs(theirs[1] / ours - 1.0)
                print(
                    f"  habitat-sim on {words}: {theirs[0]}; {np.isfinite(theirs[1]).sum()} of "
                    f"{len(ends)} paths found, lengths apart by {np.median(gaps):.2%} at the "
                    f"median, {gaps.max():.2%} at most"
                )


def drawn(
    storeys: list[np.ndarray], count: int, rng: np.random.Generator
) -> list[tuple[Point, Point]]:
    """Random positions on neighbouring storeys in turn, in Habitat's frame."""
    neighbours = list(pairwise(storeys))
    ends = []
    for number in range(count):
        (ax, ay, az), (bx, by, bz) = (
            floor[rng.integers(len(floor))].tolist()
            for floor in neighbours[number % len(neighbours)]
        )
        ends.append(((ax, az, -ay), (bx, bz, -by)))
    return ends


def habitat_lengths(
    files: ExportedBuilding, choice: NavmeshChoice, ends: list[tuple[Point, Point]]
) -> tuple[str, np.ndarray]:
    """Islands of habitat-sim's mesh, and lengths of its shortest paths, metres."""
    habitat_sim = require_habitat()
    with closing(HabitatRenderer(read_scene(files.glb), files.glb, ROBOT, choice)) as opened:
        finder: Any = opened.path_finder
        lengths = []
        for start, end in ends:
            path = habitat_sim.ShortestPath()
            path.requested_start, path.requested_end = start, end
            lengths.append(path.geodesic_distance if finder.find_path(path) else math.inf)
        areas = np.array([finder.island_area(k) for k in range(finder.num_islands)])
    return islands(areas), np.array(lengths)


def islands(areas: np.ndarray) -> str:
    """Number and area of islands, for people."""
    return f"{len(areas)} islands, the largest {areas.max():.2f} of {areas.sum():.2f} m²"


if __name__ == "__main__":
    tyro.cli(main)
