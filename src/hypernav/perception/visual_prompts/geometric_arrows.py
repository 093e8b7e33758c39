"""Choice of arrows without a model: the way that is free farthest, unexplored first."""

from dataclasses import dataclass, field

import numpy as np

from hypernav.core.exploring.arrows import TURN_AROUND, ArrowChoice, ArrowView
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.perception.visual_prompts.config import ArrowsConfig


@dataclass(frozen=True, eq=False)
class GeometricArrowReasoner:
    """Prefers unexplored arrows, and of them the one whose floor is free farthest.

    Where all arrows are explored it turns around if it may, and else takes any, the freer the
    likelier. It looks at neither image nor goal: a stand-in for the model of the arrow methods.

    Attributes:
        log: Log of all choices, for the trace.
        config: Seed of the choice where nothing is unexplored.
        stands_in_for: What it is used in place of, and the remedy, for people.
    """

    log: ExchangeLog
    config: ArrowsConfig = field(default_factory=ArrowsConfig)

    stands_in_for = "a vision-language model (--vlm)"

    def choose(self, view: ArrowView, goal: Goal) -> ArrowChoice:
        """The best arrows; see `hypernav.core.components.protocols.ArrowReasoner`."""
        choice = self._choice(view)
        question = "Which arrow leads farthest over floor that was not looked at yet?"
        chosen = choice.numbers[0] if choice.numbers else None
        self.log.note("choose arrow", "geometric", question, choice.reason, chosen=chosen)
        return choice

    def _choice(self, view: ArrowView) -> ArrowChoice:
        fresh = sorted(
            (one for one in view.arrows if not one.is_explored), key=lambda one: -one.free_m
        )
        if fresh:
            best = fresh[0]
            reason = f"arrow {best.number}: unexplored, free for {best.free_m:.1f} m"
            return ArrowChoice(tuple(one.number for one in fresh[: view.wanted]), reason)
        if view.may_turn:
            return ArrowChoice((TURN_AROUND,), "all arrows are explored, turning around")
        if not view.arrows:
            return ArrowChoice((), "there is no arrow")
        weights = np.array([one.free_m + 1e-3 for one in view.arrows])
        # By the number of the question, so that a robot which comes to a place again may leave it
        # in another direction.
        rng = np.random.default_rng([self.config.seed, view.asked])
        drawn = rng.choice(
            len(weights),
            size=min(view.wanted, len(weights)),
            replace=False,
            p=weights / weights.sum(),
        )
        numbers = tuple(view.arrows[k].number for k in drawn.tolist())
        return ArrowChoice(numbers, f"arrow {numbers[0]}: drawn, all are explored")
