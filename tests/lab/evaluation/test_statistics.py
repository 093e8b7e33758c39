import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from eval_runs import apart, record
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.statistics import (
    compare,
    discordance,
    failure_counts,
    holm,
    mean_with_interval,
    ratio_with_interval,
    summarise,
)

SCENES = ["a", "a", "b", "b", "c", "c"]


def test_the_mean_is_over_episodes_not_over_scenes():
    assert mean_with_interval([1.0, 1.0, 1.0, 0.0], ["a", "a", "a", "b"]).mean == 0.75


@given(st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6))
def test_the_interval_holds_the_mean_and_stays_in_range(values):
    estimate = mean_with_interval(values, SCENES, draws=200)
    assert min(values) - 1e-9 <= estimate.low <= estimate.mean + 1e-9
    assert estimate.mean - 1e-9 <= estimate.high <= max(values) + 1e-9


def test_the_same_numbers_give_the_same_interval():
    values = [0.1, 0.9, 0.4, 0.3, 0.8, 0.2]
    estimate = mean_with_interval(values, SCENES)
    assert estimate.low < estimate.mean < estimate.high
    assert mean_with_interval(values, SCENES) == estimate


def test_episodes_of_a_scene_are_not_taken_for_independent():
    rng = np.random.default_rng(0)
    scenes = [str(k // 25) for k in range(500)]
    # A scene is easy or hard as a whole: 20 facts, not 500.
    values = np.repeat(rng.integers(0, 2, 20), 25).astype(float).tolist()
    clustered = mean_with_interval(values, scenes)
    naive = mean_with_interval(values, [str(k) for k in range(500)])
    assert clustered.high - clustered.low > 3 * (naive.high - naive.low)


def test_the_interval_agrees_with_scipy_where_every_scene_has_one_episode():
    values = np.random.default_rng(0).uniform(size=60)
    mine = mean_with_interval(values.tolist(), [str(k) for k in range(60)])
    theirs = stats.bootstrap((values,), np.mean, method="percentile", rng=0)
    assert mine.low == pytest.approx(theirs.confidence_interval.low, abs=0.01)
    assert mine.high == pytest.approx(theirs.confidence_interval.high, abs=0.01)


@pytest.mark.slow
def test_the_interval_covers_the_truth_about_as_often_as_it_says():
    rng, covered = np.random.default_rng(0), 0
    scenes = [str(k // 28) for k in range(36 * 28)]
    for _ in range(300):
        ease = np.repeat(rng.beta(9, 1, 36), 28)
        values = (rng.uniform(size=ease.size) < ease).astype(float)
        estimate = mean_with_interval(values.tolist(), scenes, draws=1000)
        covered += estimate.low <= 0.9 <= estimate.high
    assert 0.90 <= covered / 300 <= 0.98


def test_a_single_scene_draws_episodes_instead():
    estimate = mean_with_interval([0.0, 1.0, 0.0, 1.0], ["a"] * 4)
    assert estimate.low < 0.5 < estimate.high


def test_without_episodes_there_is_no_number():
    estimate = mean_with_interval([], [])
    assert math.isnan(estimate.mean)
    assert estimate.count == 0


def test_a_ratio_is_of_sums_and_its_interval_is_over_scenes():
    # Scene a: 6 m for 2 m and 2 m for 2 m; scene b: 3 m for 1 m. In all 11 m for 5 m.
    ratio = ratio_with_interval([6.0, 2.0, 3.0], [2.0, 2.0, 1.0], ["a", "a", "b"])
    assert (ratio.mean, ratio.count) == (11 / 5, 3)
    assert (ratio.low, ratio.high) == (2.0, 3.0)  # a alone, and b alone


def test_a_run_does_not_differ_from_itself():
    values = [0.1, 0.9, 0.4, 0.3, 0.8, 0.2]
    compared = compare(values, values, SCENES)
    assert compared.p_value == 1.0
    assert (compared.difference.low, compared.difference.high) == (0.0, 0.0)


def test_the_flip_test_by_hand():
    # Three scenes, better by 1 in each: of 8 ways to flip, 2 are as extreme.
    compared = compare([0, 0, 0], [1, 1, 1], ["a", "b", "c"])
    assert compared.difference.mean == 1.0
    assert compared.p_value == 0.25


def test_many_scenes_are_flipped_at_random_and_p_is_never_0():
    scenes = [str(k) for k in range(40)]
    compared = compare([0.0] * 40, [1.0] * 40, scenes, draws=999)
    assert compared.p_value == pytest.approx(1 / 1000)


def test_comparing_the_other_way_round_changes_the_sign_alone():
    rng = np.random.default_rng(1)
    a, b = rng.uniform(size=30).tolist(), rng.uniform(size=30).tolist()
    scenes = [str(k // 3) for k in range(30)]
    there, back = compare(a, b, scenes), compare(b, a, scenes)
    assert there.difference.mean == pytest.approx(-back.difference.mean)
    assert there.p_value == back.p_value


def test_holm_by_hand():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, 0.9]) == [1.0, 1.0]
    assert holm([]) == []


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_a_corrected_p_value_lies_between_the_plain_one_and_bonferroni(values):
    for plain, corrected in zip(values, holm(values), strict=True):
        assert plain <= corrected <= min(1.0, len(values) * plain)


def test_mcnemar_by_hand():
    found = discordance([True] * 5 + [False] * 3, [False] * 5 + [False, True, True])
    assert (found.only_first, found.only_second, found.both, found.neither) == (5, 2, 0, 1)
    assert found.p_value == pytest.approx(2 * (1 + 7 + 21) / 2**7)  # P(at most 2 of 7), twice


def test_equal_runs_have_p_1():
    assert discordance([True, False], [True, False]).p_value == 1.0


def test_what_does_not_count_is_in_no_mean():
    records = [record("0"), record("1", failure=Failure.NEVER_SEEN, stopped=False), apart("2")]
    summary = summarise(records)
    assert summary.success.count == 2
    assert summary.success.mean == 0.5
    assert failure_counts(records) == {Failure.NEVER_SEEN: 1, Failure.MODEL_UNAVAILABLE: 1}


def test_goals_that_cannot_be_reached_are_left_out_of_the_mean_distance_only():
    lost = record("1", failure=Failure.UNREACHABLE, distance_to_goal_m=None, shortest_path_m=None)
    summary = summarise([record("0"), lost])
    assert summary.success.mean == 0.5
    assert summary.distance_to_goal_m.mean == pytest.approx(0.05)
    assert summary.distance_to_goal_m.count == 1


def test_a_ratio_leaves_out_draws_without_references():
    scenes = [f"house {number}" for number in range(4)]
    ratio = ratio_with_interval([0.5, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], scenes)
    assert (ratio.mean, ratio.low, ratio.high) == (0.5, 0.5, 0.5)
