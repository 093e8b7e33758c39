"""Belief in candidates: how images change the evidence for and against them."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from hypernav.core.config import along
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.kind_shapes import KindShape
from hypernav.core.observation import Observation
from hypernav.core.score_weights import MISSED, NEUTRAL
from hypernav.search.memory.candidate import (
    Candidate,
    GoalEvidence,
    Measure,
    Rejection,
    areas_touch,
)
from hypernav.search.memory.goal_area import GoalArea
from hypernav.search.memory.things import Things
from hypernav.search.memory.visibility import is_cut_off, seems_to_hold, should_be_visible
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.shape import form_evidence

_INDIRECT = 0.5  # share of the shift that counts for the form in one image, or another thing there
_BELIEVED = 3.0
"""Log-odds from which a candidate is taken for the goal, after a second look if it needs one."""
_SURE = 4.2
"""Log-odds from which it needs no second look, if its form is not doubtful either."""
_LEAST_LOOKS = 2  # number of positions of images, below which it needs a second look anyway
_LAST_CHANCE = -1.0
"""Log-odds that are enough when nothing else is left."""
_NEW_EVIDENCE = 1.5
"""Rise of the log-odds that brings a refuted candidate back."""
_WORTH_M = 10.0
"""Length of path that a candidate of even odds is worth."""
_LEAST = -1.3
"""Log-odds below which a candidate is not gone to, however near; later images may raise them."""
_FAITH_M = 2.0
"""Length of path by which another candidate must be better to become the target."""
_SAME_SHARE = 0.5
"""Share of an area's cells in a rejected area above which both belong to one object."""
_SAME_OBJECT = 0.3
"""Share of the cells of one area in another from which both belong to one candidate."""
_MOST_CANDIDATES = 30
_NEAR_M = 6.0
"""Distance beyond which no image can be expected to show a candidate."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """A detection of the goal with its goal area; `Sightings` in core holds the other things.

    Attributes:
        detection: The detection.
        area: Its goal area.
        score_weight: Shift of the log-odds by its score.
        shape: Shift of the log-odds by its form in this image.
        measure: Measurement of its form, to be combined with those of other images; None without.
        kind: What things of the goal's kind are like, if its form was measured; else None.
    """

    detection: Detection
    area: GoalArea
    score_weight: float
    shape: float = 0.0
    measure: Measure | None = None
    kind: KindShape | None = None

    @property
    def weight(self) -> float:
        """Shift of the log-odds by score and form; a form that fits counts for nothing."""
        return self.score_weight + _INDIRECT * min(self.shape, 0.0)


def weight_of(score: float, config: LocalConfig) -> float:
    """Shift of the log-odds by the score of a detection, 0 to 1."""
    return along(config.score_weights or NEUTRAL, float(score))


def is_convincing(evidence: GoalEvidence, config: LocalConfig) -> bool:
    """Whether the evidence suffices to call the target the goal; always so with "latest"."""
    target = evidence.target
    if target is None or config.target == "latest":
        return target is not None
    return target.log_odds >= (_LAST_CHANCE if target.is_last_chance else _BELIEVED)


def needs_second_look(evidence: GoalEvidence, config: LocalConfig) -> bool:
    """Whether the target must be looked at from another side before it is taken for the goal."""
    target = evidence.target
    if target is None or target.confirmed or config.target == "latest":
        return False
    is_sure = target.log_odds >= _SURE and not target.is_form_doubtful
    return not is_sure or len(target.looks) < _LEAST_LOOKS


def confirmed(evidence: GoalEvidence) -> GoalEvidence:
    """The evidence after the second look at the target."""
    target = evidence.target
    return evidence if target is None else evidence.with_candidate(replace(target, confirmed=True))


def with_position_barred(evidence: GoalEvidence, observation: Observation) -> GoalEvidence | None:
    """The evidence with the robot's position barred, if something hides the target from there.

    Args:
        evidence: The evidence with the present image.
        observation: Present frame of a robot that faces the target.

    Returns:
        None if the target is not hidden, or if no other position at it is left.
    """
    target = evidence.target
    if target is None or target.number in evidence.seen:
        return None
    if not is_cut_off(target.area.seen_points, target.area.height_m, observation):
        return None
    barred = target.barred_at(observation.robot.xy)
    return None if barred is None else evidence.with_candidate(barred)


def rejected(
    evidence: GoalEvidence, config: LocalConfig, *, for_good: bool = False
) -> GoalEvidence:
    """The evidence after the target was refuted; new evidence brings a candidate back.

    Args:
        evidence: The evidence.
        config: Rule for the target, and how long a rejection lasts with "latest".
        for_good: Whether no later image can bring a candidate back.
    """
    target = evidence.target
    if target is None:
        return evidence
    if config.target == "latest":
        new = Rejection(target, config.rejected_for_looks)
        return replace(evidence, candidates=(), chosen=None, rejections=(*evidence.rejections, new))
    is_over = for_good or target.is_last_chance
    needed = math.inf if is_over else target.log_odds + _NEW_EVIDENCE
    refuted = replace(target, needed=needed, confirmed=False, barred=())
    return replace(evidence.with_candidate(refuted), chosen=None)


def likeliest(evidence: GoalEvidence) -> Candidate | None:
    """The likeliest candidate; None if nothing is likely enough, or all had their last chance."""
    left = [
        one
        for one in evidence.candidates
        if one.log_odds >= _LAST_CHANCE and one.needed < math.inf and not one.is_last_chance
    ]
    return max(left, key=lambda one: one.log_odds, default=None)


def reconsidered(evidence: GoalEvidence) -> GoalEvidence | None:
    """The evidence with the likeliest candidate taken for the goal, since nothing else is left.

    Returns:
        None if there is none; each comes back in this way once.
    """
    best = likeliest(evidence)
    if best is None:
        return None
    again = replace(best, needed=-math.inf, is_last_chance=True, confirmed=False, barred=())
    return replace(evidence.with_candidate(again), chosen=best.number)


def before_a_look(evidence: GoalEvidence) -> GoalEvidence:
    """The evidence before one more image: rejections for a number of images last one less."""
    rejections = tuple(
        replace(one, looks_left=one.looks_left - 1)
        for one in evidence.rejections
        if one.looks_left > 0
    )
    return replace(evidence, rejections=rejections, seen=frozenset())


def is_rejected(evidence: GoalEvidence, area: GoalArea) -> bool:
    """Whether more than half of an area lies in one that is rejected or refuted at present."""
    return any(one.covers(area) > _SAME_SHARE for one in evidence.rejected_areas)


def with_latest(
    evidence: GoalEvidence, sightings: list[Sighting], observation: Observation
) -> GoalEvidence:
    """The evidence after an image; a sighting in it becomes the target in any case (paper).

    Args:
        evidence: The evidence before the image.
        sightings: Sightings of the goal in the image, in the detector's order.
        observation: The image.
    """
    if not sightings:
        return evidence
    one, old = sightings[0], evidence.target
    if old is not None and areas_touch(one.area, old.area):
        target = old.seen_again(one.area, one.detection, observation, join=False)
    else:
        target = Candidate(one.area, observation, one.detection.box.area)
    return replace(evidence, candidates=(target,), chosen=0, seen=frozenset({0}))


def with_sightings(
    evidence: GoalEvidence,
    config: LocalConfig,
    sightings: list[Sighting],
    others: list[Detection],
    observation: Observation,
) -> GoalEvidence:
    """The evidence for every candidate after an image, with the best of them as the target.

    Args:
        evidence: The evidence before the image.
        config: What scores are worth.
        sightings: Sightings of the goal in the image, in the detector's order.
        others: Detections of other things in the image.
        observation: The image.
    """
    known = {one.number: one for one in evidence.candidates}
    weights, count = dict[int, float](), evidence.count
    for one in sightings:
        number = _number_of(one.area, known.values(), evidence.chosen)
        if number in weights:
            continue  # a further box of this candidate adds nothing, and may hold what is beside it
        if number is None:
            number, count = count, count + 1
            known[number] = Candidate(one.area, observation, one.detection.box.area, number=number)
        elif one.weight > 0.0:  # a doubtful detection may be of something beside the candidate
            known[number] = known[number].seen_again(
                one.area, one.detection, observation, join=True
            )
        if one.measure is not None and one.kind is not None:
            known[number] = _measured(known[number], one.measure, one.kind)
        weights[number] = one.weight
    for number, one in known.items():
        weight = weights.get(number)
        if weight is None and _is_missed(one, observation):
            weight = MISSED if config.missed_weight is None else config.missed_weight
        if weight is not None:
            weight -= _rivalry(one, others, observation, config)
            known[number] = one.with_look(observation.robot.xy, weight)
    kept = sorted(known.values(), key=lambda one: (one.number != evidence.chosen, -one.log_odds))
    after = replace(
        evidence,
        candidates=tuple(kept[:_MOST_CANDIDATES]),
        seen=frozenset(weights),
        count=count,
    )
    return replace(after, chosen=_best(after, observation.robot))


def with_earlier_looks(
    evidence: GoalEvidence, before: GoalEvidence, things: Things, goal: Goal, config: LocalConfig
) -> GoalEvidence:
    """The evidence with what earlier searches saw of the candidates that are new in it.

    Args:
        evidence: The evidence after an image.
        before: The evidence before it.
        things: Things that were remembered when the search began.
        goal: Goal of the search.
        config: What scores are worth.
    """
    for one in evidence.candidates:
        if one.number >= before.count:
            for thing in things.at(*one.area.centre, goal):
                for x, y, score in thing.views if not thing.refuted_in else ():
                    one = one.with_look((x, y), weight_of(score, config))
            evidence = evidence.with_candidate(one)
    return evidence


def _measured(one: Candidate, measure: Measure, kind: KindShape) -> Candidate:
    """A candidate after one more image of its form."""
    measures = (*one.measures, measure)
    form = form_evidence(measures, kind)
    return replace(one, measures=measures, form=form.log_odds, is_form_doubtful=form.is_doubtful)


def _number_of(area: GoalArea, known: Iterable[Candidate], chosen: int | None) -> int | None:
    """The number of the candidate that an area belongs to, the target first; None if to none."""
    same = [
        one
        for one in known  # areas of neighbours hardly overlap
        if max(area.covers(one.area), one.area.covers(area)) >= _SAME_OBJECT
    ]
    if not same:
        return None
    return max(same, key=lambda one: (one.number == chosen, one.area.covers(area))).number


def _is_missed(one: Candidate, observation: Observation) -> bool:
    """Whether an image without a sighting of a candidate should show it."""
    area = one.area
    is_near = observation.robot.distance_to(*area.centre) <= _NEAR_M
    return is_near and should_be_visible(area.seen_points, area.height_m, observation)


def _rivalry(
    one: Candidate, others: list[Detection], observation: Observation, config: LocalConfig
) -> float:
    """Log-odds that the surest detection of another thing in the same pixels takes away."""
    seen = one.area.seen_points
    scores = [o.score for o in others if seems_to_hold(o.box, seen, observation)]
    return _INDIRECT * max([0.0, *(weight_of(score, config) for score in scores)])


def _best(evidence: GoalEvidence, robot: Pose2) -> int | None:
    """The number of the candidate most worth its path, the target preferred; None if none is."""

    def worth_m(one: Candidate) -> float:
        faith_m = _FAITH_M if one.number == evidence.chosen else 0.0
        return _WORTH_M * math.exp(min(one.log_odds, 5.0)) - one.distance_to(*robot.xy) + faith_m

    target = evidence.target
    if target is not None and target.is_last_chance:
        return target.number
    left = [one for one in evidence.candidates if not one.is_refuted and one.log_odds >= _LEAST]
    best = max(left, key=worth_m, default=None)
    return None if best is None or worth_m(best) <= 0.0 else best.number
