from dataclasses import replace

import pytest

from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.refinement.area_record import AreaRecord, BoxSource, MaskSource
from hypernav.lab.evaluation.refinement.footprint import OffTarget
from hypernav.lab.evaluation.refinement.goal_position import GoalPosition
from hypernav.lab.evaluation.refinement.summary import MEASURES, drawn_in, table
from small_episodes import episode_from

EPISODE = episode_from(Pose2(0.0, 0.0, 0.0))
GOOD = GoalPosition(in_obstacle=False, unreachable=False, occluded=False, fails=False)
OFF = "cells off the goal"
BESIDE = "goal area off the goal"


def record(mask, off, position=GOOD, *, number=0, frames=1, box=BoxSource.TRUE):
    """A record of an episode with so many of 10 cells off the goal in every frame."""
    episode = replace(EPISODE, episode_id=str(number), scene_id=f"scene {number}")
    one = replace(AreaRecord.begun(episode, box, mask), position=position)
    for _ in range(frames):
        one = one.after(None if off is None else OffTarget(10, off))
    return one


def episode(number, raw, refined, **values):
    return [
        record(MaskSource.RAW, raw, number=number, **values),
        record(MaskSource.BOX, raw, number=number, **values),
        record(MaskSource.SEGMENTED, refined, number=number, **values),
        record(MaskSource.TRUE, 0, number=number, **values),
    ]


def test_drops_are_shares_of_the_raw_box():
    rows = table([*episode(0, 4, 1), *episode(1, 6, 2)])
    raw, _, refined, true = (row.measures[OFF] for row in rows)
    assert refined.drop is not None
    assert true.drop is not None
    assert [row.mask for row in rows] == list(MaskSource)
    assert raw.share.mean == pytest.approx(0.5)
    assert raw.drop is None
    assert refined.share.mean == pytest.approx(0.15)
    assert refined.drop.mean == pytest.approx(0.7)
    assert true.drop.mean == pytest.approx(1.0)


def test_every_episode_counts_alike_however_many_frames_it_has():
    rows = table([*episode(0, 8, 0, frames=1), *episode(1, 0, 0, frames=9)])
    assert rows[0].measures[OFF].share.mean == pytest.approx(0.4)


def test_an_episode_that_a_mask_left_nothing_of_is_in_no_row():
    rows = table([*episode(0, 4, 1), *episode(1, 6, None)])
    assert {row.episodes for row in rows} == {1}
    assert table(episode(0, 4, None)) == []


def test_where_the_raw_box_has_nothing_to_drop_there_is_no_drop():
    assert table(episode(0, 0, 0))[2].measures[OFF].drop is None


def test_an_area_is_off_the_goal_if_most_of_its_cells_are():
    shares = [table(episode(0, raw, 0))[0].measures[BESIDE].share.mean for raw in (0, 4, 5, 6, 10)]
    assert shares == [0.0, 0.0, 0.0, 1.0, 1.0]


def test_whether_an_area_is_off_the_goal_is_told_by_the_first_one():
    first, later = OffTarget(10, 6), OffTarget(1000, 0)
    one = replace(record(MaskSource.RAW, None), position=GOOD).after(first).after(later)
    others = [record(mask, 2) for mask in MaskSource if mask is not MaskSource.RAW]
    raw = table([one, *others])[0].measures
    assert raw[BESIDE].share.mean == 1.0
    assert raw[OFF].share.mean == pytest.approx(6 / 1010)


def test_areas_of_boxes_that_show_what_lies_behind_drop_as_the_papers_do():
    rows = table([*episode(0, 8, 1), *episode(1, 7, 6), *episode(2, 9, 0), *episode(3, 2, 0)])
    raw, _, refined, _ = (row.measures[BESIDE] for row in rows)
    assert raw.share.mean == pytest.approx(0.75)
    assert refined.drop is not None
    assert refined.drop.mean == pytest.approx(2 / 3)


@pytest.mark.parametrize(
    ("fact", "measure"),
    [
        ("in_obstacle", "goal in an obstacle"),
        ("occluded", "goal out of sight at the end"),
        ("unreachable", "no path to the goal area"),
        ("fails", "a STOP there fails"),
    ],
)
def test_each_fact_of_a_position_is_counted_by_itself(fact, measure):
    row = table(episode(0, 0, 0, position=replace(GOOD, **{fact: True})))[0]
    shares = {name: one.share.mean for name, one in row.measures.items()}
    assert shares == dict.fromkeys(MEASURES, 0.0) | {measure: 1.0}


def test_intervals_draw_episodes_where_there_is_one_scene():
    several = table([*episode(0, 4, 1), *episode(1, 6, 2)])
    one = table(episode(0, 4, 1, box=BoxSource.DETECTED))
    assert drawn_in(several) == "scenes"
    assert drawn_in(one) == "episodes"
    assert drawn_in([*several, *one]).startswith("scenes, or episodes where")
