from collections import Counter
from collections.abc import Callable

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hypernav.core.errors import (
    ChatTimeoutError,
    ChatTransportError,
    ModelRejectedError,
    ModelUnavailableError,
)
from hypernav.io.bounded_http import Deadline
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.reply_errors import Retry, RetryLaterError


class Time:
    """A clock that only sleeping moves."""

    def __init__(self) -> None:
        self.now = 0.0
        self.waits: list[float] = []

    def sleep(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.now += seconds


def patience(time: Time, **settings: float) -> Retry:
    return Retry(ChatConfig.model_validate(settings), sleep=time.sleep, clock=lambda: time.now)


def call(retry: Retry, attempt: Callable[[Deadline], str]) -> tuple[str, Counter[str]]:
    return retry.call(attempt, who="m", patience=retry.begin())


def failing(times: int, error: Exception) -> Callable[[Deadline], str]:
    left = [times]

    def attempt(deadline: Deadline) -> str:
        assert deadline.seconds_left > 0.0
        if left[0] > 0:
            left[0] -= 1
            raise error
        return "done"

    return attempt


def test_waits_double_up_to_the_longest():
    time = Time()
    lost_often = failing(5, ChatTransportError("lost"))
    result, lost = call(patience(time, longest_wait_s=3.0), lost_often)
    assert (result, lost) == ("done", {"transport": 5})
    assert time.waits == [0.5, 1.0, 2.0, 3.0, 3.0]


def test_heeds_what_the_server_asks_for_within_bounds():
    time = Time()
    attempt = failing(1, RetryLaterError("busy", 2.5))
    assert call(patience(time), attempt) == ("done", {"transport": 1})
    assert call(patience(time), failing(1, RetryLaterError("busy", 900.0)))[1].total() == 1
    assert time.waits == [2.5, 8.0]


def test_a_server_cannot_make_us_ask_more_often():
    time = Time()
    call(patience(time), failing(3, RetryLaterError("busy", 0.0)))
    assert time.waits == [0.5, 1.0, 2.0]


def test_all_attempts_of_a_question_share_its_patience():
    time = Time()
    retry = patience(time, patience_s=10.0, timeout_s=60.0)
    begun = retry.begin()
    time.now = 9.0
    with pytest.raises(ModelUnavailableError):
        retry.call(slow_until_the_end(time), who="m", patience=begun)
    assert time.now == 10.0


def slow_until_the_end(time: Time) -> Callable[[Deadline], str]:
    def attempt(deadline: Deadline) -> str:
        time.now += deadline.seconds_left
        raise ChatTimeoutError("slow")

    return attempt


@given(
    st.floats(0.0, 60.0),
    st.floats(0.01, 5.0),
    st.floats(0.1, 20.0),
    st.sampled_from([ChatTransportError("lost"), ChatTimeoutError("slow")]),
)
@example(0.1 + 0.2, 0.1, 0.1, ChatTransportError("lost"))  # nothing is left after the waits
def test_gives_up_within_the_patience(limit: float, first: float, longest: float, error: Exception):
    time = Time()
    with pytest.raises(ModelUnavailableError, match="gave no answer in"):
        call(
            patience(time, patience_s=limit, first_wait_s=first, longest_wait_s=longest),
            failing(10**6, error),
        )
    assert time.now <= limit


def test_lost_attempts_are_counted_by_reason():
    def attempt(deadline: Deadline) -> str:
        if errors:
            raise errors.pop()
        return "done"

    errors: list[Exception] = [
        ChatTimeoutError("a"),
        ChatTransportError("b"),
        ChatTimeoutError("c"),
    ]
    assert call(patience(Time()), attempt)[1] == {"timeout": 2, "transport": 1}


def test_no_patience_means_one_attempt():
    time = Time()
    with pytest.raises(ModelUnavailableError, match="in 1 attempt; last: lost"):
        call(patience(time, patience_s=0.0), failing(1, ChatTransportError("lost")))
    assert time.waits == []


def test_an_attempt_may_last_no_longer_than_the_patience_that_is_left():
    time = Time()
    limits: list[float] = []

    def slow(deadline: Deadline) -> str:
        limits.append(deadline.limit_s)
        return slow_until_the_end(time)(deadline)

    with pytest.raises(ModelUnavailableError):
        call(patience(time, patience_s=10.0, timeout_s=4.0, first_wait_s=1.0), slow)
    assert limits == [4.0, 4.0]
    assert time.now <= 10.0


def test_what_cannot_succeed_is_not_repeated():
    time = Time()
    with pytest.raises(ModelRejectedError):
        call(patience(time), failing(1, ModelRejectedError("no such model")))
    assert time.waits == []


def test_the_last_words_of_a_server_outlive_a_timeout():
    errors: list[Exception] = [
        ChatTimeoutError("no answer within 0.02 s"),
        RetryLaterError("answered 503: the queue is full", remedy="wait for the others"),
    ]

    def attempt(deadline: Deadline) -> str:
        raise errors.pop() if len(errors) > 1 else errors[0]

    with pytest.raises(ModelUnavailableError, match=r"last: no answer .* the queue is full") as end:
        call(patience(Time(), patience_s=2.0), attempt)
    assert end.value.remedy == "wait for the others"
