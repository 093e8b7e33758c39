"""How an examined model errs, in a form from which its stand-ins draw their errors (`mimics`)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from hypernav.core.geometry.boxes import Box
from hypernav.exam.questions import EQUAL_M, Answered

_ELSEWHERE_IOU = 0.1
"""Overlap with the true box below which a box was drawn somewhere, not around the goal."""
_ALIKE_STRATA = (("near", "far"), ("absent", "look-alike"), ("not there", "look-alike"))
"""Strata that stand in for each other where an exam asked about one of them only."""

_Answer = TypeVar("_Answer")


@dataclass(frozen=True)
class BoxAnswer:
    """One answer to the question where the goal is in an image.

    Attributes:
        edges: The best box ``(x_min, y_min, x_max, y_max)``: from the upper left corner of the true
            box, in units of its sides, or of the image if it is elsewhere; None if there is none.
        score: Score of the best box.
        is_elsewhere: Whether it lies elsewhere than the goal.
    """

    edges: tuple[float, float, float, float] | None = None
    score: float = 1.0
    is_elsewhere: bool = False

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
        blocks: For every map, the share of the other blocks that were truly better than the chosen
            one; None where no block could be read, so that the geometric rule chooses. Empty if
            the model was not asked.
        boxes: By stratum the answers about images, the best first; empty if it was not asked.
        things_in_view: Mean number of things in these images.
        presence: By stratum whether the answer was that the goal is there, each "yes" first, then
            None for those that can't be used; empty if it was not asked.
    """

    blocks: tuple[float | None, ...]
    boxes: Mapping[str, tuple[BoxAnswer, ...]]
    things_in_view: float
    presence: Mapping[str, tuple[bool | None, ...]]


def confusion_of(answers: Sequence[Answered]) -> Confusion:
    """How a model erred in an exam, by all its answers."""
    boxes: dict[str, list[tuple[float, BoxAnswer]]] = {}
    presence: dict[str, list[bool | None]] = {}
    clutter = []
    for one in answers:
        if one.kind == "boxes":
            boxes.setdefault(one.stratum, []).append(_box_answer(one))
            clutter.append(one.conditions.get("clutter", 1.0))
        elif one.kind == "presence":
            is_yes = None if one.chosen is None else one.chosen == "yes"
            presence.setdefault(one.stratum, []).append(is_yes)
    best_first = {
        stratum: tuple(answer for _, answer in sorted(found, key=lambda pair: -pair[0]))
        for stratum, found in boxes.items()
    }
    yes_first = {
        stratum: tuple(sorted(said, key=(True, None, False).index))
        for stratum, said in presence.items()
    }
    return Confusion(
        tuple(_better_share(one) for one in answers if one.kind == "block"),
        _completed(best_first),
        max(sum(clutter) / len(clutter), 1.0) if clutter else 1.0,
        _completed(yes_first),
    )


def better_shares(costs: Mapping[int, float]) -> dict[int, float]:
    """For every option, the share of the others whose paths are clearly shorter.

    Args:
        costs: True lengths of the paths, metres; infinite where there is none.
    """
    others = max(len(costs) - 1, 1)
    return {
        option: sum(other < cost - EQUAL_M for other in costs.values()) / others
        for option, cost in costs.items()
    }


def _better_share(answered: Answered) -> float | None:
    if answered.chosen is None:
        return None
    costs = {int(option): answered.costs.get(option, math.inf) for option in answered.options}
    return better_shares(costs).get(int(answered.chosen))


def _box_answer(answered: Answered) -> tuple[float, BoxAnswer]:
    """An answer, and how good it is: by overlap where the goal is seen, else by having no box."""
    score = 1.0 if answered.probability is None else answered.probability
    if not answered.boxes:
        return (-1.0 if answered.true_boxes else 0.0), BoxAnswer()
    box, (width, height) = Box(*answered.boxes[0]), answered.image_size
    true = max((Box(*one) for one in answered.true_boxes), key=box.iou, default=None)
    if true is None or true.iou(box) < _ELSEWHERE_IOU:
        edges = (box.x_min / width, box.y_min / height, box.x_max / width, box.y_max / height)
        return (-score if true is None else 0.0), BoxAnswer(edges, score, is_elsewhere=True)
    w, h = true.x_max - true.x_min, true.y_max - true.y_min
    edges = (
        (box.x_min - true.x_min) / w,
        (box.y_min - true.y_min) / h,
        (box.x_max - true.x_min) / w,
        (box.y_max - true.y_min) / h,
    )
    return true.iou(box), BoxAnswer(edges, score)


def _completed(by_stratum: dict[str, tuple[_Answer, ...]]) -> dict[str, tuple[_Answer, ...]]:
    """The answers with those of a similar stratum where a stratum has none."""
    found = dict(by_stratum)
    for a, b in _ALIKE_STRATA:
        if by_stratum.keys() & {a, b}:
            found.setdefault(a, by_stratum.get(b, ()))
            found.setdefault(b, by_stratum.get(a, ()))
    return found
