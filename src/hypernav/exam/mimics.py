"""Stand-ins for an examined model in searches: they err as it did in the exam.

A detector and a presence check err the same way about a thing each time they see it, as real ones
do; how persistently a detector does is as measured of YOLOX. How persistently the choices of blocks
in one search are good or bad is as in the exam.
"""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from hypernav.core.components.protocols import BlockReasoner
from hypernav.core.episodes.truth import EpisodeTruth
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.boxes import Detection
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel
from hypernav.core.observation import Observation
from hypernav.exam.choices import BlockChoices, ranks_of
from hypernav.exam.confusion import Confusion
from hypernav.perception.explorers.map_question import VlmReasonerConfig, offered_blocks
from hypernav.perception.local.ground_truth import true_detection, true_labels, visible_objects
from hypernav.perception.local.noisy_detector import distance_to, resembles
from hypernav.perception.local.persistence import (
    SAME_NAME_SAID,
    SAME_THING_FOUND,
    STANDARD_NORMAL,
    is_cut_off,
    latent,
    uniform,
    view_of,
)

Asked = Counter[str]
"""Number of questions of a search, by the names of their kinds in traces."""

_SALT = "mimic"  # so that errors don't coincide with those of another stand-in
_MOST = 0.99
"""Rate of false boxes above which the things in view are taken to be equally likely."""
_FAR_M = 10.0
"""Distance beyond which a thing is as far as it gets, metres."""
_SIMILAR = 2.0
"""Number of answers about the most similar questions, in square roots of the number of all."""
_Drawn = TypeVar("_Drawn")


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
        confusion: How it errs.
        asked: Counter of the questions.
        crops: Largest number of boxes of an image whose crops are asked about.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
    """

    confusion: Confusion
    asked: Asked
    crops: int = 0
    looks_at_colours: bool = field(default=False, init=False)

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
            view = view_of(true, observation)
            if label.satisfies(goal):
                found = self._of_goal(key, view, true, observation, goal)
                right += [] if found is None else [found]
            else:
                wrong += self._of_other(key, view, true, label, goal)
        # The model gave one box at most where there was no goal; it is that of the likeliest thing.
        wrong = sorted(wrong, key=lambda pair: pair[0])[:1]
        found = sorted([*right, *(one for _, one in wrong)], key=lambda one: -one.score)
        self.asked["ground"] += 1
        self.asked["crop"] += min(len(found), self.crops)
        return found

    def _of_goal(
        self,
        key: tuple[object, ...],
        view: tuple[object, ...],
        true: Detection,
        observation: Observation,
        goal: Goal,
    ) -> Detection | None:
        height, width = observation.depth.shape
        side = math.sqrt(true.box.area / (width * height))
        away_m = min(distance_to(true, observation), _FAR_M)
        is_cut = is_cut_off(true.box, observation)
        similar = _most_similar(
            self.confusion.seen,
            lambda one: (
                abs(math.log(one.side / side))
                + abs(math.log(min(one.distance_m, _FAR_M) / away_m))
                + (one.is_cut_off != is_cut)
            ),
        )
        answer = _drawn(similar, _level(key, view, SAME_THING_FOUND))
        box = answer.about(true.box, width, height)
        return None if box is None else Detection(box, answer.score, goal.thing)

    def _of_other(
        self,
        key: tuple[object, ...],
        view: tuple[object, ...],
        true: Detection,
        label: ObjectLabel,
        goal: Goal,
    ) -> list[tuple[float, Detection]]:
        """The detection of a thing taken for the goal, if it is, with its rank among the things."""
        alike = resembles(label, goal)
        answers = self.confusion.unseen.get("look-alike" if alike else "absent", ())
        alarms = [one for one in answers if one.edges is not None]
        rate = len(alarms) / max(len(answers), 1)
        if not alike:  # an image of the exam showed several things, of which one was enough
            rate = 1.0 - (1.0 - min(rate, _MOST)) ** (1.0 / self.confusion.things_in_view)
        level = _level(key, view, SAME_NAME_SAID)
        if level >= rate:
            return []
        answer = _drawn(alarms, uniform((*key, "score")))
        return [(level / rate, Detection(true.box, answer.score, goal.thing))]


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
        said = _drawn(answers, uniform((_SALT, about, goal.text, stratum)))
        return self.unsure_is_yes if said is None else said


def _most_similar(answers: Sequence[_Drawn], difference: Callable[[_Drawn], float]) -> list[_Drawn]:
    """The answers to the questions that differ least, in their order."""
    by_difference = sorted(range(len(answers)), key=lambda k: difference(answers[k]))
    count = math.ceil(_SIMILAR * math.sqrt(len(answers)))
    return [answers[k] for k in sorted(by_difference[:count])]


def _drawn(answers: Sequence[_Drawn], level: float) -> _Drawn:
    """One of the answers, which are in order, by its level from 0 to 1."""
    return answers[min(int(level * len(answers)), len(answers) - 1)]


def _level(key: tuple[object, ...], view: tuple[object, ...], persistence: float) -> float:
    return float(STANDARD_NORMAL.cdf(latent(key, view, persistence)))
