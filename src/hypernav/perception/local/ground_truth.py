"""Detection by perfect labels from a simulated world, for work on everything but recognition."""

from functools import lru_cache

import numpy as np

from hypernav.core.errors import LabelsMissingError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation

MIN_AREA_SHARE = 0.0005
"""Share of the image below which objects are overlooked, as by a real detector: 12×12 pixels in
640×480."""


@lru_cache(maxsize=4096)
def _satisfies(label: ObjectLabel, goal: Goal) -> bool:
    return label.satisfies(goal)


class GroundTruthDetector:
    """Sees exactly what is visible and labelled, and nothing else.

    Its detections carry their masks, so no segmenter is asked.

    Attributes:
        gives_masks: See `hypernav.core.components.abilities.gives_masks`.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
    """

    gives_masks = True
    looks_at_colours = False

    def __init__(self, min_area_share: float = MIN_AREA_SHARE) -> None:
        """Create the detector.

        Args:
            min_area_share: Share of the image below which objects are overlooked.
        """
        self._min_area_share = min_area_share

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Visible instances that satisfy the goal, largest first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        return [
            true_detection(truth, number)
            for number in visible_objects(truth, self._min_area_share)
            if _satisfies(truth.labels[number], goal)
        ]


def true_labels(observation: Observation) -> LabelledPixels:
    """The ground truth of an image.

    Raises:
        LabelsMissingError: The world supplies no labels.
    """
    if observation.truth is None:
        raise LabelsMissingError(
            "ground-truth detection needs a simulated world with labels, and this one supplies "
            "none; choose a real detector, for example --detector yolox:PATH.onnx"
        )
    return observation.truth


def visible_objects(truth: LabelledPixels, min_area_share: float = MIN_AREA_SHARE) -> list[int]:
    """Labelled instances that cover at least this share of the image, largest first."""
    pixels = np.bincount(truth.ids.ravel() + 1)[1:]
    enough = np.flatnonzero(pixels >= min_area_share * truth.ids.size)
    visible = [int(number) for number in enough if int(number) in truth.labels]
    return sorted(visible, key=lambda number: (-int(pixels[number]), number))


def true_detection(truth: LabelledPixels, number: int) -> Detection:
    """A visible instance with its mask, the box around that, and its category."""
    mask = truth.ids == number
    rows = np.flatnonzero(mask.any(axis=1))
    columns = np.flatnonzero(mask.any(axis=0))
    box = Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
    return Detection(box, 1.0, truth.labels[number].category, mask)
