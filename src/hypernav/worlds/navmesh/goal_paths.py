"""Shortest paths to the nearest of many goals, as habitat-sim's ``MultiGoalShortestPath``."""

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.navmesh.detour.nearest_kernels import NOWHERE
from hypernav.worlds.navmesh.detour.path_kernels import nearest_goal
from hypernav.worlds.navmesh.navmesh import NO_PATH, MeshPath, Navmesh, Point, singles


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
