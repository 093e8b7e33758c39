"""Costs of cells and lines, and sequences of actions, beside plain ways to work them out."""

import heapq
import math
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hypernav.search.planning.costmap_kernels import (
    GO,
    LEFT,
    SLACK,
    cost_of_line,
    drop_first,
    expand,
    plan_actions,
    priced,
    push,
    shortcut,
)

RANDOM = np.random.default_rng(0)
COSTS = RANDOM.choice([0.0, 1.0, 2.0, 3.0, 6.0], (12, 15), p=(0.06, 0.6, 0.14, 0.1, 0.1)).astype(
    np.float32
)


def sampled(costs, a, b) -> float:
    """Cost of a line, by the cells of very many of its points."""
    points = np.array(a) + np.linspace(0.0, 1.0, 4001)[:, None] * (np.array(b) - a)
    cells = np.floor(points).astype(int)
    if (cells < 0).any() or (cells >= costs.shape).any():
        return math.inf
    along = costs[tuple(cells.T)]
    return math.inf if (along <= 0.0).any() else float(along.mean()) * math.dist(a, b)


def test_a_cell_is_priced_by_what_is_known_of_it():
    unknown, closed, near = RANDOM.integers(0, 2, (3, 9, 9)).astype(np.uint8)
    found = priced(unknown > 0, closed * 3, near * 2, np.float32(3.0), np.float32(1.5))
    expected = np.where(unknown, 3.0, 1.0) * np.where(near, 1.5, 1.0) * (closed == 0)
    assert np.array_equal(found, expected)


@given(st.tuples(st.integers(0, 8), st.integers(0, 11)), st.sampled_from([1.0, 3.0]))
def test_over_open_ground_a_path_has_as_many_straight_and_diagonal_steps_as_it_needs(start, cost):
    costs = np.full((9, 12), cost, dtype=np.float32)
    everywhere = np.array([0, 8, 0, 11])  # a search without guidance, and without an end
    nowhere, (row, column) = np.zeros((9, 12), np.uint8), start
    spent, _, found = expand(costs, row, column, nowhere, everywhere, 0.0)
    down, across = np.abs(np.indices(costs.shape) - np.array(start)[:, None, None])
    steps = np.abs(down - across) + math.sqrt(2.0) * np.minimum(down, across)
    np.testing.assert_allclose(spent.reshape(11, 14)[1:-1, 1:-1], cost * steps, rtol=1e-5)
    assert found == -1


def test_a_line_costs_what_its_points_do():
    for a, b in RANDOM.uniform((-0.5, -0.5), (12.5, 15.5), (400, 2, 2)):
        found, expected = cost_of_line(COSTS, *a, *b), sampled(COSTS, a, b)
        if math.isinf(found) and not math.isinf(expected):
            continue  # it cuts a corner by less than samples tell
        assert found == pytest.approx(expected, rel=0.01)
    for k in range(4):  # straight along rows and columns
        a, b = (3.2, k + 0.5), (7.9, k + 0.5)
        assert cost_of_line(COSTS, *a, *b) == pytest.approx(sampled(COSTS, a, b), rel=0.01)
        assert cost_of_line(COSTS, *b, *a) == pytest.approx(sampled(COSTS, a, b), rel=0.01)


@pytest.mark.parametrize("closed", [(4, 5), (5, 4)])
def test_a_line_through_a_corner_touches_all_cells_there(closed):
    costs = np.ones((9, 9), dtype=np.float32)
    assert cost_of_line(costs, 2.5, 2.5, 6.5, 6.5) == pytest.approx(4.0 * math.sqrt(2.0))
    costs[closed] = 0.0
    assert cost_of_line(costs, 2.5, 2.5, 6.5, 6.5) == math.inf
    assert cost_of_line(costs, 6.5, 6.5, 2.5, 2.5) == math.inf


def test_a_straightened_path_costs_hardly_more_and_goes_on_as_far_as_it_can():
    costs = np.ones((12, 20), dtype=np.float32)
    costs[:8, 6] = costs[4:, 12] = 0.0
    way = [(2, c) for c in range(5)] + [(r, 4) for r in range(3, 10)]
    way += [(9, c) for c in range(5, 11)] + [(r, 10) for r in range(8, 1, -1)]
    way += [(2, c) for c in range(11, 18)]
    path = np.array(way, dtype=np.int64)
    kept = shortcut(costs, path, 2.2, 0.7)
    assert (kept[0], kept[-1]) == (0, len(path) - 1)
    assert (np.diff(kept) > 0).all()
    assert len(kept) <= 6
    spots = [(2.2, 0.7), *(path[kept[1:]] + 0.5)]
    for (before, after), (a, b) in zip(pairwise(kept), pairwise(spots), strict=True):
        walked = sum(math.dist(way[k], way[k + 1]) for k in range(before, after))
        assert cost_of_line(costs, *a, *b) <= walked + SLACK
        for later in range(after + 1, len(path)):
            walked = sum(math.dist(way[k], way[k + 1]) for k in range(before, later))
            assert cost_of_line(costs, *a, *(path[later] + 0.5)) > walked + SLACK


TURNS = 8
SINES, COSINES = (one(2.0 * math.pi * np.arange(TURNS) / TURNS) for one in (np.sin, np.cos))
STEP, TURN_COST = 2.3, 0.7


def end_of(costs, at, actions) -> tuple[float, float, float]:
    """Where a sequence of actions ends, and what it costs."""
    (y, x), heading, spent = at, 0, 0.0
    for action in actions:
        if action == GO:
            end = y + STEP * SINES[heading], x + STEP * COSINES[heading]
            spent += cost_of_line(costs, y, x, *end)
            y, x = end
        else:
            heading = (heading + (1 if action == LEFT else -1)) % TURNS
            spent += TURN_COST
    return y, x, spent


@pytest.mark.parametrize("target", [(20.5, 28.5), (30.5, 20.5), (9.5, 12.5), (20.5, 8.5)])
def test_a_plan_leads_as_far_as_told_at_the_least_cost(target):
    costs = np.ones((41, 41), dtype=np.float32)
    costs[15:19, 24] = costs[24:27, 17:24] = 0.0
    middles = np.indices(costs.shape) + 0.5
    to_go = np.hypot(middles[0] - target[0], middles[1] - target[1]).astype(np.float32)
    at, arrive, horizon = (20.4, 20.6), 2.0, 6.0
    actions, left = plan_actions(
        costs, to_go, *at, SINES, COSINES, STEP, TURN_COST, arrive, horizon
    )
    y, x, spent = end_of(costs, at, actions)
    assert left == to_go[math.floor(y), math.floor(x)]
    goal = max(arrive, to_go[20, 20] - horizon)
    assert left <= goal
    best = math.inf
    for count in range(1, 8):
        for other in product(range(3), repeat=count):
            if other[-1] == GO:
                y, x, cost = end_of(costs, at, other)
                if cost < best and to_go[math.floor(y), math.floor(x)] <= goal:
                    best = cost
    assert spent <= best + 1.5


def test_where_nothing_leads_on_the_plan_is_empty():
    costs = np.zeros((9, 9), dtype=np.float32)
    costs[4, 4] = 1.0
    to_go = np.full((9, 9), 5.0, dtype=np.float32)
    actions, left = plan_actions(costs, to_go, 4.5, 4.5, SINES, COSINES, STEP, TURN_COST, 0.0, 3.0)
    assert (len(actions), left) == (0, 5.0)


@given(st.lists(st.one_of(st.none(), st.integers(0, 20)), max_size=40))
@example([1, 3, 2, 7, 4, 6, 5, None, 0, None, None, None, None, None, None])
@example([5, 1, 4, 2, 3, None, None, None, None, None])
def test_the_first_of_a_heap_always_has_the_smallest_key(operations):
    """A number is put in, None takes the first one out."""
    keys, nodes, reference = np.zeros(41), np.zeros(41, np.int64), []
    for node, key in enumerate(operations):
        if key is not None:
            push(keys, nodes, len(reference), float(key), node)
            heapq.heappush(reference, key)
        elif reference:
            drop_first(keys, nodes, len(reference))
            heapq.heappop(reference)
        size = len(reference)
        assert sorted(keys[:size]) == sorted(reference)
        assert [operations[one] for one in nodes[:size]] == keys[:size].tolist()
        if size:
            assert keys[0] == reference[0]
            assert all(keys[i] >= keys[(i - 1) // 2] for i in range(1, size))
