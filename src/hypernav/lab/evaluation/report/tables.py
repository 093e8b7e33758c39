"""Tables of a report, as data; their layout is in the template."""

import math
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.protocol import PROTOCOLS, EvaluationProtocol, StopRule
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.report.run_data import RunData
from hypernav.lab.evaluation.statistics import (
    Comparison,
    Discordance,
    Estimate,
    Summary,
    compare,
    discordance,
    drawn,
    failure_counts,
    mean_with_interval,
    ratio_with_interval,
    summarise,
)

DISTANCE_BINS_M = (0.0, 3.0, 5.0, 8.0, 12.0, math.inf)
"""Edges of the classes of shortest distance, metres."""


@dataclass(frozen=True)
class Group:
    """Episodes that have something in common, in all runs of a report.

    Attributes:
        name: Common property of the episodes.
        count: Number of distinct episodes in all runs.
        success: Success rate in every run; None where it has no such episode.
        spl: Mean SPL in every run.
    """

    name: str
    count: int
    success: list[Estimate | None]
    spl: list[Estimate | None]


@dataclass(frozen=True)
class FailureRow:
    """Frequency of a failure class in every run.

    Attributes:
        failure: Failure class.
        counts: Number of episodes in every run.
        shares: Share of the run's counted episodes; of all episodes for classes that stand apart.
    """

    failure: Failure
    counts: list[int]
    shares: list[float]


@dataclass(frozen=True)
class MetresRow:
    """How far a run drove before and after the goal was first in the image.

    Attributes:
        explored: Path until the goal was first in the image, divided by the shortest path from the
            start; over all counted episodes in which it was, and whose goal can be reached.
        approached: Path from then to STOP, divided by the shortest path from there; over successes
            only, because other episodes never arrive.
        unseen: Share of the counted episodes in which the goal was never in the image.
    """

    explored: Estimate
    approached: Estimate
    unseen: Estimate


@dataclass(frozen=True)
class ModuleRow:
    """Time of one module in every run.

    Attributes:
        name: Name of the module.
        milliseconds: Mean time per step, milliseconds.
        shares: Share of the total time.
    """

    name: str
    milliseconds: list[float]
    shares: list[float]


@dataclass(frozen=True)
class Pair:
    """Two runs on the episodes that both have done.

    Attributes:
        first: Name of the run that is compared with.
        second: Name of the other.
        count: Episodes that both have.
        success: Difference of the success rates.
        spl: Difference of SPL.
        soft_spl: Difference of SoftSPL.
        steps: Difference of the number of steps.
        outcomes: Numbers of episodes that both, one or neither found.
        drawn: What intervals and tests draw; see `hypernav.lab.evaluation.statistics.drawn`.
    """

    first: str
    second: str
    count: int
    success: Comparison
    spl: Comparison
    soft_spl: Comparison
    steps: Comparison
    outcomes: Discordance
    drawn: str


def overall(runs: Sequence[RunData]) -> list[Summary]:
    """The numbers of every run under its own protocol."""
    return [summarise(run.records, own_protocol(run)) for run in runs]


def own_protocol(run: RunData) -> EvaluationProtocol:
    """The protocol that a run was made for."""
    told = run.configuration["protocol"]
    return EvaluationProtocol(float(told["success_distance_m"]), StopRule(told["stop_rule"]))


def protocol_matrix(
    run: RunData,
) -> dict[StopRule, list[tuple[EvaluationProtocol, Summary | None]]]:
    """A run under every protocol, by stop rule; None if its records can't be scored like that."""
    matrix: dict[StopRule, list[tuple[EvaluationProtocol, Summary | None]]] = {}
    for protocol in PROTOCOLS:
        summary = summarise(run.records, protocol) if protocol.can_score(run.counted) else None
        matrix.setdefault(protocol.stop_rule, []).append((protocol, summary))
    return matrix


def by_scene(runs: Sequence[RunData]) -> list[Group]:
    """A group for every scene, in order of its name."""
    return _grouped(runs, lambda record: record.scene_id, sorted)


def by_goal(runs: Sequence[RunData]) -> list[Group]:
    """A group for every goal, most frequent first."""
    counts = Counter(record.goal for record in _distinct(runs))
    return _grouped(
        runs,
        lambda record: record.goal,
        lambda names: sorted(names, key=lambda name: (-counts[name], name)),
    )


def by_part(runs: Sequence[RunData]) -> list[Group]:
    """A group for every part of the data set ("unseen"); empty if it has none."""
    found = _grouped(runs, lambda record: record.group, sorted)
    return [] if [group.name for group in found] == [""] else found


def by_distance(runs: Sequence[RunData]) -> list[Group]:
    """A group for every class of shortest distance, nearest first."""
    return _grouped(
        runs,
        lambda record: _distance_class(record.shortest_path_m),
        lambda names: [name for name in _class_names() if name in set(names)],
    )


def failures(runs: Sequence[RunData]) -> list[FailureRow]:
    """Every class that occurs in some run, most frequent first, those apart last."""
    counts = [failure_counts(run.records) for run in runs]
    found = [failure for failure in Failure if any(failure in c for c in counts)]
    found.sort(key=lambda f: (f.is_apart, -sum(c.get(f, 0) for c in counts)))
    return [
        FailureRow(
            failure,
            [c.get(failure, 0) for c in counts],
            [
                c.get(failure, 0) / len(run.records if failure.is_apart else run.counted)
                for c, run in zip(counts, runs, strict=True)
            ],
        )
        for failure in found
    ]


def metres(runs: Sequence[RunData]) -> list[MetresRow]:
    """How far every run drove before and after it first saw the goal."""
    return [_metres(run.counted) for run in runs]


def _metres(records: Sequence[EpisodeRecord]) -> MetresRow:
    scenes = [record.scene_id for record in records]
    explored = [
        (r.explored_m, r.shortest_path_m, r.scene_id)
        for r in records
        if r.explored_m is not None and 0.0 < r.shortest_path_m < math.inf
    ]
    approached = [
        (r.approached_m, r.shortest_from_sight_m, r.scene_id)
        for r in records
        if r.success and r.approached_m is not None and 0.0 < r.shortest_from_sight_m < math.inf
    ]
    return MetresRow(
        explored=_ratio(explored),
        approached=_ratio(approached),
        unseen=mean_with_interval([float(r.explored_m is None) for r in records], scenes),
    )


def _ratio(parts: Sequence[tuple[float, float, str]]) -> Estimate:
    paths, shortest, scenes = zip(*parts, strict=True) if parts else ((), (), ())
    return ratio_with_interval(paths, shortest, scenes)


def module_times(runs: Sequence[RunData]) -> list[ModuleRow]:
    """Time per module, longest first; the remainder is "everything else"."""
    means = [_milliseconds_a_step(run.records) for run in runs]
    names = sorted(
        {name for mean in means for name in mean if name != "total"},
        key=lambda name: -max(mean.get(name, 0.0) for mean in means),
    )
    return [
        ModuleRow(
            name,
            [mean.get(name, 0.0) for mean in means],
            [mean.get(name, 0.0) / mean["total"] if mean["total"] else 0.0 for mean in means],
        )
        for name in names
    ]


def questions_a_step(runs: Sequence[RunData]) -> dict[str, list[float]]:
    """Questions per step of every kind, in every run."""
    totals = [Counter[str]() for _ in runs]
    for total, run in zip(totals, runs, strict=True):
        for record in run.records:
            total.update(record.questions)
    steps = [max(sum(record.steps for record in run.records), 1) for run in runs]
    kinds = sorted({kind for total in totals for kind in total})
    return {kind: [t[kind] / n for t, n in zip(totals, steps, strict=True)] for kind in kinds}


def pairs(runs: Sequence[RunData]) -> list[Pair]:
    """Every run against the first one.

    Raises:
        RunFolderError: One shares no episode with it.
    """
    found = [pair(runs[0], other) for other in runs[1:]]
    if missing := [one for one in found if one.count == 0]:
        raise RunFolderError(
            f"{missing[0].first} and {missing[0].second} have no episode in common; only runs of "
            "the same data set can be compared"
        )
    return found


def pair(first: RunData, second: RunData) -> Pair:
    """The second run against the first, on the episodes that count in both."""
    a, b = first.by_key, second.by_key
    keys = [key for key in a if key in b]
    protocol = own_protocol(first)
    scores = [(protocol.score(a[key]), protocol.score(b[key])) for key in keys]
    scenes = [key[0] for key in keys]

    def compared(value: Callable[[int], tuple[float, float]]) -> Comparison:
        values = [value(index) for index in range(len(keys))]
        return compare([x for x, _ in values], [y for _, y in values], scenes)

    return Pair(
        first=first.name,
        second=second.name,
        count=len(keys),
        success=compared(lambda k: (float(scores[k][0].success), float(scores[k][1].success))),
        spl=compared(lambda k: (scores[k][0].spl, scores[k][1].spl)),
        soft_spl=compared(lambda k: (scores[k][0].soft_spl, scores[k][1].soft_spl)),
        steps=compared(lambda k: (float(a[keys[k]].steps), float(b[keys[k]].steps))),
        outcomes=discordance([x.success for x, _ in scores], [y.success for _, y in scores]),
        drawn=drawn(scenes),
    )


def _grouped(
    runs: Sequence[RunData],
    name_of: Callable[[EpisodeRecord], str],
    order: Callable[[list[str]], list[str]],
) -> list[Group]:
    counts = Counter(name_of(record) for record in _distinct(runs))
    groups = []
    for name in order(list(counts)):
        success: list[Estimate | None] = []
        spl: list[Estimate | None] = []
        for run in runs:
            protocol = own_protocol(run)
            records = [record for record in run.counted if name_of(record) == name]
            scenes = [record.scene_id for record in records]
            scores = [protocol.score(record) for record in records]
            rates = mean_with_interval([float(score.success) for score in scores], scenes)
            success.append(rates if records else None)
            means = mean_with_interval([score.spl for score in scores], scenes)
            spl.append(means if records else None)
        groups.append(Group(name, counts[name], success, spl))
    return groups


def _distinct(runs: Sequence[RunData]) -> list[EpisodeRecord]:
    """Every counted episode once, whichever runs have done it."""
    return list({record.key: record for run in runs for record in run.counted}.values())


def _distance_class(distance_m: float) -> str:
    for name, (low, high) in zip(_class_names(), pairwise(DISTANCE_BINS_M), strict=False):
        if low <= distance_m < high:
            return name
    return _class_names()[-1]


def _class_names() -> list[str]:
    edges = list(pairwise(DISTANCE_BINS_M))
    named = [f"{low:g} to {high:g} m" for low, high in edges[1:-1]]
    return [f"under {edges[0][1]:g} m", *named, f"{edges[-1][0]:g} m and more", "no path there"]


def _milliseconds_a_step(records: Sequence[EpisodeRecord]) -> dict[str, float]:
    steps = max(sum(record.steps for record in records), 1)
    total: dict[str, float] = defaultdict(float)
    for record in records:
        for name, seconds in record.seconds.items():
            total[name] += seconds
    named = sum(seconds for name, seconds in total.items() if name != "total")
    total["everything else"] = max(total["total"] - named, 0.0)
    return {name: 1000.0 * seconds / steps for name, seconds in total.items()}
