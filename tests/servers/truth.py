"""A brain for the scripted server that answers from the simulator's truth, with set error rates.

It knows every image that an agent has seen and recognises the one it is sent, so it tells the
truth about that very image, whenever it is asked.
"""

import json
import random
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
import pytest

from hypernav.core.chat import Question
from hypernav.core.exploring.guidance import (
    TURN_AROUND,
    ArrowChoice,
    ArrowView,
    GuideChoice,
    GuideView,
)
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.vlm_families import family_named
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers import map_question
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.perception.local.vlm_detector import CROP_MARGIN, VlmDetector
from hypernav.search.perception.local.yes_no_checks import VlmPresenceCheck, crop_of
from hypernav.search.rivals.arrows.arrow_reasoners import ChatArrowReasoner
from hypernav.search.rivals.arrows.prompted import ChatStopCheck, TruthStopCheck
from hypernav.search.rivals.navvlm.guides import ChatGuide, TruthGuide
from hypernav.search.rivals.room_table import chance_in_view
from hypernav.search.rivals.vlfm.scene_scorers import ChatScorer
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion
from servers.scripted import Asked


@dataclass
class Errors:
    """How often the truth is bent, each from 0 to 1.

    Attributes:
        miss: The goal is in the image, and it says that it is not.
        wrong_label: It calls the thing something else.
        wrong_space: It answers in thousandths where pixels are expected.
        prose: It writes sentences around the JSON.
        truncate: It stops in the middle.
        jitter_px: How far a box's edges are off, standard deviation.
        babble: It answers a closed question with nonsense.
        wrong_block: It names another block than the one on the shortest path to the goal.
    """

    miss: float = 0.0
    wrong_label: float = 0.0
    wrong_space: float = 0.0
    prose: float = 0.0
    truncate: float = 0.0
    jitter_px: float = 0.0
    babble: float = 0.0
    wrong_block: float = 0.0


@dataclass
class Truth:
    """What an agent has seen so far, by a small version of each image."""

    observations: list[tuple[np.ndarray, Observation]] = field(default_factory=list)
    overviews: list[tuple[np.ndarray, tuple[Overview, Goal]]] = field(default_factory=list)
    crops: list[tuple[np.ndarray, tuple[Box, Observation, Goal]]] = field(default_factory=list)
    world: SimulatedWorld | None = None
    arrows: tuple[ArrowView, Goal] | None = None
    guided: tuple[GuideView, Goal] | None = None
    scored: tuple[Observation, Goal] | None = None
    region: GoalRegion | None = None

    def forget(self) -> None:
        """Forget what was seen: another search begins."""
        self.region = None
        self.observations.clear()
        self.overviews.clear()
        self.crops.clear()

    def see(self, observation: Observation) -> None:
        """Remember a camera image."""
        self.observations.append((_small(observation.rgb), observation))

    def draw(self, image: np.ndarray, overview: Overview, goal: Goal) -> None:
        """Remember a map and what was searched on it."""
        self.overviews.append((_small(image), (overview, goal)))

    def by_way_of(self, block: Block, goal: Goal) -> tuple[int, float]:
        """Length of the shortest path to the goal that leads by a block, and what is left there.

        The length is rounded to 0.5 m, so that of several blocks on the path the last one leads on.
        """
        left_m = self.left_m(block.destination, goal)
        length_m = min(block.travel_m + left_m, 1e6)
        return round(length_m / 0.5), left_m

    def left_m(self, position: tuple[float, float], goal: Goal) -> float:
        """Length of the shortest path from a position to the goal."""
        assert self.world is not None
        x, y, _ = self.world.map_to_scene.apply(np.array([[*position, 0.0]]))[0]
        return self._region_of(goal).distance(float(x), float(y))

    def left_here_m(self, goal: Goal) -> float:
        """Length of the shortest path from where the robot is to the goal."""
        assert self.world is not None
        x, y, _ = self.world.position
        return self._region_of(goal).distance(x, y)

    def _region_of(self, goal: Goal) -> GoalRegion:
        """Where the goal is reached; its distances are computed once in a search."""
        assert self.world is not None
        if self.region is None or self.region.goal != goal:
            self.region = self.world.goal_truth(goal)
        return self.region


def _small(image: np.ndarray) -> np.ndarray:
    small = cv2.resize(image, (64, 48), interpolation=cv2.INTER_AREA)
    return small.astype(np.float32)


def offered_numbers(text: str) -> set[int]:
    """Numbers of the blocks that a question about the map offers."""
    offered = re.search(r"(?:is one of|numbered blocks:) ([\d, ]+)\.", text)
    excluded = re.search(r"Don't answer number \[([\d, ]+)\]", text)
    listed, ruled_out = (
        {int(number) for number in match[1].split(",")} if match else set[int]()
        for match in (offered, excluded)
    )
    return listed - ruled_out


def _share_inside(box: Box, other: Box) -> float:
    width = min(box.x_max, other.x_max) - max(box.x_min, other.x_min)
    height = min(box.y_max, other.y_max) - max(box.y_min, other.y_min)
    return max(width, 0.0) * max(height, 0.0) / max(box.area, 1e-9)


def _recognised(image: np.ndarray, known: list) -> Any:
    small = _small(image)
    return min(reversed(known), key=lambda one: float(np.abs(one[0] - small).mean()))[1]


@contextmanager
def watching(truth: Truth) -> Iterator[Truth]:
    """While it lasts, all that is asked about in this process becomes known to the truth."""
    detect, about_map = VlmDetector.detect, map_question.map_question
    is_present, reset = VlmPresenceCheck.is_present, SimulatedWorld.reset
    looked_at = VlmDetector._looked_at
    about_arrows, about_direction = ChatArrowReasoner.choose, ChatGuide.direct
    about_view, is_here = ChatScorer.score, ChatStopCheck.is_here

    def watched_image(self: VlmDetector, observation: Observation, goal: Goal) -> list[Detection]:
        truth.see(observation)
        return detect(self, observation, goal)

    def watched_map(
        config: VlmReasonerConfig, overview: Overview, goal: Goal, *others: Any, **more: Any
    ) -> Question:
        question = about_map(config, overview, goal, *others, **more)
        truth.draw(question.images[0], overview, goal)
        return question

    def watched_crops(
        self: VlmDetector, found: list[Detection], observation: Observation, goal: Goal
    ) -> list[Detection]:
        for one in found:
            crop = crop_of(observation.rgb, one.box, CROP_MARGIN)
            truth.crops.append((_small(crop), (one.box, observation, goal)))
        return looked_at(self, found, observation, goal)

    def watched_arrows(self: ChatArrowReasoner, view: ArrowView, goal: Goal) -> ArrowChoice:
        truth.arrows = view, goal
        return about_arrows(self, view, goal)

    def watched_direction(self: ChatGuide, view: GuideView, goal: Goal) -> GuideChoice:
        truth.guided = view, goal
        return about_direction(self, view, goal)

    def watched_score(self: ChatScorer, observation: Observation, goal: Goal) -> float:
        truth.scored = observation, goal
        return about_view(self, observation, goal)

    def watched_reset(self: SimulatedWorld, *others: Any, **more: Any) -> Observation:
        truth.world = self
        truth.forget()
        return reset(self, *others, **more)

    def watched_presence(self: VlmPresenceCheck, observation: Observation, goal: Goal) -> bool:
        truth.see(observation)
        return is_present(self, observation, goal)

    def watched_stop(self: ChatStopCheck, observation: Observation, goal: Goal) -> bool:
        truth.see(observation)
        return is_here(self, observation, goal)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ChatStopCheck, "is_here", watched_stop)
        patch.setattr(VlmDetector, "detect", watched_image)
        patch.setattr(map_question, "map_question", watched_map)
        patch.setattr(VlmPresenceCheck, "is_present", watched_presence)
        patch.setattr(VlmDetector, "_looked_at", watched_crops)
        patch.setattr(ChatArrowReasoner, "choose", watched_arrows)
        patch.setattr(ChatGuide, "direct", watched_direction)
        patch.setattr(ChatScorer, "score", watched_score)
        patch.setattr(SimulatedWorld, "reset", watched_reset)
        yield truth


class TruthfulBrain:
    """Answers the questions of the method."""

    def __init__(self, truth: Truth, errors: Errors | None = None, seed: int = 0) -> None:
        self._truth = truth
        self.errors = errors or Errors()
        self._rng = random.Random(seed)
        self._detector = GroundTruthDetector()

    def __call__(self, asked: Asked) -> str:
        match asked.kind:
            case "ground":
                return self._ground(asked)
            case "choose block":
                return self._choose(asked)
            case "verify":
                return self._verify(asked)
            case "crop":
                return self._look_closer(asked)
            case "choose arrow":
                return self._follow()
            case "choose direction":
                return self._point()
            case "score view":
                return self._score()
            case "stop":
                return self._stop(asked)
        return "I was not asked a question that I know."

    def _happens(self, rate: float) -> bool:
        return self._rng.random() < rate

    def _ground(self, asked: Asked) -> str:
        match = re.match(r"Locate every (.+?) in the picture", asked.text)
        goal = Goal(match[1] if match else "nothing")
        view = _recognised(asked.images[0], self._truth.observations)
        assert isinstance(view, Observation)
        things = [] if self._happens(self.errors.miss) else self._detector.detect(view, goal)
        height, width = view.rgb.shape[:2]
        space = "thousandths" if self._happens(self.errors.wrong_space) else "qwen2.5-vl"
        label = "window curtain" if self._happens(self.errors.wrong_label) else goal.text
        found = []
        for thing in things:
            edges = [thing.box.x_min, thing.box.y_min, thing.box.x_max, thing.box.y_max]
            edges = [edge + self._rng.gauss(0.0, self.errors.jitter_px) for edge in edges]
            said = family_named(space).from_image(Box(*edges), width, height)
            numbers = [round(edge) for edge in (said.x_min, said.y_min, said.x_max, said.y_max)]
            found.append({"bbox_2d": numbers, "label": label})
        text = f"```json\n{json.dumps(found)}\n```"
        if self._happens(self.errors.prose):
            text = f"Certainly! I looked closely and here is what I see:\n{text}\nAnything else?"
        if self._happens(self.errors.truncate):
            text = text[: self._rng.randint(0, len(text))]
        return text

    def _choose(self, asked: Asked) -> str:
        if self._happens(self.errors.babble):
            return "The kitchen smells of 4 or 5 sorts of cheese."
        overview, goal = _recognised(asked.images[0], self._truth.overviews)
        numbers = offered_numbers(asked.text)
        offered = [block for block in overview.blocks if block.number in numbers]
        best = min(offered, key=lambda block: self._truth.by_way_of(block, goal))
        if self._happens(self.errors.wrong_block) and len(offered) > 1:
            best = self._rng.choice([block for block in offered if block is not best])
        if asked.allowed:
            return str(best.number)
        return f"The goal is that way.\nAnswer: {best.number}"

    def _follow(self) -> str:
        assert self._truth.arrows is not None
        view, goal = self._truth.arrows
        best = sorted(view.arrows, key=lambda arrow: self._truth.left_m(arrow.end, goal))
        if view.may_turn and self._truth.left_m(best[0].end, goal) >= self._truth.left_here_m(goal):
            return "None of these. " + json.dumps({"action": TURN_AROUND})
        numbers = [arrow.number for arrow in best[: view.wanted]]
        if view.wanted > 1:
            return json.dumps({"actions": numbers})
        return "It is that way. " + json.dumps({"action": numbers[0]})

    def _point(self) -> str:
        assert self._truth.guided is not None
        return str(TruthGuide(ExchangeLog()).direct(*self._truth.guided).direction)

    def _score(self) -> str:
        assert self._truth.scored is not None
        chance = chance_in_view(*self._truth.scored)
        return "yes" if chance is not None and chance > 0.3 else "no"

    def _stop(self, asked: Asked) -> str:
        match = re.match(r"A robot looks for (?:an? )?(.+?)\. The picture", asked.text)
        goal = Goal(match[1] if match else "nothing")
        view = _recognised(asked.images[0], self._truth.observations)
        assert isinstance(view, Observation)
        return "yes" if TruthStopCheck(ExchangeLog()).is_here(view, goal) else "no"

    def _look_closer(self, asked: Asked) -> str:
        if self._happens(self.errors.babble):
            return "It is what it is."
        box, view, goal = _recognised(asked.images[0], self._truth.crops)
        things = self._detector.detect(view, goal)
        return "yes" if any(_share_inside(box, thing.box) > 0.5 for thing in things) else "no"

    def _verify(self, asked: Asked) -> str:
        if self._happens(self.errors.babble):
            return "Beauty lies in the eye of the beholder."
        match = re.match(r"Is there (?:an? )?(.+?) in this picture", asked.text)
        goal = Goal(match[1] if match else "nothing")
        view = _recognised(asked.images[0], self._truth.observations)
        assert isinstance(view, Observation)
        return "yes" if self._detector.detect(view, goal) else "no"
