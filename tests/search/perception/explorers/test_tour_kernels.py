"""Tours against all orders of the stops, one by one."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.search.perception.explorers.tour_kernels import soonest_tour, unseen_after


def cost(order, first, legs, areas, shows):
    """Length of the path until something is seen, times its area, over all areas."""
    total, length, seen = 0.0, 0.0, np.zeros(len(areas), bool)
    for before, stop in zip((None, *order), order, strict=False):
        length += first[stop] if before is None else legs[before, stop]
        total += length * areas[shows[stop] & ~seen].sum()
        seen |= shows[stop]
    return total


def tour(first, legs, areas, shows):
    unseen = unseen_after(areas, shows)
    return [int(stop) for stop in soonest_tour(first, legs, unseen)]


@st.composite
def problems(draw):
    stops, parts = draw(st.integers(1, 5)), draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    places = rng.uniform(0.0, 10.0, (stops + 1, 2))
    legs = np.linalg.norm(places[:, None] - places, axis=2)
    shows = rng.random((stops, parts)) < 0.4
    shows[0] |= ~shows.any(axis=0)
    return legs[0, 1:].copy(), legs[1:, 1:].copy(), rng.uniform(0.0, 5.0, parts), shows


@given(problems())
@settings(max_examples=60)
def test_no_order_sees_things_sooner(problem):
    order = tour(*problem)
    assert sorted(order) == list(range(len(problem[0])))  # each once
    best = min(cost(other, *problem) for other in permutations(order))
    assert cost(order, *problem) == pytest.approx(best)
    assert tour(*problem) == order


@given(problems())
@settings(max_examples=30)
def test_the_rest_of_a_tour_stays_the_best_on_the_way(problem):
    _, legs, areas, shows = problem
    order = tour(*problem)
    if len(order) < 2:
        return
    done, rest = order[0], order[1:]
    left = areas * ~shows[done]
    then = tour(legs[done, rest], legs[np.ix_(rest, rest)], left, shows[rest])
    chosen = [rest[stop] for stop in then]
    whole = legs[done, rest], legs[np.ix_(rest, rest)], left, shows[rest]
    as_planned = cost(list(range(len(rest))), *whole)
    assert cost(then, *whole) == pytest.approx(as_planned)
    assert set(chosen) == set(rest)


def test_what_is_shown_twice_counts_once():
    areas = np.array([3.0, 1.0, 4.0])
    shows = np.array([[True, True, False], [False, True, True]])
    assert unseen_after(areas, shows).tolist() == [8.0, 4.0, 3.0, 0.0]


def test_much_that_is_farther_comes_before_little_that_is_near():
    # 0 is 2 m to the left and shows little, 1 is 3 m to the right and shows much.
    first, legs = np.array([2.0, 3.0]), np.array([[0.0, 5.0], [5.0, 0.0]])
    shows = np.eye(2, dtype=bool)
    assert tour(first, legs, np.array([1.0, 10.0]), shows) == [1, 0]
    assert tour(first, legs, np.array([1.0, 1.0]), shows) == [0, 1]


def test_what_is_near_is_finished_before_leaving():
    # Two small things side by side, and a large one 10 m away.
    first = np.array([1.0, 1.5, 10.0])
    legs = np.array([[0.0, 0.5, 10.0], [0.5, 0.0, 10.0], [10.0, 10.0, 0.0]])
    order = tour(first, legs, np.array([2.0, 2.0, 12.0]), np.eye(3, dtype=bool))
    assert order == [0, 1, 2]
