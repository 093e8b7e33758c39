"""Choice of a block by a vision-language model that looks at the map (paper: global)."""

import re
from collections.abc import Sequence
from typing import Any, Literal

from pydantic import Field

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.components.protocols import BlockReasoner, ChatModel
from hypernav.core.config import RoomConfig
from hypernav.core.goal import Goal
from hypernav.core.overview import BlockChoice, Overview
from hypernav.core.trace import ExchangeLog
from hypernav.models.chat.answer_parsing import shortened, without_thinking
from hypernav.perception.exchanges import exchange_of

_CONTEXT = (
    "A robot searches an unknown building for: {goal}. The picture is the map that it has drawn so "
    "far, seen from above: white is free floor, dark is walls and furniture, grey is not yet "
    "explored. The orange arrow is the robot and where it looks, the blue line is where it has "
    "been. The explored area is divided into numbered blocks: {numbers}."
)
_FREE = (
    "Which numbered block should the robot go to next to find the {goal}? Think about what kind of "
    "room each part may be and where unexplored space begins. Answer with the number of one block "
    "and a short reason."
)
_CONSTRAINED = (
    "Which numbered block should the robot go to next to find the {goal}? Answer with the number "
    "only."
)


class VlmReasonerConfig(RoomConfig):
    """Configuration of the map question to a model. Values not marked with "paper" are ours.

    Attributes:
        mode: Form of the answer. "paper": free text, summarised to a number by rules and, where
            they fail, by a second short question. "constrained": the numbers are the only possible
            answers.
        attempts: Number of questions, where answers give no number, before the fallback chooses.
        max_tokens: Limit on the length of a free answer, tokens.
        skip_only_block: Whether to go without a question where only one block is left.
    """

    mode: Literal["paper", "constrained"] = "constrained"
    attempts: int = Field(default=2, ge=1, le=100)
    max_tokens: int = Field(default=300, ge=16, le=1_000_000)
    skip_only_block: bool = True


def map_question(
    config: VlmReasonerConfig,
    image: Image,
    goal: Goal,
    blocks: Sequence[int],
    excluded: frozenset[int] = frozenset(),
    *,
    hint: str = "",
) -> Question:
    """Question to a model about one image of a map."""
    paper = config.mode == "paper"
    context = _CONTEXT.format(goal=goal.text.strip(), numbers=", ".join(map(str, blocks)))
    asked = (_FREE if paper else _CONSTRAINED).format(goal=goal.text.strip())
    # The paper's words for what was visited already.
    avoid = f" Don't answer number {sorted(excluded)}." if excluded else ""
    return Question(
        kind="choose block",
        text=f"{context}\n\n{asked}{avoid}{hint}",
        images=(image,),
        allowed=() if paper else tuple(str(number) for number in blocks if number not in excluded),
        max_tokens=config.max_tokens if paper else 8,
    )


class VlmReasoner:
    """Shows the map and asks which block to visit."""

    def __init__(
        self,
        chat: ChatModel,
        log: ExchangeLog,
        fallback: BlockReasoner,
        config: VlmReasonerConfig | None = None,
    ) -> None:
        """Create the reasoner.

        Args:
            chat: Chat model to ask.
            log: Log of all questions and answers, for the trace.
            fallback: Reasoner that chooses where the model gives no usable answer.
            config: Configuration of the question.
        """
        self._chat = chat
        self._log = log
        self._fallback = fallback
        self._config = config or VlmReasonerConfig()
        self.fallbacks = 0
        """Number of choices of the fallback so far."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """The block that the model names; the fallback's if it names none.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        numbers = [block.number for block in overview.blocks if block.number not in excluded]
        if not numbers:
            return BlockChoice(None, "every block is excluded")
        if len(numbers) == 1 and self._config.skip_only_block:
            return BlockChoice(numbers[0], f"block {numbers[0]} is the only one left")
        hint = ""
        for _ in range(self._config.attempts):
            question = self.question(overview, goal, excluded, hint=hint)
            answer = self._chat.ask(question)
            choice = self._read(question, answer, numbers, excluded)
            if choice is not None:
                return choice
            said = shortened(without_thinking(answer.text))
            hint = f"\n\nYou said '{said}', which names none of the blocks to choose from."
        self.fallbacks += 1
        choice = self._fallback.choose(overview, goal, excluded)
        return BlockChoice(
            choice.number, f"fell back: {choice.reason}", probabilities=choice.probabilities
        )

    def take_report(self) -> dict[str, Any]:
        """Number of choices of the fallback since the last call."""
        report, self.fallbacks = {"geometric_choices": self.fallbacks}, 0
        return report

    def question(
        self, overview: Overview, goal: Goal, excluded: frozenset[int], *, hint: str = ""
    ) -> Question:
        """Question about one map.

        Args:
            overview: Map and blocks.
            goal: Target of the search.
            excluded: Numbers of the blocks that must not be answered.
            hint: Additional text about an answer that could not be used.
        """
        blocks = [block.number for block in overview.blocks]
        return map_question(self._config, overview.image, goal, blocks, excluded, hint=hint)

    def _read(
        self, question: Question, answer: Answer, numbers: list[int], excluded: frozenset[int]
    ) -> BlockChoice | None:
        """The choice in an answer, if there is one; asks for a summary where rules fail."""
        chances = {int(number): chance for number, chance in answer.probabilities.items()}
        if question.allowed:
            number = None if answer.fault is not None else int(answer.value)
        else:
            number = summarised(answer.text, numbers)
        remarks = [] if number is not None else [answer.detail or "no rule finds one number"]
        self._record(question, answer, number, excluded, remarks)
        if number is None and not question.allowed and answer.fault is None:
            number = self._ask_for_summary(answer, numbers, excluded)
        if number is None:
            return None
        said = shortened(without_thinking(answer.text), 160)
        reason = f"block {number}" if said == str(number) else f"block {number}: {said}"
        if number in chances:
            reason += f" ({chances[number]:.0%} sure)"
        return BlockChoice(number, reason, probabilities=chances)

    def _ask_for_summary(
        self, answer: Answer, numbers: list[int], excluded: frozenset[int]
    ) -> int | None:
        """Ask the model itself which number it meant (paper: summariser)."""
        question = Question(
            kind="summarise",
            text=(
                "Somebody was asked for the number of one block on a map and answered:\n\n"
                f"{without_thinking(answer.text)[:2000]}\n\n"
                f"Which number did they choose? Possible are {', '.join(map(str, numbers))}. "
                "Answer with the number only."
            ),
            allowed=tuple(map(str, numbers)),
            max_tokens=8,
        )
        summary = self._chat.ask(question)
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
        self._log.record(
            exchange_of(question, answer, chosen=number, excluded=sorted(excluded), remarks=remarks)
        )


_NUMBER_WORDS: tuple[str, ...] = (
    *("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"),
    *("eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen"),
    *("nineteen", "twenty"),
)
# A bare "one" is no number: "block 3 is the one to visit".
_IN_WORDS = re.compile(rf"(?:(?<=block )|(?<=number )|^)({'|'.join(_NUMBER_WORDS)})\b", re.I)
_DECLARED = (
    r"\\boxed\{\s*(\d+)\s*\}",
    r"(?:answer|choice|choose|select|pick|go to|head (?:to|for)|visit|recommend)"
    r"(?:\s+(?:is|would be|the|to|with|for|should|be|number|block|no\.?)|[:*#\s])*\s*(\d+)\b",
    r"\*\*\s*(?:block|number)?\s*(\d+)\s*\*\*",
)
_DENIED = re.compile(
    r"(?:\bnot\b|n['’]t\b|\bavoid\b|\bexclud\w*|\binstead of\b|\brather than\b)"
    r"(?:\s+(?:to|go|choose|pick|answer|visit|the|in|be))*\s+(?:blocks?\s+|numbers?\s+)*"
    r"\[?\s*\d+(?:(?:\s*,\s*|\s+(?:and|or|nor)\s+)\d+)*\s*\]?",
    re.IGNORECASE,
)


def summarised(text: str, numbers: list[int]) -> int | None:
    """The one block that a free answer chooses, by rules; None if they find none or several.

    In this order: an answer that is nothing but a number; a number that is declared to be the
    answer (the last such); the only possible number that is mentioned at all. Numbers that are
    named in order not to be chosen do not count, nor do those with a unit behind them.
    """
    said = without_thinking(text)
    said = _IN_WORDS.sub(lambda match: str(_NUMBER_WORDS.index(str(match[1]).lower())), said)
    bare = re.fullmatch(r"\W*(?:block|number)?\W*(\d{1,6})\W*", said, re.IGNORECASE)
    if bare is not None:
        return _possible(bare[1], numbers)
    said = _DENIED.sub(" ", said)
    for pattern in _DECLARED:
        declared = {int(found) for found in re.findall(pattern, said, re.IGNORECASE)}
        declared &= set(numbers)
        if len(declared) == 1:
            return declared.pop()
    mentioned = re.findall(r"(?<![\d.,])(\d{1,6})\b(?!\s*(?:m\b|met|cm|%|°|deg|\.\d))", said)
    possible = {number for found in mentioned if (number := _possible(found, numbers)) is not None}
    return possible.pop() if len(possible) == 1 else None


def _possible(digits: str, numbers: list[int]) -> int | None:
    return int(digits) if int(digits) in numbers else None
