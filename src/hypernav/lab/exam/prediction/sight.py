"""How an examined model finds goals in images: whether at all, and where its boxes lie."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize
from scipy.special import expit, log_expit

from hypernav.core.geometry.boxes import Box
from hypernav.lab.exam.prediction.agreement import agreement_of, likeness_of
from hypernav.lab.exam.questions import Answered
from hypernav.search.perception.local.stand_ins.systematic_detector import (
    SAME_THING_FOUND,
    STANDARD_NORMAL,
    touches_edge,
)

_Answer = TypeVar("_Answer")
_FAR_M = 10.0
"""Distance beyond which a thing is as far as it gets, metres."""
_SIMILAR = 2.0
"""Number of answers about the most similar goals, in square roots of the number of all."""
_SURE = 0.98
"""Fitted chance above which an exception still tells of the thing, not of the model."""
_RIDGE = 0.0001
"""How strongly the chance of a find is drawn towards depending on nothing; ours."""


@dataclass(frozen=True)
class BoxAnswer:
    """One answer to the question where the goal is in an image.

    Attributes:
        edges: The best box ``(x_min, y_min, x_max, y_max)``: from the upper left corner of the true
            box, in units of its sides, or of the image if it is elsewhere; None if there is none.
        score: Score of the best box.
        is_elsewhere: Whether it does not even overlap the goal.
        side: Square root of the true box's share of the image.
        distance_m: Distance to the goal, metres; infinite where it has no depth.
        is_cut_off: Whether the edge of the image cuts the goal off.
    """

    edges: tuple[float, float, float, float] | None = None
    score: float = 1.0
    is_elsewhere: bool = False
    side: float = 1.0
    distance_m: float = math.inf
    is_cut_off: bool = False

    @property
    def is_found(self) -> bool:
        """Whether there is a box, and it leads to the goal."""
        return self.edges is not None and not self.is_elsewhere

    def same_error_on(self, true: Box, width: int, height: int) -> Box | None:
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
class Sight:
    """How a model finds goals.

    Attributes:
        found: The answers that lead to the goal, the best box first.
        missed: The others, those with a box elsewhere first.
        weights: Of `_features`, for the log odds that a goal is found.
        by_thing: How alike it is, in views of one thing, whether that is found, beyond what size,
            distance and the image's edge explain: 0 to 1.
        box_by_thing: How alike the boxes of one thing are in how well they fit: 0 to 1.
    """

    found: tuple[BoxAnswer, ...]
    missed: tuple[BoxAnswer, ...]
    weights: Float[np.ndarray, " features"]
    by_thing: float
    box_by_thing: float

    def chance(self, asked: BoxAnswer) -> float:
        """Probability that a goal of this size, at this distance, is found."""
        if not self.found or not self.missed:
            return float(bool(self.found))
        return float(expit(_features(asked) @ self.weights))

    def answer(self, asked: BoxAnswer, level: float, box_level: float) -> BoxAnswer:
        """What is answered about a goal.

        Args:
            asked: The goal; its box doesn't matter.
            level: Number from 0, where everything is found that ever can be, to 1.
            box_level: Number from 0, where the box is the best that such goals get, to 1.
        """
        chance = self.chance(asked)
        if level < chance:
            return drawn(_similar(self.found, asked), box_level)
        return drawn(_similar(self.missed, asked), (level - chance) / (1.0 - chance))


def sight_of(answers: Sequence[Answered]) -> Sight | None:
    """How a model finds goals, by its answers about images with the goal; None without any."""
    if not answers:
        return None
    told = sorted(((*_box_answer(one), _goal_in(one)) for one in answers), key=lambda one: -one[0])
    found = [answer for _, answer, _ in told if answer.is_found]
    missed = [answer for _, answer, _ in told if not answer.is_found]
    weights = _fitted([*found, *missed])
    fitted = Sight(tuple(found), tuple(missed), weights, SAME_THING_FOUND, 0.0)
    # Of each thing one image from each side, which are hardly two. Of boxes the ranks, as normal
    # numbers: one is better or worse than others, by how much doesn't matter.
    once = {view: answer for _, answer, view in told}
    ranked = [view for view, answer in once.items() if answer.is_found]
    places = (np.arange(len(ranked)) + 0.5) / max(len(ranked), 1)
    return replace(
        fitted,
        by_thing=agreement_of(
            [answer.is_found for answer in once.values()],
            [min(max(fitted.chance(answer), 1.0 - _SURE), _SURE) for answer in once.values()],
            [about for about, _ in once],
            SAME_THING_FOUND,
        ),
        box_by_thing=likeness_of(
            [STANDARD_NORMAL.inv_cdf(place) for place in places.tolist()],
            [about for about, _ in ranked],
        ),
    )


def drawn(answers: Sequence[_Answer], level: float) -> _Answer:
    """One of the answers, which are in order, by its level from 0 to 1."""
    return answers[min(int(level * len(answers)), len(answers) - 1)]


def _similar(answers: Sequence[BoxAnswer], asked: BoxAnswer) -> list[BoxAnswer]:
    """The answers about goals of the most similar size and distance, in their order."""
    here = _features(asked)
    apart = [float(np.abs(_features(one) - here).sum()) for one in answers]
    count = math.ceil(_SIMILAR * math.sqrt(len(answers)))
    nearest = sorted(range(len(answers)), key=lambda k: apart[k])[:count]
    return [answers[k] for k in sorted(nearest)]


def _features(asked: BoxAnswer) -> Float[np.ndarray, " features"]:
    """What finding a goal depends on: a constant, size, distance, and the edge of the image."""
    away_m = min(asked.distance_m, _FAR_M)
    return np.array([1.0, math.log(asked.side), math.log(away_m), float(asked.is_cut_off)])


def _fitted(answers: Sequence[BoxAnswer]) -> Float[np.ndarray, " features"]:
    """Weights of greatest likelihood (logistic regression), but small if answers tell little."""
    features = np.stack([_features(one) for one in answers])
    signs = np.array([1.0 if one.is_found else -1.0 for one in answers])

    def unlikelihood(weights: Float[np.ndarray, " features"]) -> float:
        ridge = _RIDGE * float((weights[1:] ** 2).sum())
        return ridge - float(log_expit(signs * (features @ weights)).sum())

    return minimize(unlikelihood, np.zeros(features.shape[1]), method="BFGS").x


def _goal_in(answered: Answered) -> tuple[tuple[str, int, str], tuple[int, int, bool]]:
    """The largest goal: its building and number, what it was asked for as; and how it is seen."""
    goal = next(one for one in answered.things if one.role == "goal")
    return (answered.scene, goal.number, answered.goal), goal.view


def _box_answer(answered: Answered) -> tuple[float, BoxAnswer]:
    """The answer about an image with the goal, and how well its box fits that, -1 for none."""
    width, height = answered.image_size
    trues = [Box(*one) for one in answered.true_boxes]
    asked = BoxAnswer(
        side=math.sqrt(trues[0].area / (width * height)),
        distance_m=answered.conditions.get("distance_m", math.inf),
        is_cut_off=touches_edge(trues[0], width, height),
    )
    boxes = [Box(*one) for one in answered.boxes]
    if not boxes:
        return -1.0, asked
    # A search looks at every box, so the one that counts is that which leads to the goal.
    fits = [(true.iou(box), true, box) for box in boxes for true in trues]
    fit, true, box = max(fits, key=lambda one: one[0])
    is_elsewhere = fit == 0.0
    around = Box(0.0, 0.0, width, height) if is_elsewhere else true
    w, h = around.x_max - around.x_min, around.y_max - around.y_min
    edges = (
        (box.x_min - around.x_min) / w,
        (box.y_min - around.y_min) / h,
        (box.x_max - around.x_min) / w,
        (box.y_max - around.y_min) / h,
    )
    score = 1.0 if answered.probability is None else answered.probability
    return fit, replace(asked, edges=edges, score=score, is_elsewhere=is_elsewhere)
