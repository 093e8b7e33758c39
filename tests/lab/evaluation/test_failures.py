"""The classes as laws: each outcome has exactly one of the paper's."""

from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.episode import Outcome
from hypernav.lab.evaluation.failures import (
    MISPLACED_M,
    BelievedTarget,
    Facts,
    Failure,
    PaperFailure,
    TargetKind,
    classify,
)

TARGETS = st.builds(
    BelievedTarget,
    kind=st.sampled_from(TargetKind),
    name=st.just("bed"),
    offset_m=st.floats(0.0, 3.0),
    is_surrounded=st.booleans(),
    map_leads_there=st.sampled_from([None, True, False]),
    lacks_data=st.booleans(),
    short_m=st.floats(-5.0, 5.0),
)
FACTS = st.builds(
    Facts,
    outcome=st.sampled_from([Outcome.NOT_FOUND, Outcome.WRONG_PLACE]),
    stopped=st.booleans(),
    gave_up=st.booleans(),
    distance_to_goal_m=st.floats(0.2, 10.0),
    goal_sightings=st.integers(0, 3),
    target=st.none() | TARGETS,
)


def test_every_class_but_outages_is_in_one_of_the_papers_and_all_of_these_occur():
    assert {failure for failure in Failure if failure.in_paper is None} == {
        failure for failure in Failure if failure.is_apart
    }
    assert {failure.in_paper for failure in Failure if not failure.is_apart} == set(PaperFailure)


def in_paper(facts: Facts) -> PaperFailure:
    verdict = classify(facts)
    assert verdict is not None
    assert verdict.failure.in_paper is not None
    return verdict.failure.in_paper


@given(facts=FACTS)
def test_what_was_taken_for_the_goal_decides_first_as_in_the_paper(facts):
    found = in_paper(facts)
    kind = None if facts.target is None else facts.target.kind
    assert (found is PaperFailure.DETECTION) == (kind is TargetKind.OTHER)  # false positives only
    assert (found is PaperFailure.LANGUAGE_UNDERSTANDING) == (kind is TargetKind.NEAR_MISS)


@given(facts=FACTS)
def test_not_found_is_what_is_not_observed_or_not_reached_in_time(facts):
    target = facts.target
    late = target is not None and target.short_m > facts.success_distance_m
    if in_paper(facts) is PaperFailure.NOT_FOUND:
        assert target is None or (late and not facts.stopped and not facts.gave_up)
    if target is None:
        assert in_paper(facts) is PaperFailure.NOT_FOUND


@given(facts=FACTS)
def test_map_quality_is_missing_data_and_nothing_else(facts):
    target = facts.target
    is_so = in_paper(facts) is PaperFailure.MAP_QUALITY
    assert not is_so or (target is not None and target.lacks_data and not facts.stopped)
    if target is not None and target.kind is TargetKind.GOAL and target.offset_m > MISPLACED_M:
        assert in_paper(facts) is PaperFailure.PATH_PLANNING  # the goal area is inaccurate


@given(facts=FACTS)
def test_a_surrounded_target_is_one_that_nobody_can_stand_near(facts):
    if in_paper(facts) is PaperFailure.TARGET_SURROUNDED:
        assert facts.target is not None
        assert facts.target.is_surrounded


def test_a_record_of_an_earlier_version_keeps_the_meaning_of_its_class():
    assert Failure("map_quality") is Failure.WRONG_MAP
