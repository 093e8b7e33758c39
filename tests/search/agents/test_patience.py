"""Patience with a robot along its path."""

from hypothesis import given
from hypothesis import strategies as st

from hypernav.search.agents.plan import Climbing, Endurance, Progress

PATIENCE = 10


class Waiting:
    """A patience, asked once a step."""

    def __init__(self, patience):
        self._patience = patience

    def lasts(self, left_m, planned):
        self._patience = self._patience.after(left_m, planned)
        return self._patience.lasts


@given(st.floats(1.0, 50.0), st.lists(st.integers(0, PATIENCE - 1), min_size=1, max_size=30))
def test_who_comes_nearer_is_patiently_waited_for(left_m, pauses):
    progress = Waiting(Progress(PATIENCE))
    for pause in pauses:
        assert all(progress.lasts(left_m, 0) for _ in range(pause + 1))
        left_m -= 0.11


@given(st.floats(0.0, 50.0))
def test_who_stands_still_is_noticed(left_m):
    progress = Waiting(Progress(PATIENCE))
    assert [progress.lasts(left_m, 0) for _ in range(PATIENCE + 2)] == [True] * (PATIENCE + 1) + [
        False
    ]


@given(st.floats(1.0, 10.0), st.floats(0.5, 10.0))
def test_who_goes_to_and_fro_is_noticed(near_m, more_m):
    progress = Waiting(Progress(PATIENCE))
    made = [progress.lasts(near_m + more_m * (step % 2), 0) for step in range(200)]
    assert not made[-1]
    assert sum(made) <= 1 + PATIENCE + 4 * more_m + 1


@given(st.floats(0.2, 3.0), st.floats(1.0, 20.0))
def test_a_detour_at_a_step_forward_and_a_turn_in_turns_is_waited_for(blocked_m, detour_m):
    progress = Waiting(Progress(PATIENCE))
    assert progress.lasts(blocked_m, 0)
    left_m = blocked_m + detour_m
    while left_m > 0.0:
        assert progress.lasts(left_m, 0)
        assert progress.lasts(left_m, 0)
        left_m -= 0.5


@given(st.integers(0, 60))
def test_a_planned_sequence_is_waited_for_and_no_more(planned):
    progress = Waiting(Progress(PATIENCE))
    assert progress.lasts(1.0, planned)
    made = [progress.lasts(1.0, max(planned - step, 0)) for step in range(1, 200)]
    assert made.index(False) == PATIENCE + planned - (planned > 0)


def test_a_value_stays_as_it_is():
    progress = Progress(PATIENCE)
    worn_out = progress
    for _ in range(PATIENCE + 2):
        worn_out = worn_out.after(1.0, 0)
    assert not worn_out.lasts
    assert progress == Progress(PATIENCE)
    assert progress.lasts


@given(st.integers(1, 60), st.lists(st.floats(0.0, 50.0), min_size=61, max_size=61))
def test_endurance_grants_so_many_steps_whatever_they_bring(limit, lefts_m):
    endurance = Waiting(Endurance(limit))
    assert [endurance.lasts(left_m, 0) for left_m in lefts_m].index(False) == limit


@given(st.floats(-2.0, 2.0), st.lists(st.integers(0, PATIENCE), min_size=1, max_size=30))
def test_on_stairs_what_counts_are_the_steps_since_the_robot_came_farthest(height_m, pauses):
    climbing = Climbing(0).after_step(height_m)
    for pause in pauses:
        assert climbing.steps == 0
        for _ in range(pause):  # it stands, or goes back
            climbing = climbing.after_step(height_m - 0.3)
        assert climbing.steps == pause
        height_m += 0.2
        climbing = climbing.after_step(height_m)
