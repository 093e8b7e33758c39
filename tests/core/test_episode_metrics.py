import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.episode import measure

lengths = st.one_of(st.floats(0, 100), st.just(math.inf))


def episode(**changes):
    values = {
        "stopped": True,
        "distance_to_goal_m": 0.05,
        "shortest_path_m": 4.0,
        "path_length_m": 5.0,
        "success_distance_m": 0.1,
    }
    return measure(**(values | changes))


def test_spl_is_the_share_of_the_path_that_was_needed():
    assert episode().success
    assert episode().spl == pytest.approx(4.0 / 5.0)


def test_a_path_shorter_than_the_geodesic_does_not_beat_one():
    assert episode(path_length_m=3.9).spl == pytest.approx(1.0)


def test_without_stop_there_is_no_success():
    assert not episode(stopped=False).success
    assert episode(stopped=False).spl == 0.0


def test_the_success_distance_is_exclusive_as_in_habitat():
    assert not episode(distance_to_goal_m=0.1).success


def test_soft_spl_rewards_progress():
    halfway = episode(stopped=False, distance_to_goal_m=2.0, path_length_m=2.0)
    assert halfway.soft_spl == pytest.approx(0.5)


def test_walking_away_is_no_progress():
    assert episode(distance_to_goal_m=9.0).soft_spl == 0.0


def test_a_start_on_the_goal_is_efficient_when_it_stays():
    here = episode(shortest_path_m=0.0, path_length_m=0.0, distance_to_goal_m=0.0)
    assert (here.success, here.spl, here.soft_spl) == (True, 1.0, 1.0)


def test_an_unreachable_goal_is_never_reached():
    lost = episode(shortest_path_m=math.inf, distance_to_goal_m=math.inf)
    assert (lost.success, lost.spl, lost.soft_spl) == (False, 0.0, 0.0)


@given(st.booleans(), lengths, lengths, st.floats(0, 100), st.floats(0.01, 2))
def test_measures_stay_between_zero_and_one(stopped, left, shortest, path, success_distance):
    result = measure(
        stopped=stopped,
        distance_to_goal_m=left,
        shortest_path_m=shortest,
        path_length_m=path,
        success_distance_m=success_distance,
    )
    assert 0.0 <= result.spl <= 1.0
    assert 0.0 <= result.soft_spl <= 1.0
    assert result.spl <= float(result.success)
