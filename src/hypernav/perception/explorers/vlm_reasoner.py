"""Choice of a block by a vision-language model that looks at the map (paper: global)."""

from dataclasses import dataclass, field
from typing import Any

from hypernav.core.chat import Answer, Question
from hypernav.core.components.protocols import BlockReasoner, ChatModel
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.models.chat.answer_parsing import shortened
from hypernav.models.chat.unwrapping import final_answer
from hypernav.perception.exchanges import exchange_of
from hypernav.perception.explorers.map_question import (
    VlmReasonerConfig,
    chosen_number,
    map_question,
    offered_blocks,
)

_QUESTIONS = 2
"""Number of questions without a usable answer after which the fallback chooses."""


@dataclass(eq=False)
class VlmReasoner:
    """Shows the map and asks which block to visit.

    Attributes:
        chat: Chat model to ask.
        log: Log of all questions and answers, for the trace.
        fallback: Reasoner that chooses where the model gives no usable answer.
        config: Configuration of the question.
        fallbacks: Number of choices of the fallback since the last report.
    """

    chat: ChatModel
    log: ExchangeLog
    fallback: BlockReasoner
    config: VlmReasonerConfig = field(default_factory=VlmReasonerConfig)
    fallbacks: int = field(default=0, init=False)

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The block that the model names; the fallback's if it names none.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        offered = offered_blocks(self.config, overview, excluded, elsewhere=True)
        numbers = [block.number for block in offered]
        if not numbers:
            return BlockChoice(None, "every block is excluded or holds nothing new")
        if len(numbers) == 1 and self.config.skip_only_block:
            return BlockChoice(numbers[0], f"block {numbers[0]} is the only one left")
        hint = ""
        for _ in range(_QUESTIONS):
            question = map_question(self.config, overview, goal, excluded, hint=hint)
            answer = self.chat.ask(question)
            choice = self._read(question, answer, numbers, excluded)
            if choice is not None:
                return choice
            said = shortened(final_answer(answer.text))
            hint = f"\n\nYou said '{said}', which names none of the blocks to choose from."
        self.fallbacks += 1
        choice = self.fallback.choose(overview, goal, excluded)
        return BlockChoice(choice.number, f"fell back: {choice.reason}")

    def take_report(self) -> dict[str, Any]:
        """Number of choices of the fallback since the last call."""
        report, self.fallbacks = {"geometric_choices": self.fallbacks}, 0
        return report

    def _read(
        self, question: Question, answer: Answer, numbers: list[int], excluded: frozenset[int]
    ) -> BlockChoice | None:
        """The choice in an answer; asks for a summary where rules find none; None without any."""
        number = chosen_number(question, answer, numbers)
        remarks = [] if number is not None else [answer.detail or "no rule finds one number"]
        self._record(question, answer, number, excluded, remarks)
        if number is None and not question.allowed and answer.fault is None:
            number = self._ask_for_summary(answer, numbers, excluded)
        if number is None:
            return None
        said = shortened(final_answer(answer.text), 160)
        reason = f"block {number}" if said == str(number) else f"block {number}: {said}"
        if (chance := answer.probabilities.get(str(number))) is not None:
            reason += f" ({chance:.0%} sure)"
        return BlockChoice(number, reason)

    def _ask_for_summary(
        self, answer: Answer, numbers: list[int], excluded: frozenset[int]
    ) -> int | None:
        """Ask the model itself which number it meant (paper: summariser)."""
        question = Question(
            kind="summarise",
            text=self.config.summary_prompt.format(
                answer=final_answer(answer.text)[:2000], numbers=", ".join(map(str, numbers))
            ),
            allowed=tuple(map(str, numbers)),
            max_tokens=8,
        )
        summary = self.chat.ask(question)
        number = None if summary.fault is not None else int(summary.value)
        remarks = [] if number is not None else [summary.detail]
        self._record(question, summary, number, excluded, remarks)
        return number

    def _record(
        self,
        question: Question,
        answer: Answer,
        number: int | None,
        excluded: frozenset[int],
        remarks: list[str],
    ) -> None:
        self.log.record(
            exchange_of(question, answer, chosen=number, excluded=sorted(excluded), remarks=remarks)
        )
