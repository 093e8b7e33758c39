from itertools import combinations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.drawing.label_placement import (
    Disc,
    HiddenWeight,
    Label,
    Square,
    number_position,
    placed_labels,
)
from hypernav.search.drawing.map_view import MapView

HEIGHT = 16.0
PIXELS = st.floats(0.0, 400.0)
LABELS = st.lists(
    st.builds(Label, st.sampled_from(["sofa", "lamp", "rug"]), PIXELS, PIXELS, st.just(40.0)),
    max_size=25,
)


@given(LABELS)
def test_no_label_covers_another(labels):
    for one, other in combinations(placed_labels(labels, HEIGHT), 2):
        assert abs(one.u - other.u) >= 40.0 or abs(one.v - other.v) >= HEIGHT


@given(LABELS)
def test_a_label_stays_within_two_rows_of_its_thing(labels):
    things = [label._replace(v=0.0) for label in labels]
    for placed in placed_labels(labels, HEIGHT):
        assert placed._replace(v=0.0) in things
        rows = [abs(placed.v - one.v) for one in labels if one.u == placed.u]
        assert min(rows) <= 2.0 * HEIGHT + 1e-9


def test_labels_apart_stay_where_their_things_are():
    labels = [Label("sofa", 50.0, 50.0, 40.0), Label("lamp", 200.0, 50.0, 40.0)]
    assert placed_labels(labels, HEIGHT) == labels


def test_of_two_things_at_one_position_the_second_is_named_a_row_beside():
    labels = [Label("sofa", 50.0, 50.0, 40.0), Label("lamp", 50.0, 50.0, 40.0)]
    assert placed_labels(labels, HEIGHT)[1] == Label("lamp", 50.0, 34.0, 40.0)


def test_one_of_several_equal_names_in_a_row_is_enough():
    cabinets = [Label("cabinet", 50.0 + 30.0 * k, 50.0, 40.0) for k in range(3)]
    assert placed_labels(cabinets, HEIGHT) == cabinets[:1]
    assert len(placed_labels([cabinets[0], cabinets[0]._replace(u=350.0)], HEIGHT)) == 2


@given(
    st.tuples(st.floats(100.0, 140.0), st.floats(100.0, 140.0), st.floats(2.0, 30.0)),
    st.tuples(st.floats(90.0, 180.0), st.floats(90.0, 180.0), st.floats(5.0, 40.0)),
)
def test_a_number_leaves_a_square_too_small_for_it_directly_away_from_the_robot(square, robot):
    left, top, side = square
    u, v, radius = robot
    at = np.array(number_position(Square(*square), 30.0, 16.0, Disc(*robot)))
    beyond = np.maximum(np.abs(at - (u, v)) - (15.0, 8.0), 0.0)
    assert np.hypot(*beyond) >= radius - 1e-6
    middle = np.array([left, top]) + side / 2.0
    if np.abs(at - middle).max() > side / 2.0:  # it has left the square
        away, moved = middle - (u, v), at - (u, v)
        assert np.hypot(*moved) == pytest.approx(radius + 17.0)
        assert away[0] * moved[1] - away[1] * moved[0] == pytest.approx(0.0, abs=1e-6)
        assert away @ moved >= 0.0


@given(st.floats(0.0, 100.0), st.floats(0.0, 100.0), st.floats(5.0, 45.0))
@example(50.0, 50.0, 40.0)
def test_a_number_stays_in_a_square_that_holds_it_beside_the_robot(u, v, radius):
    at = np.array(number_position(Square(0.0, 0.0, 100.0), 20.0, 12.0, Disc(u, v, radius)))
    assert (np.abs(at - 50.0) <= (40.0, 44.0)).all()
    beyond = np.maximum(np.abs(at - (u, v)) - (10.0, 6.0), 0.0)
    assert np.hypot(*beyond) >= radius


def test_obstacles_are_worth_most_to_see_the_unknown_little_and_floor_nothing():
    cells = np.repeat([Cell.UNKNOWN, Cell.FREE, Cell.OCCUPIED], 20)[None, :].repeat(60, axis=0)
    grid = OccupancyGrid(cells.astype(np.uint8), 0.05, (0.0, 0.0))
    hides = HiddenWeight(grid, MapView(0.0, 3.0, 100.0, 300))
    assert [hides.weight(u, 150.0, 40.0, 20.0) for u in (50.0, 150.0, 250.0)] == [1.0, 0.0, 100.0]
    assert hides.weight(200.0, 150.0, 40.0, 20.0) == pytest.approx(50.0, abs=1.0)
    assert hides.weight(-500.0, -500.0, 40.0, 20.0) == 0.0
