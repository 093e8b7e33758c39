"""Detection by perfect labels from a simulated world, for work on everything but recognition."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import ClassVar

import cv2
import numpy as np
from scipy import ndimage

from hypernav.core.config import Curve
from hypernav.core.errors import LabelsMissingError
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.search.models.reliability import known

MIN_AREA_SHARE = 0.0005
"""Share of the image below which objects are overlooked, as by a real detector: 12×12 pixels in
640×480."""
_COARSE = 4
_STRIDE = 8
_LEAST_PIXELS = 2
"""To name things every 8th pixel in both directions is read, and two of them must show one."""


@dataclass(frozen=True, eq=False)
class GroundTruthDetector:
    """Sees exactly what is visible, labelled and not too small.

    Its detections carry their masks, so no segmenter is asked.

    Attributes:
        min_area_share: Share of the image below which objects are overlooked.
        gives_masks: See `hypernav.core.components.abilities.gives_masks`.
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        looks_closer: See `hypernav.core.components.abilities.looks_closer`.
        score_weights: See `hypernav.core.components.abilities.score_weights_of`; its scores are 1.
    """

    min_area_share: float = MIN_AREA_SHARE

    gives_masks = True
    looks_at_colours = False
    looks_closer = False
    score_weights: ClassVar[Curve] = known()["yolox-nano"].boxes

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """Visible instances that satisfy the goal, largest first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        return [
            true_detection(truth, number)
            for number in visible_objects(truth, self.min_area_share)
            if truth.labels[number].satisfies(goal)
        ]

    def things_in(
        self, observation: Observation, detections: Sequence[Detection]
    ) -> list[Detection]:
        """All visible labelled instances, in the order of their numbers.

        Boxes are rounded to `_COARSE` pixels, since all pixels would be read for nothing more.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        ids = truth.ids[::_COARSE, ::_COARSE]
        pixels, windows = np.bincount(ids[ids >= 0]), ndimage.find_objects(ids + 1)
        least = max(self.min_area_share * ids.size, 1.0)
        found = []
        for number in np.flatnonzero(pixels >= least).tolist():
            if number not in truth.labels:
                continue
            rows, columns = windows[number]
            top, bottom = _COARSE * rows.start, _COARSE * rows.stop
            left, right = _COARSE * columns.start, _COARSE * columns.stop
            mask = np.zeros(truth.ids.shape, dtype=bool)
            window = np.s_[top:bottom, left:right]
            np.equal(truth.ids[window], number, out=mask[window])
            box = Box(float(left), float(top), float(right), float(bottom))
            found.append(Detection(box, 1.0, truth.labels[number].category, mask))
        return found

    def name_things(
        self, observation: Observation, *, besides: Collection[int]
    ) -> dict[int, SeenThing]:
        """Visible instances that have depth, by their numbers, with positions in the ``map`` frame.

        Args:
            observation: Present frame.
            besides: Numbers of the instances to leave out.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        ids = truth.ids[::_STRIDE, ::_STRIDE]
        depth = observation.depth[::_STRIDE, ::_STRIDE]
        rows, columns = np.nonzero((ids >= 0) & is_measured(depth))
        shown = ids[rows, columns]
        things = {}
        for number in np.flatnonzero(np.bincount(shown) >= _LEAST_PIXELS).tolist():
            if number in besides or number not in truth.labels:
                continue
            mine = shown == number
            points = observation.camera.unproject_pixels(
                rows[mine] * _STRIDE, columns[mine] * _STRIDE, depth[rows[mine], columns[mine]]
            )
            x, y, _ = observation.camera_to_map.apply(np.median(points, axis=0)[None])[0]
            things[number] = SeenThing(truth.labels[number].category, (float(x), float(y)))
        return things


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
    """Numbers of labelled instances with at least this share of the image, largest first."""
    pixels = np.bincount(truth.ids[truth.ids >= 0])
    enough = np.flatnonzero(pixels >= min_area_share * truth.ids.size)
    visible = [int(number) for number in enough if int(number) in truth.labels]
    return sorted(visible, key=lambda number: (-int(pixels[number]), number))


def true_detection(truth: LabelledPixels, number: int) -> Detection:
    """A visible instance with its mask, the box around that, and its category."""
    mask = truth.ids == number
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    box = Box(float(left), float(top), float(left + width), float(top + height))
    return Detection(box, 1.0, truth.labels[number].category, mask)
