"""What the probabilities and scores of an examined model are worth in searches with it."""

import itertools
import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.optimize import isotonic_regression

from hypernav.app.build.components.exam_file import Calibration
from hypernav.core.config import Curve
from hypernav.lab.exam.questions import Answered
from hypernav.search.memory.candidate import log_odds_by

_ELSEWHERE_IOU = 0.1
"""Overlap with the true box below which a box was drawn somewhere and does not lead to the goal."""
_LEAST = 8
"""Least number of answers with the goal there, and without it, to judge probabilities by."""
_SHIFTS = np.linspace(-3.0, 3.0, 241)
"""Shifts of the weight of a look that are compared."""
NO_BOX = -1.0
"""Score of an answer without a box: less than that of any box."""


def calibration_of(answers: Sequence[Answered]) -> Calibration:
    """What the probabilities and scores of a model are worth."""
    checks = [
        (_yes(one), "yes" in one.right)
        for one in answers
        if one.kind == "presence" and one.chosen is not None
    ]
    boxes, _ = log_odds_of(_boxes(answers))
    return Calibration(presence=_true_probabilities(checks), boxes=boxes)


def log_odds_of(told: Sequence[tuple[float, bool]]) -> tuple[Curve, float]:
    """What scores are worth, as shifts of the log-odds, and what it is worth that there is no box.

    Args:
        told: Scores, or `NO_BOX`, and whether it was the goal.

    Returns:
        The curve, empty if too little was told, and the shift without a box, 0 if too little was.
    """
    curve = tuple((s, round(math.log(p / (1.0 - p)), 3)) for s, p in _true_probabilities(told))
    counts = Counter(is_so for _, is_so in told)
    if min(counts[True], counts[False]) < _LEAST:
        return curve, 0.0
    none = Counter(is_so for score, is_so in told if score < 0.0)
    half = 0.5 / min(counts[True], counts[False])
    yes, no = (none[is_so] / counts[is_so] + half for is_so in (True, False))
    return curve, round(math.log(yes / no), 3)


def shift_of_looks(things: Sequence[tuple[Sequence[float], bool]]) -> float:
    """What to add to the weight of every look, so that the odds of things come out right.

    Looks at one thing share their errors, and the more a network names, the less a name is worth.
    So each look that `log_odds_of` weighs alone is weighed once more together with those before it.

    Args:
        things: For each thing the weights of the looks at it, from the first box on, and whether it
            is what it was taken for.
    """
    sums = np.concatenate([np.cumsum(weights) for weights, _ in things])
    looks = np.concatenate([np.arange(1.0, len(weights) + 1.0) for weights, _ in things])
    signs = np.concatenate([np.full(len(weights), 1.0 if so else -1.0) for weights, so in things])

    def loss(shift: float) -> float:
        odds = [log_odds_by([total]) for total in (sums + shift * looks).tolist()]
        return float(np.logaddexp(0.0, -signs * odds).sum())

    return min(_SHIFTS.tolist(), key=loss)


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
        told = score if one.boxes else NO_BOX
        if one.true_boxes and (one.overlap or 0.0) < _ELSEWHERE_IOU:
            found.append((NO_BOX, True))
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
