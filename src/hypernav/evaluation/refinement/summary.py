"""The table of the study of goal refinement: shares and drops, with intervals over scenes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hypernav.evaluation.refinement.area_record import AreaRecord, BoxSource, MaskSource
from hypernav.evaluation.refinement.goal_position import GoalPosition
from hypernav.evaluation.statistics import Estimate, mean_with_interval, ratio_with_interval


def off_target_share(record: AreaRecord) -> float:
    """Share of the seen cells that lie off the goal."""
    return record.seen_off / record.seen


def off_target_share_dilated(record: AreaRecord) -> float:
    """Share of the dilated cells that lie farther from the goal than dilation reaches."""
    return record.dilated_off / record.dilated


def is_useless(record: AreaRecord) -> float:
    """1 if the goal position is unreachable or occluded or there is none, else 0."""
    return float(record.position not in (GoalPosition.GOOD, GoalPosition.TOO_FAR))


def is_no_success(record: AreaRecord) -> float:
    """1 if a STOP at the goal position is no success, or the robot doesn't get there, else 0."""
    return float(record.position is not GoalPosition.GOOD)


@dataclass(frozen=True)
class Measure:
    """One measure of one kind of mask.

    Attributes:
        share: Mean over episodes.
        drop: Share of the raw box's mean by which it is lower, on the same episodes; None for the
            raw box itself, and where the raw box leaves nothing to drop.
    """

    share: Estimate
    drop: Estimate | None


@dataclass(frozen=True)
class Row:
    """One row of the table.

    Attributes:
        box: Source of the boxes.
        mask: What was projected of them.
        episodes: Number of episodes with a goal area of this box by every mask.
        frames: Number of their frames.
        off_target: Share of the seen cells off the goal.
        off_target_dilated: Share of the dilated cells off the goal.
        useless: Share of the goal positions that are unreachable or occluded.
        no_success: Share of the goal positions at which a STOP fails, useless ones included.
        positions: Number of the goal positions of each kind.
    """

    box: BoxSource
    mask: MaskSource
    episodes: int
    frames: int
    off_target: Measure
    off_target_dilated: Measure
    useless: Measure
    no_success: Measure
    positions: dict[GoalPosition, int]


def table(records: Sequence[AreaRecord]) -> list[Row]:
    """The rows of all kinds of boxes and masks; those without episodes are left out."""
    rows: list[Row] = []
    for box in BoxSource:
        by_mask = _paired([one for one in records if one.box is box])
        raw = by_mask.get(MaskSource.BOX, [])
        rows += [_row(box, mask, by_mask[mask], raw) for mask in MaskSource if by_mask.get(mask)]
    return rows


def _paired(records: Sequence[AreaRecord]) -> dict[MaskSource, list[AreaRecord]]:
    """Records by mask, of the same episodes in the same order.

    Episodes in which a mask never gave a goal area have no shares, so they are left out.
    """
    by_episode: dict[tuple[str, str], dict[MaskSource, AreaRecord]] = {}
    for record in records:
        by_episode.setdefault((record.scene_id, record.episode_id), {})[record.mask] = record
    whole = [
        found
        for _, found in sorted(by_episode.items())
        if len(found) == len(MaskSource) and all(one.seen > 0 for one in found.values())
    ]
    return {mask: [found[mask] for found in whole] for mask in MaskSource}


def _row(
    box: BoxSource, mask: MaskSource, records: Sequence[AreaRecord], raw: Sequence[AreaRecord]
) -> Row:
    baseline = None if mask is MaskSource.BOX else raw
    return Row(
        box=box,
        mask=mask,
        episodes=len(records),
        frames=sum(record.frames for record in records),
        off_target=_measure(off_target_share, records, baseline),
        off_target_dilated=_measure(off_target_share_dilated, records, baseline),
        useless=_measure(is_useless, records, baseline),
        no_success=_measure(is_no_success, records, baseline),
        positions={
            kind: sum(record.position is kind for record in records) for kind in GoalPosition
        },
    )


def _measure(
    value: Callable[[AreaRecord], float],
    records: Sequence[AreaRecord],
    raw: Sequence[AreaRecord] | None,
) -> Measure:
    scenes = [record.scene_id for record in records]
    values = [value(record) for record in records]
    share = mean_with_interval(values, scenes)
    references = [] if raw is None else [value(record) for record in raw]
    if sum(references) == 0.0:
        return Measure(share, None)
    ratio = ratio_with_interval(values, references, scenes)
    drop = Estimate(1.0 - ratio.mean, 1.0 - ratio.high, 1.0 - ratio.low, ratio.count)
    return Measure(share, drop)
