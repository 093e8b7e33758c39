from collections.abc import Callable

from hypothesis import given
from hypothesis import strategies as st

from hypernav.app.show import episode_summary
from hypernav.core.trace import DetectionRecord, Mode, StepTrace

MakeStep = Callable[..., StepTrace]


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
