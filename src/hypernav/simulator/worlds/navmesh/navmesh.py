"""Queries of a navigation mesh, with the results of habitat-sim's ``PathFinder``.

Shortest paths to the nearest of many goals are those of its ``MultiGoalShortestPath``.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int32

from hypernav.core.errors import StartError
from hypernav.simulator.worlds.config import StopChoice
from hypernav.simulator.worlds.navmesh.file_format import NavmeshFile
from hypernav.simulator.worlds.navmesh.navmesh_reader import read_navmesh
from hypernav.simulator.worlds.navmesh.recast_detour.detour_kernels import (
    NOWHERE,
    height_on,
    nearest,
)
from hypernav.simulator.worlds.navmesh.recast_detour.detour_mesh import find_islands, mesh_of
from hypernav.simulator.worlds.navmesh.recast_detour.detour_motion_kernels import try_step
from hypernav.simulator.worlds.navmesh.recast_detour.detour_path_kernels import (
    nearest_goal,
    path_between,
)

Point = tuple[float, float, float]
"""Position ``(x, y, z)`` in Habitat's frame, y up, metres."""

Singles = tuple[np.float32, np.float32, np.float32]
"""The same for kernels."""

_DRAWS = 10
_NAVIGABLE_HEIGHT_M = 0.5
_NAVIGABLE_GAP_M = 1e-2


@dataclass(frozen=True, eq=False)
class MeshPath:
    """A shortest path.

    Attributes:
        length_m: Its length, metres; infinite if there is none.
        points: Start, bends and end, Habitat's frame, metres; empty if there is none.
    """

    length_m: float
    points: Float32[np.ndarray, "n 3"]


NO_PATH = MeshPath(math.inf, np.zeros((0, 3), dtype=np.float32))


class Navmesh:
    """A navigation mesh for queries. All positions are in Habitat's frame, y up, metres.

    A position off the mesh is replaced by the nearest one on it, within 2 m, as in habitat-sim.

    Attributes:
        mesh: The mesh, in the kernels' form.
        islands: Island of every polygon.
        areas_m2: Area of every island.
        bounds: Lowest and highest corner.
    """

    def __init__(self, file: NavmeshFile) -> None:
        """Prepare the content of a file.

        Raises:
            NavmeshError: Too many edges lie on borders between its tiles.
        """
        self.islands, self.areas_m2, self.mesh = find_islands(mesh_of(file))
        self.bounds: Float32[np.ndarray, "2 3"] = np.stack(
            [self.mesh.tile_low.min(axis=0), self.mesh.tile_high.max(axis=0)]
        )

    @staticmethod
    def load(path: Path) -> "Navmesh":
        """Read a file.

        Raises:
            NavmeshError: It cannot be read or holds no navigation mesh of habitat-sim.
        """
        return Navmesh(read_navmesh(path))

    @property
    def area_m2(self) -> float:
        """Area of all islands."""
        return float(self.areas_m2.sum())

    def nearest(self, point: Point, island: int | None = None) -> Point | None:
        """The nearest position on the mesh, or on one island; None if none is near."""
        polygon, found = self.located(point, NOWHERE if island is None else island)
        return None if polygon == NOWHERE else _point(found)

    def is_navigable(self, point: Point, height_m: float = _NAVIGABLE_HEIGHT_M) -> bool:
        """Whether a position is on the mesh, within a tolerance in height and 1 cm sideways."""
        found = self.nearest(point)
        if found is None:
            return False
        gap = math.hypot(found[0] - point[0], found[2] - point[2])
        return abs(found[1] - point[1]) <= height_m and gap <= _NAVIGABLE_GAP_M

    def island_of(self, point: Point) -> int:
        """Island of the nearest position on the mesh; -1 if none is near."""
        polygon, _ = self.located(point)
        return NOWHERE if polygon == NOWHERE else int(self.islands[polygon])

    def try_step(
        self, start: Point, end: Point, *, sliding: bool, stop_at: StopChoice = "first_wall"
    ) -> Point:
        """End of a straight move on the mesh.

        Args:
            start: Where it begins.
            end: Where it should end.
            sliding: Whether to slide along borders of the mesh; otherwise a move ends there.
            stop_at: The border that ends a move without sliding.

        Returns:
            The position reached; the start if it, or the end, is off the mesh, or if they lie on
            different islands.
        """
        ends, to_last_wall = (singles(start), singles(end)), stop_at == "last_wall"
        return _point(try_step(self.mesh, self.islands, *ends, sliding, to_last_wall))

    def shortest_path(self, start: Point, end: Point) -> MeshPath:
        """The shortest path between two positions."""
        length, points = path_between(self.mesh, self.islands, singles(start), singles(end))
        return MeshPath(float(length), points)

    def random_point(self, rng: np.random.Generator, island: int | None = None) -> Point:
        """A position on the mesh or on one island, uniform over the area.

        Raises:
            StartError: There is nothing to walk on.
        """
        polygons, triangles, areas = self._triangles
        if island is not None:
            areas = np.where(self.islands[polygons] == island, areas, 0.0)
        sums = np.cumsum(areas)
        for _ in range(_DRAWS if sums[-1] > 0.0 else 0):
            # By rounding a point at a border may be outside its polygon.
            chosen = min(int(np.searchsorted(sums, rng.random() * sums[-1])), len(sums) - 1)
            along, across = math.sqrt(rng.random()), rng.random()
            point = singles(
                np.array([1.0 - along, along * (1.0 - across), along * across]) @ triangles[chosen]
            )
            over, height = height_on(self.mesh, int(polygons[chosen]), point)
            if over:
                return _point((point[0], np.float32(height), point[2]))
        raise StartError("the navigation mesh has nothing to walk on to draw a position from")

    def located(self, point: Point, island: int = NOWHERE) -> tuple[int, Singles]:
        """The polygon nearest to a position and the point on it; `NOWHERE` if none is near."""
        polygon, found = nearest(self.mesh, singles(point), self.islands, island)
        return int(polygon), singles(np.array(found))

    @cached_property
    def _triangles(
        self,
    ) -> tuple[Int32[np.ndarray, " t"], Float64[np.ndarray, "t 3 3"], Float64[np.ndarray, " t"]]:
        """Walkable polygons cut into triangles: polygon, corners and area in the plane of each."""
        polygons, corners = np.nonzero(
            np.arange(2, self.mesh.corners.shape[1]) < self.mesh.corner_count[:, None]
        )
        numbers = np.stack([np.zeros_like(corners), corners + 1, corners + 2], axis=1)
        triangles = self.mesh.vertices[self.mesh.corners[polygons[:, None], numbers]].astype(float)
        ab, ac = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        areas = np.abs(ab[:, 0] * ac[:, 2] - ab[:, 2] * ac[:, 0]) / 2.0
        areas = np.where(self.mesh.walkable[polygons], areas, 0.0)
        return polygons.astype(np.int32), triangles, areas


def singles(point: Point | np.ndarray) -> Singles:
    """A point in single precision, which numbers from kernels have lost."""
    x, y, z = point
    return np.float32(x), np.float32(y), np.float32(z)


def _point(point: tuple[Any, Any, Any]) -> Point:
    return float(point[0]), float(point[1]), float(point[2])


class GoalPaths:
    """The nearest of many goals by path length, for a series of positions.

    habitat-sim keeps a lower bound of the distance to each goal between queries, so that few paths
    must be searched. Its paths are not always the very shortest, so a result may depend on the
    earlier queries, by millimetres. The same series of queries gives the same results here.
    """

    def __init__(self, navmesh: Navmesh, goals: Float64[np.ndarray, "n 3"]) -> None:
        """Create it for a set of goals.

        Args:
            navmesh: Mesh that they lie on or near; those that are off it count as out of reach.
            goals: Positions of the goals, Habitat's frame, metres.
        """
        self._navmesh = navmesh
        self._goals = goals.astype(np.float32)
        located = [navmesh.located((x, y, z)) for x, y, z in goals.tolist()]
        self._polygons = np.array([polygon for polygon, _ in located], dtype=np.int64)
        self._points = np.array([point for _, point in located], dtype=np.float32).reshape(-1, 3)
        self._bounds = np.zeros(len(goals), dtype=np.float32)
        self._before: Point = (0.0, 0.0, 0.0)

    def nearest(self, start: Point) -> tuple[int, MeshPath]:
        """The goal with the shortest path from a position, and the path.

        Returns:
            Number of the goal and the path; -1 and no path if none leads anywhere.
        """
        polygon, point = self._navmesh.located(start)
        if polygon == NOWHERE or not (self._polygons != NOWHERE).any():
            return NOWHERE, NO_PATH
        here = singles(start)
        if len(self._goals) > 1:
            moved = np.float32(self._navmesh.shortest_path(start, self._before).length_m)
            straight = np.linalg.norm(self._goals - np.array(here), axis=1)
            self._bounds = np.maximum(self._bounds - moved, straight)
            self._before = start
        goal, length, points = nearest_goal(
            self._navmesh.mesh,
            self._navmesh.islands,
            here,
            polygon,
            point,
            self._goals,
            self._polygons,
            self._points,
            self._bounds,
        )
        return int(goal), MeshPath(float(length), points)
