"""In which remembered images the goal is: the likely ones by a ranking, then by a question.

The ranking compares images with texts. An image counts for how much better it fits the goal's words
than words that say nothing, since some images fit any text, and for how far it stands out in that
from the other images, since some texts fit any image. Both are ours: VLFM takes the bare
similarity, and DynaMem (Liu et al. 2024; its code) goes to the place of the greatest one and has a
detector look there.
"""

import math
import re
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

import cv2
import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.chat import Image, Question
from hypernav.core.components.protocols import ChatModel, ImageTextModel
from hypernav.core.errors import ContractError
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.text import draw_text
from hypernav.search.memory.key_images import KeyImage
from hypernav.search.models.chat.answer_parsing import final_answer
from hypernav.search.perception.config import ImageRecallConfig
from hypernav.search.perception.exchanges import exchange_of

_WORDS = "a photo of a {goal}"
NEUTRAL_WORDS = ("a photo", "a photo of a room", "a photo of an object", "a photo of a wall")
"""Texts that say nothing of a goal."""
_LEAST_IMAGES = 8
"""Number of images below which none stands out: too few to tell how much they differ anyway."""
_LEAST_SPREAD = 0.005
"""Cosine below which images that differ by it count as alike."""
_TO_DEVIATION = 1.4826
"""Standard deviation of normal values over the median of their distances from their median."""
IMAGES_PER_QUESTION = 6
"""Number of images in one question, and of those whose similarity the trace tells."""
_COLUMNS = 3
_TILE_PX = 640
"""Width of an image on the sheet, pixels."""
_GAP_PX = 8
_DISC_PX = 26
_NUMBER = r"(?<![\d.])\d{1,6}(?!\.?\d)"
_RANGE = re.compile(rf"({_NUMBER})(?:\s*(?:[-–]|to\b)\s*({_NUMBER}))?", re.IGNORECASE)
_OF_IMAGES = re.compile(
    rf"\bimages?\W{{0,3}}(?:(?:no\.|number)\s*)?"
    rf"((?:{_NUMBER}(?:\s*(?:[-–,&]|(?:to|and|or)\b))*\s*)+)",
    re.IGNORECASE,
)
_NONE = re.compile(
    r"\b(?:none|no(?!\.\s*\d+(?!\s*\w))|not|neither|nothing)\b|n['’]t\b|^\W*\[\s*\]\W*$",
    re.IGNORECASE,
)
_LAST_LINE = re.compile(r"^\W*(?:final )?answer\W+(.+)", re.IGNORECASE | re.MULTILINE)


@dataclass(frozen=True)
class RankedImage:
    """An image and how much it looks like the goal.

    Attributes:
        number: Its number in the memory.
        above: How far it stands out from the other images, in standard deviations of these;
            negative if it looks less like the goal than most. 0 where there are too few images.
    """

    number: int
    above: float


@dataclass(eq=False)
class ImageRanking:
    """Ranks remembered images. Each is given to the model once, whatever is looked for later.

    Attributes:
        model: Model that compares images with texts.
        log: Log of all rankings, for the trace.
        name: Name of the model for people.
        least: How far an image must stand out for the robot to go to it; see `RankedImage.above`.
        known: Unit vectors of the images that were given to the model.
        neutral: Unit vectors of words that say nothing.
    """

    model: ImageTextModel
    log: ExchangeLog
    name: str
    least: float
    known: WeakKeyDictionary[KeyImage, Float32[np.ndarray, "n size"]] = field(
        default_factory=WeakKeyDictionary, init=False
    )
    neutral: Float32[np.ndarray, "texts size"] = field(init=False)

    def __post_init__(self) -> None:
        """Ask for the neutral words, so that a model that can't be used is refused now.

        Raises:
            HyPerNavError: The model fails.
        """
        self.neutral = _unit(self.model.text_vectors(NEUTRAL_WORDS))

    def ranked(self, images: Sequence[KeyImage], goal: Goal) -> list[RankedImage]:
        """Images in the order in which they look like the goal, the likeliest first.

        Raises:
            ContractError: Vectors of images and of texts have different sizes.
            HyPerNavError: The model fails.
        """
        if not images:
            return []
        words, began_s = goal.named_in(_WORDS), time.perf_counter()
        fits = self._fits(images, words)
        away = fits - np.median(fits)
        spread = max(_TO_DEVIATION * float(np.median(np.abs(away))), _LEAST_SPREAD)
        above = away / spread if len(images) >= _LEAST_IMAGES else np.zeros(len(images))
        order = sorted(range(len(images)), key=lambda k: (-fits[k], images[k].number))
        ranked = [RankedImage(images[k].number, round(float(above[k]), 3)) for k in order]
        told = ", ".join(
            f"image {one.number}: {one.above:+.1f}" for one in ranked[:IMAGES_PER_QUESTION]
        )
        took_s = time.perf_counter() - began_s
        self.log.note("rank images", self.name, words, told, seconds=took_s)
        return ranked

    def _fits(self, images: Sequence[KeyImage], words: str) -> Float64[np.ndarray, " images"]:
        """How much better each image fits the words than neutral ones: difference of cosines."""
        texts = np.concatenate([_unit(self.model.text_vectors((words,))), self.neutral])
        fits = list[float]()
        for image in images:
            vectors = self.known.get(image)
            if vectors is None:
                vectors = self.known[image] = _unit(self.model.image_vectors(image.rgb))
            if vectors.shape[1] != texts.shape[1]:
                raise ContractError(
                    f"{self.name}: vectors of images have {vectors.shape[1]} numbers, and those of "
                    f"texts {texts.shape[1]}; they must have as many"
                )
            cosines = (vectors @ texts.T).max(axis=0).astype(np.float64)
            fits.append(float(cosines[0] - cosines[1:].mean()))
        return np.array(fits)


def _unit(vectors: Float32[np.ndarray, "n size"]) -> Float32[np.ndarray, "n size"]:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@dataclass(eq=False)
class ImageRecall:
    """Shows remembered images and asks in which of them the goal is.

    Attributes:
        chat: Chat model to ask.
        log: Log of all questions and answers, for the trace.
        config: Configuration of the question.
        unread: Number of answers that name no image, and don't say "none", since the last report.
    """

    chat: ChatModel
    log: ExchangeLog
    config: ImageRecallConfig = field(default_factory=ImageRecallConfig)
    unread: int = field(default=0, init=False)

    def shown_in(self, images: Sequence[Image], goal: Goal) -> tuple[int, ...]:
        """Which of some images (RGB) show the goal, as the model says: their indices.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = images_question(self.config, images, goal)
        answer = self.chat.ask(question)
        numbers = None if answer.fault is not None else named_images(answer.text, len(images))
        remarks = [] if numbers is not None else [answer.detail or "it names no image"]
        self.log.record(exchange_of(question, answer, remarks=remarks))
        self.unread += numbers is None
        return tuple(number - 1 for number in numbers or ())

    def take_report(self) -> dict[str, Any]:
        """Number of answers since the last call that could not be read, if there were any."""
        report = {"unread_image_answers": self.unread} if self.unread else {}
        self.unread = 0
        return report


def images_question(config: ImageRecallConfig, images: Sequence[Image], goal: Goal) -> Question:
    """Question to a model in which of some images (RGB) it sees the goal."""
    return Question(
        kind="choose images",
        text=goal.named_in(config.prompt),
        images=(sheet_of(images),),
        max_tokens=64,
        at_once=True,
    )


def named_images(text: str, count: int) -> tuple[int, ...] | None:
    """The numbers of the images that an answer names, from 1, in rising order.

    The last line "Answer: …" counts, else the first line, else the whole text; each only if it
    names images or says that there is none, and not both. "1-3" and "1 to 3" are ranges. Numbers
    after the word "image" count, if there are any, and no other ones then.

    Args:
        text: The answer.
        count: Number of images.

    Returns:
        None if it can't be read.
    """
    said = final_answer(text)
    parts = (*_LAST_LINE.findall(said)[-1:], said.partition("\n")[0], said)
    read = (_named(part, count) for part in parts)
    return next((one for one in read if one is not None), None)


def _named(text: str, count: int) -> tuple[int, ...] | None:
    listed = ", ".join(_OF_IMAGES.findall(text)) or text
    ends = [(int(first), int(last or first)) for first, last in _RANGE.findall(listed)]
    between = (range(first, min(last, count) + 1) for first, last in ends)
    numbers = {number for one in (*ends, *between) for number in one}
    possible = tuple(sorted(number for number in numbers if 1 <= number <= count))
    says_none = _NONE.search(text) is not None or numbers == {0}
    if possible:
        return None if says_none else possible
    return () if says_none and numbers <= {0} else None


def sheet_of(images: Sequence[Image]) -> Image:
    """The images side by side, each with its number: some servers take one image a question."""
    columns = min(_COLUMNS, len(images))
    height = max(round(_TILE_PX * one.shape[0] / one.shape[1]) for one in images)
    down, right = height + _GAP_PX, _TILE_PX + _GAP_PX
    rows = math.ceil(len(images) / columns)
    sheet = np.full((rows * down - _GAP_PX, columns * right - _GAP_PX, 3), 255, np.uint8)
    for k, image in enumerate(images):
        top, left = k // columns * down, k % columns * right
        scale = _TILE_PX / image.shape[1]
        size = (_TILE_PX, round(image.shape[0] * scale))
        how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
        tile = cv2.resize(np.ascontiguousarray(image), size, interpolation=how)
        sheet[top : top + size[1], left : left + _TILE_PX] = tile
        middle = (left + 1.5 * _DISC_PX, top + 1.5 * _DISC_PX)
        shapes.disc(sheet, middle, _DISC_PX, palette.INK)
        draw_text(sheet, str(k + 1), middle, _DISC_PX, bold=True, color=palette.FREE, align=0.5)
    return sheet
