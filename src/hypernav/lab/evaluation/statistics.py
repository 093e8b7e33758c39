"""Confidence intervals and paired tests over episodes that share scenes, and mean results.

Episodes of one scene are alike, so they are not independent samples. All methods here resample or
flip whole scenes (clusters). With a single scene, its episodes are the clusters instead, and the
interval says nothing about other scenes.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.protocol import EvaluationProtocol
from hypernav.lab.evaluation.record import EpisodeRecord

DRAWS = 10_000
CONFIDENCE = 0.95

_SEED = 20250101
_EXACT_FLIPS = 13

FEWEST_WITH_INTERVAL = 5
"""Number of scenes, or episodes of a single one, below which an interval says nothing."""


@dataclass(frozen=True)
class Estimate:
    """A mean with its confidence interval.

    Attributes:
        mean: Mean over episodes.
        low: Lower end of the 95% interval.
        high: Upper end of the 95% interval.
        count: Number of episodes.
        drawn: Number of scenes that the interval was drawn from, or episodes of a single one.
    """

    mean: float
    low: float
    high: float
    count: int
    drawn: int

    @property
    def has_interval(self) -> bool:
        """Whether enough was drawn from for the interval to say something."""
        return self.drawn >= FEWEST_WITH_INTERVAL

    @property
    def drawn_ends(self) -> tuple[float, float]:
        """Ends of the interval in a figure: where it says nothing, the mean."""
        return (self.low, self.high) if self.has_interval else (self.mean, self.mean)


@dataclass(frozen=True)
class Comparison:
    """Difference of two runs over the same episodes: the second minus the first.

    Attributes:
        difference: Mean difference with its interval.
        p_value: Two-sided p-value of a permutation test that swaps the runs scene by scene: how
            often a difference at least as large arises by chance.
        least_p_value: The smallest that so few scenes can give, however large the difference.
    """

    difference: Estimate
    p_value: float
    least_p_value: float


@dataclass(frozen=True)
class Discordance:
    """Agreement of two runs in success, episode by episode.

    Attributes:
        only_first: Number of episodes in which only the first run succeeded.
        only_second: Number of episodes in which only the second run succeeded.
        both: Number of episodes in which both succeeded.
        neither: Number of episodes in which both failed.
        p_value: P-value of McNemar's exact test, which takes episodes as independent.
    """

    only_first: int
    only_second: int
    both: int
    neither: int
    p_value: float


def drawn(scenes: Iterable[str]) -> str:
    """What bootstrap and flips draw: "scenes", or "episodes" where they are of a single one."""
    return "scenes" if len(set(scenes)) > 1 else "episodes"


def mean_with_interval(
    values: Sequence[float],
    scenes: Sequence[str],
    *,
    rng: np.random.Generator | None = None,
    draws: int = DRAWS,
) -> Estimate:
    """The mean over episodes, with the percentile bootstrap interval over scenes.

    Args:
        values: Values, one per episode.
        scenes: Scenes, one per episode.
        rng: Generator of the draws; by default one of a fixed seed, so that reports are repeatable.
        draws: Number of bootstrap samples.

    Returns:
        The estimate; NaN without episodes.
    """
    return ratio_with_interval(values, np.ones(len(values)).tolist(), scenes, rng=rng, draws=draws)


def ratio_with_interval(
    values: Sequence[float],
    references: Sequence[float],
    scenes: Sequence[str],
    *,
    rng: np.random.Generator | None = None,
    draws: int = DRAWS,
) -> Estimate:
    """The sum of values over the sum of references, with the bootstrap interval over scenes.

    Args:
        values: Values, one per episode.
        references: What they are compared with, one number per episode, none negative and not all
            0; draws whose references are all 0 are left out.
        scenes: Scenes, one per episode.
        rng: Generator of the draws; by default one of a fixed seed, so that reports are repeatable.
        draws: Number of bootstrap samples.

    Returns:
        The estimate, whose mean is the ratio; NaN without episodes.
    """
    numbers, weights = (np.asarray(each, dtype=np.float64) for each in (values, references))
    if numbers.size == 0:
        return Estimate(float("nan"), float("nan"), float("nan"), 0, 0)
    clusters = _clusters(scenes)
    sums, totals = (np.bincount(clusters, weights=each) for each in (numbers, weights))
    rng = rng or np.random.default_rng(_SEED)
    drawn = rng.integers(0, sums.size, size=(draws, sums.size))
    above, below = sums[drawn].sum(axis=1), totals[drawn].sum(axis=1)
    ratios = above[below > 0.0] / below[below > 0.0]
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(ratios, (tail, 1.0 - tail))
    ratio = float(numbers.sum() / weights.sum())
    return Estimate(ratio, float(low), float(high), int(numbers.size), int(sums.size))


def compare(
    first: Sequence[float],
    second: Sequence[float],
    scenes: Sequence[str],
    *,
    rng: np.random.Generator | None = None,
    draws: int = DRAWS,
) -> Comparison:
    """Difference of two runs over the same episodes, with its interval and p-value.

    Args:
        first: Values of the first run, one per episode.
        second: Values of the second run, of the same episodes in the same order.
        scenes: Scenes, one per episode.
        rng: Generator of draws and flips; by default one of a fixed seed.
        draws: Number of bootstrap samples, and of flips if there are too many to try all.
    """
    rng = rng or np.random.default_rng(_SEED)
    gaps = np.asarray(second, dtype=np.float64) - np.asarray(first, dtype=np.float64)
    difference = mean_with_interval(gaps.tolist(), scenes, rng=rng, draws=draws)
    if gaps.size == 0:
        return Comparison(difference, float("nan"), float("nan"))
    sums = np.bincount(_clusters(scenes), weights=gaps)
    least = 0.5 ** (sums.size - 1)  # all signs equal, or all turned
    return Comparison(difference, _flip_p_value(sums, rng, draws), least)


def holm(p_values: Sequence[float]) -> list[float]:
    """P-values corrected for their number by Holm's method, in the given order.

    If all tests with a corrected p-value below a limit are called significant, the probability of
    one or more false positives is at most that limit.
    """
    values = np.asarray(p_values, dtype=np.float64)
    order = np.argsort(values, kind="stable")
    corrected = np.empty_like(values)
    corrected[order] = np.maximum.accumulate(values[order] * np.arange(values.size, 0, -1))
    return np.minimum(corrected, 1.0).tolist()


def discordance(first: Sequence[bool], second: Sequence[bool]) -> Discordance:
    """Count the episodes in which two runs agree and differ in success."""
    from scipy.stats import binomtest  # imported here: only comparisons need it, and it takes time

    a, b = np.asarray(first, dtype=bool), np.asarray(second, dtype=bool)
    only_first, only_second = int((a & ~b).sum()), int((b & ~a).sum())
    count = only_first + only_second
    p_value = float(binomtest(only_first, count, 0.5).pvalue) if count else 1.0
    return Discordance(only_first, only_second, int((a & b).sum()), int((~a & ~b).sum()), p_value)


def _clusters(scenes: Sequence[str]) -> Int64[np.ndarray, "episodes"]:
    """Number of every episode's cluster: its scene, or the episode itself if there is one scene."""
    names, numbers = np.unique(np.asarray(scenes), return_inverse=True)
    return (np.arange(numbers.size) if names.size == 1 else numbers).astype(np.int64)


def _flip_p_value(
    sums: Float64[np.ndarray, "clusters"], rng: np.random.Generator, draws: int
) -> float:
    """Two-sided p-value of the total under random signs of the clusters."""
    observed = abs(float(sums.sum()))
    if sums.size <= _EXACT_FLIPS:
        bits = np.arange(2**sums.size)[:, None] >> np.arange(sums.size)
        signs = 1.0 - 2.0 * (bits & 1)
        totals = np.abs(signs @ sums)
        return float((totals >= observed - 1e-9).mean())
    signs = rng.choice((-1.0, 1.0), size=(draws, sums.size))
    totals = np.abs(signs @ sums)
    # The observed signs are one of the possible draws, so p is never 0.
    return float((1 + (totals >= observed - 1e-9).sum()) / (draws + 1))


@dataclass(frozen=True)
class Summary:
    """Mean results of some episodes under one protocol; episodes that don't count are left out.

    Attributes:
        success: Success rate.
        spl: Mean SPL.
        soft_spl: Mean SoftSPL.
        distance_to_goal_m: Mean distance at the end, over episodes whose goal can be reached.
        steps: Mean number of actions.
    """

    success: Estimate
    spl: Estimate
    soft_spl: Estimate
    distance_to_goal_m: Estimate
    steps: Estimate


def counted(records: Sequence[EpisodeRecord]) -> list[EpisodeRecord]:
    """The records that count in rates."""
    return [record for record in records if record.counts]


def summarise(
    records: Sequence[EpisodeRecord],
    protocol: EvaluationProtocol | None = None,
    *,
    draws: int = DRAWS,
) -> Summary:
    """Mean results of some episodes.

    Args:
        records: Records of one run.
        protocol: Protocol that decides about success; Habitat's by default.
        draws: Number of bootstrap samples of the intervals.
    """
    protocol = protocol or EvaluationProtocol()
    records = sorted(counted(records), key=lambda record: record.key)  # as draws depend on it
    scores = [protocol.score(record) for record in records]
    scenes = [record.scene_id for record in records]

    def estimate(values: list[float]) -> Estimate:
        return mean_with_interval(values, scenes, draws=draws)

    near = [r for r in records if r.distance_to_goal_m < float("inf")]
    return Summary(
        success=estimate([float(score.success) for score in scores]),
        spl=estimate([score.spl for score in scores]),
        soft_spl=estimate([score.soft_spl for score in scores]),
        distance_to_goal_m=mean_with_interval(
            [r.distance_to_goal_m for r in near], [r.scene_id for r in near], draws=draws
        ),
        steps=estimate([float(record.steps) for record in records]),
    )


def failure_counts(records: Sequence[EpisodeRecord]) -> dict[Failure, int]:
    """Number of episodes of each failure class that occurs, in the order of `Failure`."""
    counts = Counter(record.failure for record in records if record.failure is not None)
    return {failure: counts[failure] for failure in Failure if counts[failure]}


def percent(estimate: Estimate) -> str:
    """The mean as a percentage."""
    return f"{100 * estimate.mean:.1f} %"


def interval(
    estimate: Estimate,
    factor: float = 1.0,
    words: str = " ({} to {})",
    digits: int | None = None,
    sign: str = "-",
) -> str:
    """The interval in these words; empty if it says nothing.

    Args:
        estimate: The mean with its interval.
        factor: Factor on both ends: 100 for percents.
        words: Words with a place for each end.
        digits: Number of decimals; by default 1 of percents, else 3.
        sign: ``"+"`` to show the sign of positive numbers, too.
    """
    if not estimate.has_interval:
        return ""
    digits = (1 if factor > 1.0 else 3) if digits is None else digits
    return words.format(
        *(f"{factor * end:{sign}.{digits}f}" for end in (estimate.low, estimate.high))
    )


def ends(estimate: Estimate) -> tuple[str, str]:
    """Both ends of the interval for a file of numbers; empty if it says nothing."""
    if not estimate.has_interval:
        return "", ""
    return f"{estimate.low:.4f}", f"{estimate.high:.4f}"
