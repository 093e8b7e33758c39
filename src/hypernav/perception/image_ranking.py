"""Which remembered images look like the goal, by a model that compares images with texts.

An image counts for how much better it fits the goal's words than words that say nothing, since some
images fit any text, and for how far it stands out in that from the other images, since some texts
fit any image. Both are ours: VLFM takes the bare similarity, and DynaMem (Liu et al. 2024; its
code) goes to the place of the greatest one and has a detector look there.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.components.protocols import ImageTextModel
from hypernav.core.errors import ContractError
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.mapping.memory.key_images import KeyImage

_WORDS = "a photo of a {goal}"
NEUTRAL_WORDS = ("a photo", "a photo of a room", "a photo of an object", "a photo of a wall")
"""Texts that say nothing of a goal."""
_LEAST_IMAGES = 8
"""Number of images below which none stands out: too few to tell how much they differ anyway."""
_LEAST_SPREAD = 0.005
"""Cosine below which images that differ by it count as alike."""
_TO_DEVIATION = 1.4826
"""Standard deviation of normal values over the median of their distances from their median."""
_TOLD = 6


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
        told = ", ".join(f"image {one.number}: {one.above:+.1f}" for one in ranked[:_TOLD])
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
