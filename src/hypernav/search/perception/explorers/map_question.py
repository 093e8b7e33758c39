"""The question about the map, as a vision-language model gets it, and the block that it chooses."""

import math
import re
from dataclasses import dataclass, field
from typing import Any

from hypernav.core.chat import Answer, Question
from hypernav.core.components.protocols import BlockReasoner, ChatModel
from hypernav.core.exploring.overview import Block, BlockChoice, Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.answer_parsing import final_answer, shortened
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.exchanges import exchange_of

_DIRECTIONS = ("ahead", "ahead on the left", "on the left", "behind on the left")
_NUMBER_WORDS: tuple[str, ...] = (
    *("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"),
    *("eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen"),
    *("nineteen", "twenty"),
)
# A bare "one" is no number: "block 3 is the one to visit".
_IN_WORDS = re.compile(rf"(?:(?<=block )|(?<=number )|^)({'|'.join(_NUMBER_WORDS)})\b", re.I)
_DECLARED = (
    r"(?:answer|choice|choose|select|pick|go to|head (?:to|for)|visit|recommend)"
    r"(?:\s{1,4}(?:is|would be|the|to|with|for|should|be|number|block|no\.?)|[:*#\s]){0,24}(\d+)\b",
    r"\*\*\s*(?:block|number)?\s*(\d+)\s*\*\*",
)
_DENIED = re.compile(
    r"(?:\bnot\b|n['’]t\b|\bnever\b|\bavoid\b|\bskip\b|\brule out\b|\bexclud\w*|\binstead of\b"
    r"|\brather than\b)"
    r"(?:\s{1,4}(?:to|go|choose|pick|answer|visit|the|in|be)){0,8}\s{1,4}"
    r"(?:(?:blocks?|numbers?)\s{1,4}){0,2}"
    r"\[?\s*\d+(?:(?:\s*,\s*|\s+(?:and|or|nor)\s+)\d+)*\s*\]?",
    re.IGNORECASE,
)
_LAST_LINE = re.compile(
    r"^[^\w\n]{0,40}(?:final )?answer\W{1,40}(?:is\s{1,4})?(?:block\b|number\b|n\b)?[^\w\n]{0,40}"
    r"(?P<number>\w+)(?P<rest>[^\n]*)",
    re.IGNORECASE | re.MULTILINE,
)

_QUESTIONS = 2
"""Number of questions without a usable answer after which the fallback chooses."""


def offered_blocks(
    config: VlmReasonerConfig,
    overview: Overview,
    excluded: frozenset[int],
    *,
    elsewhere: bool = False,
) -> list[Block]:
    """The blocks that may be answered, in the order of their numbers.

    Args:
        config: What is offered.
        overview: Map and blocks.
        excluded: Numbers of the blocks that must not be answered.
        elsewhere: Whether blocks of other floors are offered, too.
    """
    offered = [
        block
        for block in (overview.everywhere if elsewhere else overview.blocks)
        if block.number not in excluded and block.frontier_cells >= config.min_frontier_cells
    ]
    longest = sorted(
        offered,
        key=lambda block: (block.connector is None, -block.frontier_cells, block.travel_m),
    )
    return sorted(longest[: config.max_blocks], key=lambda block: block.number)


def map_question(
    config: VlmReasonerConfig,
    overview: Overview,
    goal: Goal,
    excluded: frozenset[int] = frozenset(),
    *,
    hint: str = "",
) -> Question:
    """Question to a model about one map.

    Args:
        config: Form of the question.
        overview: Map and blocks.
        goal: Goal of the search.
        excluded: Numbers of the blocks that must not be answered.
        hint: Additional text about an answer that could not be used.
    """
    offered = offered_blocks(config, overview, excluded, elsewhere=True)
    numbers = [block.number for block in offered]
    shown, hatched = frozenset(numbers), excluded
    avoid = ""
    if config.list_excluded:
        shown, hatched = shown | excluded, frozenset[int]()
        # The paper's words for what was visited already.
        avoid = f" Don't answer number {sorted(excluded)}." if excluded else ""
    return Question(
        kind="choose block",
        text=_text(config, overview, goal, offered, shown) + avoid + hint,
        images=(overview.draw(shown, hatched),),
        allowed=tuple(map(str, numbers)) if config.mode == "constrained" else (),
        max_tokens=8 if config.mode == "constrained" else config.max_tokens,
    )


def _text(
    config: VlmReasonerConfig,
    overview: Overview,
    goal: Goal,
    offered: list[Block],
    shown: frozenset[int],
) -> str:
    is_reasoned = config.mode == "reasoned"
    answerable = [block.number for block in offered] if is_reasoned else sorted(shown)
    numbers = ", ".join(map(str, answerable))
    return config.words.format(
        goal=goal.thing,
        legend=overview.legend,
        facts=_facts(offered, overview) if config.facts else numbers,
        numbers=numbers,
    )


def _facts(blocks: list[Block], overview: Overview) -> str:
    """What is known of each block, a line for each."""
    boundary = max(sum(b.frontier_cells for b in overview.everywhere if not b.words), 1)
    lines = []
    for block in blocks:
        there = overview.floor_of(block.number)
        if there is None:
            trajectory, seen_things = overview.trajectory, overview.things
            where = _whereabouts(block, overview.robot)
        else:
            trajectory, seen_things = there.known.trajectory, there.known.things
            where = f"on {there.known.words}, {_far(block)}"
        if block.connector is not None:
            lines.append(f"- block {block.number}: {block.words} to another floor; {where}")
            continue
        if block.words:
            lines.append(
                f"- block {block.number}: {block.words} there, stairs down may begin; {where}"
            )
            continue
        share = block.frontier_cells / boundary
        borders = f"{share:.0%} of the boundary to the unexplored" if share else "nothing new"
        was_there = any(map(block.holds, trajectory))
        visited = "the robot was there" if was_there else "not visited yet"
        seen = sorted({one.label for one in seen_things if block.holds(one.position)})
        things = f"; seen there: {', '.join(seen)}" if seen else ""
        lines.append(f"- block {block.number}: {where}; {borders}; {visited}{things}")
    return "\n".join(lines)


def _whereabouts(block: Block, robot: Pose2) -> str:
    """Distance and direction of a block, for example "3.2 m away, ahead on the left"."""
    bearing = robot.bearing_to(*block.destination)
    eighth = round(abs(bearing) / (math.pi / 4.0))
    words = _DIRECTIONS[eighth] if eighth < len(_DIRECTIONS) else "behind"
    return f"{_far(block)}, {words if bearing > 0 else words.replace('left', 'right')}"


def _far(block: Block) -> str:
    return f"{block.travel_m:.1f} m away" if math.isfinite(block.travel_m) else "out of reach"


def chosen_number(question: Question, answer: Answer, numbers: list[int]) -> int | None:
    """The block that an answer to a map question chooses; None if it names none.

    Args:
        question: Question that was asked.
        answer: Answer of the model.
        numbers: Numbers of the blocks that may be answered.
    """
    if answer.fault is not None:
        return None
    return int(answer.value) if question.allowed else summarised(answer.text, numbers)


def summarised(text: str, numbers: list[int]) -> int | None:
    """The one block that a free answer chooses, by rules; None if they find none or several.

    In this order: the last line "Answer: N"; an answer that is nothing but a number; the only
    possible number that one form of words declares to be the answer; the only possible number that
    is mentioned at all. For the last two, numbers named in order not to be chosen do not count, and
    for the last, those with a unit behind them.
    """
    said = final_answer(text)
    *_, line = [None, *_LAST_LINE.finditer(said)]
    if line is not None and (number := _in_digits(line["number"])) is not None:
        others = {int(found) for found in re.findall(r"\d{1,6}", line["rest"])} - {int(number)}
        return None if others & set(numbers) else _possible(number, numbers)
    said = _IN_WORDS.sub(lambda match: _in_digits(match[1]) or "", said)
    bare = re.fullmatch(r"\W*(?:(?:block|number)\W*)?(\d{1,6})\W*", said, re.IGNORECASE)
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


def _in_digits(word: str) -> str | None:
    """A number that is written in digits or as a word, in digits."""
    if word.lower() in _NUMBER_WORDS:
        return str(_NUMBER_WORDS.index(word.lower()))
    return word if word.isdecimal() and word.isascii() else None


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
