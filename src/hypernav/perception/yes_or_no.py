"""Questions that a chat model answers with yes or no."""

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.trace import ExchangeLog
from hypernav.perception.exchanges import exchange_of


def yes_no_question(kind: str, text: str, image: Image) -> Question:
    """Question about an image, of whose answer only yes or no counts.

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


class YesNoAsker:
    """Asks, keeps question and answer for the trace, and counts what is neither yes nor no."""

    def __init__(self, chat: ChatModel, log: ExchangeLog) -> None:
        """Create it.

        Args:
            chat: Chat model to ask.
            log: Log of all questions and answers, for the trace.
        """
        self._chat = chat
        self._log = log
        self._unsure = 0

    def ask(self, question: Question, otherwise: str = "") -> float | None:
        """Probability of yes, 0 to 1; None if the answer is neither yes nor no.

        Args:
            question: Question with the answers yes and no.
            otherwise: What an answer that is neither comes to, for the trace.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        answer = self._chat.ask(question)
        yes = probability_of_yes(answer)
        self._unsure += yes is None
        remark = "; ".join(filter(None, (answer.detail, otherwise)))
        self._log.record(exchange_of(question, answer, remarks=[remark] if yes is None else []))
        return yes

    def take_unsure(self) -> int:
        """Number of answers that were neither yes nor no since the last call."""
        unsure, self._unsure = self._unsure, 0
        return unsure
