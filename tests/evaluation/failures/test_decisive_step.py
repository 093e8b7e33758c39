"""Which step of a failure a report links to."""

import pytest

from hypernav.core.trace import DetectionRecord, Mode, StepTrace
from hypernav.evaluation.failure_evidence import decisive_step
from hypernav.evaluation.failures import Failure

AREA = [[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]]
SEEN = [DetectionRecord(box=(0.0, 0.0, 1.0, 1.0), score=0.3, label="bed")]


def steps(areas, seen=()):
    """Steps with a goal area where there is a mark, and a detection at some of them."""
    return [
        StepTrace(
            step=number,
            pose=(0.0, 0.0, 0.0),
            action=None,
            mode=Mode.EXPLORE,
            goal_area=AREA if mark == "x" else [],
            detections=SEEN if number in seen else [],
        )
        for number, mark in enumerate(areas)
    ]


@pytest.mark.parametrize(
    ("areas", "decisive"), [("...xxx", 3), ("xx..xx", 4), ("xxx", 0), ("....", 3), ("xx..", 3)]
)
def test_a_wrong_belief_is_decided_where_the_last_one_began(areas, decisive):
    assert decisive_step(Failure.FALSE_DETECTION, steps(areas)) == decisive


def test_a_goal_that_was_missed_is_decided_where_it_was_first_detected():
    assert decisive_step(Failure.SEEN_BUT_MISSED, steps("......", seen={2, 4})) == 2
    assert decisive_step(Failure.SEEN_BUT_MISSED, steps("......")) == 5


@pytest.mark.parametrize("failure", [Failure.NEVER_SEEN, Failure.STOPPED_TOO_FAR])
def test_all_others_are_decided_at_their_end(failure):
    assert decisive_step(failure, steps("..xx..xx", seen={1})) == 7
