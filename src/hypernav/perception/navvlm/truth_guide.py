"""A stand-in for a model that says directions: what is really in view, and a table of rooms."""

from dataclasses import dataclass

from hypernav.core.exploring.guidance import Direction, GuideChoice, GuideView
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.perception.vlfm.truth_scorer import chance_in_view

_LEAST_CHANCE = 0.4
"""Chance of the goal in a room like the one in a direction at which that direction leads there;
ours."""
_LEAST_LEAD = 2.0
"""How many times as likely as in the least likely direction the goal must be elsewhere to lead
there below that chance; ours."""


@dataclass(frozen=True, eq=False)
class TruthGuide:
    """Says the direction in which a room is in view that likely holds the goal.

    Ours; nothing like it was published.

    Attributes:
        log: Log of all choices, for the trace.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        stands_in_for: What it is used in place of, and the remedy, for people.
    """

    log: ExchangeLog

    looks_at_colours = False
    stands_in_for = "a vision-language model (--vlm)"

    def direct(self, view: GuideView, goal: Goal) -> GuideChoice:
        """The likeliest direction, if it is likely enough.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        choice = self._choice(view, goal)
        question = "Which part of the image shows a room that likely holds the goal?"
        self.log.note("choose direction", "truth", question, choice.reason)
        return choice

    def _choice(self, view: GuideView, goal: Goal) -> GuideChoice:
        chances = {
            direction: chance
            for direction, columns in view.windows.items()
            if (chance := chance_in_view(view.observation, goal, columns)) is not None
        }
        if not chances:
            return GuideChoice(Direction.EXPLORE, f"{Direction.EXPLORE}: nothing tells the room")
        best = max(chances, key=lambda direction: chances[direction])
        ahead = chances[best] >= _LEAST_LEAD * min(chances.values())
        leads = ahead or chances[best] >= _LEAST_CHANCE
        direction = best if leads else Direction.EXPLORE
        reason = f"{direction}: a room like the one in view has it {chances[best]:.0%} of the time"
        return GuideChoice(direction, reason)
