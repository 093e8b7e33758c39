from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from certainty import certain
from drawn_grids import drawn
from grid_graphs import cost_to_go
from hypernav.core.embodiment import BodyConfig
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.costmap import Costmap
from hypernav.search.planning.costmap_kernels import cost_of_line
from hypernav.search.planning.planner import PlannedPath, Planner, astar, costs_to_go, is_blocked

CONFIG = PlanningConfig()
BODY = BodyConfig()
CLEARANCE_M = 0.22
WIDE = PlanningConfig(squeeze_m=0.0)
SIMPLE = PlanningConfig(
    squeeze_m=0.0,
    comfort_cost=0.0,
    targets="nearest-straight",
    steering="waypoint",
)
# Costs that floats hold exactly, so that equal paths are equal.
cost_grids = arrays(
    np.float32,
    array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=20),
    elements=st.sampled_from([0.0, 1.0, 1.0, 1.0, 2.0, 6.0]),
)
coarse_maps = arrays(np.uint8, (8, 8), elements=st.sampled_from([0, 1, 1, 1, 1, 1, 2]))
DOOR = """
    .....##.....
    .....##.....
    ............
    ............
    .....##.....
    .....##.....
"""


def grid_of(coarse, scale=5, origin=(-0.7, 1.3)):
    return OccupancyGrid(np.kron(coarse, np.ones((scale, scale), np.uint8)), 0.05, origin)


def middles(grid):
    """Two positions anywhere on the grid."""
    rows, columns = grid.cells.shape
    x, y = grid.origin
    position = st.tuples(
        st.floats(x + 0.01, x + columns * 0.05 - 0.01), st.floats(y + 0.01, y + rows * 0.05 - 0.01)
    )
    return st.tuples(position, position)


def draw_cell(data, shape):
    return tuple(data.draw(st.integers(0, side - 1)) for side in shape)


@settings(deadline=None)
@given(cost_grids, st.data())
def test_astar_finds_the_cheapest_way(costs, data):
    start, end = draw_cell(data, costs.shape), draw_cell(data, costs.shape)
    costs[start] = max(costs[start], 1.0)
    targets = np.zeros(costs.shape, np.uint8)
    targets[end] = targets[draw_cell(data, costs.shape)] = 1
    expected = cost_to_go(costs, start)[targets > 0].min()
    path, cost = astar(costs, start, targets)
    assert cost == pytest.approx(expected, rel=1e-4)
    assert (len(path) > 0) == np.isfinite(expected)
    if len(path) > 0:
        assert tuple(path[0]) == start
        assert targets[tuple(path[-1])]
        walked = 0.0
        for (r, c), (s, d) in pairwise(path.tolist()):
            assert max(abs(s - r), abs(d - c)) == 1
            assert costs[s, d] > 0
            assert costs[r, d] > 0  # no corner is cut
            assert costs[s, c] > 0
            walked += np.hypot(s - r, d - c) * (costs[r, c] + costs[s, d]) / 2
        assert walked == pytest.approx(expected, rel=1e-4)


@settings(deadline=None)
@given(cost_grids, st.data())
def test_costs_to_go_are_those_of_the_cheapest_ways(costs, data):
    end, robot = draw_cell(data, costs.shape), draw_cell(data, costs.shape)
    costs[end] = max(costs[end], 1.0)
    expected = cost_to_go(costs, end)
    found = costs_to_go(costs, end, robot, 4.0)
    needed = (
        expected <= expected[robot] + 4.0 if np.isfinite(expected[robot]) else expected < np.inf
    )
    np.testing.assert_allclose(found[needed], expected[needed], rtol=1e-4)
    assert (found >= expected * 0.9999).all()


def test_no_target_is_no_way():
    path, cost = astar(np.ones((4, 4), np.float32), (0, 0), np.zeros((4, 4), np.uint8))
    assert len(path) == 0
    assert cost == np.inf


@settings(deadline=None)
@given(cost_grids, st.data())
def test_the_cost_of_a_line_is_the_sum_over_its_cells(costs, data):
    rows, columns = costs.shape
    ends = [data.draw(st.floats(0.01, side - 0.01)) for side in (rows, columns) * 2]
    share = (np.arange(20000) + 0.5) / 20000
    r = np.floor(ends[0] + share * (ends[2] - ends[0])).astype(int)
    c = np.floor(ends[1] + share * (ends[3] - ends[1])).astype(int)
    length = np.hypot(ends[2] - ends[0], ends[3] - ends[1])
    cost = cost_of_line(costs, *ends)
    if (costs[r, c] == 0).any():
        assert cost == np.inf
    elif np.isfinite(cost):  # it may touch a closed cell's corner between two samples
        assert cost == pytest.approx(length * costs[r, c].mean(), rel=1e-3, abs=2e-3)
        assert cost == pytest.approx(cost_of_line(costs, *ends[2:], *ends[:2]), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("ends", [(0.5, 0.5, 1.5, 1.5), (1.5, 1.5, 0.5, 0.5)])
@pytest.mark.parametrize("closed", [(0, 1), (1, 0)])
def test_a_line_through_a_corner_touches_both_cells_beside_it(ends, closed):
    costs = np.ones((2, 2), np.float32)
    costs[closed] = 0.0
    assert cost_of_line(costs, *ends) == np.inf


def test_a_line_that_leaves_the_grid_is_closed():
    costs = np.ones((3, 3), np.float32)
    assert cost_of_line(costs, 1.5, 1.5, 1.5, 4.0) == np.inf
    assert cost_of_line(costs, 1.5, -0.5, 1.5, 1.5) == np.inf


def path_of(config, grid, start, targets):
    return certain(Planner(config, BODY).plan(grid, start, targets))


def costmap_of(grid, start):
    return Costmap.of(grid, CONFIG, start, CLEARANCE_M)


@settings(deadline=None, max_examples=150)
@given(coarse_maps, st.sampled_from([CONFIG, WIDE, SIMPLE]), st.data())
def test_a_path_never_touches_an_inflated_obstacle(coarse, config, data):
    grid = grid_of(coarse)
    start, target = data.draw(middles(grid))
    path = Planner(config, BODY).plan(grid, start, np.array([target]))
    assume(path is not None)
    path = certain(path)
    assert path.waypoints[0] == start
    obstacles = grid.centres_of(np.argwhere(grid.occupied))
    inflated = np.ones(grid.cells.shape, bool)
    middle = grid.centres_of(np.argwhere(inflated))
    away = np.full(len(middle), np.inf)
    for obstacle in obstacles:
        away = np.minimum(away, np.hypot(*(middle - obstacle).T))
    away = away.reshape(grid.cells.shape)
    inflated = away <= config.clearances_m(BODY)[-1] + 1e-9
    here = grid.cell_of(*start)
    if not grid.inside(*here) or away[here] <= CLEARANCE_M + 1e-9:
        # The escape is short.
        inflated &= (np.hypot(*(middle - np.array(start)).T) > 1.5).reshape(inflated.shape)
    for a, b in pairwise(path.waypoints):
        points = np.linspace(a, b, max(int(np.hypot(b[0] - a[0], b[1] - a[1]) / 0.002), 2))
        cells = grid.cells_of(points)
        cells = cells[grid.contains(cells)]
        assert not inflated[cells[:, 0], cells[:, 1]].any()
    ends_in_unknown = path.gap_m == 0.0
    assert grid.state_at(*path.end) in (
        (Cell.FREE, Cell.UNKNOWN) if ends_in_unknown else (Cell.FREE,)
    )
    assert path.length_m >= np.hypot(*(np.array(path.end) - start)) - 1e-9
    assert path.gap_m <= (np.inf if config.max_gap_m is None else config.max_gap_m)
    if path.gap_m == 0.0:
        assert grid.cell_of(*path.end) == grid.cell_of(*target)


def test_a_path_across_open_floor_is_one_straight_line():
    path = path_of(CONFIG, drawn("....\n" * 4, scale=20), (0.3, 0.4), np.array([[3.0, 1.7]]))
    assert len(path.waypoints) == 2
    assert path.length_m == pytest.approx(np.hypot(2.7, 1.3), abs=0.05)


def test_a_way_through_a_door_keeps_to_its_middle_where_comfort_counts():
    grid = drawn(DOOR, scale=10)  # the door is y 1 to 2, and the path could stay at y 1.25
    start, target = (0.5, 1.25), np.array([[5.5, 1.25]])
    direct = path_of(SIMPLE, grid, start, target)
    comfortable = path_of(CONFIG, grid, start, target)
    assert len(direct.waypoints) == 2
    middle = max(y for x, y in comfortable.waypoints if 2.0 < x < 4.0)
    assert middle == pytest.approx(1.45, abs=0.1)


def test_a_way_ends_in_the_unknown_only_at_a_destination_that_has_no_known_cell():
    grid = drawn("...??\n" * 3, scale=20)
    start, known, unknown = (0.3, 1.5), [2.2, 1.5], [3.5, 1.5]
    for targets, end in (([unknown], unknown), ([unknown, known], known)):
        path = path_of(CONFIG, grid, start, np.array(targets))
        assert path.end == pytest.approx(end, abs=0.06)
        assert path.gap_m == pytest.approx(0.0, abs=0.06)


def test_the_unknown_is_dearer_or_forbidden_as_configured():
    grid = drawn(
        """
        .....
        .???.
        .???.
        .???.
        """,
        scale=10,
    )
    start, target = (0.25, 0.25), np.array([[2.25, 0.25]])
    through = path_of(PlanningConfig(unknown_cost=1.0), grid, start, target)
    assert through.length_m == pytest.approx(2.0, abs=0.05)
    around = path_of(PlanningConfig(unknown_cost=9.0), grid, start, target)
    assert around.length_m > 4.0
    grid.cells[20:] = Cell.UNKNOWN
    assert Planner(PlanningConfig(unknown_cost=9.0), BODY).plan(grid, start, target) is not None
    assert Planner(PlanningConfig(unknown_cost=0.0), BODY).plan(grid, start, target) is None


def wall_with(gap_cells, *, beyond):
    """A wall across a room of 4 m x 4 m, with a gap; on the right it ends in the given state."""
    cells = np.full((80, 80), Cell.FREE, dtype=np.uint8)
    cells[38:42, :70] = Cell.OCCUPIED
    cells[38:42, 20 : 20 + gap_cells] = Cell.FREE
    cells[30:50, 70:] = beyond
    return OccupancyGrid(cells, 0.05, (0.0, 0.0))


@pytest.mark.parametrize(
    ("prefer_known", "beyond", "gap_cells", "through_the_gap"),
    [
        (True, Cell.UNKNOWN, 8, True),  # 0.4 m: passable with a margin of next to nothing
        (False, Cell.UNKNOWN, 8, False),
        (True, Cell.FREE, 8, False),
        (True, Cell.UNKNOWN, 4, False),  # too narrow for the robot
        (True, Cell.UNKNOWN, 12, True),
    ],
)
def test_a_known_gap_comes_before_the_unknown(prefer_known, beyond, gap_cells, through_the_gap):
    grid = wall_with(gap_cells, beyond=beyond)
    config = PlanningConfig(prefer_known=prefer_known)
    path = path_of(config, grid, (1.2, 1.0), np.array([[1.2, 3.0]]))
    assert path.enters
    assert (max(x for x, _ in path.waypoints) < 2.0) == through_the_gap
    assert path.is_known == (through_the_gap or beyond == Cell.FREE)


@pytest.mark.parametrize("beyond", [Cell.UNKNOWN, Cell.FREE])
def test_what_will_do_is_gone_to_where_the_best_lies_behind_the_unknown(beyond):
    grid = wall_with(0, beyond=beyond)
    best, will_do = np.array([[1.2, 3.0]]), np.array([[1.2, 3.0], [1.2, 1.5]])
    options = list(Planner(CONFIG, BODY).options(grid, (0.3, 0.3), [best, will_do]))
    end = certain(options[0][1]).end
    assert end == pytest.approx((1.2, 3.0) if beyond == Cell.FREE else (1.2, 1.5), abs=0.05)
    assert len(options) == 4


def test_of_several_targets_the_configured_one_is_gone_to():
    grid = drawn(
        """
        ......
        ......
        #####.
        ......
        ......
        """,
        scale=10,
    )
    start = (0.5, 0.5)
    targets = np.array([[0.5, 2.0], [2.6, 0.5]])  # near behind the wall, or farther on this side
    assert path_of(SIMPLE, grid, start, targets).end == pytest.approx((0.5, 2.0), abs=0.03)
    assert path_of(CONFIG, grid, start, targets).end == pytest.approx((2.6, 0.5), abs=0.03)


def test_a_target_inside_an_obstacle_moves_to_the_nearest_open_cell():
    grid = drawn("..........\n" * 4 + "....##....\n" * 2 + "..........\n" * 4, scale=10)
    path = path_of(SIMPLE, grid, (0.5, 2.5), np.array([[2.05, 2.5]]))
    assert path.end == pytest.approx((1.75, 2.5), abs=0.06)
    assert path.gap_m == pytest.approx(0.3, abs=0.06)


def test_a_target_too_deep_inside_is_no_destination():
    grid = drawn("....######\n" * 6, scale=10)
    target = np.array([[4.0, 1.5]])
    assert Planner(CONFIG, BODY).plan(grid, (0.5, 1.5), target) is None
    far = PlanningConfig(max_gap_m=3.0)
    assert path_of(far, grid, (0.5, 1.5), target).gap_m == pytest.approx(2.25, abs=0.1)


def test_a_target_off_the_map_moves_to_the_nearest_known_cell():
    grid = drawn("....\n" * 4, scale=10)
    path = path_of(CONFIG, grid, (0.5, 1.0), np.array([[2.6, 1.0]]))
    assert path.end == pytest.approx((1.975, 1.0), abs=0.06)
    assert Planner(CONFIG, BODY).plan(grid, (0.5, 1.0), np.array([[40.0, 1.0]])) is None


def test_a_robot_inside_an_inflated_obstacle_gets_out_first():
    grid = drawn("#.........\n" * 4, scale=10)
    path = path_of(CONFIG, grid, (0.55, 1.0), np.array([[4.0, 1.0]]))
    assert path.waypoints[0] == (0.55, 1.0)
    assert path.end == pytest.approx((4.0, 1.0), abs=0.05)
    assert path.length_m == pytest.approx(3.45, abs=0.05)


def test_a_robot_that_is_walled_in_has_no_way():
    grid = drawn("##########\n" * 8, scale=10)
    assert Planner(CONFIG, BODY).plan(grid, (2.0, 2.0), np.array([[4.0, 2.0]])) is None


def test_a_path_to_where_the_robot_is_has_no_length():
    grid = drawn("....\n" * 4, scale=10)
    path = path_of(CONFIG, grid, (1.0, 1.0), np.array([[1.0, 1.0]]))
    assert path.length_m < 0.05
    assert len(path.waypoints) == 2


def test_the_grid_is_not_changed():
    grid = drawn(DOOR, scale=10)
    before = grid.cells.copy()
    grid.cells.flags.writeable = False
    Planner(CONFIG, BODY).plan(grid, (0.5, 1.25), np.array([[5.5, 1.25]]))
    np.testing.assert_array_equal(grid.cells, before)


def test_a_path_is_blocked_once_an_obstacle_lies_on_it():
    grid = drawn("............\n" * 4, scale=10)
    path = ((0.5, 1.0), (3.0, 1.0), (5.0, 1.5))
    assert not is_blocked(path, costmap_of(grid, path[0]))
    for row, column in ((20, 20), (26, 80)):  # on the first leg, on the last
        blocked = OccupancyGrid(grid.cells.copy(), 0.05, grid.origin)
        blocked.cells[row, column] = Cell.OCCUPIED
        assert is_blocked(path, costmap_of(blocked, path[0]))
    grid.cells[20, 8] = Cell.OCCUPIED  # beside the robot: it has to get out anyway
    assert not is_blocked(path, costmap_of(grid, path[0]))


def test_the_way_out_does_not_lead_through_a_thin_wall():
    """The robot touches a wall from the left; open floor is nearer behind it than beside it."""
    grid = drawn(".....................\n" * 11, scale=5)
    grid.cells[:50, 40] = Cell.OCCUPIED
    grid.cells[:28, 34] = Cell.OCCUPIED  # a dead end, too narrow to stand in
    start = (1.87, 1.0)
    costmap = costmap_of(grid, start)
    assert costmap.is_tight
    leads_out = certain(costmap.escape).cells
    assert not (leads_out & grid.cropped(1.0).occupied).any()
    path = path_of(CONFIG, grid, start, np.array([[0.5, 2.5]]))
    corners = costmap.grid.cells_of(np.array(path.waypoints))
    assert not costmap.grid.occupied[corners[:, 0], corners[:, 1]].any()


def test_a_gap_that_only_just_fits_is_taken_where_no_other_way_leads():
    """A gap of 0.40 m lets 2 x 0.18 m through, and not 2 x 0.22 m."""
    grid = drawn("........\n" * 4, scale=10)
    grid.cells[:, 40] = Cell.OCCUPIED
    grid.cells[16:24, 40] = Cell.FREE
    start, targets = (0.5, 1.0), np.array([[3.5, 1.0]])
    assert Planner(SIMPLE, BODY).plan(grid, start, targets) is None
    path = path_of(CONFIG, grid, start, targets)
    assert path is not None
    assert path.length_m < 3.3
    grid.cells[16:19, 40] = Cell.OCCUPIED
    assert Planner(CONFIG, BODY).plan(grid, start, targets) is None


def test_the_length_of_a_path_is_that_of_its_legs():
    path = PlannedPath(((0.0, 0.0), (3.0, 4.0), (3.0, 5.0)), gap_m=0.0, cost=120.0, is_known=True)
    assert path.length_m == pytest.approx(6.0)


def test_dense_waypoints_are_one_in_every_cell():
    grid = drawn("....\n" * 4, scale=20)
    start, target = (0.3, 0.4), np.array([[3.0, 1.7]])
    dense = path_of(PlanningConfig(waypoints="dense"), grid, start, target)
    assert dense.end == path_of(CONFIG, grid, start, target).end
    legs = [np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(dense.waypoints)]
    assert max(legs[1:]) <= 0.05 * np.sqrt(2) + 1e-9
    assert len(legs) >= 2.7 / 0.05


def test_a_start_in_an_obstacle_may_move_to_the_nearest_free_cell_whatever_lies_between():
    """The robot touches a wall from the left; free floor is nearer behind it than beside it."""
    grid = drawn("....................\n" * 12, scale=5)
    grid.cells[:, 40] = Cell.OCCUPIED
    grid.cells[20:40, 36] = Cell.OCCUPIED
    start, behind = (1.97, 1.5), np.array([[4.0, 1.5]])
    on_this_side = PlanningConfig(squeeze_m=0.0, unknown_cost=0.0)
    nearest = on_this_side.model_copy(update={"start_in_obstacle": "nearest"})
    assert Planner(on_this_side, BODY).plan(grid, start, behind) is None
    assert path_of(nearest, grid, start, behind).end == pytest.approx((4.0, 1.5), abs=0.06)
    grid.cells[grid.free] = Cell.UNKNOWN
    dares = nearest.model_copy(update={"unknown_cost": 1.0})
    assert Planner(dares, BODY).plan(grid, start, behind) is None


def test_the_nearest_free_cell_of_a_destination_may_be_out_of_reach():
    """The destination lies in a wall, nearer to the room behind it."""
    grid = drawn("..........##..........\n" * 4, scale=10)
    start, target = (0.5, 1.0), np.array([[5.8, 1.0]])
    assert path_of(CONFIG, grid, start, target).end[0] < 5.0
    nearest = PlanningConfig(squeeze_m=0.0, unknown_cost=0.0, end_in_obstacle="nearest")
    assert Planner(nearest, BODY).plan(grid, start, target) is None
    assert path_of(nearest, grid, start, np.array([[5.2, 1.0]])).end[0] < 5.0


def test_without_a_limit_the_path_ends_however_far_from_the_destination():
    grid = drawn("....######\n" * 6, scale=10)
    unlimited = PlanningConfig(max_gap_m=None)
    assert path_of(unlimited, grid, (0.5, 1.5), np.array([[4.0, 1.5]])).gap_m > 2.0
    grid.cells[:] = Cell.OCCUPIED
    assert Planner(unlimited, BODY).plan(grid, (0.5, 1.5), np.array([[4.0, 1.5]])) is None


WALLED = """
    ????????????
    ############
    ............
    ............
    ............
    ############
"""


@pytest.mark.parametrize(
    ("place", "nearest"),
    [
        ((1.0, 1.0), (1.0, 1.0)),  # open floor is itself
        ((1.0, 1.6), (1.0, 1.1)),  # on this side of the wall, a clearance away from it
        ((1.0, 1.9), (1.0, 1.1)),  # for the unknown beyond it, too
        ((1.0, 2.3), None),  # more than a metre away
    ],
)
def test_the_nearest_known_position_is_open_and_explored(place, nearest):
    grid = drawn(WALLED, scale=6)  # cells of the drawing are 0.3 m; the wall begins at y 1.2
    found = Planner(WIDE, BODY).nearest_known(grid, (0.5, 0.8), place, 1.0)
    if nearest is None:
        assert found is None
    else:
        assert certain(found) == pytest.approx(nearest, abs=0.15)
        assert grid.state_at(*certain(found)) is Cell.FREE


def test_the_nearest_known_position_is_one_that_a_path_leads_to():
    grid = drawn(DOOR, scale=6)  # 0.3 m each
    closed = OccupancyGrid(grid.cells.copy(), grid.resolution_m, grid.origin)
    closed.cells[:, 30:42] = Cell.OCCUPIED  # the door is shut
    place = (2.4, 0.9)
    assert certain(Planner(WIDE, BODY).nearest_known(grid, (0.5, 0.9), place, 1.0))[0] > 2.1
    found = Planner(WIDE, BODY).nearest_known(closed, (0.5, 0.9), place, 2.0)
    assert certain(found)[0] < 1.5
