"""Belief in the target: how images change the evidence for and against it."""

import math
from dataclasses import dataclass, replace

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.mapping.memory.goal_evidence import GoalEvidence, Rejection
from hypernav.mapping.memory.target import Target, areas_touch, log_odds_of
from hypernav.mapping.memory.visibility import is_cut_off, seems_to_hold, should_be_visible
from hypernav.perception.local.config import LocalConfig

_MISS_LOG_ODDS = 1.0
"""Weight of an image that misses the target; ours, not measured: as if three in ten images missed a
true target and eight in ten a false one."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A detection of the goal, and the area on the floor plan that it gave."""

    detection: Detection
    area: GoalArea


def believed(evidence: GoalEvidence, config: LocalConfig) -> Target | None:
    """The target, once it was seen often enough."""
    target = evidence.target
    return target if target is not None and target.sightings >= config.min_sightings else None


def is_convincing(evidence: GoalEvidence, config: LocalConfig) -> bool:
    """Whether the detections of the target were certain enough on average."""
    target = evidence.target
    return (
        target is not None and target.mean_score >= config.min_mean_score and not target.is_outdone
    )


def needs_second_look(evidence: GoalEvidence, config: LocalConfig) -> bool:
    """Whether the target is too uncertain to be believed from one side."""
    target = evidence.target
    return target is not None and not target.confirmed and target.mean_score < config.sure_score


def is_missed(evidence: GoalEvidence) -> bool:
    """Whether the latest image lacks the target, and that outweighs all earlier sightings."""
    target = evidence.target
    return evidence.missed_now and target is not None and target.log_odds < _MISS_LOG_ODDS


def held_area(evidence: GoalEvidence, config: LocalConfig) -> GoalArea | None:
    """Goal area of a held target that needs no second look."""
    target, holds = believed(evidence, config), config.target == "hold"
    return target.area if target and holds and not needs_second_look(evidence, config) else None


def confirmed(evidence: GoalEvidence) -> GoalEvidence:
    """The evidence after the target was looked at once more."""
    target = evidence.target
    return evidence if target is None else replace(evidence, target=replace(target, confirmed=True))


def with_position_barred(evidence: GoalEvidence, observation: Observation) -> GoalEvidence | None:
    """The evidence with the robot's position barred, if something hides the target from there.

    Args:
        evidence: The evidence with the present image.
        observation: Present frame of a robot that faces the target.

    Returns:
        None if the target is not hidden, or if no other position at it is left.
    """
    target = evidence.target
    is_seen = evidence.score_now > 0.0
    if target is None or is_seen:
        return None
    if not is_cut_off(target.area.seen_points, target.area.height_m, observation):
        return None
    barred = target.barred_at(observation.robot.xy)
    return None if barred is None else replace(evidence, target=barred)


def rejected(
    evidence: GoalEvidence, config: LocalConfig, *, for_good: bool = False
) -> GoalEvidence:
    """The evidence without the target; nothing in its area is taken for the goal.

    Args:
        evidence: The evidence.
        config: How long a rejection lasts, and what brings a target back.
        for_good: Whether no later image can bring it back (`LocalConfig.believe_again`).
    """
    target = evidence.target
    if target is None:
        return evidence
    before = next((one for one in evidence.rejections if one.covers(target.area)), None)
    needed = float(config.min_verdicts) if before is None else before.needed
    if for_good or not config.believe_again:
        needed = math.inf
    others = [one for one in evidence.rejections if one is not before]
    new = Rejection(target, config.rejected_for_looks or math.inf, needed)
    return replace(evidence, target=None, rejections=(*others, new))


def reconsidered(evidence: GoalEvidence) -> GoalEvidence | None:
    """The evidence with the most likely of the rejected targets taken for the goal once more.

    Returns:
        None if there is none; each comes back in this way once, unless it is rejected for good.
    """
    soft = [one for one in evidence.rejections if one.holds and one.needed < math.inf]
    if not soft:
        return None
    best = max(soft, key=lambda one: one.target.mean_score)
    others = [one for one in evidence.rejections if one is not best]
    return replace(
        evidence,
        target=replace(best.target, misses=0, rival_score=0.0, confirmed=False, barred=()),
        rejections=(*others, replace(best, needed=math.inf, holds=False)),
    )


def before_a_look(evidence: GoalEvidence) -> GoalEvidence:
    """The evidence when one more image is taken; some rejections end by that."""
    rejections = tuple(
        replace(one, looks_left=one.looks_left - 1)
        for one in evidence.rejections
        if one.looks_left > 0
    )
    return replace(evidence, rejections=rejections, score_now=0.0, missed_now=False)


def with_sighting(
    evidence: GoalEvidence, config: LocalConfig, area: GoalArea, score: float, robot: Pose2
) -> tuple[GoalEvidence, bool]:
    """The evidence after a detection in an area, and whether that area stays rejected.

    Args:
        evidence: The evidence.
        config: What brings a target back.
        area: Goal area of the detection.
        score: Score of the detection.
        robot: Pose of the robot that took the image.
    """
    rejections, is_barred = list(evidence.rejections), False
    for number, one in enumerate(rejections):
        if one.holds and one.covers(area):
            rejections[number] = one.seen_again(score, robot, config.min_mean_score)
            is_barred |= rejections[number].holds
    return replace(evidence, rejections=tuple(rejections)), is_barred


def with_candidates(
    evidence: GoalEvidence,
    config: LocalConfig,
    candidates: list[Candidate],
    observation: Observation,
) -> GoalEvidence:
    """The evidence after the candidates of an image, or their absence.

    Args:
        evidence: The evidence before the image.
        config: Rules for new detections, and the evidence that the target needs.
        candidates: Candidates of the image, the most certain first.
        observation: The image.
    """
    if config.pick == "nearest":
        candidates = sorted(candidates, key=lambda c: c.area.distance_to(*observation.robot.xy))
    target = evidence.target
    if target is None or config.target == "latest":
        same = candidates[0] if candidates else None
    else:
        same = next((c for c in candidates if areas_touch(c.area, target.area)), None)
    if same is not None:
        score = float(same.detection.score)
        target = _merged(target, same, config, observation)
        return replace(evidence, target=target, score_now=score)
    evidence = replace(evidence, score_now=0.0)
    if (
        target is not None
        and config.target == "hold"
        and should_be_visible(target.area.seen_points, target.area.height_m, observation)
    ):
        target = replace(target, misses=target.misses + 1)
        return _unless_refuted(replace(evidence, target=target, missed_now=True), config)
    return evidence


def with_rivals(
    evidence: GoalEvidence, config: LocalConfig, others: list[Detection], observation: Observation
) -> GoalEvidence:
    """The evidence after the score by which the target looks like something else in an image."""
    target = evidence.target
    if target is None:
        return evidence
    seen = target.area.seen_points
    scores = [float(one.score) for one in others if seems_to_hold(one.box, seen, observation)]
    if not scores:
        return evidence
    strongest = max(scores)
    return _unless_refuted(
        replace(
            evidence,
            target=replace(target, rival_score=target.rival_score + strongest),
            score_now=evidence.score_now - strongest,
        ),
        config,
    )


def _merged(
    old: Target | None, candidate: Candidate, config: LocalConfig, observation: Observation
) -> Target:
    detection = candidate.detection
    if old is None or not areas_touch(candidate.area, old.area):
        score = float(detection.score)
        odds = log_odds_of(score)
        return Target(candidate.area, observation, detection.box.area, score, odds)
    hold = config.target == "hold"
    return old.seen_again(candidate.area, detection, observation, join=hold)


def _unless_refuted(evidence: GoalEvidence, config: LocalConfig) -> GoalEvidence:
    """The evidence, with its target rejected if enough images speak against it."""
    target = evidence.target
    if target is None:
        return evidence
    is_refuted = target.missed_share > config.max_missed_share or target.is_outdone
    if is_refuted and target.verdicts >= config.min_verdicts:
        return rejected(evidence, config)
    return evidence
