import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.houses.dice import Dice


def test_a_stream_is_fixed_for_all_time():
    dice = Dice(1234, "layout")
    assert [dice.integer(0, 999) for _ in range(5)] == [13, 785, 270, 125, 306]


def test_equal_keys_give_equal_streams_and_others_do_not():
    assert Dice(1, "a").array(8).tolist() == Dice(1, "a").array(8).tolist()
    assert Dice(1, "a").array(8).tolist() != Dice(1, "b").array(8).tolist()
    assert Dice(1, "a").array(8).tolist() != Dice(2, "a").array(8).tolist()


def test_a_fork_does_not_depend_on_what_its_parent_drew():
    fresh, used = Dice(7), Dice(7)
    used.array(100)
    assert fresh.fork("x").unit() == used.fork("x").unit()


@given(st.integers(0, 2**31), st.integers(-5, 5), st.integers(0, 9))
def test_whole_numbers_stay_in_their_range(seed: int, low: int, span: int):
    dice = Dice(seed)
    drawn = [dice.integer(low, low + span) for _ in range(50)]
    assert min(drawn) >= low
    assert max(drawn) <= low + span


@given(st.integers(0, 2**31), st.lists(st.integers(), max_size=20))
def test_shuffling_loses_nothing(seed: int, items: list[int]):
    assert sorted(Dice(seed).shuffled(items)) == sorted(items)


def test_weights_are_kept():
    dice = Dice(3)
    drawn = [dice.weighted((("a", 3.0), ("b", 1.0))) for _ in range(4000)]
    assert drawn.count("a") / 4000 == pytest.approx(0.75, abs=0.03)


def test_a_raster_is_kept():
    values = np.array([Dice(k).uniform(1.0, 2.0, 0.05) for k in range(50)])
    assert np.allclose((values - 1.0) / 0.05, np.rint((values - 1.0) / 0.05))
