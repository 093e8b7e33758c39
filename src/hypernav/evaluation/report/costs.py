"""The cost of a run's episodes, beside their results."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hypernav.evaluation.record import EpisodeRecord
from hypernav.evaluation.report.run_data import RunData

_TICKS = (0, 1, 3, 10, 30, 100, 300, 1000, 3000, 10_000)


@dataclass(frozen=True)
class CostRow:
    """Cost of an episode of a run, on average over its counted episodes.

    Attributes:
        metres: Path that the robot drove, metres.
        steps: Number of actions.
        seconds: Wall-clock time, simulation included, seconds.
        calls: Number of questions that a chat model answered.
        tokens: Number of tokens that it read and wrote.
        success: Success rate, 0 to 1.
        spl: Mean SPL, 0 to 1.
    """

    metres: float
    steps: float
    seconds: float
    calls: float
    tokens: float
    success: float
    spl: float


@dataclass(frozen=True)
class CallAxis:
    """An axis for the number of calls per episode, from 0 to thousands.

    Attributes:
        ticks: Numbers of calls with their positions on the axis, 0 to 1.
        places: Positions of the runs on the axis, in the order of the runs.
    """

    ticks: tuple[tuple[int, float], ...]
    places: tuple[float, ...]


def costs(runs: Sequence[RunData]) -> list[CostRow]:
    """Cost of an episode in every run."""
    return [_cost(run.counted) for run in runs]


def call_axis(rows: Sequence[CostRow]) -> CallAxis | None:
    """The axis on which the runs are drawn; None if no model was asked in any of them."""
    most = max(row.calls for row in rows)
    if most == 0.0:
        return None
    end = next((tick for tick in _TICKS if tick >= most), math.ceil(most))

    def place(calls: float) -> float:
        return math.log1p(calls) / math.log1p(end)

    ticks = tuple((tick, place(tick)) for tick in _TICKS if tick <= end)
    return CallAxis(ticks, tuple(place(row.calls) for row in rows))


def _cost(records: Sequence[EpisodeRecord]) -> CostRow:
    def mean(values: Sequence[float]) -> float:
        return sum(values) / len(values)

    return CostRow(
        metres=mean([one.path_length_m for one in records]),
        steps=mean([one.steps for one in records]),
        seconds=mean([one.seconds.get("total", 0.0) for one in records]),
        calls=mean([one.model_calls for one in records]),
        tokens=mean([one.tokens_in + one.tokens_out for one in records]),
        success=mean([float(one.success) for one in records]),
        spl=mean([one.spl for one in records]),
    )
