"""What a trace tells of stairs and floors."""

from collections.abc import Callable

import pytest

from hypernav.app.show.climbs import (
    Climb,
    StairsMark,
    climb_words,
    climbs,
    floor_heights_m,
    floor_words,
    stairs_by_step,
    stairs_on,
    typical_steps,
    whereabouts,
)
from hypernav.core.trace import Mode, StepTrace

MakeStep = Callable[..., StepTrace]


def walk(make_step: MakeStep, *stretches: tuple[Mode, int | None, int]) -> list[StepTrace]:
    """Steps of 1 m each along x, in stretches of one mode on one floor."""
    modes = [(mode, floor) for mode, floor, count in stretches for _ in range(count)]
    return [
        make_step(k, mode=mode, floor=floor, pose=(float(k), 0.0, 0.0))
        for k, (mode, floor) in enumerate(modes)
    ]


def test_stairs_lead_from_where_the_climb_began_to_where_it_ended(make_step: MakeStep) -> None:
    steps = walk(make_step, (Mode.EXPLORE, None, 3), (Mode.CLIMB, None, 4), (Mode.EXPLORE, 2, 2))
    made = climbs(steps)
    assert made == [Climb(3, 6, 1, 2, given_up=False, ends=((3.0, 0.0), (6.0, 0.0)))]
    assert stairs_on(1, made) == [StairsMark((3.0, 0.0), "to floor 2")]
    assert stairs_on(2, made) == [StairsMark((6.0, 0.0), "to floor 1")]
    assert stairs_on(3, made) == []


def test_stairs_say_whether_they_lead_up_or_down(make_step: MakeStep) -> None:
    steps = walk(make_step, (Mode.EXPLORE, None, 2), (Mode.CLIMB, None, 3), (Mode.EXPLORE, 2, 1))
    risen = [
        one.model_copy(update={"z": z}) for one, z in zip(steps, (0, 0, 0, 1, 2, 3), strict=True)
    ]
    assert [one.words for one in stairs_on(1, climbs(risen))] == ["up to floor 2"]
    assert [one.words for one in stairs_on(2, climbs(risen))] == ["down to floor 1"]


def test_stairs_that_were_given_up_are_no_way(make_step: MakeStep) -> None:
    steps = walk(make_step, (Mode.CLIMB, 2, 3), (Mode.EXPLORE, 2, 1))
    given_up = steps[3].model_copy(update={"events": ["stairs given up"]})
    made = climbs([*steps[:3], given_up])
    assert [one.given_up for one in made] == [True]
    assert stairs_on(2, made) == [StairsMark((0.0, 0.0), "no way")]
    assert climb_words(made[0], 1, {}).startswith("Stairs tried in vain")


def test_after_each_step_there_are_the_stairs_that_its_trace_tells_of(make_step: MakeStep) -> None:
    stretches = [(Mode.EXPLORE, None, 2), (Mode.CLIMB, None, 3), (Mode.EXPLORE, 2, 3)]
    stretches += [(Mode.CLIMB, 2, 2), (Mode.EXPLORE, 3, 2), (Mode.CLIMB, 3, 2), (Mode.STOP, 3, 1)]
    steps = walk(make_step, *stretches)
    steps[-1] = steps[-1].model_copy(update={"events": ["stairs given up"]})
    changes = stairs_by_step(iter(steps))  # one pass over them is enough
    assert list(changes) == [2, 5, 8, 10, 12, 14]
    for last in range(len(steps)):
        since = max((one for one in changes if one <= last), default=-1)
        for floor in (1, 2, 3):
            expected = stairs_on(floor, climbs(steps[: last + 1]))
            assert changes.get(since, {}).get(floor, []) == expected


def test_stairs_on_which_the_robot_is_are_not_given_up(make_step: MakeStep) -> None:
    made = climbs(walk(make_step, (Mode.EXPLORE, 2, 1), (Mode.CLIMB, 2, 3)))
    assert stairs_on(2, made) == [StairsMark((1.0, 0.0), "stairs")]


def test_stairs_that_were_taken_once_lead_there() -> None:
    begun = Climb(3, 4, 1, None, given_up=True, ends=((0.0, 0.0), (1.0, 0.0)))
    taken = Climb(9, 12, 1, 2, given_up=False, ends=((0.5, 0.0), (3.0, 0.0)))
    mark = StairsMark((0.5, 0.0), "to floor 2")
    assert stairs_on(1, [begun, taken]) == [mark] == stairs_on(1, [taken, begun])


def test_of_two_flights_that_begin_at_one_landing_both_are_marked() -> None:
    down = Climb(0, 2, 1, 2, given_up=False, ends=((5.0, 0.0), (0.0, 0.0)))
    up = Climb(5, 9, 2, 3, given_up=False, ends=((0.5, 0.0), (5.0, 0.0)))
    marks = [StairsMark((0.0, 0.0), "to floor 1"), StairsMark((0.5, 0.0), "to floor 3")]
    assert stairs_on(2, [down, up]) == marks
    again = Climb(12, 14, 2, 3, given_up=False, ends=((0.4, 0.0), (5.0, 0.0)))
    assert stairs_on(2, [down, up, again]) == [marks[0], StairsMark((0.4, 0.0), "to floor 3")]


def test_each_step_is_on_a_floor_or_on_stairs_between_two(make_step: MakeStep) -> None:
    stretches = [(Mode.EXPLORE, None, 1), (Mode.CLIMB, None, 2), (Mode.EXPLORE, 2, 1)]
    steps = walk(make_step, *stretches, (Mode.CLIMB, 2, 1))
    assert whereabouts(steps) == [
        "on floor 1",
        *["on the stairs from floor 1 to floor 2"] * 2,
        "on floor 2",
        "on the stairs from floor 2",
    ]


def test_a_search_that_knows_one_floor_names_none(make_step: MakeStep) -> None:
    assert whereabouts(walk(make_step, (Mode.EXPLORE, None, 3))) == ["", "", ""]


def test_a_floor_is_as_high_as_the_robot_in_the_middle_of_its_stay_there(
    make_step: MakeStep,
) -> None:
    stretches = [(Mode.EXPLORE, None, 4), (Mode.CLIMB, None, 2), (Mode.EXPLORE, 2, 3)]
    assert typical_steps(walk(make_step, *stretches)) == {1: 2, 2: 7}
    assert typical_steps([]) == {}


def test_floors_are_as_high_as_the_robot_was_off_the_stairs(make_step: MakeStep) -> None:
    steps = walk(make_step, (Mode.EXPLORE, None, 3), (Mode.CLIMB, None, 2), (Mode.EXPLORE, 2, 3))
    heights_m = [0.0, 0.03, 0.03, 1.0, 2.0, 2.9, 3.0, 3.0]
    pairs = zip(steps, heights_m, strict=True)
    assert floor_heights_m(one.model_copy(update={"z": z}) for one, z in pairs) == {1: 0.03, 2: 3.0}


@pytest.mark.parametrize(
    ("heights_m", "words"),
    [
        ({}, "Floor 2"),
        ({1: 0.9, 2: 3.9}, "Floor 2 (3.0 m above the start)"),
        ({1: 0.9, 2: -1.7}, "Floor 2 (2.6 m below the start)"),
        ({1: 0.9, 2: 1.0}, "Floor 2"),
        ({2: 3.9}, "Floor 2"),
    ],
)
def test_a_floor_is_above_or_below_the_start(heights_m: dict[int, float], words: str) -> None:
    assert floor_words(2, 1, heights_m) == words


def test_a_search_may_begin_on_any_floor_that_is_remembered() -> None:
    heights_m = {1: 0.0, 2: 3.0}
    assert floor_words(2, 2, heights_m) == "Floor 2 (start)"
    assert floor_words(1, 2, heights_m) == "Floor 1 (3.0 m below the start)"


@pytest.mark.parametrize(
    ("heights_m", "words"),
    [
        ({1: 0.0, 2: 3.0}, "Up the stairs from floor 1 to floor 2 (3.0 m above the start)"),
        ({1: 3.0, 2: 0.0}, "Down the stairs from floor 1 to floor 2 (3.0 m below the start)"),
        ({}, "Over the stairs from floor 1 to floor 2"),
    ],
)
def test_a_climb_goes_up_or_down(heights_m: dict[int, float], words: str) -> None:
    climb = Climb(0, 3, 1, 2, given_up=False, ends=((0.0, 0.0), (1.0, 0.0)))
    assert climb_words(climb, 1, heights_m) == words
