"""Stairs lead along the walls and railings on both sides of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.mapping.stairs.flights import along_walls


def edge(axis: float) -> Connector:
    return Connector(0, False, (0.0, 0.0), axis)


def line(start: tuple[float, float], end: tuple[float, float]) -> np.ndarray:
    return np.linspace(start, end, round(math.dist(start, end) / 0.02))


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


def map_of(*walls: np.ndarray) -> OccupancyGrid:
    grid = OccupancyGrid(np.full((120, 120), Cell.FREE, np.uint8), 0.05, (-3.0, -3.0))
    grid.cells[grid.mask_of(np.concatenate(walls))] = Cell.OCCUPIED
    return grid


def railings(*, length_m: float = 2.0) -> np.ndarray:
    """Two railings along x, 1.2 m apart, on both sides of the origin."""
    return np.concatenate([line((0.0, y), (length_m, y)) for y in (-0.6, 0.6)])


BIG_WALL = line((-2.5, 1.0), (2.5, 1.0))
"""A wall along x that passes the origin 1 m away."""


def rotunda(radius_m: float, middle_y: float) -> np.ndarray:
    around = np.arange(0.0, math.tau, 0.01)
    return np.stack([radius_m * np.cos(around), middle_y + radius_m * np.sin(around)], axis=1)


@pytest.mark.parametrize("off", [-0.6, 0.0, 0.6])
@pytest.mark.parametrize("angle", [-2.0, -0.3, 0.2, 1.4, 3.0])
def test_stairs_lead_along_the_walls_around_them(angle: float, off: float):
    straight = along_walls(edge(angle + off), map_of(turned(railings(), angle)))
    assert abs(wrap_angle(straight.axis - angle)) < 0.04
    assert replace(straight, axis=0.0) == edge(0.0)


@pytest.mark.parametrize("angle", [-2.0, -0.3, 0.2, 1.4])
def test_steps_up_are_no_wall(angle: float):
    """They fill a part of the map in which a line lies in every direction."""
    steps = np.concatenate([line((0.2, y), (1.5, y)) for y in np.arange(-0.6, 0.61, 0.02)])
    straight = along_walls(edge(angle + 0.3), map_of(turned(steps, angle)))
    assert abs(wrap_angle(straight.axis - angle)) < 0.04


@pytest.mark.parametrize("off", [-0.15, 0.0, 0.15])
@pytest.mark.parametrize("askew_deg", [-30.0, 30.0, 45.0])
@pytest.mark.parametrize("angle", [-2.0, 0.2, 1.4])
def test_stairs_askew_to_a_big_wall_lead_along_their_own_railings(
    angle: float, askew_deg: float, off: float
):
    wall = turned(BIG_WALL, angle + math.radians(askew_deg))
    for length_m, bound in ((1.0, 0.05), (0.6, max(abs(off), 0.1))):  # short ones tell less
        own = turned(railings(length_m=length_m), angle)
        straight = along_walls(edge(angle + off), map_of(wall, own))
        assert abs(wrap_angle(straight.axis - angle)) < bound


@pytest.mark.parametrize("askew_deg", [-30.0, 15.0, 30.0, 45.0])
@pytest.mark.parametrize("angle", [-2.0, 0.2, 1.4])
def test_stairs_askew_to_the_only_wall_keep_their_axis(angle: float, askew_deg: float):
    seen = edge(angle)
    assert along_walls(seen, map_of(turned(BIG_WALL, angle + math.radians(askew_deg)))) == seen


@pytest.mark.parametrize("middle_y", [0.0, 0.4, 1.2])
@pytest.mark.parametrize("radius_m", [1.5, 2.0, 3.0])
def test_a_round_wall_has_no_direction(radius_m: float, middle_y: float):
    seen = edge(0.4)
    assert along_walls(seen, map_of(rotunda(radius_m, middle_y))) == seen


@pytest.mark.parametrize("radius_m", [0.9, 1.2, 1.5])
def test_spiral_stairs_begin_around_their_middle(radius_m: float):
    walls = map_of(rotunda(radius_m, 0.6), rotunda(0.15, 0.6))
    assert abs(along_walls(edge(0.1), walls).axis) <= 0.1


def test_stairs_keep_their_axis_where_no_walls_tell_it():
    askew = edge(0.4)
    assert along_walls(askew, map_of(railings(length_m=0.1))) == askew
    scattered = np.random.default_rng(0).random((120, 120)) < 0.02
    cells = np.where(scattered, np.uint8(Cell.OCCUPIED), np.uint8(Cell.FREE))
    assert along_walls(askew, OccupancyGrid(cells, 0.05, (-3.0, -3.0))) == askew


@pytest.mark.parametrize("end", [(-9.0, 0.0), (9.0, 0.0), (0.0, -9.0), (0.0, 9.0), (9.0, -9.0)])
def test_stairs_off_the_map_keep_their_axis(end: tuple[float, float]):
    seen = replace(edge(0.3), end=end)
    assert along_walls(seen, map_of(railings())) == seen
