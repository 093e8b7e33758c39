"""Things that a robot remembers of a floor, and what an image says about them.

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
from hypernav.core.labels import canonical
from hypernav.core.observation import Observation
from hypernav.mapping.memory.thing import Thing, holds, joined, overlap
from hypernav.mapping.memory.visibility import should_be_visible

MOST_THINGS = 500
"""Number of things that a floor remembers; the least certain are forgotten first."""
_MOST_POINTS = 250
"""Number of pixels of a detection's box that are read, about."""
_LARGEST_STRIDE = 24
_LEAST_POINTS = 3
_STRAYS = 0.05
"""Share of a detection's points at each end of each axis that don't count to its extent."""
_SAME_DEPTH_M = 0.5
"""Distance in depth from a box's middle up to which its pixels are the thing's, without a mask."""
_LOW_SHARE = 0.25
_LEAST_PX = 20.0
"""Size in the image, pixels, below which it says nothing that a thing was not detected."""
_NEAR_M = 4.0
"""Distance beyond which no image can be expected to show a thing, metres."""
_LARGER = 4.0
"""Times that a thing must be larger in an image than in all key images for one more of it."""


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

    def at(self, x: float, y: float, goal: Goal) -> list[Thing]:
        """The things at a position, metres, that may be a goal."""
        return [
            one
            for one in self.known
            if holds(one, (x, y, one.position[2])) and one.fits(goal) > 0.0
        ]

    def refuted_at(
        self, positions: Iterable[tuple[float, float]], goal: Goal, search: int
    ) -> "Things":
        """The things after a search rejected what it took for its goal at these positions."""
        refuted = {one.number for xy in positions for one in self.at(*xy, goal)}
        return replace(
            self,
            known=tuple(
                replace(one, refuted_in=search) if one.number in refuted else one
                for one in self.known
            ),
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
            name = canonical(new.label)
            same = [
                one for one in known.values() if canonical(one.label) == name and overlap(one, new)
            ]
            for one in same:
                del known[one.number]
            one = joined(same, new)
            known[one.number] = one
            shown[one.number] = max(new.pixels, shown.get(one.number, 0.0))
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
    spread = np.sort(points, axis=0)  # much faster than percentiles
    first = int(_STRAYS * len(points))
    (x0, y0, z0), (x1, y1, z1) = spread[[first, -1 - first]].round(3).tolist()
    return Thing(
        number=number,
        label=detection.label,
        score=round(float(detection.score), 4),
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        views=((*observation.robot.xy, round(float(detection.score), 4)),),
        pixels=float(detection.box.area),
        first_search=search,
        last_search=search,
    )


def _points(
    detection: Detection, observation: Observation, camera: CameraConfig
) -> Float64[np.ndarray, "n 3"]:
    """Points of a detection, ``map`` frame, metres; without a mask those as far as its middle."""
    height, width = observation.depth.shape
    box = detection.box.clipped(width, height)
    x_min, y_min, x_max, y_max = box.pixels()
    stride = min(max(int(math.sqrt(box.area / _MOST_POINTS)), 1), _LARGEST_STRIDE)
    window = (slice(y_min, y_max, stride), slice(x_min, x_max, stride))
    depth = observation.depth[window]
    good = is_measured(depth, camera.min_depth_m, camera.max_depth_m)
    if detection.mask is not None:
        good &= detection.mask[window]
    elif good.any():
        middle = _middle_depth(box, observation, camera)
        good &= np.abs(depth - middle) <= _SAME_DEPTH_M
    rows, columns = np.nonzero(good)
    return observation.points_at(y_min + rows * stride, x_min + columns * stride)


def _middle_depth(box: Box, observation: Observation, camera: CameraConfig) -> float:
    """Median depth in the middle half of a box, metres; NaN where nothing is measured."""
    dx, dy = (box.x_max - box.x_min) / 4.0, (box.y_max - box.y_min) / 4.0
    rows = slice(round(box.y_min + dy), round(box.y_max - dy) + 1)
    columns = slice(round(box.x_min + dx), round(box.x_max - dx) + 1)
    depths = observation.depth[rows, columns]
    depths = depths[is_measured(depths, camera.min_depth_m, camera.max_depth_m)]
    return float(np.median(depths)) if depths.size else math.nan


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
