"""The marks of an exam, type by type: scores, calibration, bias, and what it cost."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import binomtest

from hypernav.app.build.components.exam_file import Cost
from hypernav.core.trace import Exchange
from hypernav.lab.evaluation.statistics import Comparison, Estimate, compare, mean_with_interval
from hypernav.lab.exam.questions import KINDS, STRATA, Answered, Kind

_BINS = 5
_LEAST_FOR_CALIBRATION = 20
_SIGNIFICANT = 0.05


@dataclass(frozen=True)
class Part:
    """The score of some of the answers of a type.

    Attributes:
        name: What they have in common.
        score: Share of right answers.
    """

    name: str
    score: Estimate


@dataclass(frozen=True)
class Calibration:
    """Whether answers with a probability of 80% are right in 80% of the cases, and so on.

    Attributes:
        count: Number of answers with a probability.
        error: Expected calibration error: mean gap from probability to share of right answers.
        bins: For each fifth from 0 to 1: mean probability, share of right answers, number.
    """

    count: int
    error: float
    bins: tuple[tuple[float, float, int], ...]


@dataclass(frozen=True)
class TypeMarks:
    """The marks of one type of question.

    Attributes:
        kind: The type.
        words: Its name for people.
        count: Number of questions.
        score: Share of right answers; an unusable answer is wrong.
        chance: Expected score of random answers; 0 where there are no options.
        rule: Score of the geometric rule on the same questions; None where there is none.
        versus_rule: The model minus the rule, on the same questions; None where there is none.
        parts: Scores by stratum, kind of building, distance, clutter and light.
        regret_m: Mean additional path of the usable answers, metres; None without paths.
        overlap: Mean IoU of boxes or masks where the goal is in the image; None without any.
        unusable: Number of unusable answers, by reason.
        calibration: None where too few answers come with a probability.
        calls: Mean number of calls of the model per question.
        seconds: Mean time of these calls per question.
        tokens_in: Mean number of prompt tokens per question.
        tokens_out: Mean number of answer tokens per question.
    """

    kind: Kind
    words: str
    count: int
    score: Estimate
    chance: float
    rule: Estimate | None
    versus_rule: Comparison | None
    parts: tuple[Part, ...]
    regret_m: float | None
    overlap: float | None
    unusable: dict[str, int]
    calibration: Calibration | None
    calls: float
    seconds: float
    tokens_in: float
    tokens_out: float

    @property
    def verdict(self) -> str:
        """What the score means for a search, in a sentence."""
        if self.versus_rule is not None:
            gap = self.versus_rule
            if gap.p_value < _SIGNIFICANT and gap.difference.mean < 0.0:
                return "The geometric rule is better: leave this question to it."
            if gap.p_value < _SIGNIFICANT:
                return "Better than the geometric rule."
            return "No difference from the geometric rule is shown."
        if self.chance and self.score.low <= self.chance:
            return "Not shown to be better than answers at random."
        return "Better than answers at random." if self.chance else ""


def marks_of(answers: Sequence[Answered]) -> list[TypeMarks]:
    """The marks of all types that were asked."""
    return [
        _marks(kind, of_kind)
        for kind in KINDS
        if (of_kind := [one for one in answers if one.kind == kind])
    ]


def costs_of(answers: Sequence[Answered]) -> dict[str, Cost]:
    """What a question cost, by its kind as in traces; the crops of an image are questions."""
    groups: dict[str, list[list[Exchange]]] = {}
    for answer in answers:
        calls = [one for one in answer.exchanges if one.by_model]
        groups.setdefault("crop", []).extend([one] for one in calls if one.kind == "crop")
        main = [one for one in calls if one.kind != "crop"]
        if main:  # with all further questions about the same, such as a summary
            groups.setdefault(main[0].kind, []).append(main)
    return {
        kind: Cost(
            calls=float(np.mean([len(calls) for calls in asked])),
            seconds=float(np.mean([sum(one.seconds for one in calls) for calls in asked])),
            tokens_in=float(np.mean([sum(one.tokens_in for one in calls) for calls in asked])),
            tokens_out=float(np.mean([sum(one.tokens_out for one in calls) for calls in asked])),
        )
        for kind, asked in groups.items()
        if asked
    }


def rate(hits: int, count: int) -> Estimate:
    """A share with its 95% interval (Wilson); NaN if `count` is 0."""
    if not count:
        return Estimate(float("nan"), float("nan"), float("nan"), 0, 0)
    interval = binomtest(hits, count).proportion_ci(method="wilson")
    return Estimate(hits / count, float(interval.low), float(interval.high), count, count)


def _marks(kind: Kind, answers: list[Answered]) -> TypeMarks:
    with_rule = [one for one in answers if one.rule_score is not None]
    regrets = [one.regret_m for one in answers if one.regret_m is not None]
    overlaps = [one.overlap for one in answers if one.overlap is not None]
    exchanges = [one for answer in answers for one in answer.exchanges if one.by_model]
    count = len(answers)
    return TypeMarks(
        kind,
        KINDS[kind],
        count,
        share([one.score > 0.5 for one in answers], [one.scene for one in answers]),
        float(np.mean([one.chance for one in answers])),
        _mean(with_rule, lambda one: one.rule_score or 0.0) if with_rule else None,
        _against_rule(with_rule) if with_rule else None,
        tuple(_parts(answers)),
        float(np.mean(regrets)) if regrets else None,
        float(np.mean(overlaps)) if overlaps else None,
        dict(Counter(one.unusable for one in answers if one.unusable).most_common()),
        _calibration(answers),
        len(exchanges) / count,
        sum(one.seconds for one in exchanges) / count,
        sum(one.tokens_in for one in exchanges) / count,
        sum(one.tokens_out for one in exchanges) / count,
    )


def share(hits: Sequence[bool], scenes: Sequence[str]) -> Estimate:
    """A share; its interval is the wider of the bootstrap over buildings and Wilson's.

    The bootstrap alone has no width where all or none are hits.
    """
    drawn = mean_with_interval([float(hit) for hit in hits], scenes)
    counted = rate(sum(hits), len(hits))
    low, high = min(drawn.low, counted.low), max(drawn.high, counted.high)
    return replace(drawn, low=low, high=high)


def _mean(answers: Sequence[Answered], value: Callable[[Answered], float]) -> Estimate:
    return mean_with_interval([value(one) for one in answers], [one.scene for one in answers])


def _against_rule(answers: Sequence[Answered]) -> Comparison:
    return compare(
        [one.rule_score or 0.0 for one in answers],
        [one.score for one in answers],
        [one.scene for one in answers],
    )


def _parts(answers: Sequence[Answered]) -> list[Part]:
    """Scores by stratum and kind of building, and for the halves of every condition."""
    groups: dict[str, list[Answered]] = {}
    for one in answers:
        if (one.kind, one.stratum) in STRATA:
            groups.setdefault(STRATA[one.kind, one.stratum], []).append(one)
    for one in answers:
        groups.setdefault(f"in {one.scene.partition(':')[0]}", []).append(one)
    for name, low, high in (
        ("distance_m", "goal nearer than {:.0f} m", "goal {:.0f} m away or more"),
        ("clutter", "fewer than {:.0f} things in view", "{:.0f} things in view or more"),
        ("light", "darker than {:.0%}", "{:.0%} bright or more"),
    ):
        values = [one.conditions[name] for one in answers if name in one.conditions]
        if len(values) >= 2:
            middle = float(np.median(values))
            known = [one for one in answers if name in one.conditions]
            groups[low.format(middle)] = [o for o in known if o.conditions[name] < middle]
            groups[high.format(middle)] = [o for o in known if o.conditions[name] >= middle]
    return [
        Part(name, rate(sum(o.score > 0.5 for o in group), len(group)))
        for name, group in groups.items()
        if group
    ]


def _calibration(answers: Sequence[Answered]) -> Calibration | None:
    told = [(o.probability, o.score) for o in answers if o.probability is not None]
    if len(told) < _LEAST_FOR_CALIBRATION or len({p for p, _ in told}) == 1:
        return None
    said, so = np.array(told).T
    number = np.minimum((said * _BINS).astype(int), _BINS - 1)
    bins = [
        (float(said[number == k].mean()), float(so[number == k].mean()), int((number == k).sum()))
        for k in range(_BINS)
        if (number == k).any()
    ]
    error = sum(count * abs(p - right) for p, right, count in bins) / len(told)
    return Calibration(len(told), float(error), tuple(bins))
