"""A goal in the image whose depth is not measured: about where it may be, and on what floor."""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.core.observation import Observation
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.memory.thing import is_in_room

_BESIDE_REJECTED_DEG = 10.0
"""Angle to a rejected area, degrees, within which a goal out of range is ignored."""
_BELOW_M, _ABOVE_M = -2.3, 3.4
"""Heights above the floor, metres, at which things of the floors below and above are, about: they
tell how far away one is whose line of sight alone is known."""
_IN_REACH = 0.25
"""Share of the pixels of a goal, or right below it, with a depth from which it is in reach."""
_LEAST_BELOW_PX = 3.0
"""Least height of what counts as right below a goal, pixels; else it is half the goal's."""


def far_position_of(
    box: Box, observation: Observation, camera: CameraConfig, rejected: Sequence[GoalArea]
) -> tuple[float, float] | None:
    """Nearest position ``(x, y)`` of a goal out of range, metres; None beside a rejected area.

    Args:
        box: Box of the goal in the image.
        observation: The image.
        camera: Camera, whose range of depth counts.
        rejected: Areas that were rejected before.
    """
    robot = observation.robot
    bearing = observation.camera.bearing_of((box.x_min + box.x_max) / 2.0)
    for area in rejected:
        away = wrap_angle(robot.bearing_to(*area.centre) - bearing)
        if abs(away) < math.radians(_BESIDE_REJECTED_DEG):
            return None
    return _position_at(camera.max_depth_m / math.cos(bearing), bearing, observation)


def off_floor_out_of_range(
    box: Box,
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    camera: CameraConfig,
    grid: OccupancyGrid,
    ground_m: float,
) -> tuple[float, float, float] | None:
    """About where a goal out of range is that lies below or above the room of the robot's floor.

    Args:
        box: Box of the goal in the image.
        mask: Mask of its pixels.
        observation: The image, with heights counted from the robot's ground.
        camera: Camera, whose range of depth counts.
        grid: Map of the robot's floor.
        ground_m: Height of that ground above the floor, metres.

    Returns:
        Position ``(x, y)``, as if a storey lay between, and the height at which its line of sight
        leaves the range, metres: the goal lies at least so far below or above. None if it may be in
        the room, as far as its line of sight tells, or within range.
    """
    camera_at = observation.camera_to_map.translation
    column, row = (
        np.array([box.x_min + box.x_max]) / 2.0,
        np.array([box.y_min + box.y_max]) / 2.0,
    )
    point = observation.camera.unproject(column, row, np.array([camera.max_depth_m]))
    nearest = observation.camera_to_map.apply(point)[0]
    if is_in_room(float(nearest[2]), ground_m):
        return None
    if _may_be_in_range(box, mask, observation, camera, grid):
        return None
    away = nearest - camera_at
    z = _BELOW_M if away[2] < 0.0 else _ABOVE_M
    x, y, _ = (camera_at + max(1.0, (z - camera_at[2]) / away[2]) * away).tolist()
    return (x, y, float(nearest[2]) + ground_m)


def _may_be_in_range(
    box: Box,
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    camera: CameraConfig,
    grid: OccupancyGrid,
) -> bool:
    """Whether a goal without depth may be near: mirrors, glass and black things have none.

    What such a thing stands on, or the wall on which it hangs, has, and comes right below it in the
    image. Right before the camera nothing has: there the map tells.
    """
    height, width = observation.depth.shape
    below_px = max((box.y_max - box.y_min) / 2.0, _LEAST_BELOW_PX)
    below = Box(box.x_min, box.y_max, box.x_max, box.y_max + below_px)
    for pixels in (mask, below.mask(width, height)):
        depths = observation.depth[pixels]
        measured = np.count_nonzero(is_measured(depths, farthest_m=camera.max_depth_m))
        if measured >= _IN_REACH * depths.size:
            return True
    bearing = observation.camera.bearing_of((box.x_min + box.x_max) / 2.0)
    blind_m = np.arange(0.0, camera.min_depth_m + grid.resolution_m, grid.resolution_m)
    before = [_position_at(float(away_m), bearing, observation) for away_m in blind_m]
    return any(grid.state_at(*position) == Cell.OCCUPIED for position in before)


def _position_at(away_m: float, bearing: float, observation: Observation) -> tuple[float, float]:
    """Position ``(x, y)`` on the map so far from the robot in a direction, metres."""
    robot = observation.robot
    angle = robot.yaw + bearing
    return (robot.x + away_m * math.cos(angle), robot.y + away_m * math.sin(angle))
