import heapq
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from hypernav.simulator.worlds.surface.walkable import WalkableGrid


def grid_of(rows: list[str], cell_m: float = 1.0) -> WalkableGrid:
    """'.' is free; the first string is the top row of the image."""
    free = np.array([[c == "." for c in row] for row in rows[::-1]])
    return WalkableGrid.from_mask(free, cell_m=cell_m)


def room(rows: int, columns: int, cell_m: float, *blocked: tuple[slice, slice]) -> WalkableGrid:
    free = np.ones((rows, columns), dtype=bool)
    for block in blocked:
        free[block] = False
    return WalkableGrid.from_mask(free, cell_m=cell_m)


def length(path: list[tuple[float, float]]) -> float:
    return sum(math.dist(a, b) for a, b in itertools.pairwise(path))


def via(*points: tuple[float, float]) -> float:
    return length(list(points))


# --- A reference that shares no code with the kernels: the visibility graph. -------------------


def _crosses(a, b, low, high) -> bool:
    """Whether a segment meets the open square between two corners."""
    enter, leave = 0.0, 1.0
    for k in range(2):
        d = b[k] - a[k]
        if d == 0.0:
            if not low[k] + 1e-9 < a[k] < high[k] - 1e-9:
                return False
            continue
        t0, t1 = sorted(((low[k] - a[k]) / d, (high[k] - a[k]) / d))
        enter, leave = max(enter, t0), min(leave, t1)
    return leave - enter > 1e-9


def _pinched(free, i, j) -> bool:
    quad = free[i - 1 : i + 1, j - 1 : j + 1]
    return quad.sum() == 2 and quad[0, 0] == quad[1, 1]


def _visible(free, a, b) -> bool:
    rows, columns = free.shape
    for r, c in np.argwhere(~free):
        if _crosses(a, b, (c, r), (c + 1, r + 1)):
            return False
    for i, j in itertools.product(range(1, rows), range(1, columns)):
        if _pinched(free, i, j):
            along = math.dist(a, (j, i)) + math.dist((j, i), b)
            if along < math.dist(a, b) + 1e-9:
                return False
    for k in range(2):  # Along a lattice line between two blocked cells.
        if a[k] == b[k] and float(a[k]).is_integer():
            other = 1 - k
            low, high = sorted((a[other], b[other]))
            for n in range(math.floor(low), math.ceil(high)):
                index = (n, int(a[0])) if k == 0 else (int(a[1]), n)
                beside = (index[0], index[1] - 1) if k == 0 else (index[0] - 1, index[1])
                if not free[index] and not free[beside]:
                    return False
    return True


def exact_distance(free: np.ndarray, start, ends) -> float:
    """Shortest way from start to the nearest end, in cells, by Dijkstra over all bends."""
    free = np.pad(free, 1)
    shift = lambda p: (p[0] + 1.0, p[1] + 1.0)  # noqa: E731
    rows, columns = free.shape
    bends = [
        (float(j), float(i))
        for i, j in itertools.product(range(1, rows), range(1, columns))
        if free[i - 1 : i + 1, j - 1 : j + 1].sum() == 3
    ]
    nodes = [shift(start), *bends, *(shift(e) for e in ends)]
    first_end = len(nodes) - len(ends)
    best = [math.inf] * len(nodes)
    best[0] = 0.0
    heap = [(0.0, 0)]
    while heap:
        d, k = heapq.heappop(heap)
        if k >= first_end:
            return d
        if d > best[k]:
            continue
        for other in range(len(nodes)):
            new = d + math.dist(nodes[k], nodes[other])
            if new < best[other] and _visible(free, nodes[k], nodes[other]):
                best[other] = new
                heapq.heappush(heap, (new, other))
    return math.inf


# --- Hand-computed cases ------------------------------------------------------------------------


def test_an_empty_room_is_crossed_in_a_straight_line():
    walkable = room(80, 100, 0.05)
    for a, b in [((0.1, 0.1), (4.9, 3.9)), ((0.1, 3.9), (4.9, 0.1)), ((0.3, 1.0), (4.1, 1.37))]:
        assert walkable.distance(a, b) == pytest.approx(math.dist(a, b), abs=2e-4)
        assert np.allclose(walkable.shortest_path(a, b), [a, b], atol=1e-4)


def test_one_corner():
    walkable = room(80, 80, 0.05, (slice(0, 40), slice(40, 80)))
    a, b = (1.0, 0.5), (3.5, 2.2)
    expected = via(a, (2.0, 2.0), b)
    assert walkable.distance(a, b) == pytest.approx(expected, rel=1e-3)


def test_around_a_box():
    walkable = room(80, 80, 0.05, (slice(30, 50), slice(20, 60)))
    a, b = (2.0, 0.5), (2.2, 3.5)
    expected = min(via(a, (1.0, 1.5), (1.0, 2.5), b), via(a, (3.0, 1.5), (3.0, 2.5), b))
    assert walkable.distance(a, b) == pytest.approx(expected, rel=1e-3)
    assert np.allclose(walkable.shortest_path(a, b), [a, (3.0, 1.5), (3.0, 2.5), b], atol=1e-4)


def test_out_of_a_u_shaped_wall():
    walkable = room(
        100,
        100,
        0.05,
        (slice(20, 80), slice(20, 24)),
        (slice(20, 80), slice(76, 80)),
        (slice(20, 24), slice(20, 80)),
    )
    a, b = (2.5, 2.0), (2.4, 0.4)
    left = via(a, (1.2, 4.0), (1.0, 4.0), (1.0, 1.0), b)
    right = via(a, (3.8, 4.0), (4.0, 4.0), (4.0, 1.0), b)
    assert walkable.distance(a, b) == pytest.approx(min(left, right), rel=1e-3)


def test_through_a_door():
    walkable = room(80, 120, 0.05, (slice(0, 30), slice(58, 62)), (slice(48, 80), slice(58, 62)))
    a, b = (1.0, 0.4), (5.5, 0.6)
    expected = via(a, (2.9, 1.5), (3.1, 1.5), b)
    assert walkable.distance(a, b) == pytest.approx(expected, rel=1e-3)


def test_nothing_slips_between_two_diagonal_cells():
    walkable = grid_of(["..#", "..#", "##.", "..."])
    assert walkable.distance((0.5, 3.5), (2.5, 0.5)) == math.inf
    assert walkable.shortest_path((0.5, 3.5), (2.5, 0.5)) == []


def test_no_way_between_separate_rooms_nor_into_a_wall():
    walkable = grid_of(["..#..", "..#..", "..#.."])
    assert walkable.distance((0.5, 0.5), (4.5, 0.5)) == math.inf
    assert walkable.distance((0.5, 0.5), (2.5, 0.5)) == math.inf
    assert walkable.distance((0.5, 0.5), (40.0, 0.5)) == math.inf
    assert walkable.distance((2.5, 0.5), (2.5, 0.5)) == math.inf


def test_a_field_without_targets_is_infinite_everywhere():
    walkable = grid_of(["...", "...", "..."])
    field = walkable.distance_field(np.zeros((0, 2)))
    assert field.distance(1.5, 1.5) == math.inf
    assert field.path(1.5, 1.5) == []


def test_a_field_knows_targets_closer_than_a_cell():
    walkable = room(40, 40, 0.05)
    targets = np.array([[1.0, 1.0], [1.012, 1.003], [0.2, 0.3]])
    field = walkable.distance_field(targets)
    for x, y in [(1.011, 1.003), (1.02, 1.02), (0.9, 1.04)]:
        nearest = min(math.dist((x, y), t) for t in targets)
        assert field.distance(x, y) == pytest.approx(nearest, abs=2e-4)
    assert field.distance(*targets[1]) == pytest.approx(0.0, abs=1e-4)


# --- Laws ---------------------------------------------------------------------------------------

sparse_masks = hnp.arrays(
    np.int8, st.tuples(st.integers(3, 9), st.integers(3, 9)), elements=st.integers(0, 3)
).map(lambda m: m != 0)


@st.composite
def grids_with_points(draw, count: int):
    free = draw(sparse_masks)
    cells = np.argwhere(free)
    if len(cells) == 0:
        free[0, 0] = True
        cells = np.argwhere(free)
    offset = st.floats(0.05, 0.95)
    points = []
    for _ in range(count):
        row, column = cells[draw(st.integers(0, len(cells) - 1))]
        points.append((float(column) + draw(offset), float(row) + draw(offset)))
    return WalkableGrid.from_mask(free, cell_m=1.0), points


@settings(max_examples=150, deadline=None)
@given(grids_with_points(2))
def test_distance_is_within_one_percent_of_the_visibility_graph(case):
    walkable, (a, b) = case
    exact = exact_distance(walkable.standable, a, [b])
    found = walkable.distance(a, b)
    assert found >= exact - 5e-3
    assert found <= exact * 1.01 + 5e-3 or (found == exact == math.inf)


@settings(max_examples=150, deadline=None)
@given(grids_with_points(4))
def test_a_field_is_within_one_percent_of_the_nearest_of_its_targets(case):
    walkable, (here, *targets) = case
    exact = exact_distance(walkable.standable, here, targets)
    field = walkable.distance_field(np.array(targets))
    found = field.distance(*here)
    assert found >= exact - 5e-3
    assert found <= exact * 1.01 + 5e-3 or (found == exact == math.inf)
    single = min(walkable.distance(here, target) for target in targets)
    assert found == pytest.approx(single, rel=0.01, abs=5e-3)


@settings(max_examples=200, deadline=None)
@given(grids_with_points(3))
def test_distance_is_a_metric(case):
    walkable, (a, b, c) = case
    ab, bc, ac = walkable.distance(a, b), walkable.distance(b, c), walkable.distance(a, c)
    assert ab == walkable.distance(b, a)
    assert walkable.distance(a, a) == 0.0
    assert ab >= math.dist(a, b) - 3e-3
    assert ac <= (ab + bc) * 1.01 + 5e-3
    assert (ab == math.inf) == (walkable.component_of(*a) != walkable.component_of(*b))


@settings(max_examples=200, deadline=None)
@given(grids_with_points(2))
def test_the_path_is_as_long_as_the_distance_and_stays_on_the_floor(case):
    walkable, (a, b) = case
    path = walkable.shortest_path(a, b)
    distance = walkable.distance(a, b)
    if not path:
        assert distance == math.inf
        return
    assert path[0] == pytest.approx(a, abs=2e-3)
    assert path[-1] == pytest.approx(b, abs=2e-3)
    assert length(path) == pytest.approx(distance, abs=5e-3)
    padded = np.pad(walkable.standable, 1)
    shifted = [(x + 1.0, y + 1.0) for x, y in path]
    assert all(_visible(padded, p, q) for p, q in itertools.pairwise(shifted))
