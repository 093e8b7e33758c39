"""Questions to a chat model and their answers in the trace."""

from collections import Counter
from collections.abc import Sequence

from hypernav.core.chat import Answer, Question
from hypernav.core.trace import Exchange, StepTrace


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
        chosen: Number of the chosen block, for a map question.
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
    """Number of a model's answers in a step that were of no use, by reason."""
    reasons = Counter[str]()
    for exchange in step.exchanges:
        reason = exchange.fault
        if exchange.kind == "ground":  # a faulty text may hold boxes all the same
            reason = "" if step.detections else reason or next(iter(exchange.remarks), "")
        if exchange.by_model and reason:
            reasons[reason] += 1
    return reasons
