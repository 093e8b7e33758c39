import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.simulator.houses.random_stream import RandomStream


def test_a_stream_is_fixed_for_all_time():
    rng = RandomStream(1234, "layout")
    assert [rng.integer(0, 999) for _ in range(5)] == [13, 785, 270, 125, 306]


def test_equal_keys_give_equal_streams_and_others_do_not():
    assert RandomStream(1, "a").array(8).tolist() == RandomStream(1, "a").array(8).tolist()
    assert RandomStream(1, "a").array(8).tolist() != RandomStream(1, "b").array(8).tolist()
    assert RandomStream(1, "a").array(8).tolist() != RandomStream(2, "a").array(8).tolist()


def test_a_fork_does_not_depend_on_what_its_parent_drew():
    fresh, used = RandomStream(7), RandomStream(7)
    used.array(100)
    assert fresh.fork("x").unit() == used.fork("x").unit()


@given(st.integers(0, 2**31), st.integers(-5, 5), st.integers(0, 9))
def test_whole_numbers_stay_in_their_range(seed: int, low: int, span: int):
    rng = RandomStream(seed)
    drawn = [rng.integer(low, low + span) for _ in range(50)]
    assert min(drawn) >= low
    assert max(drawn) <= low + span


@given(st.integers(0, 2**31), st.lists(st.integers(), max_size=20))
def test_shuffling_loses_nothing(seed: int, items: list[int]):
    assert sorted(RandomStream(seed).shuffled(items)) == sorted(items)


def test_weights_are_kept():
    rng = RandomStream(3)
    drawn = [rng.weighted((("a", 3.0), ("b", 1.0))) for _ in range(4000)]
    assert drawn.count("a") / 4000 == pytest.approx(0.75, abs=0.03)


def test_a_raster_is_kept():
    values = np.array([RandomStream(k).uniform(1.0, 2.0, 0.05) for k in range(50)])
    assert np.allclose((values - 1.0) / 0.05, np.rint((values - 1.0) / 0.05))
