"""habitat-sim's path finder as the surface that a robot stands on."""

import math
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.errors import StartError
from hypernav.core.world import Position
from hypernav.worlds.habitat.simulator import require_habitat
from hypernav.worlds.surface.walkable_surface import floors_of_box, is_near_box

_POINTS = 4000
_DRAWS = 1000
_NAVIGABLE_M = 0.5


class HabitatSurface:
    """Where habitat-sim lets a robot stand: a `WalkableSurface`. Scene frame, z up, metres.

    Attributes:
        floor_z: Height of the main storey's floor: the median over the largest island.
    """

    def __init__(self, path_finder: Any) -> None:
        """Create it with habitat-sim's path finder of an opened scene."""
        self._finder = path_finder
        self.floor_z = float(np.median(self._floor[:, 2]))

    def is_on_storey(self, z: Float64[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Whether heights belong to a storey; always True, because the mesh has all storeys."""
        return np.ones(len(z), dtype=bool)

    def height_at(self, x: float, y: float, z: float | None = None) -> float:
        """Height of the floor, metres; NaN where the robot can't stand."""
        if not self.is_standable(x, y, z):
            return math.nan
        return _position(self._finder.snap_point(self._point(x, y, z)))[2]

    def is_standable(self, x: float, y: float, z: float | None = None) -> bool:
        """Whether the robot fits here: the floor is at most 0.5 m higher or lower."""
        return bool(self._finder.is_navigable(self._point(x, y, z), _NAVIGABLE_M))

    def nearest_standable(self, x: float, y: float, z: float | None = None) -> Position:
        """The nearest position where the robot fits."""
        found = self._finder.snap_point(self._point(x, y, z))
        if not np.isnan(np.asarray(found)).any():
            return _position(found)
        here = np.array([x, y, self.floor_z if z is None else z])
        nearest = self._floor[np.argmin(((self._floor - here) ** 2).sum(axis=1))]
        return float(nearest[0]), float(nearest[1]), float(nearest[2])

    def move(self, position: Position, dx: float, dy: float, *, sliding: bool = False) -> Position:
        """End of a straight move, by habitat-sim's step filter."""
        x, y, z = position
        step = self._finder.try_step if sliding else self._finder.try_step_no_sliding
        return _position(step(self._point(x, y, z), self._point(x + dx, y + dy, z)))

    def distance(self, start: Position, end: Position) -> float:
        """Geodesic distance, metres; infinite if no path exists."""
        path = require_habitat().ShortestPath()
        path.requested_start, path.requested_end = self._point(*start), self._point(*end)
        return float(path.geodesic_distance) if self._finder.find_path(path) else math.inf

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> "HabitatField":
        """Shortest paths to the nearest of these positions."""
        return HabitatField(self._finder, goals, self.floor_z)

    def component_of(self, x: float, y: float, z: float | None = None) -> int:
        """Whether a point is on the largest island (0), on another (1) or on none (-1)."""
        if not self.is_standable(x, y, z):
            return -1
        return int(self._finder.get_island(self._point(x, y, z)) != self._island)

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Points spread over the largest island; no points for other islands."""
        return self._floor[:, :2] if component == 0 else np.zeros((0, 2))

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest island within a distance of a box, on its storey."""
        near = self._floor[is_near_box(self._floor[:, :2], low[:2], high[:2], reach_m)]
        return near[floors_of_box(near[:, 2], low[2])]

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A point of the largest island, on the main storey.

        Raises:
            StartError: There is none.
        """
        for _ in range(_DRAWS):
            x, y, _ = self._floor[rng.integers(len(self._floor))].tolist()
            if self.is_standable(x, y):
                return x, y
        raise StartError("habitat-sim's navigation mesh has no main storey")

    @cached_property
    def _island(self) -> int:
        areas = [self._finder.island_area(k) for k in range(self._finder.num_islands)]
        return int(np.argmax(areas))

    @cached_property
    def _floor(self) -> Float64[np.ndarray, "n 3"]:
        """Points spread over the largest island, drawn by habitat-sim, the same each time."""
        self._finder.seed(0)
        drawn = [
            _position(self._finder.get_random_navigable_point(10, self._island))
            for _ in range(_POINTS)
        ]
        points = np.array(drawn, dtype=np.float64)
        return points[np.isfinite(points).all(axis=1)]

    def _point(self, x: float, y: float, z: float | None) -> Float64[np.ndarray, "3"]:
        return np.array([x, self.floor_z if z is None else z, -y])


class HabitatField:
    """habitat-sim's shortest paths to the nearest of a set of goals. Scene frame, metres."""

    def __init__(self, finder: Any, goals: Float64[np.ndarray, "n 3"], floor_z: float) -> None:
        """Create it for a set of goals."""
        self._finder, self._floor_z = finder, floor_z
        self._path: Any = require_habitat().MultiGoalShortestPath()
        self._has_goals = len(goals) > 0
        if self._has_goals:
            self._path.requested_ends = np.column_stack([goals[:, 0], goals[:, 2], -goals[:, 1]])

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance; infinite if no path leads there."""
        return float(self._path.geodesic_distance) if self._found(x, y, z) else math.inf

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest goal, seen from above; empty if there is none."""
        points = self._path.points if self._found(x, y, z) else []
        return [(float(point[0]), -float(point[2])) for point in points]

    def _found(self, x: float, y: float, z: float | None) -> bool:
        if not self._has_goals:
            return False
        self._path.requested_start = np.array([x, self._floor_z if z is None else z, -y])
        return bool(self._finder.find_path(self._path))


def _position(point: Any) -> Position:
    return float(point[0]), -float(point[2]), float(point[1])
