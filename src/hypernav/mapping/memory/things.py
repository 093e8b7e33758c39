"""Things that a robot remembers of a floor, and what an image says about them.

Detections of one label that overlap on the floor plan are one thing, unless a wall is between. An
image that should show a thing and doesn't is a miss, and misses tell the more, the more reliably
the thing was seen before.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Detection
from hypernav.core.goal import Goal
from hypernav.core.labels import canonical
from hypernav.core.observation import Observation
from hypernav.mapping.memory.image_kernels import are_near
from hypernav.mapping.memory.namesakes import chances_by_name
from hypernav.mapping.memory.seen_thing import seen_thing
from hypernav.mapping.memory.thing import (
    Thing,
    fit,
    holds,
    joined,
    overlap,
    stands_in_room,
)
from hypernav.mapping.memory.two_sides import is_wall_between
from hypernav.mapping.memory.visibility import are_visible
from hypernav.mapping.top_down.top_down_map import TopDownMap

MOST_THINGS = 500
"""Number of things that a floor remembers; the least certain are forgotten first."""
_LOW_SHARE = 0.25
_LEAST_PX = 20.0
"""Size in the image, pixels, below which it says nothing that a thing was not detected."""
_NEAR_M = 4.0
"""Distance beyond which no image can be expected to show a thing, metres."""
_WHOLLY, _ITS_KIND = 1.0, 0.5
"""How well a thing's label may fit a goal; see `Thing.fits`."""
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
    is_near = are_near(boxes, where, observation.camera.lens[0], _NEAR_M, _LEAST_PX)
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
