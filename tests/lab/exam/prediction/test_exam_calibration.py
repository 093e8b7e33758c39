"""What probabilities and scores are worth, by the truth of the answers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exam_answers import TRUE_BOX, boxed, checked
from hypernav.lab.exam.prediction.calibration import calibration_of

ELSEWHERE = (100.0, 10.0, 140.0, 40.0)
told = st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=16, max_size=60)


@given(told)
def test_a_higher_probability_never_counts_less(answers):
    curve = calibration_of(
        [checked("there" if there else "not there", "yes", p) for p, there in answers]
    ).presence
    xs, ys = [x for x, _ in curve], [y for _, y in curve]
    assert xs == sorted(set(xs))
    assert ys == sorted(ys)
    assert all(0.0 < y < 1.0 for y in ys)
    assert not curve or min(sum(t for _, t in answers), sum(not t for _, t in answers)) >= 8


def test_who_is_always_right_is_nearly_believed_and_more_so_after_more_questions():
    def believed(count: int) -> float:
        right = [checked("there", "yes"), checked("not there", "no")] * count
        return calibration_of(right).presence[-1][1]

    assert 0.9 < believed(10) < believed(100) < 1.0


def test_who_always_says_yes_tells_nothing():
    curve = calibration_of([checked("there", "yes"), checked("not there", "yes")] * 20).presence
    assert [y for _, y in curve] == [pytest.approx(0.5)]


@pytest.mark.parametrize("others", [8, 20, 40])
def test_who_always_says_yes_tells_nothing_however_many_questions_of_either_side(others: int):
    answers = [checked("there", "yes")] * 10 + [checked("not there", "yes")] * others
    assert [y for _, y in calibration_of(answers).presence] == [pytest.approx(0.5)]


def test_a_model_that_is_surer_than_right_is_brought_down():
    rng = np.random.default_rng(0)
    answers = [checked("there", "yes", 0.99) for _ in range(60)]
    answers += [
        checked("not there", "yes" if rng.random() < 0.5 else "no", 0.99) for _ in range(60)
    ]
    assert calibration_of(answers).presence[-1][1] == pytest.approx(2.0 / 3.0, abs=0.08)


def test_a_box_without_a_score_counts_for_how_seldom_there_is_a_false_one():
    def weight(false_boxes: int) -> float:
        answers = [boxed("near", TRUE_BOX)] * 20
        answers += [boxed("absent", ELSEWHERE)] * false_boxes
        answers += [boxed("absent", None)] * (20 - false_boxes)
        ((score, log_odds),) = calibration_of(answers).boxes
        assert score == 1.0
        return log_odds

    assert weight(0) > weight(5) > weight(15) > weight(20) - 1e-9
    assert weight(20) == pytest.approx(0.0, abs=0.01)


def test_boxes_that_miss_the_goal_are_false_ones():
    good = calibration_of([boxed("near", TRUE_BOX), boxed("absent", None)] * 20).boxes[0][1]
    bad = calibration_of([boxed("near", ELSEWHERE), boxed("absent", None)] * 20).boxes[0][1]
    assert good > 2.0
    assert bad == pytest.approx(0.0)  # no box never counts for more, and it tells nothing here


def test_low_scores_that_miss_the_goal_speak_against_it():
    answers = [boxed("near", TRUE_BOX, 0.9), boxed("near", ELSEWHERE, 0.3), boxed("absent", None)]
    low, high = calibration_of(answers * 20).boxes
    assert low[1] < -0.5
    assert high[1] > 2.0


def test_few_answers_tell_nothing():
    few = [boxed("near", TRUE_BOX), boxed("absent", None), checked("there", "yes")] * 7
    assert (calibration_of(few).boxes, calibration_of(few).presence) == ((), ())
