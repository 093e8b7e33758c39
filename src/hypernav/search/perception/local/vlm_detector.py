"""Detection by a vision-language model that is asked for boxes (paper: by Qwen-VL)."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from hypernav.core.chat import Answer, Fault, Image, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.config import Curve
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, asked_place, label_for, place_in
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.answer_parsing import final_answer
from hypernav.search.models.chat.vlm_families import VlmFamily, family_named, family_of
from hypernav.search.models.reliability import known
from hypernav.search.perception.config import GROUNDING_WORDS, VlmDetectorConfig
from hypernav.search.perception.exchanges import YesNoAsker, exchange_of
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.grounding_format import (
    NEGATED,
    Grounding,
    PointedAt,
    read_grounding,
)
from hypernav.search.perception.local.yes_no_checks import crop_of, crop_question

_NOTHING = {"[]", "{}", "null", "none", "there are none"}
_POINT_SHARE = 0.1
"""Side of the box around a point without depth, as a share of the image's longer side."""
_UNSURE = 0.5
"""Score of a box if the answer about its crop is neither yes nor no."""
CROP_MARGIN = 0.3
"""Width of the margin that a crop shows around its box, as a share of the box's sides."""
_MAX_BOXES = 10
"""Largest number of boxes of an answer; further ones are dropped."""
_ENLARGED = 1.25
"""Share of an image's tokens above which it was enlarged, whatever surrounds it."""
_USUAL_LEAST = 1024
"""``--image-min-tokens`` that llama.cpp recommends for Qwen's models."""
_MARKS_OF_AN_IMAGE = 4
"""Largest number of tokens that mark the begin and the end of an image; Qwen's models have two."""
_TOKENS_AROUND = 100
"""Largest number of tokens that a chat template puts around a question; a byte has one at most."""
_MIN_SIDE_PX = 4.0
"""Shortest side of a box; smaller boxes are dropped."""


class _Thing(BaseModel):
    model_config = ConfigDict(extra="forbid")

    bbox_2d: tuple[float, float, float, float]
    label: str


class _Things(BaseModel):
    """The form of a constrained answer; hosted APIs want an object at the root."""

    model_config = ConfigDict(extra="forbid")

    objects: list[_Thing]


def grounding_question(
    config: VlmDetectorConfig, family: VlmFamily, image: Image, goal: Goal
) -> Question:
    """Question to a model of a family about one image."""
    example = "[y1, x1, y2, x2]" if family.rows_first else "[x1, y1, x2, y2]"
    words = family.asks if family.asks and config.prompt == GROUNDING_WORDS else config.prompt
    return Question(
        kind="ground",
        text=words.format(goal=goal.thing, key=family.box_key, example=example),
        images=(family.prepared(image),),
        form=_Things if config.constrained else None,
        max_tokens=config.max_tokens,
        at_once=True,
    )


def family_as_seen(
    family: VlmFamily, question: Question, answer: Answer, ask: Callable[[Question], Answer]
) -> VlmFamily:
    """The family at a server that enlarges images, by the number of tokens that it counted.

    llama.cpp with ``--image-min-tokens`` does, so that pixels would mean others on its side; sent
    as large as that, images stay as they are. Only where an image seems to have far more tokens
    than it should is the same question asked without it, which tells them from those of the words.

    Args:
        family: The family as its makers say.
        question: A question about one image that was sent as this family wants it.
        answer: Its answer.
        ask: Asks the model.
    """
    height, width = question.images[0].shape[:2]
    most = _ENLARGED * family.tokens(width, height)
    words = len(question.text.encode()) + _TOKENS_AROUND
    if not family.token_px or answer.usage.tokens_in - words <= most:
        return family
    bare = ask(Question(question.kind, question.text, max_tokens=1, at_once=True))
    counted = answer.usage.tokens_in - bare.usage.tokens_in
    if not bare.usage.tokens_in or counted <= most:
        return family
    usual = family.with_least_tokens(_USUAL_LEAST)
    is_usual = abs(counted - usual.tokens(width, height)) <= _MARKS_OF_AN_IMAGE
    return usual if is_usual else family.with_least_tokens(counted - _MARKS_OF_AN_IMAGE)


class VlmDetector:
    """Asks for boxes of the goal. What can't be used of an answer is counted, never an error.

    Attributes:
        looks_closer: See `hypernav.core.components.abilities.looks_closer`; it asks about crops
            itself.
        score_weights: See `hypernav.core.components.abilities.score_weights_of`; YOLOX-nano's,
            until an exam of the model says more.
    """

    looks_closer = False
    score_weights: Curve = known()["yolox-nano"].boxes

    def __init__(
        self, chat: ChatModel, log: ExchangeLog, config: VlmDetectorConfig | None = None
    ) -> None:
        """Create the detector.

        Args:
            chat: Chat model to ask.
            log: Log of all questions and answers, for the trace.
            config: Configuration of the question.
        """
        self._chat = chat
        self._log = log
        self._crops = YesNoAsker(chat, log)
        self._config = config or VlmDetectorConfig()
        self._family: VlmFamily | None = None
        self._is_size_known = False
        self.rejected: Counter[str] = Counter()
        """Number of boxes and answers that could not be used so far, by reason."""

    @property
    def family(self) -> VlmFamily:
        """Family of models whose coordinates the model answers in.

        Raises:
            ConfigError: The model's name does not tell the family, and none is configured.
            ModelUnavailableError: The model's name cannot be found out.
        """
        if self._family is None:
            name = self._config.family
            auto = name == "auto"
            self._family = family_of(self._chat.identify()) if auto else family_named(name)
        return self._family

    def check_model(self) -> VlmFamily:
        """The family of the model; raises the errors of `family` where it is not known."""
        return self.family

    def take_report(self) -> dict[str, Any]:
        """Number of boxes and answers that could not be used since the last call, by reason."""
        report = {"rejected_boxes": dict(sorted(self.rejected.items()))}
        self.rejected.clear()
        return report

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Boxes of the goal in the image, pixels, in the model's order.

        The scores of crops don't change it: only the largest boxes have one.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = grounding_question(self._config, self.family, observation.rgb, goal)
        answer = self._chat.ask(question)
        if not self._is_size_known:
            self._is_size_known = True
            self._family = family_as_seen(self.family, question, answer, self._ask_aside)
        height, width = observation.rgb.shape[:2]
        grounding = read_grounding(
            "" if answer.fault is Fault.CUT else answer.text,
            self.family,
            width,
            height,
            names_goal=lambda key: labels_agree(key, goal),
            max_boxes=_MAX_BOXES,
            min_side_px=_MIN_SIDE_PX,
        )
        remarks = self._remarks(answer, grounding, goal)
        self._log.record(exchange_of(question, answer, remarks=remarks))
        boxes = [*grounding.boxes, *(around(one, observation) for one in grounding.points)]
        found = [replace(one, label=one.label or label_for(goal)) for one in boxes]
        return self._looked_at(found, observation, goal)

    def _ask_aside(self, question: Question) -> Answer:
        """Ask, and keep it for the trace."""
        answer = self._chat.ask(question)
        self._log.record(exchange_of(question, answer))
        return answer

    def _looked_at(
        self, found: list[Detection], observation: Observation, goal: Goal
    ) -> list[Detection]:
        """The detections with the scores of their crops, without those whose score is too low."""
        by_size = sorted(range(len(found)), key=lambda k: -found[k].box.area)
        for k in by_size[: self._config.score_crops]:
            crop = crop_of(observation.rgb, found[k].box, CROP_MARGIN)
            yes = self._crops.ask(crop_question(crop, goal))
            found[k] = replace(found[k], score=_UNSURE if yes is None else yes)
        kept = [one for one in found if one.score >= self._config.min_score]
        if len(kept) < len(found):
            self.rejected["denied on a closer look"] += len(found) - len(kept)
        return kept

    def _remarks(self, answer: Answer, grounding: Grounding, goal: Goal) -> list[str]:
        """Oddities of an answer, which are counted."""
        remarks = [
            f"{count} {'box' if count == 1 else 'boxes'} {reason.value}"
            for reason, count in grounding.rejected.items()
        ]
        self.rejected.update({reason.value: n for reason, n in grounding.rejected.items()})
        found = [*grounding.boxes, *grounding.points]
        if not found and not grounding.rejected and not _says_nothing(answer.text):
            reason = answer.fault.value if answer.fault is not None else "no box in the answer"
            remarks.append(answer.detail if answer.fault is Fault.CUT else reason)
            self.rejected[reason] += 1
        for one in found:
            if one.label and not labels_agree(one.label, goal):
                remarks.append(f"labelled '{one.label}', not '{goal.text}'")
                self.rejected["other label"] += 1
        return remarks


def around(pointed: PointedAt, observation: Observation) -> Detection:
    """The detection of what a model points at; its box is that of what depth connects with it."""
    x, y = pointed.x, pointed.y
    mask = DepthCutSegmenter().segment_point(observation, x, y)
    height, width = mask.shape
    half = _POINT_SHARE * max(width, height) / 2.0
    box = Box(x - half, y - half, x + half, y + half).clipped(width, height)
    if mask.any():
        rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
        corners = columns[0], rows[0], columns[-1] + 1, rows[-1] + 1
        box = Box(*map(float, corners))
    return Detection(box, 1.0, pointed.label, point=(x, y))


def labels_agree(label: str, goal: Goal) -> bool:
    """Whether a model's label can mean the goal: the same name, or a wider or narrower one.

    "sofa" agrees with the goal "L-shaped sofa", "corner sofa" with the goal "sofa"; a "window
    curtain" is no "shower curtain". Of a description its name alone counts.
    """
    wanted = ObjectLabel(asked_place(goal).before)
    if NEGATED.match(label) and not NEGATED.match(goal.thing):
        return False
    name = place_in(label).before
    return ObjectLabel(name).satisfies(goal) or wanted.is_named(name)


def _says_nothing(text: str) -> bool:
    """Whether an answer plainly says that the image shows no goal."""
    bare = final_answer(text).rstrip(".").casefold()
    return bare in _NOTHING or bare.replace(" ", "") == '{"objects":[]}'
