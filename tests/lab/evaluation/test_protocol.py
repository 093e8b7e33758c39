import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eval_runs import record
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.protocol import (
    PROTOCOLS,
    SUCCESS_DISTANCES_M,
    EvaluationProtocol,
    Reference,
    StopRule,
)

LENGTHS = st.floats(min_value=0.0, max_value=50.0)
TIMEOUT = StopRule.TIMEOUT_COUNTS


def ended(distance, *, stopped=True, shortest=4.0, path=8.0):
    return record(
        distance_to_goal_m=distance,
        shortest_path_m=shortest,
        path_length_m=path,
        stopped=stopped,
    )


@pytest.mark.parametrize(
    ("distance", "stopped", "protocol", "success"),
    [
        (0.05, True, EvaluationProtocol(), True),
        (
            0.1,
            True,
            EvaluationProtocol(),
            False,
        ),  # habitat-lab: strictly under the success distance
        (0.15, True, EvaluationProtocol(), False),
        (0.15, True, EvaluationProtocol(0.2), True),
        (0.05, False, EvaluationProtocol(), False),
        (0.05, False, EvaluationProtocol(0.1, TIMEOUT), True),
        (0.95, False, EvaluationProtocol(1.0, TIMEOUT), True),
        (1.0, False, EvaluationProtocol(1.0, TIMEOUT), False),
        (math.inf, True, EvaluationProtocol(1.0), False),
    ],
)
def test_success_by_hand(distance, stopped, protocol, success):
    assert protocol.score(ended(distance, stopped=stopped)).success is success


@pytest.mark.parametrize(
    ("shortest", "path", "distance", "spl", "soft_spl"),
    [
        (4.0, 8.0, 0.05, 0.5, 0.5 * (1 - 0.05 / 4)),
        (4.0, 4.0, 0.0, 1.0, 1.0),
        (4.0, 3.9, 0.0, 1.0, 1.0),  # within the success distance the way may be shorter
        (0.0, 0.0, 0.0, 1.0, 1.0),  # started at the goal and stayed
        (0.0, 2.0, 0.0, 0.0, 0.0),  # started at the goal and walked about
        (4.0, 0.0, 4.0, 0.0, 0.0),
        (4.0, 6.0, 5.0, 0.0, 0.0),  # farther than at the start is no progress below 0
        (math.inf, 5.0, math.inf, 0.0, 0.0),
    ],
)
def test_spl_and_soft_spl_by_hand(shortest, path, distance, spl, soft_spl):
    score = EvaluationProtocol().score(ended(distance, shortest=shortest, path=path))
    assert score.spl == pytest.approx(spl)
    assert score.soft_spl == pytest.approx(soft_spl)


def test_every_distance_is_scored_under_both_rules():
    assert len(PROTOCOLS) == len(set(PROTOCOLS)) == 2 * (len(SUCCESS_DISTANCES_M) + 1) == 12


@pytest.mark.parametrize(
    ("to_object", "stopped", "rule", "success"),
    [
        (0.9, True, StopRule.STOP_REQUIRED, True),
        (0.9, False, StopRule.STOP_REQUIRED, False),
        (0.9, False, TIMEOUT, True),
        (1.0, True, StopRule.STOP_REQUIRED, False),
        (None, True, StopRule.STOP_REQUIRED, False),
    ],
)
def test_the_distance_to_the_object_is_a_protocol_of_its_own(to_object, stopped, rule, success):
    protocol = EvaluationProtocol(1.0, rule, Reference.OBJECT)
    ending = record(distance_to_goal_m=3.0, distance_to_object_m=to_object, stopped=stopped)
    assert protocol.score(ending).success is success
    assert not EvaluationProtocol(1.0, rule).score(ending).success


def test_records_of_earlier_versions_cannot_be_scored_by_the_object():
    protocol = EvaluationProtocol(1.0, reference=Reference.OBJECT)
    assert not protocol.can_score([record()])
    assert protocol.can_score([record(), record("1", distance_to_object_m=0.5)])


@given(distance=LENGTHS, shortest=LENGTHS, path=LENGTHS, stopped=st.booleans())
def test_a_laxer_protocol_never_finds_less(distance, shortest, path, stopped):
    ending = ended(distance, stopped=stopped, shortest=shortest, path=path)
    for rule in StopRule:
        spl = [EvaluationProtocol(d, rule).score(ending).spl for d in SUCCESS_DISTANCES_M]
        assert spl == sorted(spl)
    for d in SUCCESS_DISTANCES_M:
        strict = EvaluationProtocol(d).score(ending)
        assert strict.spl <= EvaluationProtocol(d, TIMEOUT).score(ending).spl
        assert 0.0 <= strict.spl <= 1.0
        assert 0.0 <= strict.soft_spl <= 1.0


def test_only_what_is_no_fault_of_the_agent_is_left_out():
    apart = {failure for failure in Failure if failure.is_apart}
    assert apart == {Failure.MODEL_UNAVAILABLE, Failure.SIMULATOR_ERROR}
