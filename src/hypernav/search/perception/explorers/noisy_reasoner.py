"""Stand-ins for a model of known quality: the truly best block at a set rate, or a random one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError
from hypernav.core.exploring.overview import Block, BlockChoice, Overview
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.map_question import offered_blocks

_EQUAL_M = 0.5
"""Difference in length below which two paths are equally short."""


@dataclass(eq=False)
class RandomReasoner:
    """Names any of the blocks that a model would be offered, all with the same probability.

    It uses neither map nor goal: a baseline of the search without global perception.

    Attributes:
        log: Log of all choices, for the trace.
        truth: True paths to the goal and the generator of the episode.
        config: Configuration of the question to a model, which says what is offered.
    """

    log: ExchangeLog
    truth: EpisodeTruth
    config: VlmReasonerConfig = field(default_factory=VlmReasonerConfig)

    _NAME: ClassVar[str] = "random block"
    _QUESTION: ClassVar[str] = "Which block is drawn?"

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """One of the offered blocks; None if none is offered.

        Raises:
            TruthMissingError: The truth about this episode was not set.
        """
        offered = offered_blocks(self.config, overview, excluded)
        rng = self.truth.rng
        if not offered:
            choice = BlockChoice(None, "every block is excluded or holds nothing new")
        elif len(offered) == 1:
            number = offered[0].number
            choice = BlockChoice(number, f"block {number} is the only one left")
        else:
            choice = self._drawn(offered, rng)
        self.log.note(
            "choose block",
            self._NAME,
            self._QUESTION,
            choice.reason,
            chosen=choice.number,
            excluded=excluded,
        )
        return choice

    def _drawn(self, offered: Sequence[Block], rng: np.random.Generator) -> BlockChoice:
        """The choice among at least two blocks."""
        drawn = offered[int(rng.integers(len(offered)))]
        return BlockChoice(drawn.number, f"block {drawn.number}: drawn from {len(offered)}")


class NoisyReasoner(RandomReasoner):
    """Names the truly best of the offered blocks with a set probability, else another of them.

    It shows how good a model must be: with probability 1 it is as good as any model can be, so the
    losses that remain are the method's. The best block is the one by way of which the path to the
    goal is shortest; of equally short ones, that with the shortest rest. All others are equally
    likely, which is worse than a model that errs: that would rather name the second best.
    Ours; the paper has no such thing.
    """

    _NAME = "noisy"
    _QUESTION = "Which block is the truly best?"

    def __init__(
        self,
        probability: float | str,
        log: ExchangeLog,
        truth: EpisodeTruth,
        config: VlmReasonerConfig | None = None,
    ) -> None:
        """Create the reasoner.

        Args:
            probability: Probability of the best block, 0 to 1; a text is read as a number.
            log: Log of all choices, for the trace.
            truth: True paths to the goal and the generator of the episode.
            config: Configuration of the question to a model, which says what is offered.

        Raises:
            ConfigError: The probability is no number from 0 to 1.
        """
        super().__init__(log, truth, config or VlmReasonerConfig())
        self._probability = _read_probability(probability)

    def _drawn(self, offered: Sequence[Block], rng: np.random.Generator) -> BlockChoice:
        best = self._best(offered)
        if rng.random() < self._probability:
            left_m = self.truth.path_left_m(*best.destination)
            reason = f"block {best.number}: truly the best, {left_m:.1f} m from there to the goal"
            return BlockChoice(best.number, reason)
        others = [block for block in offered if block is not best]
        other = others[int(rng.integers(len(others)))]
        reason = f"block {other.number}: an error on purpose, the best is {best.number}"
        return BlockChoice(other.number, reason)

    def _best(self, offered: Sequence[Block]) -> Block:
        """The block on the shortest path; of equally short ones that with the shortest rest."""
        left_m = {one.number: self.truth.path_left_m(*one.destination) for one in offered}
        shortest_m = min(one.travel_m + left_m[one.number] for one in offered)
        if math.isinf(shortest_m):
            return min(offered, key=lambda one: (left_m[one.number], one.travel_m, one.number))
        equal = [
            one for one in offered if one.travel_m + left_m[one.number] <= shortest_m + _EQUAL_M
        ]
        return min(equal, key=lambda one: (left_m[one.number], one.number))


def _read_probability(text: float | str) -> float:
    try:
        probability = float(text)
    except ValueError:
        probability = math.nan
    if not 0.0 <= probability <= 1.0:
        raise ConfigError(
            f"--reasoner noisy:{text!s:.40}: expected the probability of the truly best block, "
            "a number from 0 to 1, for example noisy:0.7"
        )
    return probability
