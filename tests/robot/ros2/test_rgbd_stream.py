"""Colour and depth are paired by their times, and an old pair is never new."""

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.robot.ros2.sensors import RgbdStream


class Clock:
    """A clock that is set by hand."""

    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def image(at_ms: int) -> SimpleNamespace:
    stamp = SimpleNamespace(sec=at_ms // 1000, nanosec=at_ms % 1000 * 1_000_000)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp))


@given(st.permutations([("colour", 100), ("depth", 110), ("colour", 133), ("depth", 140)]))
def test_the_newest_pair_wins_in_whatever_order_images_come(arrivals):
    stream = RgbdStream(0.015)
    for name, at_ms in arrivals:
        (stream.add_colour if name == "colour" else stream.add_depth)(image(at_ms))
    assert stream.latest is not None
    assert stream.latest.stamp_s == 0.133
    assert stream.latest.depth.header.stamp.nanosec == 140_000_000


def test_images_too_far_apart_are_no_pair():
    stream = RgbdStream(0.015)
    stream.add_colour(image(100))
    stream.add_depth(image(116))
    assert stream.latest is None
    assert "no pair" in stream.described()


def test_a_camera_that_repeats_itself_sends_nothing_new():
    clock = Clock()
    stream = RgbdStream(0.015, clock=clock)
    for clock.now_s in (1.0, 2.0, 3.0):
        stream.add_colour(image(100))
        stream.add_depth(image(100))
    assert stream.latest is not None
    assert stream.latest.received_s == 1.0


def test_it_remembers_few_images():
    stream = RgbdStream(0.0)
    for at_ms in range(0, 10_000, 10):
        stream.add_colour(image(at_ms))
    stream.add_depth(image(0))
    assert stream.latest is None
    stream.add_depth(image(9_990))
    assert stream.latest is not None


def test_a_pair_of_before_is_there_for_an_odometry_that_lags_behind():
    stream = RgbdStream(0.0)
    for at_ms in (100, 200, 300):
        stream.add_colour(image(at_ms))
        stream.add_depth(image(at_ms))
    pair = stream.newest_until(0.25)
    assert pair is not None
    assert pair.stamp_s == 0.2
    assert stream.newest_until(0.05) is None


@pytest.mark.parametrize("period_ms", [10, 50, 200, 500])
def test_pairs_are_kept_for_as_long_at_any_rate(period_ms):
    stream = RgbdStream(0.0)
    for at_ms in range(0, 3001, period_ms):
        stream.add_colour(image(at_ms))
        stream.add_depth(image(at_ms))
    assert stream.newest_until(2.6) is not None
    assert stream.newest_until(2.35) is None
