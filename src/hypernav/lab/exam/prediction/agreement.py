"""How alike answers are that have something in common, such as the thing that they are about."""

from collections.abc import Hashable, Sequence

import numpy as np
from scipy.special import ndtr, ndtri

_USUAL_SD = 0.3
"""How far from the usual value a correlation is taken to lie before any answer is seen."""
_CORRELATIONS = np.append(np.linspace(0.0, 0.98, 50), (0.99, 0.995, 0.999))
_SURE = 0.9999
"""Probability from which an event is as good as certain, so that an exception stays possible."""
_LEVELS = ndtri((np.arange(100) + 0.5) / 100)
"""Standard normal numbers, all as likely as the others."""


def agreement_of(
    happened: Sequence[bool], chances: Sequence[float], groups: Sequence[Hashable], usual: float
) -> float:
    """The most likely correlation within groups of the numbers that events are drawn by.

    An event happens where a standard normal number lies below the threshold of its chance (a probit
    model with one random effect for each group, whose marginal chances are given).

    Args:
        happened: Whether each event happened.
        chances: Its probability, by all that is known but its group.
        groups: What it has in common with others.
        usual: The correlation that is taken where the events tell nothing, 0 to 1.

    Returns:
        The correlation, 0 to 0.999.
    """
    signs = np.where(np.array(happened, dtype=bool), 1.0, -1.0)
    thresholds = ndtri(np.clip(np.array(chances, dtype=float), 1.0 - _SURE, _SURE))
    members: dict[Hashable, list[int]] = {}
    for k, group in enumerate(groups):
        members.setdefault(group, []).append(k)
    several = [np.array(some) for some in members.values() if len(some) > 1]
    best, highest = usual, -np.inf
    for correlation in _CORRELATIONS.tolist():
        own, common = np.sqrt(1.0 - correlation), np.sqrt(correlation) * _LEVELS
        score = -0.5 * ((correlation - usual) / _USUAL_SD) ** 2
        for some in several:
            each = ndtr(signs[some, None] * (thresholds[some, None] - common) / own)
            score += np.log(each.prod(axis=0).mean() + 1e-300)
        if score > highest:
            best, highest = correlation, score
    return best


def likeness_of(values: Sequence[float], names: Sequence[Hashable]) -> float:
    """Correlation of numbers within groups of one name (one-way analysis of variance), 0 to 1."""
    groups: dict[Hashable, list[float]] = {}
    for value, name in zip(values, names, strict=True):
        groups.setdefault(name, []).append(value)
    several = [np.array(group) for group in groups.values() if len(group) > 1]
    count, within = sum(map(len, several)), sum(float(((g - g.mean()) ** 2).sum()) for g in several)
    if len(several) < 2 or count == len(several):
        return 0.0
    middle = np.concatenate(several).mean()
    between = sum(len(g) * float((g.mean() - middle) ** 2) for g in several)
    within_mean, between_mean = within / (count - len(several)), between / (len(several) - 1)
    size = (count - sum(len(g) ** 2 for g in several) / count) / (len(several) - 1)
    total = between_mean + (size - 1.0) * within_mean
    return min(max((between_mean - within_mean) / total, 0.0), 1.0) if total > 0.0 else 0.0
