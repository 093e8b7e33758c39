"""Which rooms the unknown belongs to, by what was seen near it, and where the goal is likely."""

from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64, Int64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.sightings import SeenThing
from hypernav.perception.rooms.belief_kernels import evidence
from hypernav.perception.rooms.room_table import RoomTable, room_table

_PATCH_M = 0.2
_MARGIN = 5
"""Patches on every side of what is asked about, for paths around something."""
_SAME_ROOM_M = 3.0
_NEXT_ROOM_M = 6.0
"""Lengths of paths at which a thing is half as likely in the same room, or the one beside it."""
_THROUGH_OBSTACLE = 4.0
"""Length of a path over furniture: things stand on it, but it may be a wall that is seen low."""
_THROUGH_WALL = 30.0
"""Length of a path through what reaches to the ceiling: a wall, or the lintel of a door."""
_SURE = 0.95
"""All of these are ours, chosen on training buildings and small_house."""


def chances_of_goal(
    goal: Goal,
    grid: OccupancyGrid,
    things: Sequence[SeenThing],
    walls: Float64[np.ndarray, "walls 2"],
    positions: Float64[np.ndarray, "n 2"],
    table: RoomTable | None = None,
) -> Float64[np.ndarray, "n"]:
    """How likely the goal is at some positions, by the rooms that these seem to belong to.

    Several things of one kind tell as much as one of them. Where no thing is near, all kinds of
    rooms are as likely as each other, and the chance is 1.

    Args:
        goal: Target of the search.
        grid: The map.
        things: Things that were seen.
        walls: Positions ``(x, y)`` of what reaches nearly to the ceiling, metres.
        positions: Positions ``(x, y)`` that are asked about, metres.
        table: What stands where; None for that of this package.

    Returns:
        Chances per square metre, in relation to the average of all rooms.
    """
    table = table or room_table()
    densities = table.densities(goal)
    named = [(table.of_thing(one.label), one.position) for one in things]
    names = sorted({name for name, _ in named if name is not None})
    if densities is None or not names or not len(positions):
        return np.ones(len(positions))
    places = np.array([position for name, position in named if name is not None])
    thing_of = np.array([names.index(name) for name, _ in named if name is not None])
    corner, step_costs = _step_costs(grid, walls, np.concatenate([places, positions]))
    here = np.array([table.chances[name] for name in names])
    beside = here @ table.beside.T
    likelihoods = evidence(
        step_costs,
        _patches(places, corner),
        thing_of,
        here / here.mean(axis=1, keepdims=True),
        beside / beside.mean(axis=1, keepdims=True),
        _patches(positions, corner),
        _SAME_ROOM_M / _PATCH_M,
        _NEXT_ROOM_M / _PATCH_M,
        _SURE,
    )
    return likelihoods @ densities / likelihoods.sum(axis=1)


def _step_costs(
    grid: OccupancyGrid,
    walls: Float64[np.ndarray, "walls 2"],
    points: Float64[np.ndarray, "n 2"],
) -> tuple[Float64[np.ndarray, "2"], Float64[np.ndarray, "rows columns"]]:
    """Lower left corner, metres, and costs of the patches around some points, with a margin."""
    corner = (np.floor(points.min(axis=0) / _PATCH_M) - _MARGIN) * _PATCH_M
    spans = np.ceil((points.max(axis=0) - corner) / _PATCH_M) + _MARGIN
    columns, rows = spans.astype(int).tolist()
    costs = np.ones((rows, columns))
    occupied = _patches(grid.centres_of(np.argwhere(grid.cells == Cell.OCCUPIED)), corner)
    costs[tuple(_inside(occupied, rows, columns).T)] = _THROUGH_OBSTACLE
    is_wall = np.zeros((rows, columns), dtype=np.uint8)
    is_wall[tuple(_inside(_patches(walls, corner), rows, columns).T)] = 1
    closed = cv2.morphologyEx(is_wall, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
    costs[closed > 0] = _THROUGH_WALL
    return corner, costs


def _patches(
    points: Float64[np.ndarray, "n 2"], corner: Float64[np.ndarray, "2"]
) -> Int64[np.ndarray, "n 2"]:
    """Rows and columns of the patches that hold points."""
    return np.floor((points - corner) / _PATCH_M)[:, ::-1].astype(np.int64)


def _inside(patches: Int64[np.ndarray, "n 2"], rows: int, columns: int) -> Int64[np.ndarray, "m 2"]:
    is_inside = (patches >= 0).all(axis=1) & (patches < (rows, columns)).all(axis=1)
    return patches[is_inside]
