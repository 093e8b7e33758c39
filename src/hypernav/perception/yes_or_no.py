"""Questions that a chat model answers with yes or no."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.trace import ExchangeLog
from hypernav.perception.exchanges import exchange_of


def yes_no_question(kind: str, text: str, image: Image) -> Question:
    """Question about an image that yes and no are the only answers to.

    Args:
        kind: Kind of the question, for the trace.
        text: The question.
        image: RGB.
    """
    return Question(kind=kind, text=text, images=(image,), allowed=("yes", "no"), max_tokens=8)


def probability_of_yes(answer: Answer) -> float | None:
    """Probability of yes, 1 or 0 where the model tells none; None if it is neither yes nor no."""
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
            otherwise: What an answer that is neither comes to, for the trace.

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
