"""Chat models for tests that need no server."""

from collections.abc import Callable

import numpy as np

from hypernav.core.chat import Answer, Question, Usage
from hypernav.search.models.chat.answer_parsing import parse_answer


def image(seed: int = 0, height: int = 48, width: int = 64) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 255, (height, width, 3)).astype(np.uint8)


class Parrot:
    """Says what it is told to say, one text after the other; the last one again and again."""

    def __init__(self, *says: str | Exception | Callable[[Question], str]) -> None:
        self.says = list(says)
        self.asked: list[Question] = []

    def identify(self) -> str:
        return "parrot/Qwen2.5-VL"

    def ask(self, question: Question) -> Answer:
        self.asked.append(question)
        text = self.says.pop(0) if len(self.says) > 1 else self.says[0]
        if isinstance(text, Exception):
            raise text
        text = text(question) if callable(text) else text
        return parse_answer(
            question, text, model=self.identify(), usage=Usage(100, len(text)), seconds=0.25
        )
