"""Numbers of blocks in the free answers of models."""

import re

from hypernav.core.chat import Answer, Question
from hypernav.models.chat.answer_parsing import without_thinking

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


_LAST_LINE = re.compile(
    r"^\W*(?:final )?answer\W+(?:is\s+)?(?:block|number|n)?[^\w\n]*(\w+)",
    re.IGNORECASE | re.MULTILINE,
)


def chosen_number(question: Question, answer: Answer, numbers: list[int]) -> int | None:
    """The block that an answer to a map question chooses; None if it names none.

    Args:
        question: Question that was asked.
        answer: Answer of the model.
        numbers: Numbers of the blocks that may be answered.
    """
    if question.allowed:
        return None if answer.fault is not None else int(answer.value)
    return summarised(answer.text, numbers)


def summarised(text: str, numbers: list[int]) -> int | None:
    """The one block that a free answer chooses, by rules; None if they find none or several.

    In this order: a last line "Answer: N"; an answer that is nothing but a number; a number that is
    declared to be the answer (the last such); the only possible number that is mentioned at all.
    Numbers that are named in order not to be chosen do not count, nor do those with a unit behind
    them.
    """
    said = without_thinking(text)
    lines = _LAST_LINE.findall(said)
    if lines and (number := _in_digits(lines[-1])) is not None:
        return _possible(number, numbers)
    said = _IN_WORDS.sub(lambda match: _in_digits(match[1]) or "", said)
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


def _in_digits(word: str) -> str | None:
    """A number that is written in digits or as a word, in digits."""
    if word.lower() in _NUMBER_WORDS:
        return str(_NUMBER_WORDS.index(word.lower()))
    return word if word.isdecimal() and word.isascii() else None
