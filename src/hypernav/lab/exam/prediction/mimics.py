"""Stand-ins for an examined model in searches: they err as it did in the exam.

A presence check says the same of a thing each time, as real ones do. How alike a detector's boxes
are in the views of a thing, and how alike the choices of one search are, is as in the exam.
"""

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from hypernav.core.components.protocols import BlockReasoner
from hypernav.core.episode import EpisodeTruth
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.boxes import Detection
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import Observation
from hypernav.lab.exam.prediction.choices import BlockChoices, ranks_of
from hypernav.lab.exam.prediction.confusion import Confusion
from hypernav.lab.exam.prediction.sight import BoxAnswer, Sight, drawn
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.map_question import offered_blocks
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.stand_ins.noisy_detector import distance_to, resembles
from hypernav.search.perception.local.stand_ins.systematic_detector import (
    STANDARD_NORMAL,
    is_cut_off,
    normal,
    uniform,
    view_of,
)

Asked = Counter[str]
"""Number of questions of a search, by the names of their kinds in traces."""

_SALT = "mimic"  # so that errors don't coincide with those of another stand-in
_Key = tuple[object, ...]
"""What always gives the same number."""


@dataclass(eq=False)
class MimicReasoner:
    """Chooses blocks in one search as the examined model did.

    Attributes:
        choices: Which blocks it chooses how often.
        truth: True paths to the goal and the generator of the episode.
        config: Configuration of the question, which says what is offered.
        fallback: The rule that chooses where the model gave no usable answer.
        asked: Counter of the questions.
    """

    choices: BlockChoices
    truth: EpisodeTruth
    config: VlmReasonerConfig
    fallback: BlockReasoner
    asked: Asked
    _tendency: float | None = field(default=None, init=False)
    """Standard normal number of the search: whether it goes well or badly in it."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        """A block, drawn with the probabilities that the exam's answers are most likely with."""
        offered = offered_blocks(self.config, overview, excluded)
        if not offered:
            return BlockChoice(None, "every block is excluded or holds nothing new")
        if len(offered) == 1 and self.config.skip_only_block:
            return BlockChoice(offered[0].number, "the only block left")
        self.asked["choose block"] += 1
        rng, how = self.truth.rng, self.choices
        if self._tendency is None:
            self._tendency = float(rng.normal())
        if rng.random() < how.unread:
            return self.fallback.choose(overview, goal, excluded)
        travel = [one.travel_m for one in offered]
        left = [self.truth.path_left_m(*one.destination) for one in offered]
        ranks = ranks_of(np.add(travel, left).tolist(), travel)
        level = math.sqrt(how.persistence) * self._tendency
        level += math.sqrt(1.0 - how.persistence) * float(rng.normal())
        chosen = offered[how.drawn(ranks, STANDARD_NORMAL.cdf(level))]
        return BlockChoice(chosen.number, "as often as in the exam")


@dataclass(frozen=True, eq=False)
class MimicDetector:
    """Gives boxes with the errors of the examined model.

    Attributes:
        sight: How it finds goals.
        confusion: How it errs otherwise.
        asked: Counter of the questions.
        crops: Largest number of boxes of an image whose crops are asked about.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        looks_closer: See `hypernav.core.components.abilities.looks_closer`.
    """

    sight: Sight
    confusion: Confusion
    asked: Asked
    crops: int = 0
    looks_at_colours: bool = field(default=False, init=False)
    looks_closer: bool = field(default=False, init=False)

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Boxes of goals that are found and of things taken for the goal, the surest first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        right, wrong = list[Detection](), list[tuple[float, Detection]]()
        for number in visible_objects(truth):
            label, true = truth.labels[number], true_detection(truth, number)
            key = (_SALT, number, label.category, *label.attributes, goal.text)
            view = (*key, *view_of(true, observation))
            if label.satisfies(goal):
                found = self._of_goal(key, view, true, observation, goal)
                right += [] if found is None else [found]
            else:
                wrong += self._of_other(key, view, true, label, goal)
        # Where there was no goal, the model gave so many boxes at most: to the likeliest things.
        wrong = sorted(wrong, key=lambda pair: pair[0])[: self.confusion.most_alarms]
        found = sorted([*right, *(one for _, one in wrong)], key=lambda one: -one.score)
        self.asked["ground"] += 1
        self.asked["crop"] += min(len(found), self.crops)
        return found

    def _of_goal(
        self, key: _Key, view: _Key, true: Detection, observation: Observation, goal: Goal
    ) -> Detection | None:
        sight = self.sight
        height, width = observation.depth.shape
        asked = BoxAnswer(
            side=math.sqrt(true.box.area / (width * height)),
            distance_m=distance_to(true, observation),
            is_cut_off=is_cut_off(true.box, observation),
        )
        level = _level((key, sight.by_thing), (view, 1.0 - sight.by_thing))
        fit, seen = ("fit", *key), ("fit", *view)
        box_level = _level((fit, sight.box_by_thing), (seen, 1.0 - sight.box_by_thing))
        answer = sight.answer(asked, level, box_level)
        box = answer.same_error_on(true.box, width, height)
        return None if box is None else Detection(box, answer.score, goal.thing)

    def _of_other(
        self, key: _Key, view: _Key, true: Detection, label: ObjectLabel, goal: Goal
    ) -> list[tuple[float, Detection]]:
        """The detection of a thing taken for the goal, if it is, with its rank among the things."""
        alarms = self.confusion.alarms.get("alike" if resembles(label, goal) else "other")
        if alarms is None or alarms.rate == 0.0:
            return []
        names = (_SALT, label.category, goal.text)
        rest = 1.0 - alarms.by_names - alarms.by_thing
        level = _level((names, alarms.by_names), (key, alarms.by_thing), (view, rest))
        if level >= alarms.rate:
            return []
        score = drawn(alarms.scores, uniform((*key, "score")))
        return [(level / alarms.rate, Detection(true.box, score, goal.thing))]


@dataclass(frozen=True, eq=False)
class MimicPresence:
    """Says whether the goal is there as the examined model did; about one thing always the same.

    Attributes:
        confusion: How it errs.
        asked: Counter of the questions.
        unsure_is_yes: Whether an answer that can't be used counts as "yes".
    """

    confusion: Confusion
    asked: Asked
    unsure_is_yes: bool

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """The answer to the image.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        self.asked["verify"] += 1
        truth = true_labels(observation)
        shown = visible_objects(truth)
        there = [n for n in shown if truth.labels[n].satisfies(goal)]
        alike = [n for n in shown if resembles(truth.labels[n], goal)]
        stratum = "there" if there else "look-alike" if alike else "not there"
        about = next(iter(there or alike or shown), -1)
        answers = self.confusion.presence.get(stratum, (True,))
        said = drawn(answers, uniform((_SALT, about, goal.text, stratum)))
        return self.unsure_is_yes if said is None else said


def _level(*parts: tuple[_Key, float]) -> float:
    """Probability of less than a standard normal number, made of parts with these variances."""
    total = sum(math.sqrt(variance) * normal(key) for key, variance in parts)
    return float(STANDARD_NORMAL.cdf(total))
