"""How sure a number is: intervals and paired tests that know that episodes share scenes.

Episodes of one scene are alike, so they are no independent samples. All methods here draw or flip
whole scenes (clusters). With a single scene, where nothing is known about others, single episodes
take the scenes' place, and the interval says nothing about other scenes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.stats import binomtest

DRAWS = 10_000
CONFIDENCE = 0.95

_SEED = 20250101
_EXACT_FLIPS = 13


@dataclass(frozen=True)
class Estimate:
    """A mean with its interval.

    Attributes:
        mean: Over episodes.
        low: Lower end of the 95% interval.
        high: Upper end.
        count: Episodes.
    """

    mean: float
    low: float
    high: float
    count: int


@dataclass(frozen=True)
class Comparison:
    """How two runs of the same episodes differ: the second minus the first.

    Attributes:
        difference: Mean difference with its interval.
        p_value: Two-sided, from flipping the runs scene by scene: how often a difference at least
            as large arises if it doesn't matter which run is which.
    """

    difference: Estimate
    p_value: float


@dataclass(frozen=True)
class Discordance:
    """Episodes in which just one of two runs succeeded.

    Attributes:
        only_first: Successes of the first run alone.
        only_second: Successes of the second run alone.
        both: Successes of both.
        neither: Failures of both.
        p_value: Exact McNemar test, which takes episodes as independent.
    """

    only_first: int
    only_second: int
    both: int
    neither: int
    p_value: float


def mean_with_interval(
    values: Sequence[float],
    scenes: Sequence[str],
    *,
    rng: np.random.Generator | None = None,
    draws: int = DRAWS,
) -> Estimate:
    """The mean over episodes, with the percentile bootstrap interval over scenes.

    Args:
        values: One per episode.
        scenes: Its scene.
        rng: Source of the draws; always the same one by default, so that a report can be repeated.
        draws: Bootstrap samples.

    Returns:
        The estimate; NaN without episodes.
    """
    numbers = np.asarray(values, dtype=np.float64)
    if numbers.size == 0:
        return Estimate(float("nan"), float("nan"), float("nan"), 0)
    sums, counts = _by_cluster(numbers, _clusters(scenes))
    rng = rng or np.random.default_rng(_SEED)
    drawn = rng.integers(0, sums.size, size=(draws, sums.size))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(means, (tail, 1.0 - tail))
    return Estimate(float(numbers.mean()), float(low), float(high), int(numbers.size))


def compare(
    first: Sequence[float],
    second: Sequence[float],
    scenes: Sequence[str],
    *,
    rng: np.random.Generator | None = None,
    draws: int = DRAWS,
) -> Comparison:
    """Whether the second run is better than the first, episode by episode.

    Args:
        first: One value per episode.
        second: Of the same episodes, in the same order.
        scenes: Of the episodes.
        rng: Source of draws and flips; always the same one by default.
        draws: Bootstrap samples, and flips if there are too many to try all.
    """
    rng = rng or np.random.default_rng(_SEED)
    gaps = np.asarray(second, dtype=np.float64) - np.asarray(first, dtype=np.float64)
    difference = mean_with_interval(gaps.tolist(), scenes, rng=rng, draws=draws)
    if gaps.size == 0:
        return Comparison(difference, float("nan"))
    sums, _ = _by_cluster(gaps, _clusters(scenes))
    return Comparison(difference, _flip_p_value(sums, rng, draws))


def discordance(first: Sequence[bool], second: Sequence[bool]) -> Discordance:
    """In which episodes two runs differ in success."""
    a, b = np.asarray(first, dtype=bool), np.asarray(second, dtype=bool)
    only_first, only_second = int((a & ~b).sum()), int((b & ~a).sum())
    count = only_first + only_second
    p_value = float(binomtest(only_first, count, 0.5).pvalue) if count else 1.0
    return Discordance(only_first, only_second, int((a & b).sum()), int((~a & ~b).sum()), p_value)


def _clusters(scenes: Sequence[str]) -> Int64[np.ndarray, "episodes"]:
    """Number of every episode's cluster: its scene, or the episode itself if there is one scene."""
    names, numbers = np.unique(np.asarray(scenes), return_inverse=True)
    return (np.arange(numbers.size) if names.size == 1 else numbers).astype(np.int64)


def _by_cluster(
    values: Float64[np.ndarray, "episodes"], clusters: Int64[np.ndarray, "episodes"]
) -> tuple[Float64[np.ndarray, "clusters"], Float64[np.ndarray, "clusters"]]:
    """Sum and number of the episodes of every cluster."""
    return np.bincount(clusters, weights=values), np.bincount(clusters).astype(np.float64)


def _flip_p_value(
    sums: Float64[np.ndarray, "clusters"], rng: np.random.Generator, draws: int
) -> float:
    """Two-sided p-value of the total when every cluster's sign is a coin's throw."""
    observed = abs(float(sums.sum()))
    if sums.size <= _EXACT_FLIPS:
        bits = np.arange(2**sums.size)[:, None] >> np.arange(sums.size)
        signs = 1.0 - 2.0 * (bits & 1)
        totals = np.abs(signs @ sums)
        return float((totals >= observed - 1e-9).mean())
    signs = rng.choice((-1.0, 1.0), size=(draws, sums.size))
    totals = np.abs(signs @ sums)
    # The observed labelling is one of the possible ones, so p is never 0.
    return float((1 + (totals >= observed - 1e-9).sum()) / (draws + 1))
