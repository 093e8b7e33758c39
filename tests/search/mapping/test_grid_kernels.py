import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from grid_graphs import cost_to_go
from hypernav.search.mapping.grid_kernels import nearest_open_cell, travel_cells
from hypernav.search.mapping.inflation import disc, inflate

open_cells = arrays(
    np.uint8,
    array_shapes(min_dims=2, max_dims=2, max_side=25),
    elements=st.sampled_from([0, 1, 1, 1]),
)


@settings(deadline=None)
@given(open_cells, st.data())
def test_travel_is_the_shortest_way(is_open, data):
    start = tuple(data.draw(st.integers(0, side - 1)) for side in is_open.shape)
    is_open[start] = 1
    travel = travel_cells(is_open, *start)
    np.testing.assert_allclose(travel, cost_to_go(is_open, start), rtol=1e-4)
    wanted = np.argwhere(is_open)[: data.draw(st.integers(1, 5))]
    at = tuple(wanted.T)
    np.testing.assert_array_equal(travel_cells(is_open, *start, wanted=wanted)[at], travel[at])


def test_travel_over_a_large_open_floor_is_octile():
    travel = travel_cells(np.ones((300, 400), np.uint8), 10, 20)
    down, across = abs(np.arange(300) - 10)[:, None], abs(np.arange(400) - 20)[None, :]
    octile = np.maximum(down, across) + (np.sqrt(2) - 1) * np.minimum(down, across)
    np.testing.assert_allclose(travel, octile, rtol=1e-4)


@given(open_cells, st.integers(-5, 30), st.integers(-5, 30), st.integers(0, 12))
def test_the_nearest_open_cell_is_the_nearest(is_open, row, column, within):
    cells = np.argwhere(is_open)
    near = cells[(abs(cells - [row, column]) <= within).all(axis=1)]
    found = nearest_open_cell(is_open, row, column, within)
    if len(near) == 0:
        assert found == (-1, -1)
    else:
        assert is_open[found]
        away = ((near - [row, column]) ** 2).sum(axis=1)
        assert ((np.array(found) - [row, column]) ** 2).sum() == away.min()


@given(
    arrays(np.bool_, (15, 18), elements=st.sampled_from([False] * 9 + [True])),
    st.floats(0.0, 0.4),
)
def test_inflation_closes_exactly_what_lies_within_the_radius(occupied, radius):
    cells = np.argwhere(occupied)
    everywhere = np.argwhere(np.ones_like(occupied))
    away = np.full(occupied.size, np.inf)
    for cell in cells:
        away = np.minimum(away, np.hypot(*(everywhere - cell).T) * 0.05)
    expected = (away <= radius + 1e-9).reshape(occupied.shape)
    unclear = abs(away - radius).reshape(occupied.shape) < 1e-6
    np.testing.assert_array_equal(inflate(occupied, radius, 0.05)[~unclear] > 0, expected[~unclear])


def test_a_disc_of_no_radius_is_one_cell():
    np.testing.assert_array_equal(disc(0.0, 0.05), [[1]])
