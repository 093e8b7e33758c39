"""Who chooses which block is read off the answers, and holds on maps that the exam did not have."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exam_answers import answered
from hypernav.lab.exam.prediction.choices import BlockChoices, choices_of, ranks_of
from hypernav.lab.exam.questions import Answered

MAPS = 150
paths = st.lists(st.floats(0.0, 50.0), min_size=2, max_size=20)


def sat_by(choose, *, blocks: tuple[int, int] = (4, 9), maps: int = MAPS, seed: int = 0):
    """The answers of who chooses by `choose(costs, travel, search, rng)`, three in each search."""
    rng, answers = np.random.default_rng(seed), list[Answered]()
    for number in range(maps):
        count = int(rng.integers(*blocks))
        travel = rng.uniform(1.0, 12.0, count)
        costs = travel + rng.uniform(0.0, 15.0, count)
        options = [str(k + 1) for k in range(count)]
        chosen = choose(costs, travel, number // 3, rng)
        one = answered(
            "block",
            "map",
            number,
            options=options,
            costs=dict(zip(options, costs.tolist(), strict=True)),
            travel=dict(zip(options, travel.tolist(), strict=True)),
            chosen=None if chosen is None else options[chosen],
        )
        answers.append(
            one.model_copy(update={"id": f"houses:1/{number // 3}/block/map/bed/{number}"})
        )
    return answers


def fitted(choose, **how) -> BlockChoices:
    found = choices_of(sat_by(choose, **how))
    assert found is not None
    return found


def best(costs, *_) -> int:
    return int(np.argmin(costs))


def nearest(_costs, travel, *_) -> int:
    return int(np.argmin(travel))


def first(*_) -> int:
    return 0


def by_chance(costs, _travel, _search, rng) -> int:
    return int(rng.integers(len(costs)))


def often_best(costs, travel, search, rng) -> int:
    return best(costs) if rng.random() < 0.6 else by_chance(costs, travel, search, rng)


def bad_days(costs, travel, search, rng) -> int:
    return best(costs) if search % 2 else by_chance(costs, travel, search, rng)


@given(paths, st.data())
def test_ranks_count_the_blocks_that_come_before(costs, data):
    travel = data.draw(st.lists(st.floats(0.0, 50.0), min_size=len(costs), max_size=len(costs)))
    better, nearer, farther, earlier, later = ranks_of(costs, travel).T
    assert better[int(np.argmin(costs))] == 0
    in_order = better[np.argsort(costs)]
    assert (np.diff(in_order) >= 0).all()
    assert nearer[int(np.argmin(travel))] == farther[int(np.argmax(travel))] == 0
    assert (earlier + later == len(costs) - 1).all()
    assert (nearer + farther <= len(costs) - 1).all()


@given(paths, st.floats(0.0, 1.0), st.tuples(*[st.floats(0.0, 20.0)] * 5), st.floats(0.0, 0.999))
def test_probabilities_sum_to_one_and_lower_levels_are_better_blocks(costs, lapse, powers, level):
    choices = BlockChoices(lapse, powers, 0.0, 0.0)
    ranks = ranks_of(costs, costs[::-1])
    assert choices.probabilities(ranks).sum() == pytest.approx(1.0)
    drawn = [choices.drawn(ranks, one) for one in (0.0, level, 1.0)]
    assert ranks[drawn[0], 0] <= ranks[drawn[1], 0] <= ranks[drawn[2], 0]


@pytest.mark.parametrize("rule", [best, nearest, first])
def test_who_goes_by_a_rule_goes_by_it_on_other_maps(rule):
    """Those of the exam have 4 to 8 blocks, these 15 to 19."""
    choices = fitted(rule)
    for one in sat_by(rule, blocks=(15, 20), maps=30, seed=1):
        costs, travel = list(one.costs.values()), list(one.travel.values())
        assert one.chosen is not None
        ranks = ranks_of(costs, travel)
        # Of blocks that are about as good, any may be taken for the best.
        right = ranks[:, 0] == ranks[one.options.index(one.chosen), 0]
        alike = right if rule is best else np.arange(len(costs)) == int(one.chosen) - 1
        assert choices.probabilities(ranks)[alike].sum() > 0.9


def test_who_errs_at_a_rate_errs_at_it_on_other_maps():
    choices = fitted(often_best)
    shares = []
    for one in sat_by(often_best, blocks=(15, 20), maps=30, seed=1):
        ranks = ranks_of(list(one.costs.values()), list(one.travel.values()))
        shares.append(choices.probabilities(ranks)[ranks[:, 0] == 0].sum())
    assert np.mean(shares) == pytest.approx(0.64, abs=4.0 * math.sqrt(0.24 / MAPS))


def test_only_errors_that_come_in_runs_persist():
    assert fitted(bad_days).persistence > 0.3
    assert fitted(often_best).persistence < 0.2
    assert fitted(by_chance).persistence < 0.2


def test_unreadable_answers_are_counted_apart():
    choices = fitted(lambda costs, _travel, search, _rng: None if search % 2 else best(costs))
    assert choices.unread == pytest.approx(0.5, abs=0.02)
    assert choices_of([]) is None
    nothing = fitted(lambda *_: None)
    assert nothing.unread == 1.0
