"""The correlation within groups is that by which the events were drawn."""

import numpy as np
import pytest

from hypernav.lab.exam.prediction.agreement import agreement_of


def drawn(correlation: float, chance: float, *, groups: int, size: int) -> tuple[list[bool], list]:
    """Events of groups, and the group of each."""
    rng = np.random.default_rng(7)
    common = rng.normal(size=(groups, 1)) * np.sqrt(correlation)
    levels = common + rng.normal(size=(groups, size)) * np.sqrt(1.0 - correlation)
    happened = levels < np.quantile(levels, chance)
    return happened.ravel().tolist(), np.repeat(np.arange(groups), size).tolist()


@pytest.mark.parametrize("correlation", [0.0, 0.4, 0.9])
@pytest.mark.parametrize("chance", [0.1, 0.5])
def test_the_correlation_is_found(correlation: float, chance: float):
    happened, groups = drawn(correlation, chance, groups=200, size=5)
    found = agreement_of(happened, [chance] * len(happened), groups, 0.5)
    assert found == pytest.approx(correlation, abs=0.12)


def test_rare_events_that_have_nothing_in_common_are_not_taken_for_alike():
    happened, groups = drawn(0.0, 0.005, groups=500, size=2)
    found = agreement_of(happened, [0.005] * len(happened), groups, 0.45)
    assert found < 0.5


def test_without_two_events_in_one_group_it_is_the_usual_one():
    assert agreement_of([True, False], [0.5, 0.5], ["a", "b"], 0.46) == pytest.approx(0.46)
    assert agreement_of([], [], [], 0.7) == pytest.approx(0.7)


def test_what_a_chance_explains_is_no_agreement():
    """Groups of events that are sure, and of others that are impossible, tell nothing."""
    happened = [True, True, False, False] * 50
    groups = np.repeat(np.arange(100), 2).tolist()
    explained = agreement_of(happened, [0.99, 0.99, 0.01, 0.01] * 50, groups, 0.3)
    unexplained = agreement_of(happened, [0.5] * 200, groups, 0.3)
    assert explained == pytest.approx(0.3, abs=0.1)
    assert unexplained > 0.9
