from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.app.show import episode_summary
from hypernav.app.show.climbs import climbs
from hypernav.core.embodiment import Action
from hypernav.core.trace import Mode, StepTrace

MakeStep = Callable[..., StepTrace]


@given(st.lists(st.sampled_from(Mode), max_size=40))
def test_phases_and_shares_account_for_every_step(modes: list[Mode]) -> None:
    steps = [
        StepTrace(step=n, pose=(0.0, 0.0, 0.0), action=Action.TURN_LEFT, mode=mode)
        for n, mode in enumerate(modes)
    ]
    phases = episode_summary.phases(steps)
    assert [phase.mode for phase in phases for _ in range(phase.count)] == modes
    assert [phase.first for phase in phases] == [
        n for n in range(len(modes)) if n == 0 or modes[n] != modes[n - 1]
    ]
    shares = episode_summary.mode_shares(steps)
    assert sum(share.count for share in shares) == len(modes)
    assert sum(share.share for share in shares) == pytest.approx(1.0 if modes else 0.0)


@given(st.lists(st.tuples(st.sampled_from(Mode), st.integers(1, 3)), max_size=40))
def test_each_stay_on_stairs_is_one_climb(walk: list[tuple[Mode, int]]) -> None:
    steps = [
        StepTrace(step=n, pose=(0.0, 0.0, 0.0), action=None, mode=mode, floor=floor)
        for n, (mode, floor) in enumerate(walk)
    ]
    on_stairs = [one for one in episode_summary.stays(steps) if one.on_stairs]
    made = climbs(steps)
    assert [(one.floor, one.first) for one in on_stairs] == [(c.floor, c.first) for c in made]
    assert [one.first + one.count - 1 for one in on_stairs] == [c.last for c in made]


def test_tokens_are_added_up(make_step: MakeStep) -> None:
    assert episode_summary.tokens([make_step(n) for n in range(6)]) == (200, 10)


@pytest.mark.parametrize(
    "seconds",
    [
        {"total": 10.0, "map": 0.5, "local": 7.0},
        {"total": 10.0, "modules": {"map": 0.5, "local": 7.0}},
        {"total": 10.0, "per_module": {"map": 0.5, "local": 7.0}},
    ],
)
def test_times_are_read_in_every_form_and_add_up_to_the_total(seconds: dict[str, object]) -> None:
    times = episode_summary.module_times({"seconds": seconds}, [])
    assert [time.name for time in times] == [
        "looking for the goal",
        "everything else",
        "drawing the map",
    ]
    assert sum(time.seconds for time in times) == pytest.approx(10.0)
    assert sum(time.of_total for time in times) == pytest.approx(1.0)
    assert times[0].share == 1.0


def test_times_come_from_the_trace_where_the_result_has_none(make_step: MakeStep) -> None:
    times = episode_summary.module_times({}, [make_step(n) for n in range(6)])
    by_name = {time.name: time for time in times}
    assert by_name["choosing where to look"].seconds == pytest.approx(1.0)
    assert by_name["choosing where to look"].typical_s == pytest.approx(0.5)
    assert by_name["drawing the map"].typical_s == pytest.approx(0.002)


@pytest.mark.parametrize("seconds", [None, 12.5, {}, {"total": None}, {"total": "?", "map": None}])
def test_missing_times_are_no_problem(seconds: object) -> None:
    assert episode_summary.module_times({"seconds": seconds}, []) == []
