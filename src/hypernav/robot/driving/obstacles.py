"""Distances to obstacles: from a map, or from what depth images show in front of the robot.

What depth images show needs no map, no network and no model.
"""

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import KDTree

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.driving.base import DepthView
from hypernav.search.mapping.config import UNEVEN_M, UNEVEN_SHARE
from hypernav.search.mapping.inflation import distance_from


@runtime_checkable
class Obstacles(Protocol):
    """Obstacles around the robot, in the frame of its path."""

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance of every point ``(x, y)`` to the nearest obstacle, metres; 0 inside one."""
        ...


class NoObstacles:
    """No obstacles at all."""

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Infinity for every point."""
        return np.full(len(points), np.inf)


class MapObstacles:
    """The occupied cells of a map; unknown cells and those beyond the map count as free."""

    def __init__(self, grid: OccupancyGrid) -> None:
        """Measure the distances in a map, which may change afterwards."""
        self._grid = grid
        cells = distance_from(grid.occupied)
        self._distances = cells.astype(np.float64) * grid.resolution_m

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance from every point's cell to the nearest occupied one, between centres, metres."""
        cells = self._grid.cells_of(points)
        inside = self._grid.contains(cells)
        found = np.full(len(points), np.inf)
        found[inside] = self._distances[cells[inside, 0], cells[inside, 1]]
        return found


class PointObstacles:
    """Points that a camera has measured."""

    def __init__(self, points: Float64[np.ndarray, "n 2"]) -> None:
        """Take points ``(x, y)`` of obstacles, metres; there may be none."""
        self._tree = KDTree(points) if len(points) else None

    def distances(self, points: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Distance of every point to the nearest measured one, metres."""
        if self._tree is None:
            return np.full(len(points), np.inf)
        return np.asarray(self._tree.query(points)[0], dtype=np.float64)


_REACH_M = 2.5
"""Depth beyond which points are ignored: far for a slow robot, and noise lifts the floor there."""
_NEAR_M = 1.2
"""Distance from the robot up to which points are remembered."""
_REMEMBERED_VIEWS = 60
"""Number of views for which a point is remembered after it left the camera's view."""
_PATCH = np.ones((3, 3), np.uint8)
"""Smallest part of an image, pixels, that shows a drop: single pixels err."""
_APART_M = 0.02
"""Distance between remembered points."""
_ACROSS = 1 << 32
"""More cells of this size than any drive is long."""
_BLIND_SHARE = 0.25
"""Share of the floor in front of the robot without a return above which the camera is blind."""
_LEAST_FLOOR_PIXELS = 10
_MOST_REPEATED = 2
"""Number of times that one image may be used again: cameras are slower than commands."""


@dataclass(frozen=True, eq=False)
class Ahead:
    """What depth images show in front of the robot.

    Attributes:
        obstacles: Points of obstacles, and of floor that is missing, in the frame of the odometry.
        is_blind: Whether the camera is frozen, or the floor in front of the robot has no return,
            because something is too near to be measured, or covers the camera.
    """

    obstacles: PointObstacles
    is_blind: bool


class DepthSafety:
    """Finds obstacles in depth images; remembers for a while those that left the image.

    What slips below the image, as a low box does when the robot comes near, is remembered as well
    as what is now too near to be measured.

    Where the camera sees below the floor, the floor is missing: the head of stairs is an obstacle
    for a robot that can't climb. It is below the image before the robot is there, so it is
    remembered until floor is seen there, or the robot has left it behind.
    """

    def __init__(self, embodiment: Embodiment) -> None:
        """Create it with an empty memory.

        Args:
            embodiment: Gives the size of the robot (points between the height of a step and its own
                height are obstacles) and the nearest depth that its camera measures.
        """
        self._body = embodiment.body
        self._nearest_m = embodiment.camera.min_depth_m
        self._remembered = np.zeros((0, 3))
        self._ages = np.zeros(0, dtype=np.int64)
        self._drops = np.zeros((0, 2))
        self._stamp_s = math.nan
        self._repeated = 0

    def look(self, view: DepthView) -> Ahead:
        """Look at the latest image."""
        robot = view.robot
        self._repeated = self._repeated + 1 if view.stamp_s == self._stamp_s else 0
        self._stamp_s = view.stamp_s
        rays = view.camera.rays() @ view.camera_to_base.rotation.T
        now = robot.to_transform().apply(self._hindering(view, rays))
        self._forget_seen(view)
        floor = _floor_depth(view, rays)
        self._drops = self._drops_around(view, rays, floor)
        known = np.vstack([now, self._remembered])[:, :2]
        obstacles = PointObstacles(np.vstack([known, self._drops]))
        near = np.hypot(now[:, 0] - robot.x, now[:, 1] - robot.y) < _NEAR_M
        kept = _lowest(now[near])
        self._remembered = np.vstack([self._remembered, kept])
        self._ages = np.concatenate([self._ages, np.zeros(len(kept), dtype=np.int64)])
        is_blind = self._repeated > _MOST_REPEATED or self._sees_no_floor(view, rays, floor)
        return Ahead(obstacles, is_blind)

    def _hindering(
        self, view: DepthView, rays: Float64[np.ndarray, "height width 3"]
    ) -> Float64[np.ndarray, "n 3"]:
        """Points that the robot would hit, base frame."""
        depth = view.depth.astype(np.float64)
        seen = is_measured(depth, 0.0, _REACH_M)
        points = rays[seen] * depth[seen][:, None] + view.camera_to_base.translation
        height = points[:, 2]
        return points[(height > self._body.max_step_m) & (height < self._body.height_m)]

    def _drops_around(
        self,
        view: DepthView,
        rays: Float64[np.ndarray, "height width 3"],
        floor: Float64[np.ndarray, "height width"],
    ) -> Float64[np.ndarray, "n 2"]:
        """Where floor is missing: in this image, or near the robot and not seen to be there."""
        if self._body.climbs_stairs:
            return self._drops
        eye, measured = view.camera_to_base.translation, is_measured(view.depth)
        z = eye[2] + rays[..., 2] * np.where(measured, view.depth, np.nan)
        uneven_m = self._body.max_step_m + UNEVEN_M + UNEVEN_SHARE * floor
        is_lower = (z < -uneven_m) & (floor < _REACH_M)
        is_drop = cv2.morphologyEx(is_lower.view(np.uint8), cv2.MORPH_OPEN, _PATCH) > 0
        points = rays[is_drop] * floor[is_drop][:, None] + eye
        now = view.robot.to_transform().apply(points)[:, :2]
        known = self._drops
        is_left = np.hypot(known[:, 0] - view.robot.x, known[:, 1] - view.robot.y) >= _REACH_M
        kept = known[~is_left & ~self._shows_floor(view, known, np.abs(z) <= uneven_m)]
        return _apart(np.vstack([kept, now]))[0]

    def _shows_floor(
        self,
        view: DepthView,
        points: Float64[np.ndarray, "n 2"],
        is_floor: Bool[np.ndarray, "height width"],
    ) -> Bool[np.ndarray, " n"]:
        """Whether an image shows floor at positions on the floor plan."""
        on_floor = np.column_stack([points, np.zeros(len(points))])
        pixels = view.camera.project(_in_camera(view, on_floor))
        shows = view.camera.contains(pixels)
        u, v = pixels[shows].astype(np.intp).T
        shows[shows] = is_floor[v, u]
        return shows

    def _forget_seen(self, view: DepthView) -> None:
        """Keep only points outside the image or too near to be measured, and drop the old ones."""
        points = self._remembered
        in_camera = _in_camera(view, points)
        pixels = view.camera.project(in_camera)
        is_seen = (in_camera[:, 2] > self._nearest_m) & view.camera.contains(pixels)
        kept = ~is_seen & (self._ages < _REMEMBERED_VIEWS)
        self._remembered, self._ages = points[kept], self._ages[kept] + 1

    def _sees_no_floor(
        self,
        view: DepthView,
        rays: Float64[np.ndarray, "height width 3"],
        floor: Float64[np.ndarray, "height width"],
    ) -> bool:
        """Whether too little of the floor in the robot's way has a return."""
        eye, down = view.camera_to_base.translation, np.isfinite(floor)
        beside = np.where(down, rays[..., 1] * np.where(down, floor, 0.0) + eye[1], np.inf)
        ahead = (floor < _REACH_M) & (np.abs(beside) < self._body.radius_m)
        if np.count_nonzero(ahead) < _LEAST_FLOOR_PIXELS:
            return False
        return bool(np.mean(~is_measured(view.depth[ahead])) > _BLIND_SHARE)


def _in_camera(view: DepthView, points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """Points in the optical frame."""
    in_base = view.robot.to_transform().inverse().apply(points)
    return view.camera_to_base.inverse().apply(in_base)


def _lowest(points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "m 3"]:
    """The lowest point of each cell of the floor plan."""
    rising = points[np.argsort(points[:, 2], kind="stable")]
    positions, first = _apart(rising[:, :2])
    return np.column_stack([positions, rising[first, 2]])


def _apart(
    points: Float64[np.ndarray, "n 2"],
) -> tuple[Float64[np.ndarray, "m 2"], Int64[np.ndarray, " m"]]:
    """One position for each cell of the floor plan, and the number of its first point."""
    cells = np.round(points / _APART_M).astype(np.int64)
    _, first = np.unique(cells[:, 0] * _ACROSS + cells[:, 1], return_index=True)
    return cells[first] * _APART_M, first


def _floor_depth(
    view: DepthView, rays: Float64[np.ndarray, "height width 3"]
) -> Float64[np.ndarray, "height width"]:
    """Depth at which the rays of an image meet the floor, metres; infinite above the horizon."""
    down = rays[..., 2] < 0.0
    eye_z = view.camera_to_base.translation[2]
    return np.where(down, -eye_z / np.where(down, rays[..., 2], -1.0), np.inf)
