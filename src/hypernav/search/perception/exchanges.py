"""Questions to a chat model: their configured texts, their answers in the trace, yes or no."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.trace import Exchange, ExchangeLog, StepTrace


def prompt_hash(prompt: str) -> str:
    """The first 12 hexadecimal digits of the text's SHA-256, which tell versions apart."""
    return hashlib.sha256(prompt.encode()).hexdigest()[:12]


def exchange_of(
    question: Question,
    answer: Answer,
    *,
    chosen: int | None = None,
    excluded: Sequence[int] = (),
    remarks: Sequence[str] = (),
) -> Exchange:
    """The trace's record of an answered question.

    Args:
        question: Question that was asked.
        answer: Answer of the model.
        chosen: Number of the chosen block or arrow, where one was asked for.
        excluded: Numbers of the blocks that were ruled out beforehand.
        remarks: Oddities of the answer.
    """
    return Exchange(
        kind=question.kind,
        asked=answer.model,
        by_model=True,
        question=question.text,
        answer=answer.text,
        chosen=chosen,
        excluded=list(excluded),
        probabilities={key: round(float(p), 6) for key, p in answer.probabilities.items()},
        tokens_in=answer.usage.tokens_in,
        tokens_out=answer.usage.tokens_out,
        seconds=answer.seconds,
        fault="" if answer.fault is None else answer.fault.value,
        remarks=list(remarks),
    )


def unusable_answers(step: StepTrace) -> Counter[str]:
    """Number of a model's answers in a step that could not be used, by reason."""
    reasons = Counter[str]()
    for exchange in step.exchanges:
        reason = exchange.fault
        if exchange.kind == "ground":  # a faulty text may hold boxes all the same
            reason = "" if step.detections else reason or next(iter(exchange.remarks), "")
        if exchange.by_model and reason:
            reasons[reason] += 1
    return reasons


def yes_no_question(kind: str, text: str, image: Image) -> Question:
    """Question about an image, to which yes and no are the only answers.

    Args:
        kind: Purpose of the question; see `Question.kind`.
        text: The question.
        image: RGB.
    """
    return Question(kind=kind, text=text, images=(image,), allowed=("yes", "no"), max_tokens=8)


def probability_of_yes(answer: Answer) -> float | None:
    """Probability of yes; 1 or 0 if the model gives none; None if it is neither yes nor no."""
    if answer.fault is not None:
        return None
    return float(answer.probabilities.get("yes", answer.value == "yes"))


@dataclass(eq=False)
class YesNoAsker:
    """Asks, keeps question and answer for the trace, and counts what is neither yes nor no.

    Attributes:
        chat: Chat model to ask.
        log: Log of all questions and answers, for the trace.
        unsure: Number of answers that were neither yes nor no since the last report.
        count_name: Name of this count in reports.
    """

    chat: ChatModel
    log: ExchangeLog
    unsure: int = field(default=0, init=False)

    count_name: ClassVar[str] = "unsure_answers"

    def ask(self, question: Question, otherwise: str = "") -> float | None:
        """Probability of yes, 0 to 1; None if the answer is neither yes nor no.

        Args:
            question: Question with the answers yes and no.
            otherwise: What an answer that is neither counts as, for the trace.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        answer = self.chat.ask(question)
        yes = probability_of_yes(answer)
        self.unsure += yes is None
        remark = "; ".join(filter(None, (answer.detail, otherwise)))
        self.log.record(exchange_of(question, answer, remarks=[remark] if yes is None else []))
        return yes

    def take_report(self) -> dict[str, Any]:
        """Number of answers that were neither yes nor no since the last call."""
        report, self.unsure = {self.count_name: self.unsure}, 0
        return report
