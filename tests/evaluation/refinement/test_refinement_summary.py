from dataclasses import replace

import pytest

from hypernav.core.geometry.transforms import Pose2
from hypernav.evaluation.refinement.area_record import AreaRecord, BoxSource, MaskSource
from hypernav.evaluation.refinement.footprint import OffTarget
from hypernav.evaluation.refinement.goal_position import GoalPosition
from hypernav.evaluation.refinement.summary import table
from small_episodes import episode_from

EPISODE = episode_from(Pose2(0.0, 0.0, 0.0))


def record(mask, off, position=GoalPosition.GOOD, *, number=0, frames=1, box=BoxSource.TRUE):
    """A record of an episode with so many of 10 cells off the goal in every frame."""
    episode = replace(EPISODE, episode_id=str(number), scene_id=f"scene {number}")
    one = replace(AreaRecord.begun(episode, box, mask), position=position)
    for _ in range(frames):
        one = one.after(None if off is None else OffTarget(10, off, 20, off))
    return one


def episode(number, raw, refined, **values):
    return [
        record(MaskSource.BOX, raw, number=number, **values),
        record(MaskSource.SEGMENTED, refined, number=number, **values),
        record(MaskSource.TRUE, 0, number=number, **values),
    ]


def test_drops_are_shares_of_the_raw_box():
    rows = table([*episode(0, 4, 1), *episode(1, 6, 2)])
    raw, refined, true = rows
    assert refined.off_target.drop is not None
    assert true.off_target.drop is not None
    assert [row.mask for row in rows] == list(MaskSource)
    assert raw.off_target.share.mean == pytest.approx(0.5)
    assert raw.off_target.drop is None
    assert refined.off_target.share.mean == pytest.approx(0.15)
    assert refined.off_target.drop.mean == pytest.approx(0.7)
    assert true.off_target.drop.mean == pytest.approx(1.0)


def test_every_episode_counts_alike_however_many_frames_it_has():
    rows = table([*episode(0, 8, 0, frames=1), *episode(1, 0, 0, frames=9)])
    assert rows[0].off_target.share.mean == pytest.approx(0.4)


def test_an_episode_that_a_mask_left_nothing_of_is_in_no_row():
    rows = table([*episode(0, 4, 1), *episode(1, 6, None)])
    assert {row.episodes for row in rows} == {1}
    assert table(episode(0, 4, None)) == []


def test_where_the_raw_box_has_nothing_to_drop_there_is_no_drop():
    assert table(episode(0, 0, 0))[1].off_target.drop is None


@pytest.mark.parametrize(
    ("position", "useless", "no_success"),
    [
        (GoalPosition.GOOD, 0.0, 0.0),
        (GoalPosition.TOO_FAR, 0.0, 1.0),
        (GoalPosition.UNREACHABLE, 1.0, 1.0),
        (GoalPosition.OCCLUDED, 1.0, 1.0),
        (GoalPosition.NONE, 1.0, 1.0),
    ],
)
def test_positions_are_judged_by_their_kind(position, useless, no_success):
    row = table(episode(0, 4, 1, position=position))[0]
    assert (row.useless.share.mean, row.no_success.share.mean) == (useless, no_success)
    assert row.positions[position] == 1
