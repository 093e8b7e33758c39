"""The way to a remembered thing: where to stand to see it from near."""

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.memory.thing import Thing
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.mapping.sight_lines import lines_are_clear
from hypernav.mapping.top_down.top_down_map import TopDownMap

_BESIDE_M = 1.0
"""Distance from a thing within which the robot goes, in sight of it, metres."""
_IN_SIGHT_M = 4.0
"""Distance within which it does where nothing nearer can be reached, metres."""
_PER_STRAIGHT_M = 2.0
"""Length of the path per metre of the straight line to where no free floor is known to lead."""
_ON_FLOOR_M = 0.3
"""Height of a thing's lowest point, metres, from which it stands on something or hangs."""
_UNDER_IT_M = 0.3
"""Distance from such a thing, metres, up to which what it stands on reaches and hides nothing."""


def way_to_thing(
    thing: Thing, floor_map: TopDownMap, reach: ReachableArea, robot: Pose2
) -> tuple[tuple[float, float], float]:
    """The reachable position beside a thing, in sight of it, and the length of the path there.

    It lies on a side that the thing was seen from: the map may not show what hides it from others.
    Where there is none beside it, the position is the one farther away with the shortest path on to
    it; where there is none at all, one that the robot has seen it from.

    Args:
        thing: The thing.
        floor_map: Map of its floor.
        reach: What of this floor the robot can reach.
        robot: Pose of the robot.

    Returns:
        The position ``(x, y)``, ``map`` frame, and the length, with what is left from there to a
        thing that is farther away, both in metres.
    """
    for nearest_m, farthest_m in ((0.0, _BESIDE_M), (_BESIDE_M, _IN_SIGHT_M)):
        away_m = _away_m(thing, reach.grid)
        near = (away_m > nearest_m) & (away_m <= farthest_m) & (reach.reachable > 0)
        rows, columns = np.nonzero(near)
        points = reach.grid.centres_of(np.column_stack([rows, columns]))
        is_clear = _in_sight(thing, floor_map, points)
        if is_clear.any():
            left_m = away_m[rows, columns] if nearest_m > 0.0 else 0.0
            path_m = reach.travel_m[rows, columns] + left_m
            nearest = int(np.where(is_clear, path_m, np.inf).argmin())
            x, y = points[nearest].tolist()
            return (x, y), float(path_m[nearest])
    return way_to_view(thing, reach, robot)


def way_to_view(
    thing: Thing, reach: ReachableArea, robot: Pose2
) -> tuple[tuple[float, float], float]:
    """The position that a thing was seen best from, and the length of the path there, metres."""
    x, y = thing.seen_from
    row, column = reach.grid.cell_of(x, y)
    rows, columns = reach.travel_m.shape
    path_m = np.inf
    if 0 <= row < rows and 0 <= column < columns and reach.reachable[row, column]:
        path_m = float(reach.travel_m[row, column])
    return (x, y), min(path_m, _PER_STRAIGHT_M * robot.distance_to(x, y))


def _in_sight(
    thing: Thing, floor_map: TopDownMap, points: Float64[np.ndarray, "n 2"]
) -> Bool[np.ndarray, " n"]:
    """Whether a thing is in sight from each position, as far as is known."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    inside = np.clip(points, thing.low[:2], thing.high[:2])
    own = _filled(thing, floor_map.grid)
    eye_level = floor_map.eye_level(np.concatenate([points, inside]))
    is_clear = lines_are_clear(eye_level, points, inside, through=own)
    return is_clear & thing.was_seen_from(points)


def _away_m(thing: Thing, grid: OccupancyGrid) -> Float64[np.ndarray, "rows columns"]:
    """Distance of the middles of a grid's cells from a thing's box, metres."""
    (left, bottom), size = grid.origin, grid.resolution_m
    x = left + (np.arange(grid.cells.shape[1]) + 0.5) * size
    y = bottom + (np.arange(grid.cells.shape[0]) + 0.5) * size
    away_x = np.maximum(np.maximum(thing.low[0] - x, x - thing.high[0]), 0.0)
    away_y = np.maximum(np.maximum(thing.low[1] - y, y - thing.high[1]), 0.0)
    return np.hypot(away_x[None, :], away_y[:, None])


def _filled(thing: Thing, grid: OccupancyGrid) -> Float64[np.ndarray, "n 2"]:
    """Middles of the cells of a thing and of what it stands on, ``(x, y)``, metres."""
    size = grid.resolution_m
    beside_m = size / 2.0 if thing.low[2] < _ON_FLOOR_M else _UNDER_IT_M
    x = np.arange(thing.low[0] - beside_m, thing.high[0] + beside_m + size / 2.0, size)
    y = np.arange(thing.low[1] - beside_m, thing.high[1] + beside_m + size / 2.0, size)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
