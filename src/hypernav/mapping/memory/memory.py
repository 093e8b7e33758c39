"""What a robot knows of a building, floor by floor.

A map is a plane: its floor is ``z = 0``. While the robot is on stairs, it counts as on the floor
that it came from, on whose map they are obstacles. Once it has walked `_WALKED_M` at one height far
above or below that floor, it is on another one: one that it knows at that height, or a new one.
"""

import copy
import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Bool

from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.sightings import Sightings
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.key_images import KeyImages
from hypernav.mapping.memory.looked_over import LookedOver
from hypernav.mapping.memory.target import GoalEvidence
from hypernav.mapping.memory.things import Things
from hypernav.mapping.top_down_map import TopDownMap

_ANOTHER_M = 1.0
"""Least height between two floors, metres; less is a step, a ramp or odometry's drift."""
_SAME_M = 0.5
"""Greatest difference in height, metres, at which the robot is on a floor that it knows."""
_LEVEL_M = 0.1
_WALKED_M = 0.75
"""Distance at one height, metres, that tells a floor from stairs: treads are shorter."""
_MOST_POSITIONS = 5000
"""Number of positions of earlier searches that a floor's trajectory keeps."""


@dataclass(frozen=True, eq=False)
class Looked:
    """Where the robot has looked from its present position.

    Attributes:
        spot: The position ``(x, y)``, ``map`` frame, metres.
        bearings: Whether it has looked in each direction, counter-clockwise from the x axis.
    """

    spot: tuple[float, float]
    bearings: Bool[np.ndarray, " rays"]


@dataclass(eq=False)
class SearchMemory:
    """What the search for one goal has learned on one floor; each goal begins a new one.

    Attributes:
        evidence: Candidates for the goal, and what speaks for and against them.
        visits: Destinations ``(x, y)`` that were reached or given up, the oldest first, metres.
        looked: Where the robot has looked from its position; None before the first look.
        notes: What explorers have noted, by keys of their own: plain values that can be copied.
        number: Number of the search in this memory.
        lasts: Whether later searches are to know what it has seen.
        remembered: Numbers of the things that were known before it began.
        gone_to: Numbers of those that it has gone to, or given up.
        looked_over: What it has looked at of the floor; None if the floor was not known before.
        looks_again: Whether it explores what it has not looked at itself, known or not.
    """

    evidence: GoalEvidence = field(default_factory=GoalEvidence)
    visits: list[tuple[float, float]] = field(default_factory=list)
    looked: Looked | None = None
    notes: dict[str, Any] = field(default_factory=dict)
    number: int = 0
    lasts: bool = False
    remembered: frozenset[int] = frozenset()
    gone_to: set[int] = field(default_factory=set)
    looked_over: LookedOver | None = None
    looks_again: bool = False

    def remembered_of(self, things: Things) -> Things:
        """The things that were known before the search began."""
        known = tuple(one for one in things.known if one.number in self.remembered)
        return Things(known, things.count)

    def forget_exploration(self) -> None:
        """Forget visits and notes: what counts as visited may hardly have been seen."""
        self.visits.clear()
        self.notes.clear()


@dataclass(eq=False)
class Floor:
    """One floor as the robot knows it.

    Attributes:
        z: Its height in the ``map`` frame, metres.
        map: Map of it.
        trajectory: Positions ``(x, y)`` of the robot on it, one per frame, metres.
        sightings: Things that were seen on it, other than the goal, for explorers' questions.
        things: All things that were seen on it, for later searches.
        search: What the present search has learned on it.
    """

    z: float
    map: TopDownMap
    trajectory: list[tuple[float, float]] = field(default_factory=list)
    sightings: Sightings = field(default_factory=Sightings)
    things: Things = field(default_factory=Things)
    search: SearchMemory = field(default_factory=SearchMemory)

    def integrate(self, observation: Observation) -> None:
        """Add a frame, with heights counted from this floor, to map and trajectory."""
        self.trajectory.append(observation.robot.xy)
        self.map.integrate(observation)
        if self.search.looked_over is not None:
            self.search.looked_over.add(observation, self.map.grid)

    def begin_search(self, number: int, *, lasts: bool) -> None:
        """Forget what the search for another goal learned; `SearchMemory` has the arguments."""
        self.search = SearchMemory(
            number=number,
            lasts=lasts,
            remembered=frozenset(one.number for one in self.things.known),
            looked_over=LookedOver.nothing(self.map.grid) if self.trajectory else None,
        )
        del self.trajectory[:-_MOST_POSITIONS]

    def seen_from(self, observation: Observation) -> Observation:
        """The same observation with heights counted from this floor: its camera is lowered by z."""
        if self.z == 0.0:
            return observation
        pose = observation.camera_to_map
        lowered = Transform(pose.rotation, pose.translation - np.array([0.0, 0.0, self.z]))
        return replace(observation, camera_to_map=lowered)


class Memory:
    """All that a robot knows of a building: given to an agent, changed by it, and kept after it.

    It holds values and arrays, and no component, so that it can be copied.

    Attributes:
        floors: Floors in the order in which the robot came to know them; the first is the floor of
            the start, whose height is 0.
        number: Number of the floor that the robot is on: its index in `floors`.
        mapping: Cells, evidence and height band of the maps.
        embodiment: The robot; the height of its camera tells that of the floor.
        searches: Number of searches that have begun with it.
        images: Key images; None if none are kept.
    """

    def __init__(
        self,
        mapping: MappingConfig,
        embodiment: Embodiment,
        *,
        images: KeyImages | None = None,
    ) -> None:
        """Begin on a floor of which nothing is known.

        Args:
            mapping: Cells, evidence and height band of the maps.
            embodiment: The robot; the height of its camera tells that of the floor.
            images: Where to keep key images; None keeps none.
        """
        self.mapping: MappingConfig = mapping
        self.embodiment: Embodiment = embodiment
        self.images: KeyImages | None = images
        self.searches: int = 0
        self.floors: list[Floor] = []
        self.floors.append(self._new_floor(0.0))
        self.number: int = 0
        self._level_z = 0.0
        self._walked_m = 0.0
        self._position: tuple[float, float] | None = None

    @property
    def floor(self) -> Floor:
        """The floor that the robot is on."""
        return self.floors[self.number]

    @property
    def search(self) -> SearchMemory:
        """What the present search has learned on this floor."""
        return self.floor.search

    def begin_search(self, *, lasts: bool = False) -> None:
        """Keep floors, maps and things seen; forget what the search for another goal learned.

        Args:
            lasts: Whether later searches are to know what this one sees: its things and key images.
        """
        self.searches += 1
        for floor in self.floors:
            floor.begin_search(self.searches, lasts=lasts)

    def copy(self) -> "Memory":
        """A copy that shares nothing that changes."""
        return copy.deepcopy(self)

    def follow(self, observation: Observation) -> Floor:
        """Note the robot's height, in every step; return the floor that the robot is on now."""
        z = float(observation.camera_to_map.translation[2]) - self.embodiment.camera.height_m
        here = observation.robot.xy
        moved_m = 0.0 if self._position is None else math.dist(self._position, here)
        self._position = here
        if abs(z - self._level_z) > _LEVEL_M:
            self._level_z, self._walked_m = z, 0.0
        else:
            self._walked_m += moved_m
        is_another = abs(self._level_z - self.floor.z) > _ANOTHER_M
        if is_another and self._walked_m >= _WALKED_M:
            self.number = self._number_at(self._level_z)
        return self.floor

    def begin_at(self, observation: Observation) -> Floor:
        """The floor that the first frame is taken on; a memory from disk begins there."""
        self._level_z = float(observation.camera_to_map.translation[2])
        self._level_z -= self.embodiment.camera.height_m
        self._walked_m, self._position = 0.0, None
        self.number = self._number_at(self._level_z)
        return self.floor

    def keep_image(self, observation: Observation) -> None:
        """Keep a frame as key image if it tells enough, and if key images are kept.

        Args:
            observation: The latest frame, with heights counted from the floor.
        """
        floor = self.floor
        if self.images is None:
            return
        image = self.images.take(
            observation,
            self.embodiment.camera,
            floor=self.number,
            search=self.searches,
            shows_new_thing=floor.things.wants_image,
        )
        if image is not None:
            floor.things = floor.things.with_image(image.number)
            self.forget_images(self.images.most_bytes)

    def forget_images(self, most_bytes: int) -> None:
        """Forget the key images that tell least, until all take at most so many bytes."""
        if self.images is None:
            return
        shown = [one.image for floor in self.floors for one in floor.things.known]
        forgotten = self.images.shrink(most_bytes, shown)
        for floor in self.floors if forgotten else ():
            floor.things = floor.things.without_images(forgotten)

    def _number_at(self, z: float) -> int:
        """The number of the floor at a height, metres, which is added if none is near it."""
        away_m = [abs(floor.z - z) for floor in self.floors]
        nearest = away_m.index(min(away_m))
        if away_m[nearest] <= _SAME_M:
            return nearest
        self.floors.append(self._new_floor(z))
        return len(self.floors) - 1

    def _new_floor(self, z: float) -> Floor:
        map_ = TopDownMap(self.mapping, self.embodiment)
        lasts = bool(self.floors) and self.search.lasts
        return Floor(z, map_, search=SearchMemory(number=self.searches, lasts=lasts))
