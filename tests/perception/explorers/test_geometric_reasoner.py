import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block, Overview
from hypernav.core.trace import ExchangeLog
from hypernav.perception.explorers.geometric_reasoner import GeometricConfig, GeometricReasoner

GOAL = Goal("bed")


def block(number, frontier_cells, travel_m, destination=(1.0, 0.0)):
    return Block(number, 0.0, 0.0, 2.0, 50, frontier_cells, destination, travel_m)


def choose(*blocks, excluded=(), log=None, **config):
    overview = Overview(lambda *_: np.zeros((8, 8, 3), np.uint8), blocks, Pose2(0.0, 0.0, 0.0))
    reasoner = GeometricReasoner(log or ExchangeLog(), GeometricConfig(**config))
    return reasoner.choose(overview, GOAL, frozenset(excluded))


def test_of_two_equal_boundaries_the_nearer_wins():
    assert choose(block(1, 30, 5.0), block(2, 30, 2.0)).number == 2


def test_of_two_equal_ways_the_longer_boundary_wins():
    assert choose(block(1, 10, 3.0), block(2, 60, 3.0)).number == 2


def test_of_two_equal_blocks_that_ahead_wins():
    ahead, behind = (2.0, 0.5), (-2.0, 0.5)
    assert choose(block(1, 30, 3.0, behind), block(2, 30, 3.0, ahead)).number == 2
    assert choose(block(1, 30, 2.0, ahead), block(2, 30, 2.0, behind)).number == 1


def test_ties_go_to_the_lower_number():
    assert choose(block(2, 30, 3.0), block(1, 30, 3.0)).number == 1


def test_without_boundary_there_is_nothing_to_choose():
    assert choose(block(1, 0, 1.0), block(2, 40, math.inf)).number is None
    assert choose().number is None


@given(
    st.lists(st.tuples(st.integers(0, 90), st.floats(0, 40)), min_size=1, max_size=12),
    st.frozensets(st.integers(1, 12)),
)
def test_the_choice_is_never_an_excluded_block(values, excluded):
    blocks = [block(i + 1, cells, travel_m) for i, (cells, travel_m) in enumerate(values)]
    choice = choose(*blocks, excluded=excluded)
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
    assert choose(*blocks).number is None
    assert choose(*blocks, min_frontier_cells=0).number == 3
    assert choose(*blocks, excluded=[3], min_frontier_cells=0).number == 2
