"""Detection by perfect labels from a simulated world, for work on everything but recognition."""

from functools import lru_cache

import numpy as np

from hypernav.core.errors import LabelsMissingError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel
from hypernav.core.observation import Observation


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

    def __init__(self, min_area_share: float = 0.0005) -> None:
        """Create the detector.

        Args:
            min_area_share: Share of the image below which objects are overlooked, as by a real
                detector; the default is a patch of 12×12 pixels in 640×480.
        """
        self._min_area_share = min_area_share

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Visible instances that satisfy the goal, largest first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = observation.truth
        if truth is None:
            raise LabelsMissingError(
                "ground-truth detection needs a simulated world with labels, and this one supplies "
                "none; choose a real detector, for example --detector yolox:PATH.onnx"
            )
        pixels = np.bincount(truth.ids.ravel() + 1)[1:]
        enough = self._min_area_share * truth.ids.size
        visible = [int(i) for i in np.flatnonzero(pixels >= enough) if i in truth.labels]
        wanted = [i for i in visible if _satisfies(truth.labels[i], goal)]
        wanted.sort(key=lambda i: (-int(pixels[i]), i))
        return [self._detection(truth.ids == i, truth.labels[i]) for i in wanted]

    @staticmethod
    def _detection(mask: np.ndarray, label: ObjectLabel) -> Detection:
        rows = np.flatnonzero(mask.any(axis=1))
        columns = np.flatnonzero(mask.any(axis=0))
        box = Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
        return Detection(box, 1.0, label.category, mask)
