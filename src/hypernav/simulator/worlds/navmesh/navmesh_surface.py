"""A navigation mesh as the surface that a simulated robot stands on, over all storeys."""

import math
from copy import copy
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.errors import SceneError, StartError
from hypernav.core.world import Position
from hypernav.lab.datasets.habitat_format import positions_from_habitat, positions_to_habitat
from hypernav.simulator.worlds.config import StopChoice
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh, Point
from hypernav.simulator.worlds.surface.storey_floors import Storeys
from hypernav.simulator.worlds.surface.walkable_surface import (
    by_importance,
    floors_of_box,
    is_near_box,
)

_SPACING_M = 0.05
_DRAWS = 1000
_ON_STOREY_M = 0.3
_SMALLEST_M2 = 1.0
_FEWER = 8
"""One point in so many tells what kind of floor an island is."""


class NavmeshSurface:
    """Where Habitat's robot can stand: a `WalkableSurface`.

    Standing, steps, sliding and paths are as in habitat-sim. Positions are in the scene frame, z
    up, metres. Connected parts are the mesh's islands, by area, or where the storeys are known
    `by_importance`, so that roofs come last.

    Attributes:
        navmesh: The mesh, in Habitat's frame.
        floor_z: Height of the main storey's floor, metres: the median over the largest island, or
            over that of its storeys that has the most floor, if they are known.
        storeys_z: Heights of the known storeys of which 1 m² and more can be reached, metres.
    """

    def __init__(
        self, navmesh: Navmesh, storeys: Storeys | None = None, stop_at: StopChoice = "first_wall"
    ) -> None:
        """Create it with a navigation mesh.

        Args:
            navmesh: The mesh.
            storeys: Storeys of the building; None if they are not known.
            stop_at: The wall that ends a step without sliding.

        Raises:
            SceneError: There is nothing to walk on.
        """
        self.navmesh = navmesh
        self._stop_at: StopChoice = stop_at
        self._by_area: Int64[np.ndarray, " i"] = np.argsort(-navmesh.areas_m2, kind="stable")
        if storeys is not None:
            areas_m2 = navmesh.areas_m2.tolist()
            parts = [
                storeys.part(self._points_of(k)[::_FEWER], areas_m2[island])
                for k, island in enumerate(self._by_area.tolist())
            ]
            self._by_area = self._by_area[by_importance(parts)]
        if len(self.floor) == 0:
            raise SceneError("the robot fits nowhere: the navigation mesh has nothing to walk on")
        heights = self.floor[:, 2]
        known = storeys.heights if storeys is not None else ()
        near = (heights[np.abs(heights - z) < _ON_STOREY_M] for z in known)
        on_storeys = [floor for floor in near if len(floor)]
        self.floor_z = float(np.median(max(on_storeys, key=len, default=heights)))
        large = (floor for floor in on_storeys if len(floor) * _SPACING_M**2 >= _SMALLEST_M2)
        self.storeys_z = tuple(float(np.median(floor)) for floor in large)

    def on_storey(self, z: float) -> "NavmeshSurface":
        """The same surface with another main storey, at a height in metres."""
        other = copy(self)
        other.floor_z = z
        return other

    @staticmethod
    def load(path: Path) -> "NavmeshSurface":
        """Read a navigation mesh of habitat-sim.

        Raises:
            NavmeshError: It cannot be read or holds no navigation mesh of habitat-sim.
            SceneError: There is nothing to walk on.
        """
        return NavmeshSurface(Navmesh.load(path))

    def is_on_storey(self, z: Float64[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Whether heights belong to a storey; always True, because this surface has all storeys."""
        return np.ones(len(z), dtype=bool)

    def height_at(self, x: float, y: float, z: float | None = None) -> float:
        """Height of the floor, metres; NaN where the robot can't stand."""
        point = self._point(x, y, z)
        if not self.navmesh.is_navigable(point):
            return math.nan
        found = self.navmesh.nearest(point)
        return math.nan if found is None else found[1]

    def is_standable(self, x: float, y: float, z: float | None = None) -> bool:
        """Whether the robot fits here: the floor is at most 0.5 m higher or lower."""
        return self.navmesh.is_navigable(self._point(x, y, z))

    def nearest_standable(self, x: float, y: float, z: float | None = None) -> Position:
        """The nearest position where the robot fits; beyond 2 m, to within 5 cm."""
        found = self.navmesh.nearest(self._point(x, y, z))
        if found is not None:
            return _position(found)
        here = np.array([x, y, self.floor_z if z is None else z])
        nearest = self.floor[np.argmin(((self.floor - here) ** 2).sum(axis=1))]
        return float(nearest[0]), float(nearest[1]), float(nearest[2])

    def move(self, position: Position, dx: float, dy: float, *, sliding: bool = False) -> Position:
        """End of a straight move.

        Args:
            position: Where the robot is.
            dx: Wanted displacement along x, metres.
            dy: Wanted displacement along y, metres.
            sliding: Whether it slides along obstacles; by default it stops at the contact.
        """
        x, y, z = position
        start, end = self._point(x, y, z), self._point(x + dx, y + dy, z)
        reached = self.navmesh.try_step(start, end, sliding=sliding, stop_at=self._stop_at)
        return _position(reached)

    def distance(self, start: Position, end: Position) -> float:
        """Geodesic distance, metres; infinite if no path exists."""
        return self.navmesh.shortest_path(self._point(*start), self._point(*end)).length_m

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> "NavmeshField":
        """Shortest paths to the nearest of these positions; those off the mesh don't count."""
        return NavmeshField(self, goals)

    def component_of(self, x: float, y: float, z: float | None = None) -> int:
        """Rank of the island around a point by area: 0 is the largest; -1 if not standable."""
        if not self.is_standable(x, y, z):
            return -1
        island = self.navmesh.island_of(self._point(x, y, z))
        return int(np.flatnonzero(self._by_area == island)[0])

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Points of one island, 5 cm apart, on all its storeys."""
        return (self.floor if component == 0 else self._points_of(component))[:, :2]

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest island, 5 cm apart, around a box and on its storey."""
        near = self.floor[is_near_box(self.floor[:, :2], low[:2], high[:2], reach_m)]
        return near[floors_of_box(near[:, 2], low[2])]

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A point of the largest island, on the main storey, uniform over its area.

        Raises:
            StartError: There is nothing to stand on.
        """
        for _ in range(_DRAWS):
            x, y, _ = _position(self.navmesh.random_point(rng, int(self._by_area[0])))
            if self.is_standable(x, y):
                return x, y
        raise StartError("the navigation mesh has no main storey to draw a position from")

    def _point(self, x: float, y: float, z: float | None) -> Point:
        """A position in Habitat's frame."""
        return x, self.floor_z if z is None else z, -y

    @cached_property
    def floor(self) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest island, 5 cm apart, on all its storeys and stairs, metres."""
        return self._points_of(0)

    def _points_of(self, component: int) -> Float64[np.ndarray, "n 3"]:
        """Points of an island in rows and columns, with the heights of its polygons."""
        mesh, island = self.navmesh.mesh, self._by_area[component]
        polygons = np.flatnonzero((self.navmesh.islands == island) & mesh.walkable)
        points = [np.zeros((0, 3))]
        for polygon in polygons.tolist():
            corners = mesh.vertices[mesh.corners[polygon, : mesh.corner_count[polygon]]]
            points.append(_points_in(positions_from_habitat(corners.astype(np.float64))))
        return np.concatenate(points)


class NavmeshField:
    """Shortest paths on a navigation mesh to the nearest of a set of goals. Scene frame, metres."""

    def __init__(self, surface: NavmeshSurface, goals: Float64[np.ndarray, "n 3"]) -> None:
        """Create it for a set of goals; those off the mesh don't count."""
        self._surface = surface
        self._paths = GoalPaths(surface.navmesh, positions_to_habitat(goals))

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance; infinite if no path leads there."""
        return self._paths.nearest(self._point(x, y, z))[1].length_m

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest goal, seen from above; empty if there is none."""
        points = self._paths.nearest(self._point(x, y, z))[1].points.astype(np.float64)
        return [(x, y) for x, y, _ in positions_from_habitat(points).tolist()]

    def _point(self, x: float, y: float, z: float | None) -> Point:
        return x, self._surface.floor_z if z is None else z, -y


def _position(point: Point) -> Position:
    x, y, z = point
    return x, -z, y


def _points_in(corners: Float64[np.ndarray, "c 3"]) -> Float64[np.ndarray, "n 3"]:
    """Points in a convex polygon that lie in rows and columns over all polygons."""
    low, high = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
    steps = [
        (np.arange(math.ceil(a / _SPACING_M), math.floor(b / _SPACING_M) + 1) + 0.5) * _SPACING_M
        for a, b in zip(low - 0.5 * _SPACING_M, high - 0.5 * _SPACING_M, strict=True)
    ]
    x, y = (grid.ravel() for grid in np.meshgrid(*steps))
    inside = np.ones(len(x), dtype=bool)
    sides = np.roll(corners, -1, axis=0) - corners
    for (ax, ay, _), (dx, dy, _) in zip(corners, sides, strict=True):
        inside &= dx * (y - ay) - dy * (x - ax) >= 0.0
    # Heights by the best-fitting plane of the corners; Detour's may differ by the detail error.
    plane, *_ = np.linalg.lstsq(
        np.column_stack([corners[:, :2], np.ones(len(corners))]), corners[:, 2]
    )
    x, y = x[inside], y[inside]
    return np.column_stack([x, y, plane[0] * x + plane[1] * y + plane[2]])
