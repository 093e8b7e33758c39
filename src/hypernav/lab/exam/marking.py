"""Marks one answer by the truth of its question."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from hypernav.core.exploring.overview import Overview
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.observation import Observation
from hypernav.core.trace import Exchange
from hypernav.lab.exam.questions import NO_IMAGE, RIGHT_IOU, Answered, ExamQuestion, Role, Shown
from hypernav.search.models.chat.answer_parsing import final_answer
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.stand_ins.noisy_detector import resembles
from hypernav.search.perception.local.stand_ins.systematic_detector import view_of

_CORNERS = re.compile(r"(?:-?\d+(?:\.\d+)?[\s,()\[\]]+){3}-?\d")
"""Four successive numbers, as of a box."""


@dataclass(frozen=True)
class Given:
    """What a component answered.

    Attributes:
        chosen: Option; None if it named none, or if boxes or a mask were asked for.
        found: Boxes, pixels of the question's image.
        mask: Pixels of the goal; None if no mask was asked for.
        probability: Score of the best box, 0 to 1; None without boxes.
    """

    chosen: str | None = None
    found: tuple[Detection, ...] = ()
    mask: Bool[np.ndarray, "height width"] | None = None
    probability: float | None = None


def marked(question: ExamQuestion, given: Given, exchanges: list[Exchange]) -> Answered:
    """The record of a question and its answer, marked by the truth."""
    unusable = _unusable(question, given, exchanges)
    chosen = None if unusable and question.kind != "boxes" else given.chosen
    costs = {key: cost for key, cost in question.costs.items() if np.isfinite(cost)}
    options = _options(question)
    overlap = _overlap(question, given)
    score = _score(question, chosen, given, overlap) if not unusable else 0.0
    image = getattr(question.subject, "rgb", None)
    texts = [final_answer(one.answer) for one in exchanges if one.kind == "ground"]
    return Answered(
        id=question.id,
        kind=question.kind,
        stratum=question.stratum,
        scene=question.scene,
        goal=question.goal.text,
        conditions={k: round(v, 3) for k, v in question.conditions.items() if np.isfinite(v)},
        options=options,
        right=sorted(question.right),
        costs={key: round(cost, 3) for key, cost in costs.items()},
        travel=_travel(question),
        chosen=chosen,
        rule=question.rule,
        true_boxes=[_corners(box) for box in question.boxes],
        boxes=[_corners(one.box) for one in _best_first(given.found)],
        things=_things(question, given),
        raw_boxes=bool(given.found) or any(_CORNERS.search(text) for text in texts),
        image_size=(0, 0) if image is None else (image.shape[1], image.shape[0]),
        score=score,
        chance=len(question.right) / len(options) if options else 0.0,
        rule_score=float(question.rule in question.right) if question.rule else None,
        overlap=overlap,
        probability=_probability(question, chosen, given, exchanges),
        unusable=unusable,
        exchanges=exchanges,
    )


def _options(question: ExamQuestion) -> list[str]:
    """The options; of images one or none, though an answer may name several."""
    if isinstance(question.subject, tuple):
        return [*(str(k + 1) for k in range(len(question.subject))), NO_IMAGE]
    return list(question.costs) or (["yes", "no"] if question.right else [])


def _travel(question: ExamQuestion) -> dict[str, float]:
    if not isinstance(question.subject, Overview):
        return {}
    return {
        str(block.number): round(block.travel_m, 3)
        for block in question.subject.blocks
        if str(block.number) in question.costs and np.isfinite(block.travel_m)
    }


def _things(question: ExamQuestion, given: Given) -> list[Shown]:
    """What the image of a question for boxes shows; a box is of the thing that it fits best."""
    if question.kind != "boxes" or not isinstance(question.subject, Observation):
        return []
    truth, goal = true_labels(question.subject), question.goal
    trues = {number: true_detection(truth, number) for number in visible_objects(truth)}
    boxed = set[int]()
    for one in given.found:
        fits = {number: true.box.iou(one.box) for number, true in trues.items()}
        best = max(fits, key=fits.__getitem__, default=None)
        if best is not None and fits[best] > 0.0:
            boxed.add(best)
    shown = []
    for number, true in trues.items():
        label = truth.labels[number]
        role: Role = "alike" if resembles(label, goal) else "other"
        shown.append(
            Shown(
                number=number,
                name=label.category,
                role="goal" if label.satisfies(goal) else role,
                boxed=number in boxed,
                view=view_of(true, question.subject),
            )
        )
    return shown


def _score(
    question: ExamQuestion, chosen: str | None, given: Given, overlap: float | None
) -> float:
    if question.kind == "mask" or question.boxes:
        return float(overlap is not None and overlap >= RIGHT_IOU)
    if question.kind == "boxes":
        return float(not given.found)
    if question.kind == "images":  # one that shows the goal is enough to go there, none may lack it
        return float(chosen is not None and question.right.issuperset(chosen.split(", ")))
    return float(chosen in question.right)


def _overlap(question: ExamQuestion, given: Given) -> float | None:
    """IoU with the truth: of the mask, or of the best box with the true one it fits best."""
    if question.mask is not None and given.mask is not None:
        both = np.count_nonzero(question.mask & given.mask)
        return both / max(np.count_nonzero(question.mask | given.mask), 1)
    if question.kind != "boxes" or not question.boxes:
        return None
    first = _best_first(given.found)[:1]
    return max((true.iou(one.box) for one in first for true in question.boxes), default=0.0)


def _unusable(question: ExamQuestion, given: Given, exchanges: list[Exchange]) -> str:
    """Why an answer can't be used; empty if it can, or if no model gave it."""
    asked = [one for one in exchanges if one.by_model]
    if not asked:
        return ""
    main = next((one for one in asked if one.kind != "crop"), asked[0])
    reason = main.fault or next(iter(main.remarks), "")
    if question.kind == "boxes":
        return "" if given.found or not _is_unread(main) else reason
    if question.kind == "images":
        return reason
    if question.kind in ("block", "arrow"):
        return "" if given.chosen is not None else reason or "it names none of the options"
    return main.fault and (reason or main.fault)


def _is_unread(exchange: Exchange) -> bool:
    """Whether no box could be read and the answer doesn't say that there is none."""
    return bool(exchange.fault) or any(
        remark == "no box in the answer" or remark.startswith(tuple("123456789"))
        for remark in exchange.remarks
    )


def _probability(
    question: ExamQuestion, chosen: str | None, given: Given, exchanges: list[Exchange]
) -> float | None:
    """Probability, 0 to 1, that the model gives its answer; None if it gives none."""
    told: list[Mapping[str, float]] = [one.probabilities for one in exchanges if one.probabilities]
    if question.kind == "boxes":
        return given.probability
    if chosen is None or not told:
        return None
    return told[-1].get(chosen)


def _best_first(found: tuple[Detection, ...]) -> list[Detection]:
    return sorted(found, key=lambda one: -one.score)


def _corners(box: Box) -> tuple[float, float, float, float]:
    return (round(box.x_min, 1), round(box.y_min, 1), round(box.x_max, 1), round(box.y_max, 1))
