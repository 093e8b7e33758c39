import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.exploring.floors import KnownFloor
from hypernav.core.exploring.overview import (
    Block,
    FloorBlocks,
    Overview,
    Prospects,
    prospects_of_boundaries,
)
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import GeometricConfig
from hypernav.search.perception.explorers import geometric_reasoner
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner

GOAL = Goal("bed")


def block(number, frontier_cells, travel_m, destination=(1.0, 0.0)):
    return Block(number, 0.0, 0.0, 2.0, 50, frontier_cells, destination, travel_m)


@dataclass(frozen=True, eq=False, kw_only=True)
class Shown(Overview):
    """Blocks that show what a function tells."""

    by: Callable[[Sequence[Block]], Prospects]

    def prospects(self, blocks):
        return self.by(blocks)


class Elsewhere(FloorBlocks):
    def prospects(self, blocks):
        return whole_views(blocks)


def choose(*blocks, excluded=(), log=None, prospects=prospects_of_boundaries, **config):
    overview = Shown(blocks, Pose2(0.0, 0.0, 0.0), by=prospects)
    reasoner = GeometricReasoner(log or ExchangeLog(), GeometricConfig(**config))
    return reasoner.choose(overview, GOAL, frozenset(excluded))


def greedy(*blocks, **options):
    return choose(*blocks, gain="boundary", order="greedy", **options)


def test_of_two_equal_boundaries_the_nearer_wins():
    assert greedy(block(1, 30, 5.0), block(2, 30, 2.0)).number == 2


def test_of_two_equal_ways_the_longer_boundary_wins():
    assert greedy(block(1, 10, 3.0), block(2, 60, 3.0)).number == 2


def test_of_two_equal_blocks_that_ahead_wins():
    ahead, behind = (2.0, 0.5), (-2.0, 0.5)
    assert greedy(block(1, 30, 3.0, behind), block(2, 30, 3.0, ahead)).number == 2
    assert greedy(block(1, 30, 2.0, ahead), block(2, 30, 2.0, behind)).number == 1


def test_ties_go_to_the_lower_number():
    assert greedy(block(2, 30, 3.0), block(1, 30, 3.0)).number == 1


def test_without_boundary_there_is_nothing_to_choose():
    assert choose(block(1, 0, 1.0), block(2, 40, math.inf)).number is None
    assert choose().number is None


@given(
    st.lists(st.tuples(st.integers(0, 90), st.floats(0, 40)), min_size=1, max_size=12),
    st.frozensets(st.integers(1, 12)),
    st.sampled_from(["greedy", "tour"]),
)
def test_the_choice_is_never_an_excluded_block(values, excluded, order):
    blocks = [block(i + 1, cells, travel_m) for i, (cells, travel_m) in enumerate(values)]
    choice = choose(*blocks, excluded=excluded, order=order)
    assert choice.number not in excluded
    assert choice.number is None or any(b.number == choice.number for b in blocks)


def test_every_choice_is_written_down():
    log = ExchangeLog()
    choose(block(1, 30, 2.0), excluded={4}, log=log)
    (exchange,) = log.drain()
    assert (exchange.kind, exchange.chosen, exchange.excluded) == ("choose block", 1, [4])
    assert exchange.asked == "geometric"
    assert log.drain() == []


def test_blocks_without_boundary_come_last_and_the_nearest_of_them_first():
    blocks = [block(1, 0, 2.0), block(2, 0, 1.0), block(3, 1, 9.0)]
    assert greedy(*blocks).number is None
    assert greedy(*blocks, min_frontier_cells=0).number == 3
    assert greedy(*blocks, excluded=[3], min_frontier_cells=0).number == 2


def test_a_view_counts_and_not_the_boundary():
    def crumbs_and_a_room(blocks):
        # The long boundary lies behind furniture, the short one is a door.
        shows = np.array([[True, False], [False, True]])
        return Prospects(np.array([0.2, 9.0]), shows, np.zeros((2, 2)))

    blocks = [block(1, 60, 2.0, (2.0, 0.0)), block(2, 16, 3.0, (-3.0, 0.0))]
    for order in ("greedy", "tour"):
        assert choose(*blocks, order=order, gain="boundary").number == 1
        assert choose(*blocks, order=order, prospects=crumbs_and_a_room).number == 2


def sized(*areas_m2):
    """Prospects of blocks each of which shows an area of its own."""

    def of(blocks):
        areas = np.array([areas_m2[one.number - 1] for one in blocks])
        return Prospects(areas, np.eye(len(blocks), dtype=bool), np.zeros((len(blocks), 2)))

    return of


def test_a_small_view_counts_less_than_its_area():
    """Four corners take less way for what they show than a room does, and come after it."""
    corners = [block(k, 20, 2.0, (0.0, 2.0)) for k in range(1, 5)]
    room = block(5, 20, 3.0, (3.0, 0.0))
    for order in ("greedy", "tour"):
        assert choose(*corners, room, prospects=sized(*[3.0] * 4, 12.0), order=order).number == 5


def test_of_views_of_one_size_the_nearest_comes_first_however_small():
    near, far = block(1, 20, 1.0), block(2, 20, 4.0)
    for size_m2 in (0.5, 6.0, 30.0):
        assert choose(near, far, prospects=sized(size_m2, size_m2)).number == 1


def test_what_a_large_view_shows_too_counts_in_full():
    """A corner that is in view from a room is no small view of its own."""

    def a_room_and_its_corner(blocks):
        shows = {1: [True, True, False], 2: [False, True, False], 3: [False, False, True]}
        areas = np.array([9.0, 3.0, 3.0])
        return Prospects(areas, np.array([shows[one.number] for one in blocks]), np.zeros((3, 2)))

    room, corner, other = block(1, 20, 9.0), block(2, 20, 2.0), block(3, 20, 1.5)
    chosen = choose(room, corner, other, order="greedy", prospects=a_room_and_its_corner)
    assert chosen.number == 2
    assert "3.0 m² of the unknown" in chosen.reason


def test_where_boundaries_count_none_is_small():
    near, far = block(1, 6, 0.5), block(2, 60, 30.0)
    for order in ("greedy", "tour"):
        assert choose(near, far, gain="boundary", order=order).number == 1


def test_a_tour_finishes_what_is_near_where_greed_leaves():
    near = [block(1, 20, 1.0, (-1.0, 0.0)), block(2, 20, 1.5, (-1.5, 0.0))]
    far = block(3, 90, 4.0, (4.0, 0.0))
    assert choose(*near, far, gain="boundary", order="greedy").number == 3
    assert choose(*near, far, gain="boundary", order="tour").number == 1


def test_a_tour_has_as_many_stops_as_allowed(monkeypatch):
    blocks = [block(n, 10 * n, 10.0 - n, (1.0 * n, 0.0)) for n in range(1, 9)]
    for stops in (12, 3, 1):
        monkeypatch.setattr(geometric_reasoner, "_TOUR_STOPS", stops)
        assert choose(*blocks).number is not None
    assert choose(*blocks).number == choose(*blocks, order="greedy").number


def test_where_nothing_is_to_be_seen_the_nearest_comes_first():
    def nothing(blocks):
        return Prospects(np.zeros(0), np.zeros((len(blocks), 0), bool), np.zeros((0, 2)))

    blocks = [block(1, 20, 5.0), block(2, 20, 2.0), block(3, 20, 9.0)]
    assert choose(*blocks, prospects=nothing).number == 2


@given(st.lists(st.tuples(st.integers(6, 90), st.floats(0, 40)), min_size=2, max_size=14))
def test_a_tour_does_not_change_when_the_robot_turns_on_the_spot(values):
    rng = np.random.default_rng(len(values))
    places = rng.uniform(-9.0, 9.0, (len(values), 2)).tolist()
    blocks = [
        block(i + 1, cells, travel_m, tuple(place))
        for i, ((cells, travel_m), place) in enumerate(zip(values, places, strict=True))
    ]
    reasoner = GeometricReasoner(ExchangeLog())
    chosen = {
        reasoner.choose(
            Overview(tuple(blocks), Pose2(0.0, 0.0, yaw)),
            GOAL,
            frozenset(),
        ).number
        for yaw in (0.0, 1.5, 3.0, -1.5)
    }
    (number,) = chosen
    assert number in {one.number for one in blocks}


def test_stairs_are_weighed_against_all_blocks_however_many_there_are():
    """They are far for the greedy choice of a tour's stops, and yet the most is behind them."""

    def crumbs_and_a_floor(blocks):
        areas = np.array([20.0 if one.connector is not None else 0.5 for one in blocks])
        return Prospects(areas, np.eye(len(blocks), dtype=bool), np.zeros((len(blocks), 2)))

    crumbs = [block(k, 10, 6.0, (6.0, 0.1 * k)) for k in range(1, 14)]
    stairs = replace(block(14, 20, 0.5), connector=0, words="stairs up")
    choice = choose(*crumbs, stairs, prospects=crumbs_and_a_floor, gain="view")
    assert choice.number == 14
    assert "stairs up" in choice.reason


def whole_views(blocks):
    """Each block shows 15 m² that no other shows."""
    areas = np.full(len(blocks), 15.0)
    return Prospects(areas, np.eye(len(blocks), dtype=bool), np.zeros((len(blocks), 2)))


def between_floors(
    here, there, seen_m2=60.0, excluded=(), visited=(), was_explored=False, **config
):
    """What is chosen, where another floor of 100 m² is known."""
    cells = np.full((100, 100), Cell.FREE, dtype=np.uint8)
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    other = KnownFloor(1, 3.0, grid, (), (), (), (), (), (0.0, 0.0), was_explored=was_explored)
    floor = Elsewhere(other, tuple(there), visited=frozenset(visited))
    robot = Pose2(0.0, 0.0, 0.0)
    overview = Shown(tuple(here), robot, elsewhere=[floor], seen_m2=seen_m2, by=whole_views)
    reasoner = GeometricReasoner(ExchangeLog(), GeometricConfig(**config))
    return reasoner.choose(overview, GOAL, frozenset(excluded))


FAR_CORNER = [block(1, 10, 12.0)]
MUCH_ELSEWHERE = [block(2, 10, 16.0), block(3, 10, 15.0), block(4, 10, 20.0)]


def test_a_floor_is_left_where_another_shows_more_a_metre_of_way():
    choice = between_floors(FAR_CORNER, MUCH_ELSEWHERE)
    assert choice.number == 3
    assert "floor 2, 3.0 m higher" in choice.reason


@pytest.mark.parametrize("nearest_m", [0.0, 4.0])
def test_it_is_not_left_for_as_much_that_is_farther_away(nearest_m: float):
    here = [block(1, 10, nearest_m), block(5, 10, 9.0), block(6, 10, 10.0)]
    assert between_floors(here, MUCH_ELSEWHERE).number in (1, 5, 6)


def test_it_is_not_left_before_half_as_much_of_it_was_seen_as_of_the_other():
    """A landing with one way on is no floor that was searched."""
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, seen_m2=49.0).number == 1
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, seen_m2=51.0).number == 3


def test_nothing_that_is_excluded_or_out_of_reach_leads_to_another_floor():
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, excluded=(3,)).number == 2
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, excluded=(2, 3, 4)).number == 1
    assert between_floors(FAR_CORNER, [block(2, 10, math.inf), block(3, 0, 9.0)]).number == 1


def test_where_boundaries_count_the_robot_stays_on_its_floor():
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, gain="boundary").number == 1


def test_what_was_visited_there_is_nothing_that_is_left():
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, visited=(3,)).number == 2
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, visited=(2, 3, 4)).number == 1


def test_only_stairs_lead_to_a_floor_that_was_explored():
    stairs = replace(block(5, 20, 15.5), connector=0, words="stairs up")
    assert between_floors(FAR_CORNER, MUCH_ELSEWHERE, was_explored=True).number == 1
    near = [block(k, 10, 0.5) for k in (6, 7, 8)]
    choice = between_floors([block(1, 10, 40.0)], [*near, stairs], was_explored=True)
    assert choice.number == 5


def test_stairs_of_another_floor_count_as_far_as_they_lead():
    here, there = [block(1, 10, 8.0)], [block(2, 10, 12.0), block(3, 10, 12.0)]
    assert between_floors(here, there).number == 2
    stairs = [replace(one, connector=one.number, words="stairs up") for one in there]
    assert between_floors(here, stairs).number == 1
