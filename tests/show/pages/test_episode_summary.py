from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.actions import Action
from hypernav.core.trace import DetectionRecord, Mode, StepTrace
from hypernav.show.pages import episode_summary

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


def test_moments_are_decisions_and_events(make_step: MakeStep, sighting: DetectionRecord) -> None:
    ground = make_step(2).exchanges[:1]
    steps = [
        make_step(0),
        make_step(1, events=["goal seen"], detections=[sighting], exchanges=ground),
        make_step(2),
        make_step(4, exchanges=ground, detections=[sighting]),
    ]
    key_steps = episode_summary.key_steps(steps)
    assert [moment.index for moment in key_steps] == [1, 2]
    seen, decided = key_steps
    assert seen.asked[0].answer == "sees “bed”, 83% sure"
    assert [asked.title for asked in decided.asked] == ["Where to look next?"]
    assert decided.asked[0].likeliest == (("2", 0.8), ("1", 0.2))


def test_a_question_asked_again_on_the_way_is_folded_into_the_first(make_step: MakeStep) -> None:
    asks = make_step(2).exchanges
    steps = [
        make_step(0, exchanges=asks),
        make_step(1, exchanges=asks),
        make_step(3, exchanges=asks),
        make_step(4, exchanges=asks, events=["destination reached"]),
        make_step(6, exchanges=asks, mode=Mode.APPROACH),
        make_step(7, exchanges=asks, mode=Mode.APPROACH),
    ]
    entries = episode_summary.entries(episode_summary.key_steps(steps))
    told = [(one.lead.index, [again.index for again in one.again]) for one in entries]
    assert told == [(0, []), (1, [2]), (3, []), (4, [5])], "step 0 looks around"


@given(st.lists(st.tuples(st.sampled_from(Mode), st.integers(1, 3)), max_size=40))
def test_chapters_tell_every_decision_once_and_in_order(walk: list[tuple[Mode, int]]) -> None:
    steps = [
        StepTrace(step=n, pose=(0.0, 0.0, 0.0), action=None, mode=mode, floor=floor, events=["it"])
        for n, (mode, floor) in enumerate(walk)
    ]
    chapters = episode_summary.chapters(steps)
    entries = [entry for chapter in chapters for entry in chapter.entries]
    told = [one.index for entry in entries for one in (entry.lead, *entry.again)]
    assert told == list(range(len(steps)))
    assert sum(chapter.count for chapter in chapters) == len(steps)
    climbing = [chapter for chapter in chapters if chapter.mode is Mode.CLIMB]
    assert sum(one.count for one in climbing) == sum(mode is Mode.CLIMB for mode, _ in walk)


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
