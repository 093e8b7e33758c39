"""Waiting until nothing is missing on the network."""

import time
from collections.abc import Callable

import pytest

from hypernav.core.errors import Nav2Error
from hypernav.robot.ros2.nav2_goals import wait_for


def answers(*words: str | None) -> Callable[[], str | None]:
    """Gives these answers, one for each question, and fails if asked once more."""
    remaining = iter(words)
    return lambda: next(remaining)


def test_what_is_there_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "sleep", pytest.fail)
    wait_for(answers(None), timeout_s=60.0)


def test_what_comes_late_is_waited_for() -> None:
    wait_for(answers("nobody reads", "nobody reads", None), timeout_s=60.0)


def test_the_last_words_say_what_is_missing() -> None:
    words = answers("nobody publishes tf", *["nobody reads the goal"] * 100)
    with pytest.raises(Nav2Error, match=r"^nobody reads the goal$"):
        wait_for(words, timeout_s=0.15)


def test_it_looks_once_even_without_time_to_wait() -> None:
    wait_for(answers(None), timeout_s=0.0)
