"""A stand-in for a real detector that errs on the same things and from the same sides each time."""

import hashlib
import math
from statistics import NormalDist

import numpy as np

from hypernav.core.errors import ConfigError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, same_name
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.perception.local import systematic_rates as rates
from hypernav.perception.local.ground_truth import (
    MIN_AREA_SHARE,
    true_detection,
    true_labels,
    visible_objects,
)

LEVELS = {"good": 0.2, "fair": 0.5, "poor": 1.0}
"""Share of YOLOX-nano's errors that a level makes."""

_NORMAL = NormalDist()
_SECTORS = 8
_PLACE_M = 1.0
_PLACES_SEEN = 30.0
"""Places of a building, cubes of 1 m, that a view shows; only sets the scale of their rate."""
_STRIDE = 4


class SystematicDetector:
    """Detects the goal with errors that belong to things, sides and sizes.

    Whether a thing is found, and whether one of another kind is taken for the goal, is drawn from
    a hash of the thing, the side from which it is seen, the size of its box and whether the image
    cuts it off. So nothing changes while the view hardly does, or when the robot comes back: some
    things are never found, some only from near, and some are taken for the goal whenever they are
    seen. Places of the building are taken for the goal in the same way. There is no randomness.

    Attributes:
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
    """

    looks_at_colours = False

    def __init__(self, level: str) -> None:
        """Create the detector.

        Args:
            level: "poor" errs as often as YOLOX-nano, "fair" half, "good" a fifth as often.

        Raises:
            ConfigError: There is no such level.
        """
        if level not in LEVELS:
            raise ConfigError(
                f"--detector systematic:{level:.40}: expected one of {', '.join(LEVELS)}"
            )
        self._share = LEVELS[level]

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """What is found of the goal and what is taken for it, best first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        found = []
        for number in visible_objects(truth):
            label, true = truth.labels[number], true_detection(truth, number)
            view = _view_of(true, observation)
            is_right = label.satisfies(goal)
            key = (number, label.category, *label.attributes, goal.text)
            if _shows(key, view, *self._chance(label, goal, true.box, observation)):
                found.append(Detection(true.box, _score((*key, *view), is_right), goal.thing))
        found += self._taken_places(truth, observation, goal)
        return sorted(found, key=lambda one: -one.score)

    def _chance(
        self, label: ObjectLabel, goal: Goal, box: Box, observation: Observation
    ) -> tuple[float, float]:
        """Probability over all things and views that this one is reported, and its persistence."""
        if label.satisfies(goal):
            size, is_cut = _size_bin(box, observation), _is_cut_off(box, observation)
            found = (rates.FOUND_CUT_OFF if is_cut else rates.FOUND_WHOLE)[size]
            return 1.0 - self._share * (1.0 - found), rates.SAME_THING_FOUND
        taken = [
            rate
            for (thing, said), rate in rates.TAKEN_FOR.items()
            if same_name(said, goal.thing) and label.is_named(thing)
        ]
        return self._share * max(taken, default=rates.TAKEN_FOR_ANY_OTHER), rates.SAME_NAME_SAID

    def _taken_places(
        self, truth: LabelledPixels, observation: Observation, goal: Goal
    ) -> list[Detection]:
        """Places of the building that are taken for the goal, always the same ones."""
        named = [
            rate for kind, rate in rates.TAKEN_FROM_BUILDING.items() if same_name(kind, goal.thing)
        ]
        rate = self._share * max(named, default=rates.TAKEN_FROM_BUILDING_ANY_OTHER)
        depth, ids = observation.depth[::_STRIDE, ::_STRIDE], truth.ids[::_STRIDE, ::_STRIDE]
        is_building = ~np.isin(ids, np.array(list(truth.labels), dtype=np.int64))
        rows, columns = np.nonzero(is_building & is_measured(depth))
        points = observation.camera_to_map.apply(
            observation.camera.unproject_pixels(
                rows * _STRIDE, columns * _STRIDE, depth[rows, columns]
            )
        )
        places, owner = np.unique(
            np.floor(points / _PLACE_M).astype(np.int64), axis=0, return_inverse=True
        )
        owner = owner.ravel()
        found = []
        for place, cube in enumerate(places.tolist()):
            key = (*cube, goal.text)
            if _uniform((*key, "building")) >= rate / _PLACES_SEEN:
                continue
            mine = owner == place
            if mine.sum() >= MIN_AREA_SHARE * ids.size:
                low = (columns[mine].min() * _STRIDE, rows[mine].min() * _STRIDE)
                high = ((columns[mine].max() + 1) * _STRIDE, (rows[mine].max() + 1) * _STRIDE)
                box = Box(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
                found.append(Detection(box, _score(key, False), goal.thing))
        return found


def _view_of(true: Detection, observation: Observation) -> tuple[int, int, bool]:
    """Side from which a thing is seen, size of its box, and whether the image cuts it off.

    The side is the sector of the direction from the thing to the camera.
    """
    assert true.mask is not None
    rows, columns = np.nonzero(true.mask)
    depth = observation.depth[rows, columns]
    measured = is_measured(depth)
    towards = float(np.median(columns)) + 0.5
    bearing = observation.robot.yaw + observation.camera.bearing_of(towards)
    if measured.any():
        point = observation.camera.unproject_pixels(
            np.array([int(np.median(rows))]),
            np.array([int(np.median(columns))]),
            float(np.median(depth[measured])),
        )
        x, y, _ = observation.camera_to_map.apply(point)[0]
        eye = observation.camera_to_map.translation
        bearing = math.atan2(float(y - eye[1]), float(x - eye[0]))
    sector = int(bearing / (2.0 * math.pi) * _SECTORS // 1) % _SECTORS
    return sector, _size_bin(true.box, observation), _is_cut_off(true.box, observation)


def _size_bin(box: Box, observation: Observation) -> int:
    side = math.sqrt(box.area) * 640.0 / observation.camera.width
    return int(np.searchsorted(rates.SIDES_PX, side, side="right"))


def _is_cut_off(box: Box, observation: Observation) -> bool:
    height, width = observation.depth.shape
    return box.x_min < 1 or box.y_min < 1 or box.x_max > width - 1 or box.y_max > height - 1


def _shows(
    key: tuple[object, ...], view: tuple[object, ...], chance: float, persistence: float
) -> bool:
    """Whether a thing is reported in a view.

    A part is drawn for the thing and a part for the view. Both are normal, so that any chance can
    be had with any persistence (a Gaussian copula).
    """
    if not 0.0 < chance < 1.0:
        return chance >= 1.0
    own, seen = _normal(key), _normal((*key, *view))
    drawn = math.sqrt(persistence) * own + math.sqrt(1.0 - persistence) * seen
    return drawn < _NORMAL.inv_cdf(chance)


def _score(key: tuple[object, ...], is_right: bool) -> float:
    mean, sd = (
        (rates.RIGHT_SCORE, rates.RIGHT_SCORE_SD)
        if is_right
        else (rates.WRONG_SCORE, rates.WRONG_SCORE_SD)
    )
    return float(np.clip(mean + sd * _normal((*key, "score")), rates.LEAST_SCORE, 1.0))


def _normal(key: tuple[object, ...]) -> float:
    return _NORMAL.inv_cdf(_uniform(key))


def _uniform(key: tuple[object, ...]) -> float:
    """A number in (0, 1) that a key always gives."""
    digest = hashlib.blake2b(repr(key).encode(), digest_size=7).digest()
    return (int.from_bytes(digest, "big") + 0.5) / 2.0**56
