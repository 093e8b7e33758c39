"""Progress of a robot along its path."""

from hypothesis import given
from hypothesis import strategies as st

from hypernav.agents.progress import Endurance, Progress

PATIENCE = 10


@given(st.floats(1.0, 50.0), st.lists(st.integers(0, PATIENCE - 1), min_size=1, max_size=30))
def test_who_comes_nearer_is_patiently_waited_for(left_m, pauses):
    progress = Progress(PATIENCE)
    for pause in pauses:
        assert all(progress.lasts(left_m, 0) for _ in range(pause + 1))
        left_m -= 0.11


@given(st.floats(0.0, 50.0))
def test_who_stands_still_is_noticed(left_m):
    progress = Progress(PATIENCE)
    assert [progress.lasts(left_m, 0) for _ in range(PATIENCE + 2)] == [True] * (PATIENCE + 1) + [
        False
    ]


@given(st.floats(1.0, 10.0), st.floats(0.5, 10.0))
def test_who_goes_to_and_fro_is_noticed(near_m, more_m):
    progress = Progress(PATIENCE)
    made = [progress.lasts(near_m + more_m * (step % 2), 0) for step in range(200)]
    assert not made[-1]
    assert sum(made) <= 1 + PATIENCE + 4 * more_m + 1


@given(st.floats(0.2, 3.0), st.floats(1.0, 20.0))
def test_a_detour_at_a_step_forward_and_a_turn_in_turns_is_waited_for(blocked_m, detour_m):
    progress = Progress(PATIENCE)
    assert progress.lasts(blocked_m, 0)
    left_m = blocked_m + detour_m
    while left_m > 0.0:
        assert progress.lasts(left_m, 0)
        assert progress.lasts(left_m, 0)
        left_m -= 0.5


@given(st.integers(0, 60))
def test_a_planned_sequence_is_waited_for_and_no_more(planned):
    progress = Progress(PATIENCE)
    assert progress.lasts(1.0, planned)
    made = [progress.lasts(1.0, max(planned - step, 0)) for step in range(1, 200)]
    assert made.index(False) == PATIENCE + planned - (planned > 0)


def test_another_way_begins_anew():
    progress = Progress(PATIENCE)
    made = [progress.lasts(1.0, 0) for _ in range(PATIENCE + 2)]
    assert not made[-1]
    progress.reset()
    assert progress.lasts(1.0, 0)


@given(st.integers(1, 60), st.lists(st.floats(0.0, 50.0), min_size=61, max_size=61))
def test_endurance_grants_so_many_steps_whatever_they_bring(limit, lefts_m):
    endurance = Endurance(limit)
    for _ in range(2):
        assert [endurance.lasts(left_m, 0) for left_m in lefts_m].index(False) == limit
        endurance.reset()
