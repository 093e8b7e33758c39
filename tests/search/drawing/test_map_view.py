import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.drawing.map_view import MapView, SteadyView, explored_bounds

metres = st.floats(-500.0, 500.0)
views = st.builds(
    MapView,
    left_m=metres,
    top_m=metres,
    pixels_per_m=st.floats(0.5, 400.0),
    size=st.integers(16, 2000),
)


@given(views, st.lists(st.tuples(metres, metres), min_size=1, max_size=20))
def test_metres_to_pixels_and_back_is_the_same_point(
    view: MapView, points: list[tuple[float, float]]
) -> None:
    there = view.to_pixels(np.array(points))
    assert view.to_metres(there) == pytest.approx(np.array(points), abs=1e-6)
    assert view.pixel_of(*points[0]) == pytest.approx(tuple(there[0]))


@given(views, metres, metres)
def test_y_points_up_and_x_to_the_right(view: MapView, x: float, y: float) -> None:
    u, v = view.pixel_of(x, y)
    right, above = view.pixel_of(x + 1.0, y), view.pixel_of(x, y + 1.0)
    assert right == pytest.approx((u + view.pixels_per_m, v))
    assert above == pytest.approx((u, v - view.pixels_per_m))


@given(metres, metres, st.floats(0.0, 300.0), st.floats(0.0, 300.0), st.integers(64, 1200))
def test_a_fitted_rectangle_is_visible_and_centred(
    x: float, y: float, width: float, height: float, size: int
) -> None:
    bounds = (x, y, x + width, y + height)
    view = MapView.around(bounds, size)
    assert view.shows(bounds)
    centre = view.pixel_of(x + width / 2, y + height / 2)
    assert centre == pytest.approx((size / 2, size / 2), abs=1e-3)


def test_the_explored_area_of_a_room_has_its_true_bounds() -> None:
    cells = np.full((120, 140), Cell.UNKNOWN, dtype=np.uint8)
    cells[20:80, 30:110] = Cell.OCCUPIED
    room = OccupancyGrid(cells, 0.05, (-2.5, -3.0))
    assert explored_bounds(room) == pytest.approx((-1.0, -2.0, 3.0, 1.0))
    assert explored_bounds(room, [(5.0, -4.0)]) == pytest.approx((-1.0, -4.0, 5.0, 1.0))


def test_an_empty_map_shows_some_metres_around_the_origin() -> None:
    empty = OccupancyGrid(np.zeros((10, 10), dtype=np.uint8), 0.05, (7.0, 7.0))
    assert explored_bounds(empty) == (math.inf, math.inf, -math.inf, -math.inf)
    view = MapView.fit(empty, 100)
    assert view.pixel_of(0.0, 0.0) == pytest.approx((50.0, 50.0))
    assert view.side_m > 3.0


def test_a_single_cell_is_not_blown_up() -> None:
    cells = np.zeros((3, 3), dtype=np.uint8)
    cells[1, 1] = Cell.FREE
    view = MapView.fit(OccupancyGrid(cells, 0.05, (0.0, 0.0)), 400)
    assert view.pixel_of(0.075, 0.075) == pytest.approx((200.0, 200.0))
    assert 0.05 * view.pixels_per_m < 10.0


def test_a_steady_view_moves_only_when_the_map_outgrows_it() -> None:
    steady, seen, views = SteadyView(300), np.zeros((200, 200), dtype=np.uint8), []
    for reach in range(5, 100):
        seen[100 - reach : 100 + reach, 100 - reach : 100 + reach] = Cell.FREE
        grid = OccupancyGrid(seen.copy(), 0.1, (-10.0, -10.0))
        view = steady.follow(grid)
        assert view.shows(explored_bounds(grid))
        views.append(view)
    moves = sum(a != b for a, b in pairwise(views))
    assert 2 <= moves <= 30
