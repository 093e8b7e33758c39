"""Belief in the target: candidates of every image gathered, weighed, rejected and taken back."""

from dataclasses import dataclass, replace

from hypernav.core.geometry.boxes import Detection
from hypernav.core.observation import Observation
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.goal_area import GoalArea
from hypernav.perception.local.rejections import Rejections
from hypernav.perception.local.target import Target, areas_touch, log_odds_of
from hypernav.perception.local.visibility import is_cut_off, seems_to_hold, should_be_visible

_MISS_LOG_ODDS = 1.0
"""Weight of an image that misses the target; ours, not measured: as if three in ten images missed a
true target and eight in ten a false one."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A detection of the goal, and the area on the floor plan that it gave."""

    detection: Detection
    area: GoalArea


class TargetBelief:
    """Remembers the target and rejected areas.

    Attributes:
        rejections: Areas in which nothing is taken for the goal.
    """

    def __init__(self, config: LocalConfig) -> None:
        """Believe in nothing yet.

        Args:
            config: Evidence that the target needs.
        """
        self._config = config
        self.reset()

    def reset(self) -> None:
        """Forget target and rejections."""
        self._target: Target | None = None
        self.rejections: Rejections = Rejections(self._config)
        self._score_now = 0.0
        self._missed_now = False

    @property
    def target(self) -> Target | None:
        """The target, once it was seen often enough."""
        if self._target is None or self._target.sightings < self._config.min_sightings:
            return None
        return self._target

    @property
    def has_sighting(self) -> bool:
        """Whether something was taken for the target, however seldom."""
        return self._target is not None

    @property
    def is_convincing(self) -> bool:
        """Whether the detections of the target were certain enough on average."""
        target = self._target
        return (
            target is not None
            and target.mean_score >= self._config.min_mean_score
            and not target.is_outdone
        )

    @property
    def needs_second_look(self) -> bool:
        """Whether the target is too uncertain to be believed from one side."""
        target = self._target
        return (
            target is not None
            and not target.confirmed
            and target.mean_score < self._config.sure_score
        )

    @property
    def is_contradicted(self) -> bool:
        """Whether the target looks more like something else in the latest image."""
        return self._score_now < 0.0

    @property
    def is_missed(self) -> bool:
        """Whether the latest image lacks the target, and that outweighs all earlier sightings."""
        target = self._target
        return self._missed_now and target is not None and target.log_odds < _MISS_LOG_ODDS

    @property
    def held_area(self) -> GoalArea | None:
        """Goal area of a held target that needs no second look."""
        target, holds = self.target, self._config.target == "hold"
        return target.area if target and holds and not self.needs_second_look else None

    def confirm(self) -> None:
        """Note that the target was looked at once more."""
        if self._target is not None:
            self._target = replace(self._target, confirmed=True)

    def bar_position(self, observation: Observation) -> bool:
        """Look for another position at the target if something hides it from a robot that faces it.

        Args:
            observation: Present frame of a robot that faces the target, after `look`.

        Returns:
            Whether the target is hidden and there is another position.
        """
        target = self._target
        is_seen = self._score_now > 0.0
        if target is None or is_seen:
            return False
        if not is_cut_off(target.area.seen_points, target.area.height_m, observation):
            return False
        barred = target.barred_at(observation.robot.xy)
        if barred is None:
            return False
        self._target = barred
        return True

    def reject(self, *, for_good: bool = False) -> None:
        """Drop the target and take nothing in its area for the goal.

        Args:
            for_good: Whether no later image can bring it back (`LocalConfig.believe_again`).
        """
        if self._target is None:
            return
        self.rejections.add(self._target, for_good=for_good)
        self._target = None

    def reconsider(self) -> bool:
        """Take the most likely of the rejected targets for the goal once more.

        Returns:
            Whether there is one; each comes back in this way once.
        """
        target = self.rejections.take_most_likely()
        if target is None:
            return False
        self._target = replace(target, misses=0, rival_score=0.0, confirmed=False, barred=())
        return True

    def begin_a_look(self) -> None:
        """Note that an image is looked at."""
        self._score_now, self._missed_now = 0.0, False
        self.rejections.note_a_look()

    def update(self, candidates: list[Candidate], observation: Observation) -> None:
        """Let the candidates of an image speak for the target, or their absence against it.

        Args:
            candidates: Candidates of the image, the most certain first.
            observation: The image.
        """
        if self._config.pick == "nearest":
            candidates = sorted(candidates, key=lambda c: c.area.distance_to(*observation.robot.xy))
        target = self._target
        if target is None or self._config.target == "latest":
            same = candidates[0] if candidates else None
        else:
            same = next((c for c in candidates if areas_touch(c.area, target.area)), None)
        self._score_now = 0.0 if same is None else float(same.detection.score)
        if same is not None:
            self._target = self._merged(same, observation)
        elif (
            target is not None
            and self._config.target == "hold"
            and should_be_visible(target.area.seen_points, target.area.height_m, observation)
        ):
            self._missed_now = True
            self._target = replace(target, misses=target.misses + 1)
            self._drop_if_refuted()

    def weigh_rivals(self, others: list[Detection], observation: Observation) -> None:
        """Note the score by which the target looks like something else in this image."""
        if self._target is None:
            return
        seen = self._target.area.seen_points
        scores = [float(one.score) for one in others if seems_to_hold(one.box, seen, observation)]
        if scores:
            strongest = max(scores)
            self._target = replace(self._target, rival_score=self._target.rival_score + strongest)
            self._score_now -= strongest
            self._drop_if_refuted()

    def _merged(self, candidate: Candidate, observation: Observation) -> Target:
        old, detection = self._target, candidate.detection
        if old is None or not areas_touch(candidate.area, old.area):
            score = float(detection.score)
            box_pixels, odds = detection.box.area, log_odds_of(score)
            return Target(candidate.area, observation, box_pixels, score, odds)
        hold = self._config.target == "hold"
        return old.seen_again(candidate.area, detection, observation, join=hold)

    def _drop_if_refuted(self) -> None:
        target = self._target
        if target is None:
            return
        is_refuted = target.missed_share > self._config.max_missed_share or target.is_outdone
        if is_refuted and target.verdicts >= self._config.min_verdicts:
            self.reject()
