"""Shortest paths to the nearest of many goals, as habitat-sim's ``MultiGoalShortestPath``."""

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.navmesh.detour.nearest_kernels import NOWHERE
from hypernav.worlds.navmesh.detour.path_kernels import nearest_goal
from hypernav.worlds.navmesh.navmesh import NO_PATH, MeshPath, Navmesh, Point, singles


class GoalPaths:
    """The nearest of many goals by path, from one position after the other.

    habitat-sim remembers from one question to the next how near each goal can be at most, so that
    few paths must be searched; its paths are not always the very shortest, so an answer may depend
    on the questions before it, by millimetres. The same questions get the same answers here.
    """

    def __init__(self, navmesh: Navmesh, goals: Float64[np.ndarray, "n 3"]) -> None:
        """Take the goals.

        Args:
            navmesh: Mesh that they lie on or near; those that are off it count as out of reach.
            goals: Their positions, Habitat's frame, metres.
        """
        self._navmesh = navmesh
        self._goals = goals.astype(np.float32)
        located = [navmesh.located((x, y, z)) for x, y, z in goals.tolist()]
        self._polygons = np.array([polygon for polygon, _ in located], dtype=np.int32)
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
