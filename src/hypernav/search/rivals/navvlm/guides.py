"""The direction question of NavVLM, answered by a chat model or by true labels."""

from dataclasses import dataclass, field

from hypernav.core.chat import Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.exploring.guidance import Direction, GuideChoice, GuideView
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.answer_parsing import final_answer, shortened
from hypernav.search.perception.exchanges import exchange_of
from hypernav.search.rivals.config import DIRECTION, DIRECTION_PAST, ChatGuideConfig
from hypernav.search.rivals.room_table import chance_in_view

_ABSENT = ("explore", "not visible", "no sign", "cannot see", "can't see", "not see", "absent")
_LEAST_CHANCE = 0.4
"""Chance of the goal in the kind of room in a direction, from which on that direction is chosen;
ours."""
_LEAST_LEAD = 2.0
"""Ratio of the chances in the likeliest and least likely direction, from which on the likeliest is
chosen also below that chance; ours."""


@dataclass(frozen=True, eq=False)
class ChatGuide:
    """Asks a vision-language model which way leads to the goal.

    Attributes:
        chat: Chat model to ask.
        log: Log of all questions and answers, for the trace.
        config: Configuration of the question.
    """

    chat: ChatModel
    log: ExchangeLog
    config: ChatGuideConfig = field(default_factory=ChatGuideConfig)

    def direct(self, view: GuideView, goal: Goal) -> GuideChoice:
        """The direction that the answer names; "explore" if it names none.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        later = len(view.images) > 1
        template = DIRECTION.replace("{first}", " first" if later else "")
        question = Question(
            kind="choose direction",
            text=goal.named_in(template.replace("{past}", DIRECTION_PAST if later else "")),
            images=view.images,
            max_tokens=self.config.max_tokens,
            at_once=True,
        )
        answer = self.chat.ask(question)
        said = final_answer(answer.text)
        direction = Direction.EXPLORE if answer.fault is not None else direction_in(said)
        remarks = [answer.detail] if answer.fault is not None else []
        self.log.record(exchange_of(question, answer, remarks=remarks))
        return GuideChoice(direction, f"{direction}: {shortened(said, 120)}")


def direction_in(said: str) -> Direction:
    """The direction in an answer, by the words in it, in NavVLM's order.

    Absence and exploration come first, then left, right, straight: "left or right" is left. An
    answer that names none means to explore.
    """
    text = said.lower()
    if any(words in text for words in _ABSENT):
        return Direction.EXPLORE
    for direction in (Direction.LEFT, Direction.RIGHT, Direction.STRAIGHT):
        if direction.value in text:
            return direction
    return Direction.EXPLORE


@dataclass(frozen=True, eq=False)
class TruthGuide:
    """Names the direction in which a room that likely holds the goal is in view.

    A stand-in for a model, by the true labels and a table of rooms. Ours; nothing like it was
    published.

    Attributes:
        log: Log of all choices, for the trace.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        stands_in_for: What it is used in place of, and the remedy, for people.
    """

    log: ExchangeLog

    looks_at_colours = False
    stands_in_for = "a vision-language model (--vlm)"

    def direct(self, view: GuideView, goal: Goal) -> GuideChoice:
        """The likeliest direction; "explore" if it is not likely enough.

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
