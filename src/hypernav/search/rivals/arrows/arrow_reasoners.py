"""Choice of arrows: by a vision-language model that is shown them, or by free floor alone."""

import json
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hypernav.core.chat import Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.exploring.guidance import TURN_AROUND, ArrowChoice, ArrowView
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.answer_parsing import final_answer, shortened
from hypernav.search.perception.exchanges import exchange_of
from hypernav.search.rivals.config import ONE_ARROW, SEVERAL_ARROWS, ArrowsConfig

_OBJECT = re.compile(r"\{[^{}]*\}")
_BARE = re.compile(r"\W*\d{1,6}(?:[\s,]+\d{1,6})*\W*")
_NUMBERS = re.compile(r"-?\d+")


@dataclass(eq=False)
class ChatArrowReasoner:
    """Shows the arrows and asks for numbers: in substance VLMnav's and PIVOT's, in our words.

    Attributes:
        chat: Chat model to ask.
        log: Log of all questions and answers, for the trace.
        config: Configuration of the question.
        unread: Number of answers without a usable number since the last report.
    """

    chat: ChatModel
    log: ExchangeLog
    config: ArrowsConfig = field(default_factory=ArrowsConfig)
    unread: int = field(default=0, init=False)

    def take_report(self) -> dict[str, Any]:
        """Number of answers without a usable number since the last call."""
        report, self.unread = {"unread_arrow_answers": self.unread}, 0
        return report

    def choose(self, view: ArrowView, goal: Goal) -> ArrowChoice:
        """The arrows that the model names (0 turns around), the best first; none if it names none.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = arrow_question(view, goal, self.config)
        answer = self.chat.ask(question)
        said = final_answer(answer.text)
        numbers = () if answer.fault is not None else named_numbers(said, view)
        remarks = [] if numbers else [answer.detail or "it names none of the numbers"]
        self.unread += not numbers
        first = numbers[0] if numbers else None
        self.log.record(exchange_of(question, answer, chosen=first, remarks=remarks))
        if not numbers:
            return ArrowChoice((), f"no number in '{shortened(said)}'")
        name = "turning around" if first == TURN_AROUND else f"arrow {first}"
        return ArrowChoice(numbers, f"{name}: {shortened(said, 160)}")


def arrow_question(view: ArrowView, goal: Goal, config: ArrowsConfig) -> Question:
    """The question to a model about the arrows in an image."""
    last = len(view.arrows)
    if config.count_short and not view.may_turn:
        last = max(last - 1, 1)
    arrows = f"Red arrows with the numbers 1 to {last} show places that it can go to."
    if last == 1:
        arrows = "The red arrow with the number 1 shows a place that it can go to."
    turn = " Number 0 turns it around." if view.may_turn else ""
    facts = ""
    if view.facts:
        facts = f" It remembers what it saw before, from where it stands: {'; '.join(view.facts)}."
    template = (ONE_ARROW if view.wanted == 1 else SEVERAL_ARROWS).format(
        goal="{goal}", arrows=arrows, turn=turn, facts=facts, wanted=view.wanted
    )
    return Question(
        kind="choose arrow",
        text=goal.named_in(template),
        images=(view.image,),
        max_tokens=config.max_tokens,
    )


def named_numbers(said: str, view: ArrowView) -> tuple[int, ...]:
    """The allowed numbers in the last JSON object of an answer, the best first.

    An answer that is nothing but one number or a list of numbers counts as well.
    """
    objects = _OBJECT.findall(said)
    if not objects and not _BARE.fullmatch(said):
        return ()
    text = objects[-1] if objects else said
    try:
        values = list(json.loads(text).values()) if objects else [text]
        text = str(values[-1]) if values else ""
    except json.JSONDecodeError:
        pass
    possible = {arrow.number for arrow in view.arrows}
    if view.may_turn:
        possible.add(TURN_AROUND)
    named = [int(found) for found in _NUMBERS.findall(text)]
    return tuple(dict.fromkeys(number for number in named if number in possible))[: view.wanted]


@dataclass(frozen=True, eq=False)
class GeometricArrowReasoner:
    """Prefers unexplored arrows, and of them the one along which the floor is free farthest.

    Where all arrows are explored it turns around if it may, else it draws one, with probabilities
    proportional to the free range. It uses neither image nor goal: a stand-in for a model.

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
