"""The table of the study of goal refinement: shares and drops, with intervals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from hypernav.lab.evaluation.refinement.area_record import AreaRecord, BoxSource, MaskSource
from hypernav.lab.evaluation.statistics import (
    Estimate,
    drawn,
    mean_with_interval,
    ratio_with_interval,
)


def _lies_beside(record: AreaRecord) -> float:
    """1 if most cells of the first goal area lie off the goal, else 0."""
    assert record.first_off is not None, "only records with an area are measured"
    return float(record.first_off > 0.5)


def _of_position(name: str) -> Callable[[AreaRecord], float]:
    """1 if a fact of `GoalPosition` holds for the position of a record, else 0."""
    return lambda record: float(getattr(record.position, name))


MEASURES: dict[str, Callable[[AreaRecord], float]] = {
    "goal area off the goal": _lies_beside,
    "cells off the goal": lambda record: record.seen_off / record.seen,
    "goal in an obstacle": _of_position("in_obstacle"),
    "no path to the goal area": _of_position("unreachable"),
    "goal out of sight at the end": _of_position("occluded"),
    "a STOP there fails": _of_position("fails"),
}
"""The measures of a record with an area, as shares; lower is better.

The paper's vision occlusion is a hidden part of the object that makes the projected goal area
wrong, so "goal area off the goal" counts it; its goal in an obstacle is an area that obstacles
enclose, so that A* fails: "goal in an obstacle" counts where, "no path to the goal area" whether.
"""


@dataclass(frozen=True)
class Measure:
    """One measure of one kind of mask.

    Attributes:
        share: Mean over episodes.
        drop: Relative decrease from the raw box's mean on the same episodes; None for the raw box
            itself, and if its mean is 0.
    """

    share: Estimate
    drop: Estimate | None


@dataclass(frozen=True)
class Row:
    """One row of the table.

    Attributes:
        box: Source of the boxes.
        mask: What was done with them.
        episodes: Number of episodes in which every mask gave a goal area from this box.
        frames: Number of their frames.
        measures: The measures, by the names of `MEASURES`.
        drawn: What their intervals draw: "scenes", or "episodes" where these are of a single one.
    """

    box: BoxSource
    mask: MaskSource
    episodes: int
    frames: int
    measures: dict[str, Measure]
    drawn: str


def table(records: Sequence[AreaRecord]) -> list[Row]:
    """The rows of all kinds of boxes and masks; those without episodes are left out."""
    rows: list[Row] = []
    for box in BoxSource:
        by_mask = _paired([one for one in records if one.box is box])
        raw = by_mask.get(MaskSource.RAW, [])
        rows += [_row(box, mask, by_mask[mask], raw) for mask in MaskSource if by_mask.get(mask)]
    return rows


def drawn_in(rows: Sequence[Row]) -> str:
    """What the intervals of a table draw, for people."""
    if len(kinds := {row.drawn for row in rows}) == 1:
        return kinds.pop()
    return "scenes, or episodes where all of a row are of one scene"


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
    baseline = None if mask is MaskSource.RAW else raw
    return Row(
        box=box,
        mask=mask,
        episodes=len(records),
        frames=sum(record.frames for record in records),
        measures={name: _measure(value, records, baseline) for name, value in MEASURES.items()},
        drawn=drawn(record.scene_id for record in records),
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
    drop = replace(ratio, mean=1.0 - ratio.mean, low=1.0 - ratio.high, high=1.0 - ratio.low)
    return Measure(share, drop)
