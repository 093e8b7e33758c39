"""What a search takes from an exam's answers.

Stand-ins draw their errors from how the model erred (`mimics`); a search with the model itself
takes its probabilities and scores for what they are worth (`hypernav.build.exam_file`).
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.optimize import isotonic_regression

from hypernav.build.exam_file import Worth
from hypernav.core.curve import Curve
from hypernav.core.geometry.boxes import Box
from hypernav.exam.choices import BlockChoices, choices_of
from hypernav.exam.questions import Answered
from hypernav.perception.local.persistence import touches_edge

_ELSEWHERE_IOU = 0.1
"""Overlap with the true box below which a box was drawn somewhere and does not lead to the goal."""
_LEAST = 8
"""Least number of answers with the goal there, and without it, to judge probabilities by."""
_NO_BOX = -1.0
"""Score of an answer without a box: less than that of any box."""
_Answer = TypeVar("_Answer")


@dataclass(frozen=True)
class BoxAnswer:
    """One answer to the question where the goal is in an image.

    Attributes:
        edges: The best box ``(x_min, y_min, x_max, y_max)``: from the upper left corner of the true
            box, in units of its sides, or of the image if it is elsewhere; None if there is none.
        score: Score of the best box.
        is_elsewhere: Whether it lies elsewhere than the goal.
        side: Square root of the true box's share of the image; 0 where the goal is not seen.
        distance_m: Distance to the goal, metres; infinite where it has no depth.
        is_cut_off: Whether the edge of the image cuts the goal off.
    """

    edges: tuple[float, float, float, float] | None = None
    score: float = 1.0
    is_elsewhere: bool = False
    side: float = 0.0
    distance_m: float = math.inf
    is_cut_off: bool = False

    def about(self, true: Box, width: int, height: int) -> Box | None:
        """The box with the same error, for another true box and image; None for no box."""
        if self.edges is None:
            return None
        around = Box(0.0, 0.0, width, height) if self.is_elsewhere else true
        w, h = around.x_max - around.x_min, around.y_max - around.y_min
        left, top, right, bottom = self.edges
        x_min = min(max(around.x_min + left * w, 0.0), width - 1.0)
        y_min = min(max(around.y_min + top * h, 0.0), height - 1.0)
        x_max = min(max(around.x_min + right * w, x_min + 1.0), float(width))
        y_max = min(max(around.y_min + bottom * h, y_min + 1.0), float(height))
        return Box(x_min, y_min, x_max, y_max)


@dataclass(frozen=True)
class Confusion:
    """The answers of an exam, so that the same errors can be made in searches.

    Attributes:
        blocks: Which blocks it chooses how often; None if it was not asked.
        seen: The answers about images with the goal, the best first; empty if it was not asked.
        unseen: By stratum the answers about images without the goal, those with a box first; empty
            if it was not asked.
        things_in_view: Mean number of things in these images.
        presence: By stratum whether the answer was that the goal is there, each "yes" first, then
            None for those that can't be used; empty if it was not asked.
    """

    blocks: BlockChoices | None
    seen: tuple[BoxAnswer, ...]
    unseen: Mapping[str, tuple[BoxAnswer, ...]]
    things_in_view: float
    presence: Mapping[str, tuple[bool | None, ...]]


def confusion_of(answers: Sequence[Answered]) -> Confusion:
    """How a model erred in an exam, by all its answers."""
    images = [one for one in answers if one.kind == "boxes"]
    clutter = [one.conditions.get("clutter", 1.0) for one in images]
    seen = sorted(map(_box_answer, (o for o in images if o.true_boxes)), key=lambda pair: -pair[0])
    unseen: dict[str, list[BoxAnswer]] = {}
    for one in images:
        if not one.true_boxes:
            unseen.setdefault(one.stratum, []).append(_box_answer(one)[1])
    presence: dict[str, list[bool | None]] = {}
    for one in answers:
        if one.kind == "presence":
            is_yes = None if one.chosen is None else one.chosen == "yes"
            presence.setdefault(one.stratum, []).append(is_yes)
    return Confusion(
        blocks=choices_of(answers),
        seen=tuple(answer for _, answer in seen),
        unseen=_completed(unseen, ("absent", "look-alike"), lambda one: one.edges is None),
        things_in_view=max(sum(clutter) / len(clutter), 1.0) if clutter else 1.0,
        presence=_completed(presence, ("not there", "look-alike"), (True, None, False).index),
    )


def _box_answer(answered: Answered) -> tuple[float, BoxAnswer]:
    """An answer, and how well its box fits the goal; less than 0 for none."""
    width, height = answered.image_size
    score = 1.0 if answered.probability is None else answered.probability
    trues = [Box(*one) for one in answered.true_boxes]
    side = math.sqrt(trues[0].area / (width * height)) if trues else 0.0
    away_m = answered.conditions.get("distance_m", math.inf)
    is_cut = bool(trues) and touches_edge(trues[0], width, height)
    if not answered.boxes:
        return -1.0, BoxAnswer(side=side, distance_m=away_m, is_cut_off=is_cut)
    box = Box(*answered.boxes[0])
    true = max(trues, key=box.iou, default=None)
    is_elsewhere = true is None or true.iou(box) < _ELSEWHERE_IOU
    around = Box(0.0, 0.0, width, height) if true is None or is_elsewhere else true
    w, h = around.x_max - around.x_min, around.y_max - around.y_min
    edges = (
        (box.x_min - around.x_min) / w,
        (box.y_min - around.y_min) / h,
        (box.x_max - around.x_min) / w,
        (box.y_max - around.y_min) / h,
    )
    fit = 0.0 if true is None else true.iou(box)
    return fit, BoxAnswer(edges, score, is_elsewhere, side, away_m, is_cut)


def _completed(
    by_stratum: dict[str, list[_Answer]],
    alike: tuple[str, str],
    order: Callable[[_Answer], float],
) -> dict[str, tuple[_Answer, ...]]:
    """The answers in order; of two strata that are alike, one stands in for the other."""
    found = {stratum: tuple(sorted(some, key=order)) for stratum, some in by_stratum.items()}
    for stratum, other in (alike, alike[::-1]):
        if stratum not in found and other in found:
            found[stratum] = found[other]
    return found


def worth_of(answers: Sequence[Answered]) -> Worth:
    """What the probabilities and scores of a model are worth."""
    checks = [
        (_yes(one), "yes" in one.right)
        for one in answers
        if one.kind == "presence" and one.chosen is not None
    ]
    boxes = _true_probabilities(_boxes(answers))
    log_odds = tuple((score, round(math.log(p / (1.0 - p)), 3)) for score, p in boxes)
    return Worth(presence=_true_probabilities(checks), boxes=log_odds)


def _yes(answered: Answered) -> float:
    """The probability of "yes" that an answer tells."""
    told = 1.0 if answered.probability is None else answered.probability
    return told if answered.chosen == "yes" else 1.0 - told


def _boxes(answers: Sequence[Answered]) -> list[tuple[float, bool]]:
    """Scores of the best boxes, and whether they lead to the goal; a goal without one is missed."""
    found = []
    for one in answers:
        if one.kind != "boxes":
            continue
        score = 1.0 if one.probability is None else one.probability
        told = score if one.boxes else _NO_BOX
        if one.true_boxes and (one.overlap or 0.0) < _ELSEWHERE_IOU:
            found.append((_NO_BOX, True))
            found += [(told, False)] if one.boxes else []
        else:
            found.append((told, bool(one.true_boxes)))
    return found


def _true_probabilities(told: Sequence[tuple[float, bool]]) -> Curve:
    """Told values with the probability that it is so, if it were so in half of all cases.

    The probability never falls with the value (isotonic regression). Half a case of the side with
    fewer answers is added to both sides of every step, so that few answers make nothing certain,
    and an answer that is as frequent on both sides is worth nothing. Answers without a box, whose
    value is negative, have no point of their own.
    """
    said, so = np.round([v for v, _ in told], 3), np.array([is_so for _, is_so in told], dtype=bool)
    counts = (int(so.sum()), int((~so).sum()))
    if min(counts) < _LEAST:
        return ()
    _, where = np.unique(said, return_inverse=True)  # equal values are one step
    weights = np.bincount(where, np.where(so, 1.0 / counts[0], 1.0 / counts[1]))
    rises = np.bincount(where, np.where(so, 1.0 / counts[0], 0.0)) / weights
    blocks = isotonic_regression(rises, weights=weights).blocks
    half, points = 0.5 / min(counts), []
    for first, last in itertools.pairwise(blocks.tolist()):
        mine = (where >= first) & (where < last)
        if not (mine & (said >= 0.0)).any():
            continue
        yes = so[mine].sum() / counts[0] + half
        no = (~so[mine]).sum() / counts[1] + half
        points.append((float(said[mine & (said >= 0.0)].mean()), float(yes / (yes + no))))
    highest = np.maximum.accumulate([p for _, p in points]).tolist()
    return tuple((v, round(p, 4)) for (v, _), p in zip(points, highest, strict=True))
