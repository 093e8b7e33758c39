"""Patience: how long a robot keeps a destination, and waits for what blocks its way."""

import math

import pytest

from hypernav.search.agents.config import SearchConfig
from hypernav.search.agents.plan import Approaching, Endurance, Progress


def test_steps_without_progress_are_counted_from_the_last_that_brought_some():
    progress = Progress(3).after(5.0, 0)
    assert (progress.shortest_m, progress.steps) == (5.0, 0)
    for steps in (1, 2, 3, 4):
        progress = progress.after(5.0, 0)
        assert (progress.steps, progress.lasts) == (steps, steps <= 3)
    assert progress.after(4.0, 0).steps == 0


@pytest.mark.parametrize(("left_m", "planned"), [(5.0, 4), (7.0, 0), (7.0, 2)])
def test_a_detour_and_planned_actions_are_granted(left_m: float, planned: int):
    def lasting(left_m: float, planned: int) -> int:
        progress, steps = Progress(3).after(5.0, 0), 0
        while (progress := progress.after(left_m, planned)).lasts:
            steps += 1
        return steps

    more = lasting(left_m, planned) - lasting(5.0, 0)
    assert more == lasting(left_m, 0) - lasting(5.0, 0) + planned
    assert (more > planned) == (left_m > 5.0)


def test_endurance_lasts_so_many_steps():
    patience, steps = Endurance(4), 0
    while (patience := patience.after(math.inf, 0)).lasts:
        steps += 1
    assert steps == 4


@pytest.mark.parametrize("steps", range(14))
def test_a_person_may_clear_the_way_for_as_long_as_patience_lasts(steps: int):
    config = SearchConfig(patience_steps=9)
    approaching = Approaching(Progress(9), blocked_steps=steps)
    assert approaching.may_clear(config) == (steps in range(1, 10))
