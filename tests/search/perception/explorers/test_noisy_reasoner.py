"""Stand-ins for a model: right as often as told, by the truth of the scene."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError, TruthMissingError
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.noisy_reasoner import NoisyReasoner, RandomReasoner

BED = Goal("bed")
GOAL_AT = (10.0, 0.0)

probabilities = st.floats(0.0, 1.0)
places = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))


def block(number, destination, travel_m, frontier_cells=30):
    return Block(number, 0.0, 0.0, 2.0, 50, frontier_cells, destination, travel_m)


def told(seed=0, path_left_m=lambda x, y: math.dist((x, y), GOAL_AT)):
    truth = EpisodeTruth()
    truth.tell(rng=np.random.default_rng(seed), path_left_m=path_left_m)
    return truth


def choose(reasoner, blocks, excluded=()):
    overview = Overview(tuple(blocks), Pose2(0, 0, 0))
    return reasoner.choose(overview, BED, frozenset(excluded)).number


def noisy(probability, **values):
    config = values.pop("config", None)
    return NoisyReasoner(probability, ExchangeLog(), told(**values), config)


# The goal is 10 m ahead, the robot at the origin. Straight ahead the path is 10 m, by way of the
# block at (3, 4) it is 5 m + 8.06 m, by way of that behind the robot 2 m + 12 m.
AHEAD = block(1, (4.0, 0.0), 4.0)
ASIDE = block(2, (3.0, 4.0), 5.0)
BEHIND = block(3, (-2.0, 0.0), 2.0)


def test_the_best_block_is_on_the_shortest_path():
    assert choose(noisy(1.0), [BEHIND, ASIDE, AHEAD]) == 1
    assert choose(noisy(1.0), [BEHIND, ASIDE, AHEAD], excluded=[1]) == 2
    assert choose(noisy(1.0), [BEHIND, ASIDE, AHEAD], excluded=[1, 2]) == 3


def test_of_blocks_on_the_same_path_the_last_leads_on():
    line = [block(n, (2.0 * n, 0.0), 2.0 * n) for n in (1, 2, 3)]
    assert choose(noisy(1.0), line) == 3
    detour = block(4, (9.0, 0.0), 9.4)  # 0.4 m longer, and only 1 m is left
    assert choose(noisy(1.0), [*line, detour]) == 4
    assert choose(noisy(1.0), [*line, block(4, (9.0, 0.0), 9.6)]) == 3


def test_a_block_without_a_path_is_the_worst():
    unreachable = block(4, (9.9, 0.0), math.inf)
    assert choose(noisy(1.0), [unreachable, BEHIND]) == 3
    assert choose(noisy(1.0, path_left_m=lambda *_: math.inf), [unreachable, BEHIND]) == 3


def test_what_a_model_is_not_offered_is_not_chosen():
    explored = block(1, (4.0, 0.0), 4.0, frontier_cells=0)
    assert choose(noisy(1.0), [explored, ASIDE, BEHIND]) == 2
    every = VlmReasonerConfig(min_frontier_cells=0)  # as the paper offers them
    assert choose(noisy(1.0, config=every), [explored, ASIDE, BEHIND]) == 1
    assert choose(noisy(1.0), [explored]) is None
    assert choose(noisy(0.0), [explored, BEHIND]) == 3


@pytest.mark.parametrize("probability", [0.25, 0.4, 0.55, 0.7, 0.85])
def test_the_best_is_named_as_often_as_told(probability):
    reasoner, asked = noisy(probability, seed=7), 800
    named = [choose(reasoner, [AHEAD, ASIDE, BEHIND]) for _ in range(asked)]
    sigma = math.sqrt(asked * probability * (1.0 - probability))
    assert abs(named.count(1) - asked * probability) < 4.0 * sigma
    errors = asked - named.count(1)
    assert abs(named.count(2) - errors / 2.0) < 4.0 * math.sqrt(errors / 4.0)


@given(st.lists(places, min_size=2, max_size=12), st.integers(0, 2**32))
def test_never_right_means_never_the_best(destinations, seed):
    blocks = [block(n + 1, at, math.hypot(*at)) for n, at in enumerate(destinations)]
    best = choose(noisy(1.0, seed=seed), blocks)
    assert choose(noisy(0.0, seed=seed), blocks) not in (best, None)


@given(st.lists(places, max_size=12), st.frozensets(st.integers(1, 12)), probabilities)
def test_the_choice_is_always_one_of_the_offered(destinations, excluded, probability):
    blocks = [block(n + 1, at, math.hypot(*at)) for n, at in enumerate(destinations)]
    offered = {one.number for one in blocks} - excluded
    for reasoner in (noisy(probability), RandomReasoner(ExchangeLog(), told())):
        number = choose(reasoner, blocks, excluded)
        assert number in offered if offered else number is None


def test_by_chance_all_blocks_are_equally_likely():
    reasoner = RandomReasoner(ExchangeLog(), told(path_left_m=None))
    named = [choose(reasoner, [AHEAD, ASIDE, BEHIND]) for _ in range(1500)]
    for number in (1, 2, 3):
        assert abs(named.count(number) - 500) < 4.0 * math.sqrt(1500 * 2.0 / 9.0)


def test_the_same_generator_gives_the_same_choices():
    runs = [
        [choose(reasoner, [AHEAD, ASIDE, BEHIND]) for _ in range(50)]
        for reasoner in (noisy(0.4, seed=1), noisy(0.4, seed=1), noisy(0.4, seed=2))
    ]
    assert [a == b for a, b in pairwise(runs)] == [True, False]


@pytest.mark.parametrize("text", ["2", "-0.1", "often", "nan", "inf", ""])
def test_a_probability_is_a_number_from_0_to_1(text):
    with pytest.raises(ConfigError, match=r"from 0 to 1, for example noisy:0\.7"):
        noisy(text)


def test_without_the_truth_nothing_is_chosen():
    for reasoner in (
        NoisyReasoner("1", ExchangeLog(), EpisodeTruth()),
        RandomReasoner(ExchangeLog(), EpisodeTruth()),
    ):
        with pytest.raises(TruthMissingError, match="only in a simulated world"):
            choose(reasoner, [AHEAD, ASIDE])
    with pytest.raises(TruthMissingError, match="true paths to the goal"):
        choose(noisy(1.0, path_left_m=None), [AHEAD, ASIDE])


def test_every_choice_is_written_down_and_no_model_made_it():
    log = ExchangeLog()
    choose(NoisyReasoner("1", log, told()), [AHEAD, ASIDE], excluded=[2])
    choose(RandomReasoner(log, told()), [AHEAD, ASIDE])
    first, second = log.drain()
    assert (first.kind, first.asked, first.chosen, first.excluded) == (
        *("choose block", "noisy", 1),
        [2],
    )
    assert second.asked == "random block"
    assert not first.by_model
    assert not second.by_model
