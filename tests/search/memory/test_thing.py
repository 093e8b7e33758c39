"""What is known of one thing: how sure it is, what views of it add, and whose floor it is of."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.search.memory.thing import (
    MOST_CHANCE,
    Thing,
    is_in_room,
    joined,
    stands_in_room,
)

CUP = Thing(3, "cup", 0.6, (1.0, 1.0, 0.5), (2.0, 2.0, 1.0), ((0.0, 1.0, 0.6),), 100.0, 1, 1)
counts = st.integers(0, 20)


def odds(thing: Thing) -> float:
    return thing.chance / (1.0 - thing.chance)


@given(st.integers(1, 20), counts, st.integers(0, 5))
def test_each_miss_counts_by_how_often_the_detector_saw_it_before(seen, overlooked, missed):
    """Laplace's rule of succession says how often, within bounds."""
    thing = replace(CUP, seen=seen, overlooked=overlooked, missed=missed)
    recall = min(max((seen + 1) / (seen + overlooked + 2), 0.3), 0.95)
    once_more = replace(thing, missed=missed + 1)
    assert odds(once_more) / odds(thing) == pytest.approx(1.0 - recall)


@given(st.integers(1, 20), counts, st.integers(2, 5))
def test_without_a_miss_the_share_of_images_that_showed_it_counts(seen, overlooked, times):
    thing = replace(CUP, seen=seen, overlooked=overlooked)
    longer = replace(CUP, seen=seen * times, overlooked=overlooked * times)
    assert longer.chance == pytest.approx(thing.chance)
    assert replace(thing, overlooked=overlooked + 1).chance < thing.chance
    assert replace(thing, refuted_in=1).chance == pytest.approx(thing.chance * 0.4)


@given(st.floats(0.0, 1.0), st.integers(1, 20), counts, st.integers(0, 5))
def test_no_thing_is_surer_than_one_of_full_score_that_each_image_shows(
    score, seen, overlooked, missed
):
    sure = replace(CUP, views=((0.0, 1.0, 1.0),), score=1.0)
    assert sure.chance == pytest.approx(MOST_CHANCE)
    other = replace(sure, views=((0.0, 1.0, score),), score=score)
    other = replace(other, seen=seen, overlooked=overlooked, missed=missed)
    assert other.chance <= MOST_CHANCE + 1e-9


@pytest.mark.parametrize(("score", "missed"), [(0.0, 1), (0.6, 1), (0.9, 3)])
def test_the_surer_a_thing_was_the_more_misses_it_takes_until_it_is_gone(score: float, missed: int):
    """What was never missed is not gone, however doubtful it is."""
    thing = replace(CUP, score=score)
    assert not replace(thing, missed=missed - 1).is_gone
    assert replace(thing, missed=missed).is_gone


def test_a_view_ends_the_misses_and_they_are_remembered():
    known = [
        replace(CUP, seen=2, missed=3, overlooked=4, first_search=2),
        replace(CUP, number=1, seen=5, missed=6, overlooked=7),
    ]
    one = joined(known, replace(CUP, number=9, score=0.9, last_search=3))
    assert (one.seen, one.missed, one.overlooked) == (8, 0, 20)
    assert (one.number, one.score, one.first_search, one.last_search) == (1, 0.9, 1, 3)


@pytest.mark.parametrize(("pixels", "is_moved"), [(49.0, False), (50.0, True), (99.0, True)])
def test_another_search_moves_a_thing_that_it_sees_at_least_half_as_large(pixels, is_moved):
    new = replace(CUP, low=(1.5, 1.5, 0.5), high=(2.5, 2.5, 1.0), pixels=pixels)
    one = joined([CUP], replace(new, last_search=2))
    assert (one.low, one.high) == ((1.5 if is_moved else 1.0,) * 2 + (0.5,), (2.5, 2.5, 1.0))
    assert one.pixels == (pixels if is_moved else 100.0)
    assert joined([CUP], new).low == CUP.low


def test_a_place_far_from_the_others_is_another_view():
    views = ((0.05, 1.0, 0.9), (3.0, 1.0, 0.4))
    one = joined([CUP], replace(CUP, pixels=1.0, views=views))
    assert one.views == ((0.0, 1.0, 0.9), (3.0, 1.0, 0.4))


def test_a_thing_is_of_the_floor_that_it_stands_on_however_high_it_is():
    def between(low: float, high: float) -> Thing:
        return replace(CUP, low=(0.0, 0.0, low), high=(1.0, 1.0, high))

    assert stands_in_room(between(0.0, 0.5), 0.0)
    assert stands_in_room(between(0.0, 9.0), 0.0)
    assert not stands_in_room(between(5.0, 9.0), 0.0)
    assert not stands_in_room(between(-9.0, -5.0), 0.0)
    assert stands_in_room(between(-9.0, 9.5), 0.0)


@given(st.integers(-50, 389).map(lambda cm: cm / 100.0 + 0.005), st.floats(-1.5, 1.5))
def test_each_height_is_of_one_of_two_floors_and_of_all_levels_of_its_own(height_m, level_m):
    is_here = is_in_room(height_m)
    assert is_here != is_in_room(height_m - 3.4)
    if is_here:
        assert is_in_room(height_m, level_m)
        assert is_in_room(height_m - level_m, level_m)


def test_its_middle_is_its_position():
    assert CUP.position == (1.5, 1.5, 0.75)
    assert CUP.size == (1.0, 1.0, 0.5)
    assert math.isclose(sum(x for x, _ in CUP.outline) / 5.0, 1.5)
