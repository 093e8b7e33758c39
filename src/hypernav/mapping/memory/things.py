"""Things that a robot remembers: what was seen where, how surely, and whether it is still there.

Detections of one label that overlap on the floor plan are one thing. An image that should show a
thing and doesn't is a miss, and misses tell the more, the more reliably the thing was seen before.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, canonical
from hypernav.core.observation import Observation
from hypernav.mapping.memory.visibility import should_be_visible

MOST_THINGS = 500
"""Number of things that a floor remembers; the least certain are forgotten first."""
_STRIDE = 4
_LEAST_POINTS = 3
_SPREAD = (5.0, 95.0)
"""Percentiles of a detection's points between which it extends, so that strays don't count."""
_SAME_DEPTH_M = 0.5
"""Distance in depth from a box's middle up to which its pixels are the thing's, without a mask."""
_SAME_SHARE = 0.35
_SAME_M = (0.15, 0.6)
"""Margin around a thing in which the middle of another view of it may lie: this share of its larger
side on the floor plan, within these limits, metres. Front and back of a sofa are one thing, and
chairs around a table are not."""
_SAME_HEIGHT_M = 0.5
_LOW_SHARE = 0.25
_LEAST_PX = 20.0
"""Size in the image, pixels, below which it says nothing that a thing was not detected."""
_NEAR_M = 4.0
"""Distance beyond which no image can be expected to show a thing, metres."""
_SUREST = 0.9
"""Largest chance that a thing is what it was taken for, before any miss."""
_RECALL = (0.3, 0.95)
"""Limits of how often a detector is believed to see a thing that is there."""
_LARGER = 4.0
"""Times that a thing must be larger in an image than in all key images for one more of it."""
_GONE = 0.2
"""Chance below which a thing counts as gone."""

Corner = tuple[float, float, float]


@dataclass(frozen=True)
class Thing:
    """A thing on a floor, as an upright box.

    Attributes:
        number: Its number on this floor.
        label: The detector's word for it.
        score: Highest score of a detection of it, 0 to 1.
        low: Lowest corner ``(x, y, z)`` of its box, ``map`` frame, heights above the floor, metres.
        high: Highest corner of its box.
        seen_from: Position ``(x, y)``, metres, of the robot in the image that shows it largest.
        pixels: Area of its box in that image, square pixels.
        first_search: Number of the search that saw it first.
        last_search: Number of the search that saw it last.
        seen: Number of images that it was detected in.
        missed: Number of images since the last detection that should have shown it.
        overlooked: Number of images before the last detection that should have shown it.
        image: Number of the key image that shows it largest; None if there is none.
        image_pixels: Area of its box in that image, square pixels.
    """

    number: int
    label: str
    score: float
    low: Corner
    high: Corner
    seen_from: tuple[float, float]
    pixels: float
    first_search: int
    last_search: int
    seen: int = 1
    missed: int = 0
    overlooked: int = 0
    image: int | None = None
    image_pixels: float = 0.0

    @property
    def position(self) -> Corner:
        """The middle of its box ``(x, y, z)``, metres."""
        x, y, z = ((a + b) / 2.0 for a, b in zip(self.low, self.high, strict=True))
        return (x, y, z)

    @property
    def size(self) -> Corner:
        """The extent of its box along x, y and z, metres."""
        x, y, z = (b - a for a, b in zip(self.low, self.high, strict=True))
        return (x, y, z)

    @property
    def outline(self) -> Float64[np.ndarray, "5 2"]:
        """Its middle and the corners of its box on the floor plan, ``(x, y)``, metres."""
        (x0, y0, _), (x1, y1, _), (x, y, _) = self.low, self.high, self.position
        return np.array([(x, y), (x0, y0), (x1, y0), (x1, y1), (x0, y1)])

    @property
    def chance(self) -> float:
        """Chance that it is what it was taken for and still there.

        Scores count as independent chances, up to `_SUREST`. Every miss since the last detection
        counts by Bayes' rule for a detector that sees this thing as often as it did before.
        """
        before = min(1.0 - (1.0 - min(self.score, 1.0)) ** self.seen, _SUREST)
        if self.missed == 0:
            return before
        recall = (self.seen + 1) / (self.seen + self.overlooked + 2)
        unseen = (1.0 - min(max(recall, _RECALL[0]), _RECALL[1])) ** self.missed
        return before * unseen / (before * unseen + 1.0 - before)

    @property
    def is_gone(self) -> bool:
        """Whether it was missed so often that it probably is no longer there."""
        return self.missed > 0 and self.chance < _GONE

    def fits(self, goal: Goal) -> float:
        """How well its label fits a goal: 1 as far as asked, 0.5 only its kind, 0 not at all."""
        label = ObjectLabel(self.label)
        if label.satisfies(goal):
            return 1.0
        return 0.5 if label.may_satisfy(goal) else 0.0


@dataclass(frozen=True)
class Things:
    """The things of one floor.

    Attributes:
        known: The things.
        count: Number of things so far, for the next one's number.
        shown: Area of the boxes, square pixels, of the things in the latest image, by number.
    """

    known: tuple[Thing, ...] = ()
    count: int = 0
    shown: Mapping[int, float] = field(default_factory=dict)

    @property
    def wants_image(self) -> bool:
        """Whether the latest image shows a thing much larger than any key image does."""
        return any(
            self.shown[one.number] > _LARGER * one.image_pixels
            for one in self.known
            if one.number in self.shown
        )

    def find(self, number: int) -> Thing | None:
        """The thing of a number; None if it was forgotten."""
        return next((one for one in self.known if one.number == number), None)

    def fitting(self, goal: Goal) -> list[tuple[Thing, float]]:
        """The things that may be a goal and are not gone, each with the chance that it is."""
        chances = [(one, one.chance * one.fits(goal)) for one in self.known if not one.is_gone]
        return [(one, chance) for one, chance in chances if chance > 0.0]

    def after_image(
        self,
        observation: Observation,
        detections: Iterable[Detection],
        camera: CameraConfig,
        *,
        search: int,
        only: Goal | None = None,
    ) -> "Things":
        """The things after one more image.

        Args:
            observation: The image, with heights counted from this floor.
            detections: All that was detected in it.
            camera: Camera, whose range of depth counts.
            search: Number of the present search.
            only: Goal, if the detector looks for nothing else; then only things that fit it can be
                missed.
        """
        known = {one.number: one for one in self.known}
        count, shown = self.count, dict[int, float]()
        for detection in detections:
            new = _seen_thing(detection, observation, camera, count, search)
            if new is None:
                continue
            same = [one for one in known.values() if _is_same(one, new)]
            for one in same:
                del known[one.number]
            joined = _joined(same, new)
            known[joined.number] = joined
            shown[joined.number] = max(new.pixels, shown.get(joined.number, 0.0))
            count += not same
        for one in list(known.values()):
            may_be_missed = one.number not in shown and (only is None or one.fits(only) > 0.0)
            if may_be_missed and _should_show(one, observation):
                known[one.number] = replace(one, missed=one.missed + 1)
        kept = sorted(known.values(), key=lambda one: one.number)
        if len(kept) > MOST_THINGS:
            surest = sorted(kept, key=lambda one: (-one.chance, -one.last_search))[:MOST_THINGS]
            kept = sorted(surest, key=lambda one: one.number)
        return Things(tuple(kept), count, shown)

    def with_image(self, number: int) -> "Things":
        """The things after the latest image became the key image of this number."""
        return replace(
            self,
            known=tuple(
                replace(one, image=number, image_pixels=self.shown[one.number])
                if self.shown.get(one.number, 0.0) > one.image_pixels
                else one
                for one in self.known
            ),
        )

    def without_images(self, numbers: Iterable[int]) -> "Things":
        """The things without key images that were forgotten."""
        gone = frozenset(numbers)
        return replace(
            self,
            known=tuple(
                replace(one, image=None, image_pixels=0.0) if one.image in gone else one
                for one in self.known
            ),
        )


def _seen_thing(
    detection: Detection, observation: Observation, camera: CameraConfig, number: int, search: int
) -> Thing | None:
    """A detection as a thing; None if too few of its pixels have depth."""
    points = _points(detection, observation, camera)
    if len(points) < _LEAST_POINTS:
        return None
    (x0, y0, z0), (x1, y1, z1) = np.percentile(points, _SPREAD, axis=0).round(3).tolist()
    return Thing(
        number=number,
        label=detection.label,
        score=round(float(detection.score), 4),
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        seen_from=observation.robot.xy,
        pixels=float(detection.box.area),
        first_search=search,
        last_search=search,
    )


def _points(
    detection: Detection, observation: Observation, camera: CameraConfig
) -> Float64[np.ndarray, "n 3"]:
    """Points of a detection, ``map`` frame, metres; without a mask those as far as its middle."""
    height, width = observation.depth.shape
    x_min, y_min, x_max, y_max = detection.box.clipped(width, height).pixels()
    top, left = y_min - y_min % _STRIDE, x_min - x_min % _STRIDE
    window = (slice(top, y_max, _STRIDE), slice(left, x_max, _STRIDE))
    depth = observation.depth[window]
    good = is_measured(depth, camera.min_depth_m, camera.max_depth_m)
    if detection.mask is not None:
        good &= detection.mask[window]
    elif good.any():
        middle = _middle_depth(detection.box.clipped(width, height), observation, camera)
        good &= np.abs(depth - middle) <= _SAME_DEPTH_M
    rows, columns = np.nonzero(good)
    return observation.points_at(top + rows * _STRIDE, left + columns * _STRIDE)


def _middle_depth(box: Box, observation: Observation, camera: CameraConfig) -> float:
    """Median depth in the middle half of a box, metres; NaN where nothing is measured."""
    dx, dy = (box.x_max - box.x_min) / 4.0, (box.y_max - box.y_min) / 4.0
    rows = slice(round(box.y_min + dy), round(box.y_max - dy) + 1)
    columns = slice(round(box.x_min + dx), round(box.x_max - dx) + 1)
    depths = observation.depth[rows, columns]
    depths = depths[is_measured(depths, camera.min_depth_m, camera.max_depth_m)]
    return float(np.median(depths)) if depths.size else math.nan


def _is_same(a: Thing, b: Thing) -> bool:
    """Whether two views are of one thing: one's middle lies in the other's box, or beside it."""
    if canonical(a.label) != canonical(b.label):
        return False
    return _holds(a, b.position) or _holds(b, a.position)


def _holds(one: Thing, position: Corner) -> bool:
    width_m = max(one.size[0], one.size[1])
    beside_m = min(max(_SAME_SHARE * width_m, _SAME_M[0]), _SAME_M[1])
    margins = (beside_m, beside_m, _SAME_HEIGHT_M)
    return all(
        low - margin <= at <= high + margin
        for low, at, high, margin in zip(one.low, position, one.high, margins, strict=True)
    )


def _joined(known: list[Thing], new: Thing) -> Thing:
    """A thing after one more view of it, which may show that several things are one.

    What was remembered from earlier searches gives way to the first view of this one that shows the
    thing as large: it may have been moved a little.
    """
    if not known:
        return new
    best = max(known, key=lambda one: one.pixels)
    is_larger = new.pixels > best.pixels
    is_renewed = best.last_search < new.last_search and 2.0 * new.pixels >= best.pixels
    boxes = [new] if is_renewed else [*known, new]
    low = np.min([one.low for one in boxes], axis=0).tolist()
    high = np.max([one.high for one in boxes], axis=0).tolist()
    return replace(
        best,
        number=min(one.number for one in known),
        score=max(best.score, new.score),
        low=tuple(low),
        high=tuple(high),
        seen_from=new.seen_from if is_larger or is_renewed else best.seen_from,
        pixels=new.pixels if is_larger or is_renewed else best.pixels,
        first_search=min(one.first_search for one in known),
        last_search=new.last_search,
        seen=sum(one.seen for one in known) + 1,
        missed=0,
        overlooked=sum(one.overlooked + one.missed for one in known),
    )


def _should_show(one: Thing, observation: Observation) -> bool:
    """Whether an image should show a thing, near and large enough to be detected."""
    x, y, _ = one.position
    robot = observation.robot
    distance_m = robot.distance_to(x, y)
    if distance_m > _NEAR_M or abs(robot.bearing_to(x, y)) > math.pi / 2.0:
        return False
    across_m = min(max(one.size[0], one.size[1]), one.size[2])
    if across_m * observation.camera.fx < _LEAST_PX * distance_m:
        return False
    # Low down the floor behind it is near enough to have depth, if the thing is not there.
    return should_be_visible(one.outline, one.low[2] + _LOW_SHARE * one.size[2], observation)
