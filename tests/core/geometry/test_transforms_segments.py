import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.transforms import distances_to_segment

coordinates = st.floats(-50.0, 50.0)
positions = st.tuples(coordinates, coordinates).map(np.array)


@given(positions, positions, positions)
def test_no_point_of_the_line_is_nearer_and_one_is_as_near(point, start, end):
    (away,) = distances_to_segment(point[None], start, end)
    on_line = np.linspace(start, end, 1001)
    apart = np.linalg.norm(on_line[1] - on_line[0])
    nearest = np.linalg.norm(on_line - point, axis=1).min()
    assert nearest - apart - 1e-9 <= away <= nearest + 1e-9


@given(positions, positions, positions)
def test_either_end_may_come_first(point, start, end):
    there = distances_to_segment(point[None], start, end)
    assert there == pytest.approx(distances_to_segment(point[None], end, start), abs=1e-9)


def test_beyond_its_ends_the_end_is_nearest():
    points = np.array([[-3.0, 4.0], [1.0, 2.0], [5.0, 4.0]])
    away = distances_to_segment(points, np.array([0.0, 0.0]), np.array([2.0, 0.0]))
    assert away.tolist() == [5.0, 2.0, 5.0]


def test_a_line_without_length_is_a_point():
    here = np.array([1.0, 1.0])
    assert distances_to_segment(np.array([[4.0, 5.0]]), here, here).tolist() == [5.0]


def test_without_points_there_are_no_distances():
    assert len(distances_to_segment(np.zeros((0, 2)), np.zeros(2), np.ones(2))) == 0
