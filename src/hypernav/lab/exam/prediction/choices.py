"""How an examined model chooses blocks: fitted to its answers about maps, used on other maps.

A map of a search offers other blocks than those of the exam, and a search that always drives to the
nearest block meets other maps than one that doesn't. So not the answers are carried over but what
they depend on: the truth, the path to the block, and the order in which the blocks were shown.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import minimize

from hypernav.lab.exam.prediction.agreement import likeness_of
from hypernav.lab.exam.questions import EQUAL_M, Answered
from hypernav.search.perception.local.stand_ins.systematic_detector import STANDARD_NORMAL

_MOST_POWER = 20.0
"""Power from which the second in a rank is as good as never chosen."""
_RANKS = 5  # those of `ranks_of`
_LEAST = 1e-9  # so that no answer is impossible


@dataclass(frozen=True)
class BlockChoices:
    """Who chooses which block how often.

    With the probability `lapse` it is any block. Else a block's share falls with a power of its
    rank: of one more than the number of those that come before it by some measure.

    Attributes:
        lapse: Probability of a choice that depends on nothing, 0 to 1.
        powers: One for each rank of `ranks_of`, 0 or more.
        unread: Share of answers that name no block, so that the geometric rule chooses.
        persistence: How alike, in being good or bad, the choices of one search are beyond what the
            ranks explain, compared with those of others: 0 to 1.
    """

    lapse: float
    powers: tuple[float, ...]
    unread: float
    persistence: float

    def probabilities(
        self, ranks: Int[np.ndarray, "options ranks"]
    ) -> Float[np.ndarray, " options"]:
        """Probability of each block."""
        shares = _shares(np.log1p(ranks), np.array(self.powers))
        return self.lapse / len(ranks) + (1.0 - self.lapse) * shares

    def drawn(self, ranks: Int[np.ndarray, "options ranks"], level: float) -> int:
        """Index of the block at a level from 0, a good choice, to 1, a bad one."""
        order = _best_first(ranks)
        below = np.cumsum(self.probabilities(ranks)[order])
        return int(order[min(int(np.searchsorted(below, level, "right")), len(order) - 1)])


def ranks_of(costs: Sequence[float], travel: Sequence[float]) -> Int[np.ndarray, "options ranks"]:
    """How many blocks come before each by five measures.

    In this order: those by way of which the true path is clearly shorter; the nearer ones; the
    farther ones; those that are shown earlier; those that are shown later.

    Args:
        costs: True lengths of the paths by way of the blocks, in the order in which they are shown,
            metres; infinite where there is none.
        travel: Lengths of the known paths to the blocks, metres.
    """
    cost, far, place = np.array(costs), np.array(travel), np.arange(len(costs))
    before = (
        cost[None, :] < cost[:, None] - EQUAL_M,
        far[None, :] < far[:, None],
        far[None, :] > far[:, None],
        place[None, :] < place[:, None],
        place[None, :] > place[:, None],
    )
    return np.stack([one.sum(axis=1) for one in before], axis=1)


def choices_of(answers: Sequence[Answered]) -> BlockChoices | None:
    """The most likely way to choose that gives these answers about maps; None without any."""
    asked = [one for one in answers if one.kind == "block"]
    if not asked:
        return None
    read = [one for one in asked if one.chosen in one.options]
    maps = [_ranks(one) for one in read]
    chosen = [one.options.index(str(one.chosen)) for one in read]
    lapse, powers = _fitted(maps, chosen)
    fitted = BlockChoices(lapse, powers, 1.0 - len(read) / len(asked), 0.0)
    levels = [_level(fitted, ranks, k) for ranks, k in zip(maps, chosen, strict=True)]
    searches = ["/".join(one.id.split("/")[:2]) for one in read]
    return BlockChoices(lapse, powers, fitted.unread, likeness_of(levels, searches))


def _ranks(answered: Answered) -> Int[np.ndarray, "options ranks"]:
    return ranks_of(
        [answered.costs.get(option, math.inf) for option in answered.options],
        [answered.travel.get(option, math.inf) for option in answered.options],
    )


def _shares(
    logs: Float[np.ndarray, "*maps options ranks"], powers: Float[np.ndarray, " ranks"]
) -> Float[np.ndarray, "*maps options"]:
    """Shares of the blocks by the logarithms of their ranks."""
    heights = -(logs @ powers)
    weights = np.exp(heights - heights.max(axis=-1, keepdims=True))
    return weights / weights.sum(axis=-1, keepdims=True)


def _fitted(
    maps: Sequence[Int[np.ndarray, "options ranks"]], chosen: Sequence[int]
) -> tuple[float, tuple[float, ...]]:
    """Lapse and powers of greatest likelihood; a choice by chance without any answer."""
    if not maps:
        return 1.0, (0.0,) * _RANKS
    by_count: dict[int, list[int]] = {}
    for k, ranks in enumerate(maps):
        by_count.setdefault(len(ranks), []).append(k)
    groups = [
        (np.log1p(np.stack([maps[k] for k in some])), np.array([chosen[k] for k in some]))
        for some in by_count.values()
    ]

    def unlikelihood(values: Float[np.ndarray, " values"]) -> float:
        lapse, total = values[0], 0.0
        for logs, picked in groups:
            own = _shares(logs, values[1:])[np.arange(len(picked)), picked]
            total -= float(np.log(lapse / logs.shape[1] + (1.0 - lapse) * own + _LEAST).sum())
        return total

    bounds = [(0.0, 1.0), *[(0.0, _MOST_POWER)] * _RANKS]
    starts = [np.array([lapse, *[power] * _RANKS]) for lapse in (0.1, 0.5) for power in (0.1, 2.0)]
    found = [minimize(unlikelihood, start, method="L-BFGS-B", bounds=bounds) for start in starts]
    best = min(found, key=lambda one: one.fun).x.tolist()
    return best[0], tuple(best[1:])


def _level(choices: BlockChoices, ranks: Int[np.ndarray, "options ranks"], chosen: int) -> float:
    """Standard normal number at which a block is chosen: the middle of its part of the levels."""
    order = _best_first(ranks).tolist()
    shares = choices.probabilities(ranks)[order]
    place = order.index(chosen)
    middle = float(shares[:place].sum() + 0.5 * shares[place])
    return STANDARD_NORMAL.inv_cdf(min(max(middle, 1e-6), 1.0 - 1e-6))


def _best_first(ranks: Int[np.ndarray, "options ranks"]) -> Int[np.ndarray, " options"]:
    """The blocks by the number of truly better ones."""
    return np.argsort(ranks[:, 0], kind="stable")
