"""Things that a robot remembers of a floor, and what an image says about them.

Detections of one label that overlap on the floor plan are one thing, unless a wall is between. An
image that should show a thing and doesn't is a miss, and misses tell the more, the more reliably
the thing was seen before.
"""

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import cv2
import numpy as np
from jaxtyping import Bool, Int32

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid, has_cell
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import canonical
from hypernav.core.observation import Observation
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.goal_area import points_under_mask
from hypernav.search.memory.goal_words import chances_by_name
from hypernav.search.memory.image_kernels import are_near
from hypernav.search.memory.thing import (
    SAME_SIDE,
    Thing,
    fit,
    holds,
    joined,
    overlap,
    stands_in_room,
)
from hypernav.search.memory.visibility import SAME_DEPTH_M, SHOWN_M, are_visible

_BESIDE_M = 0.6
"""Distance beside two things, metres, within which a wall between them must have no end."""

_MOST_POINTS = 250
"""Number of pixels of a detection's box that are read, about."""
_LARGEST_STRIDE = 24
_LEAST_POINTS = 3
_STRAYS = 0.05
"""Share of a detection's points at each end of each axis that don't count to its extent."""

MOST_THINGS = 500
"""Number of things that a floor remembers; the least certain are forgotten first."""
_LOW_SHARE = 0.25
_LEAST_PX = 20.0
"""Size in the image, pixels, below which it says nothing that a thing was not detected."""
_WHOLLY, _ITS_KIND = 1.0, 0.5
"""How well a thing's label may fit a goal; see `Thing.fits`."""
_LARGER = 4.0
"""Times that a thing must be larger in an image than in all key images for one more of it."""


def is_wall_between(one: Thing, other: Thing, floor_map: TopDownMap) -> bool:
    """Whether a known wall parts all lines of sight to one thing from those to another.

    Around what stands free, however tall it is, the map shows a path from one line of sight to the
    other; so it does where the wall is not known to go on beside the things.

    Args:
        one: A thing.
        other: A thing in the same place, or right beside it.
        floor_map: Map of their floor.
    """
    if _is_seen_from_one_side(one, other):
        return False
    corners = np.array([(*thing.low[:2], *thing.high[:2]) for thing in (one, other)])
    low, high = corners[:, :2].min(axis=0), corners[:, 2:].max(axis=0)
    reach_m = float((high - low).max()) / 2.0 + _BESIDE_M
    middle = (low + high) / 2.0
    around = np.array([middle - reach_m, middle + reach_m])
    grid = floor_map.eye_level(around)
    (bottom, left), (top, right) = np.maximum(grid.cells_of(around), 0).tolist()
    is_open = grid.cells[bottom : top + 1, left : right + 1] != Cell.OCCUPIED
    parts = cv2.connectedComponents(is_open.view(np.uint8), connectivity=4)[1]
    sides = [_parts_in_sight(thing, grid, parts, (bottom, left)) for thing in (one, other)]
    return all(sides) and sides[0].isdisjoint(sides[1])


def _is_seen_from_one_side(one: Thing, other: Thing) -> bool:
    """As `Thing.was_seen_from`, much faster for so few views."""
    x, y, _ = one.position
    return any(
        (a - x) * (c - x) + (b - y) * (d - y)
        >= SAME_SIDE * math.hypot(a - x, b - y) * math.hypot(c - x, d - y)
        for a, b, _ in one.views
        for c, d, _ in other.views
    )


def _parts_in_sight(
    thing: Thing,
    grid: OccupancyGrid,
    parts: Int32[np.ndarray, "rows columns"],
    corner: tuple[int, int],
) -> set[int]:
    """The parts of a map that the lines of sight to a thing lie in, before they end at an obstacle.

    Args:
        thing: The thing.
        grid: The map.
        parts: Number of the part of each cell around the thing; 0 where an obstacle is.
        corner: Row and column of the first of these cells in the map.
    """
    middle, found = np.array(thing.position[:2]), set[int]()
    for view in np.array(thing.views)[:, :2]:
        length_m = math.dist(view, middle)
        samples = math.ceil(2.0 * length_m / grid.resolution_m) + 1
        line = view + np.linspace(0.0, 1.0, samples)[:, None] * (middle - view)
        cells = grid.cells_of(line) - corner
        along = parts[tuple(cells[has_cell(parts.shape, *cells.T)].T)]
        is_end = along == 0
        found |= set(along[: int(is_end.argmax()) if is_end.any() else None].tolist())
    return found


def seen_thing(
    detection: Detection, observation: Observation, camera: CameraConfig, search: int
) -> Thing | None:
    """A detection as a thing, without a number yet; None with too few pixels of depth.

    Args:
        detection: The detection.
        observation: The image, with heights counted from the floor.
        camera: Camera, whose range of depth counts.
        search: Number of the present search.
    """
    height, width = observation.depth.shape
    box = detection.box.clipped(width, height)
    points = points_under_mask(
        _mask(box, observation, camera) if detection.mask is None else detection.mask,
        observation,
        min_depth_m=camera.min_depth_m,
        max_depth_m=camera.max_depth_m,
        stride=min(max(int(math.sqrt(box.area / _MOST_POINTS)), 1), _LARGEST_STRIDE),
        window=box.pixels(),
    )
    if len(points) < _LEAST_POINTS:
        return None
    spread = np.sort(points, axis=0)  # much faster than percentiles
    first = int(_STRAYS * len(points))
    (x0, y0, z0), (x1, y1, z1) = spread[[first, -1 - first]].round(3).tolist()
    score = round(float(detection.score), 4)
    return Thing(
        number=-1,
        label=detection.label,
        score=score,
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        views=((*observation.robot.xy, score),),
        pixels=float(detection.box.area),
        first_search=search,
        last_search=search,
    )


def _mask(
    box: Box, observation: Observation, camera: CameraConfig
) -> Bool[np.ndarray, "height width"]:
    """The pixels of a box that are about as far away as its middle, where it has no mask."""
    mask = np.zeros(observation.depth.shape, dtype=bool)
    x_min, y_min, x_max, y_max = box.pixels()
    window = (slice(y_min, y_max), slice(x_min, x_max))
    middle_m = _middle_depth(box, observation, camera)
    mask[window] = np.abs(observation.depth[window] - middle_m) <= SAME_DEPTH_M
    return mask


def _middle_depth(box: Box, observation: Observation, camera: CameraConfig) -> float:
    """Median depth in the middle half of a box, metres; NaN where nothing is measured."""
    dx, dy = (box.x_max - box.x_min) / 4.0, (box.y_max - box.y_min) / 4.0
    rows = slice(round(box.y_min + dy), round(box.y_max - dy) + 1)
    columns = slice(round(box.x_min + dx), round(box.x_max - dx) + 1)
    depths = observation.depth[rows, columns]
    depths = depths[is_measured(depths, camera.min_depth_m, camera.max_depth_m)]
    return float(np.median(depths)) if depths.size else math.nan


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

    @cached_property
    def labels(self) -> frozenset[str]:
        """The labels of the things."""
        return frozenset(one.label for one in self.known)

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

    def known_before(self, search: int) -> "Things":
        """The things that earlier searches than this one saw."""
        known = tuple(one for one in self.known if one.first_search < search)
        return Things(known, self.count)

    def find(self, number: int) -> Thing | None:
        """The thing of a number; None if it was forgotten."""
        return next((one for one in self.known if one.number == number), None)

    def fitting(self, goal: Goal, besides: Collection[int] = ()) -> list[tuple[Thing, float]]:
        """The things that may be a goal and are not gone, each with the chance that it is.

        Their names tell which of them are; see `chances_by_name`.

        Args:
            goal: The goal.
            besides: Numbers of things that are none, since the search has gone to them.
        """
        there = [
            one
            for one in self._that_fit(goal, _WHOLLY, _ITS_KIND)
            if not one.is_gone and one.number not in besides
        ]
        return chances_by_name(there, goal)

    def others_in(self, observation: Observation, goal: Goal) -> set[int]:
        """Numbers of the things of a goal's kind that the latest image shows not to be the goal.

        What lies where something was detected may be that, by another name.

        Args:
            observation: The latest image, in which the goal alone was looked for, with heights
                counted from the floor.
            goal: Goal, of which more than its kind was said.
        """
        shown = [one for one in self.known if one.number in self.shown]
        alike = [
            one
            for one in self._that_fit(goal, _ITS_KIND)
            if not any(overlap(one, other) for other in shown)
        ]
        return {one.number for one in _that_should_show(alike, observation)}

    def _that_fit(self, goal: Goal, *fits: float) -> list[Thing]:
        """The things that fit a goal so well; there are far fewer labels than things."""
        fitting = _fitting(self.labels, goal, fits)
        return [one for one in self.known if one.label in fitting] if fitting else []

    def after_image(
        self,
        observation: Observation,
        detections: Iterable[Detection],
        camera: CameraConfig,
        *,
        search: int,
        only: Goal | None = None,
        tells_floors: bool = False,
        ground_m: float = 0.0,
        floor_map: TopDownMap | None = None,
    ) -> "Things":
        """The things after one more image.

        Args:
            observation: The image, with heights counted from the floor.
            detections: All that was detected in it.
            camera: Camera, whose range of depth counts.
            search: Number of the present search.
            only: Goal, if the detector looks for nothing else; then only things that fit all of it
                can be missed.
            tells_floors: Whether what is seen below or above the room of the floor is none of its
                things.
            ground_m: Height of the robot's ground above the floor, metres.
            floor_map: Map of the floor, whose walls part what was seen on both sides of them; None
                where none is known.
        """
        seen = [seen_thing(one, observation, camera, search) for one in detections]
        here = [
            one
            for one in seen
            if one is not None and not (tells_floors and not stands_in_room(one, ground_m))
        ]
        after = self._with_seen(here, floor_map)
        return after._with_missed(observation, only)._at_most(MOST_THINGS)

    def _with_seen(self, seen: list[Thing], floor_map: TopDownMap | None) -> "Things":
        """The things after an image has shown some, each of which may be known."""
        if not seen:
            return replace(self, shown={}) if self.shown else self
        known = {one.number: one for one in self.known}
        named = defaultdict[str, dict[int, Thing]](dict)
        for one in self.known:
            named[canonical(one.label)][one.number] = one
        count, shown = self.count, dict[int, float]()
        for new in seen:
            alike = named[canonical(new.label)]
            same = [one for one in alike.values() if _is_same(one, new, floor_map)]
            for one in same:
                del known[one.number], alike[one.number]
            one = joined(same, new) if same else replace(new, number=count)
            known[one.number] = alike[one.number] = one
            shown[one.number] = max(new.pixels, shown.get(one.number, 0.0))
            count += not same
        return Things(tuple(sorted(known.values(), key=lambda one: one.number)), count, shown)

    def _with_missed(self, observation: Observation, only: Goal | None) -> "Things":
        """The things after an image, with those missed that it should show and doesn't."""
        looked_for = self.known if only is None else self._that_fit(only, _WHOLLY)
        unseen = [one for one in looked_for if one.number not in self.shown]
        missed = {one.number for one in _that_should_show(unseen, observation)}
        if not missed:
            return self
        return replace(
            self,
            known=tuple(
                replace(one, missed=one.missed + 1) if one.number in missed else one
                for one in self.known
            ),
        )

    def _at_most(self, most: int) -> "Things":
        """The things without the least certain ones, if there are more."""
        if len(self.known) <= most:
            return self
        surest = sorted(self.known, key=lambda one: (-one.chance, -one.last_search))[:most]
        return replace(self, known=tuple(sorted(surest, key=lambda one: one.number)))

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


def _is_same(known: Thing, new: Thing, floor_map: TopDownMap | None) -> bool:
    """Whether a sighting is of a thing that is known by the same name."""
    if not overlap(known, new):
        return False
    return floor_map is None or not is_wall_between(known, new, floor_map)


@lru_cache(maxsize=256)
def _fitting(labels: frozenset[str], goal: Goal, fits: tuple[float, ...]) -> frozenset[str]:
    """The labels that fit a goal so well."""
    return frozenset(label for label in labels if fit(label, goal) in fits)


def _that_should_show(things: Iterable[Thing], observation: Observation) -> list[Thing]:
    """The things that an image should show, near and large enough to be detected.

    What was seen from other sides alone may be hidden from this one, by what is on no map.
    """
    things, robot = list(things), observation.robot
    boxes = np.array([one.low + one.high for one in things]).reshape(-1, 6)
    where = (robot.x, robot.y, robot.yaw)
    is_near = are_near(boxes, where, observation.camera.lens[0], SHOWN_M, _LEAST_PX)
    near = [one for one, is_so in zip(things, is_near.tolist(), strict=True) if is_so]
    if not near:
        return []
    # Low down the floor behind it is near enough to have depth, if the thing is not there.
    heights = [one.low[2] + _LOW_SHARE * one.size[2] for one in near]
    visible = are_visible(np.array([one.outline for one in near]), np.array(heights), observation)
    here = np.array([robot.xy])
    return [
        one
        for one, is_visible in zip(near, visible.tolist(), strict=True)
        if is_visible and one.was_seen_from(here)[0]
    ]
