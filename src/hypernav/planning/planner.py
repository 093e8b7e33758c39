"""Ways over the map."""

from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.grid import OccupancyGrid
from hypernav.planning.astar_kernels import astar, dearest_on_line, pull_string
from hypernav.planning.config import PlanningConfig
from hypernav.planning.terrain import Terrain


@dataclass(frozen=True)
class Path:
    """A way for the robot's middle, ``map`` frame.

    Attributes:
        waypoints: Corners ``(x, y)`` from the start to the end, metres.
        gap_m: From the path's end to the nearest cell of the destination; more than 0 where the
            destination itself cannot be entered.
    """

    waypoints: tuple[tuple[float, float], ...]
    gap_m: float

    @property
    def end(self) -> tuple[float, float]:
        """Where it leads."""
        return self.waypoints[-1]

    @property
    def length_m(self) -> float:
        """Of the polyline."""
        corners = np.array(self.waypoints)
        return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())


class Planner:
    """A* on inflated obstacles."""

    def __init__(self, config: PlanningConfig) -> None:
        """Create the planner."""
        self._config = config

    def plan(
        self,
        grid: OccupancyGrid,
        start: tuple[float, float],
        targets: Float64[np.ndarray, "n 2"],
    ) -> Path | None:
        """The cheapest way to a destination.

        A start inside an inflated obstacle moves to the nearest open cell. Where no cell of the
        destination can be reached, the way leads to the reachable cell nearest to it.

        Args:
            grid: The map.
            start: ``(x, y)``, metres.
            targets: Points ``(x, y)`` of the destination, metres.

        Returns:
            The way, or None if the robot is walled in.
        """
        return self.plan_on(Terrain.of(grid, self._config), start, targets)

    def plan_on(
        self,
        terrain: Terrain,
        start: tuple[float, float],
        targets: Float64[np.ndarray, "n 2"],
    ) -> Path | None:
        """The same over a map that is inflated already."""
        if self._config.targets == "nearest-straight":
            offsets = ((targets - np.array(start)) ** 2).sum(axis=1)
            targets = targets[[int(offsets.argmin())]]
        first = terrain.nearest_open(*terrain.grid.cell_of(*start))
        if first is None:
            return None
        goal, gap_m = _reachable_goal(terrain, first, targets)
        cells, _ = astar(terrain.costs, *first, goal)
        if len(cells) == 0:
            return None
        corners = cells[pull_string(terrain.costs, cells)]
        points = [(float(x), float(y)) for x, y in terrain.grid.centres_of(corners)]
        return Path((start, *(points[1:] or points)), gap_m)


def is_blocked(path: Path, terrain: Terrain) -> bool:
    """Whether the map now shows an obstacle on a path, its first leg aside."""
    corners = [terrain.continuous(*point) for point in path.waypoints[1:]]
    return any(np.isinf(dearest_on_line(terrain.costs, *a, *b)) for a, b in pairwise(corners))


def _reachable_goal(
    terrain: Terrain, first: tuple[int, int], targets: Float64[np.ndarray, "n 2"]
) -> tuple[Bool[np.ndarray, "rows columns"], float]:
    """Cells to go to, and how far from the destination they are."""
    is_open = (terrain.costs > 0).astype(np.uint8)
    # Diagonal steps need both neighbours, so what is 8-reachable is 4-connected.
    _, parts = cv2.connectedComponents(is_open, connectivity=4)
    reachable = parts == parts[first]
    wanted = np.zeros(reachable.shape, dtype=bool)
    cells = terrain.grid.cells_of(targets)
    inside = ((cells >= 0) & (cells < np.array(reachable.shape))).all(axis=1)
    wanted[cells[inside, 0], cells[inside, 1]] = True
    goal = wanted & reachable
    if goal.any():
        return goal, 0.0
    size = terrain.grid.resolution_m
    if wanted.any():
        away = cv2.distanceTransform((~wanted).astype(np.uint8), cv2.DIST_L2, 5)
    else:  # beyond the explored map: the reachable cell nearest to the first target
        rows, columns = np.indices(reachable.shape)
        row, column = terrain.continuous(*targets[0])
        away = np.hypot(rows + 0.5 - row, columns + 0.5 - column)
    away = np.where(reachable, away, np.inf)
    nearest = np.unravel_index(int(away.argmin()), away.shape)
    goal = np.zeros_like(wanted)
    goal[nearest] = True
    return goal, float(away[nearest]) * size
