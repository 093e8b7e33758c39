"""A stand-in for a real detector that errs on the same things and from the same sides each time.

All numbers are drawn from hashes, so they don't change when the robot comes back.
"""

import hashlib
import math
from statistics import NormalDist

import numpy as np

from hypernav.core.config import Curve
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, same_name
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.search.models.reliability import known
from hypernav.search.perception.local.stand_ins.ground_truth import (
    MIN_AREA_SHARE,
    true_detection,
    true_labels,
    visible_objects,
)

SAME_THING_FOUND = 0.7
"""Correlation between views of whether one thing is found: at this value a thing that is found in
one view is found in about 58% of its others, as by YOLOX (benchmarks/persistent_errors.py)."""

SAME_NAME_SAID = 0.45
"""The same for wrong names: at a rate of 0.06, what is said in one view is said in 23% of the
others, as by YOLOX."""

STANDARD_NORMAL = NormalDist()

_SIDES_PX = (30.0, 60.0, 120.0, 240.0)
"""Square root of the area of a thing's box where a bin of size ends, pixels of 640×480."""
_SECTORS = 8

LEVELS = {"good": 0.2, "fair": 0.5, "poor": 1.0}
"""Share of YOLOX-nano's errors that a level makes."""

_PLACE_M = 1.0
_PLACES_SEEN = 30.0
"""Places of a building, cubes of 1 m, that a view shows on average; it scales their error rate."""
_STRIDE = 4

# Error rates of YOLOX-nano, counted in 1,400 views of 27 generated training buildings and one made
# by others:
#
#     python benchmarks/detection_bank.py --model yolox_nano.onnx --out bank --images 50 \
#         --scenes houses:3100 offices:3100 shops:3100 SMALL_HOUSE.glb houses:3101 … shops:3108
#     python benchmarks/persistent_errors.py bank

_FOUND_WHOLE = (0.06, 0.29, 0.54, 0.70, 1.0)
_FOUND_CUT_OFF = (0.0, 0.18, 0.25, 0.58, 0.57)
"""Shares of views in which a thing of a known kind is found, by bin of size."""

_TAKEN_FOR: dict[tuple[str, str], float] = {
    ("computer monitor", "tv"): 0.282,
    ("storage rack", "bed"): 0.055,
    ("armchair", "couch"): 0.527,
    ("desk", "dining table"): 0.061,
    ("sofa", "chair"): 0.193,
    ("mannequin", "person"): 0.51,
    ("meeting table", "dining table"): 0.369,
    ("picture", "person"): 0.061,
    ("sofa", "bed"): 0.14,
    ("desk", "chair"): 0.033,
    ("coffee table", "dining table"): 0.205,
    ("vase", "potted plant"): 0.467,
    ("reception desk", "bed"): 0.185,
    ("locker", "refrigerator"): 0.268,
    ("fire extinguisher", "bottle"): 0.303,
    ("picture", "tv"): 0.025,
    ("filing cabinet", "refrigerator"): 0.22,
    ("dishwasher", "oven"): 0.216,
    ("storage rack", "chair"): 0.011,
    ("chair", "dining table"): 0.011,
    ("door", "refrigerator"): 0.018,
    ("coffee table", "chair"): 0.096,
    ("water dispenser", "refrigerator"): 0.175,
    ("sink", "toilet"): 0.07,
    ("kitchen cabinet", "tv"): 0.026,
    ("trash can", "toilet"): 0.071,
    ("copier", "refrigerator"): 0.24,
    ("chair", "tv"): 0.008,
    ("desk divider", "tv"): 0.055,
    ("clothes rack", "tv"): 0.055,
    ("candle", "cup"): 0.24,
    ("kitchen cabinet", "refrigerator"): 0.022,
    ("wine rack", "chair"): 0.333,
    ("window", "tv"): 0.004,
    ("sales counter", "bed"): 0.156,
}
"""Shares of the views of a thing in which it is taken for a kind."""

_TAKEN_FROM_BUILDING: dict[str, float] = {
    "chair": 0.041,
    "book": 0.039,
    "vase": 0.026,
    "refrigerator": 0.019,
    "person": 0.009,
    "tv": 0.009,
    "sink": 0.007,
    "bed": 0.004,
}
"""Mean number of boxes per view in which walls, floors and ceilings are taken for a kind."""

_ANY_OTHER = 0.0003
"""Both for any others: two kinds, or a kind that parts of the building are taken for."""
_RIGHT_SCORE, _RIGHT_SCORE_SD = 0.67, 0.19
_WRONG_SCORE, _WRONG_SCORE_SD = 0.49, 0.16
_LEAST_SCORE = 0.3
"""Below it YOLOX reports nothing."""


def view_of(true: Detection, observation: Observation) -> tuple[int, int, bool]:
    """Side from which a thing is seen, bin of its box's size, and whether the image cuts it off.

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
    return sector, size_bin(true.box, observation), is_cut_off(true.box, observation)


def size_bin(box: Box, observation: Observation) -> int:
    """Number of the bin of a box's size, 0 to 4."""
    side = math.sqrt(box.area) * 640.0 / observation.camera.width
    return int(np.searchsorted(_SIDES_PX, side, side="right"))


def is_cut_off(box: Box, observation: Observation) -> bool:
    """Whether a box touches the edge of the image."""
    height, width = observation.depth.shape
    return touches_edge(box, width, height)


def touches_edge(box: Box, width: int, height: int) -> bool:
    """Whether a box touches the edge of an image of this size, pixels."""
    return box.x_min < 1 or box.y_min < 1 or box.x_max > width - 1 or box.y_max > height - 1


def latent(key: tuple[object, ...], view: tuple[object, ...], persistence: float) -> float:
    """A standard normal number of a thing in a view, correlated between its views.

    A part is drawn for the thing and a part for the view. Both are normal, so that any chance can
    be had with any persistence (a Gaussian copula).

    Args:
        key: The thing, and what it is asked about.
        view: The view.
        persistence: Correlation between views, 0 to 1.
    """
    own, seen = normal(key), normal((*key, *view))
    return math.sqrt(persistence) * own + math.sqrt(1.0 - persistence) * seen


def normal(key: tuple[object, ...]) -> float:
    """A standard normal number that a key always gives."""
    return STANDARD_NORMAL.inv_cdf(uniform(key))


def uniform(key: tuple[object, ...]) -> float:
    """A number in (0, 1) that a key always gives."""
    digest = hashlib.blake2b(repr(key).encode(), digest_size=7).digest()
    return (int.from_bytes(digest, "big") + 0.5) / 2.0**56


class SystematicDetector:
    """Detects the goal with errors that belong to things, sides and sizes.

    Whether a thing is found, and whether one of another kind is taken for the goal, is drawn from
    a hash of the thing, the side from which it is seen, the size of its box and whether the image
    cuts it off. So nothing changes while the view hardly does, or when the robot comes back: some
    things are never found, some only from near, and some are taken for the goal whenever they are
    seen. Places of the building are taken for the goal in the same way. There is no randomness.

    Attributes:
        looks_at_colours: See `hypernav.core.components.abilities.looks_at_colours`.
        looks_closer: See `hypernav.core.components.abilities.looks_closer`.
        score_weights: See `hypernav.core.components.abilities.score_weights_of`; YOLOX-nano's,
            which it imitates.
    """

    looks_at_colours = False
    looks_closer = False
    score_weights: Curve = known()["yolox-nano"].boxes

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
        """Goals found and things or places taken for the goal, best first.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        truth = true_labels(observation)
        found = []
        for number in visible_objects(truth):
            label, true = truth.labels[number], true_detection(truth, number)
            view = view_of(true, observation)
            is_right = label.satisfies(goal)
            key = (number, label.category, *label.attributes, goal.text)
            if _shows(key, view, *self._chance(label, goal, true.box, observation)):
                found.append(Detection(true.box, _score((*key, *view), is_right), goal.thing))
        found += self._taken_places(truth, observation, goal)
        return sorted(found, key=lambda one: -one.score)

    def _chance(
        self, label: ObjectLabel, goal: Goal, box: Box, observation: Observation
    ) -> tuple[float, float]:
        """Probability that such a thing is reported, and the correlation between its views."""
        if label.satisfies(goal):
            size, is_cut = size_bin(box, observation), is_cut_off(box, observation)
            found = (_FOUND_CUT_OFF if is_cut else _FOUND_WHOLE)[size]
            return 1.0 - self._share * (1.0 - found), SAME_THING_FOUND
        taken = [
            rate
            for (thing, said), rate in _TAKEN_FOR.items()
            if same_name(said, goal.thing) and label.is_named(thing)
        ]
        return self._share * max(taken, default=_ANY_OTHER), SAME_NAME_SAID

    def _taken_places(
        self, truth: LabelledPixels, observation: Observation, goal: Goal
    ) -> list[Detection]:
        """Detections of places of the building, always the same ones, taken for the goal."""
        named = [rate for kind, rate in _TAKEN_FROM_BUILDING.items() if same_name(kind, goal.thing)]
        rate = self._share * max(named, default=_ANY_OTHER)
        depth, ids = observation.depth[::_STRIDE, ::_STRIDE], truth.ids[::_STRIDE, ::_STRIDE]
        is_building = ~np.isin(ids, np.array(list(truth.labels), dtype=np.int64))
        rows, columns = np.nonzero(is_building & is_measured(depth))
        points = observation.points_at(rows * _STRIDE, columns * _STRIDE)
        places, owner = np.unique(
            np.floor(points / _PLACE_M).astype(np.int64), axis=0, return_inverse=True
        )
        owner = owner.ravel()
        found = []
        for place, cube in enumerate(places.tolist()):
            key = (*cube, goal.text)
            if uniform((*key, "building")) >= rate / _PLACES_SEEN:
                continue
            mine = owner == place
            if mine.sum() >= MIN_AREA_SHARE * ids.size:
                low = (columns[mine].min() * _STRIDE, rows[mine].min() * _STRIDE)
                high = ((columns[mine].max() + 1) * _STRIDE, (rows[mine].max() + 1) * _STRIDE)
                box = Box(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
                found.append(Detection(box, _score(key, False), goal.thing))
        return found


def _shows(
    key: tuple[object, ...], view: tuple[object, ...], chance: float, persistence: float
) -> bool:
    """Whether a thing is reported in a view."""
    if not 0.0 < chance < 1.0:
        return chance >= 1.0
    return latent(key, view, persistence) < STANDARD_NORMAL.inv_cdf(chance)


def _score(key: tuple[object, ...], is_right: bool) -> float:
    mean, sd = (_RIGHT_SCORE, _RIGHT_SCORE_SD) if is_right else (_WRONG_SCORE, _WRONG_SCORE_SD)
    return float(np.clip(mean + sd * normal((*key, "score")), _LEAST_SCORE, 1.0))
