"""What a robot knows of a building, floor by floor.

A map is a plane: its floor is ``z = 0``. On stairs the robot keeps to the floor that it was on, on
whose map they are obstacles. When it has walked a little at one height again, and that is far above
or below its floor, it has come to another one: to one that it knows, or to a new one.
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
from hypernav.mapping.memory.target import GoalEvidence
from hypernav.mapping.top_down_map import TopDownMap

_ANOTHER_M = 1.0
"""Least height between two floors; less is a step, a ramp or the drift of odometry."""
_SAME_M = 0.5
"""Greatest difference in height at which the robot is back on a floor that it knows."""
_LEVEL_M = 0.1
_WALKED_M = 0.75
"""Distance at one height that tells a floor from stairs, whose treads are shorter."""


@dataclass(frozen=True, eq=False)
class Looked:
    """Where the robot has looked from its present position.

    Attributes:
        spot: The position ``(x, y)``, metres.
        bearings: Whether it has looked in each direction, around from that of the x axis.
    """

    spot: tuple[float, float]
    bearings: Bool[np.ndarray, " rays"]


@dataclass(eq=False)
class SearchMemory:
    """What the search for one goal has learned on one floor; another goal begins another.

    Attributes:
        evidence: What may be the goal, and what is not.
        visits: Destinations ``(x, y)`` that were reached or given up, the oldest first, metres.
        looked: Where the robot has looked from where it is.
        notes: What explorers have noted, by keys of their own: plain values that can be copied.
    """

    evidence: GoalEvidence = field(default_factory=GoalEvidence)
    visits: list[tuple[float, float]] = field(default_factory=list)
    looked: Looked | None = None
    notes: dict[str, Any] = field(default_factory=dict)

    def forget_exploration(self) -> None:
        """Explore anew over the same map: what counts as visited may hardly have been seen."""
        self.visits.clear()
        self.notes.clear()


@dataclass(eq=False)
class Floor:
    """One floor as the robot knows it.

    Attributes:
        z: Its height in the ``map`` frame, metres.
        map: What the robot has drawn of it.
        trajectory: Positions ``(x, y)`` of the robot on it so far, metres.
        sightings: Things that were seen on it, other than the goal.
        search: What the present search has learned on it.
    """

    z: float
    map: TopDownMap
    trajectory: list[tuple[float, float]] = field(default_factory=list)
    sightings: Sightings = field(default_factory=Sightings)
    search: SearchMemory = field(default_factory=SearchMemory)

    def integrate(self, observation: Observation) -> None:
        """Add a frame, with heights counted from this floor, to map and trajectory."""
        self.trajectory.append(observation.robot.xy)
        self.map.integrate(observation)

    def seen_from(self, observation: Observation) -> Observation:
        """The observation with heights counted from this floor."""
        if self.z == 0.0:
            return observation
        pose = observation.camera_to_map
        lowered = Transform(pose.rotation, pose.translation - np.array([0.0, 0.0, self.z]))
        return replace(observation, camera_to_map=lowered)


class Memory:
    """All that a robot knows of a building: given to an agent, and left behind by it.

    It holds values and arrays, and no component, so that it can be copied.

    Attributes:
        floors: Floors in the order in which the robot came to know them; the first is the floor of
            the start, whose height is 0.
        number: Index of the floor that the robot is on.
    """

    def __init__(self, mapping: MappingConfig, embodiment: Embodiment) -> None:
        """Begin on a floor of which nothing is known.

        Args:
            mapping: Cells, evidence and height band of the maps.
            embodiment: Robot, whose camera tells the height of the floor.
        """
        self._mapping = mapping
        self._embodiment = embodiment
        self.floors: list[Floor] = [self._new_floor(0.0)]
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

    def begin_search(self) -> None:
        """Keep floors, maps and things; what was learned in looking for another goal goes."""
        for floor in self.floors:
            floor.search = SearchMemory()

    def copy(self) -> "Memory":
        """A copy that shares nothing that changes."""
        return copy.deepcopy(self)

    def follow(self, observation: Observation) -> Floor:
        """The floor that the robot is on now; to be asked with every observation."""
        z = float(observation.camera_to_map.translation[2]) - self._embodiment.camera.height_m
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

    def _number_at(self, z: float) -> int:
        """The number of the floor at a height; a new one if none is near it."""
        away_m = [abs(floor.z - z) for floor in self.floors]
        nearest = away_m.index(min(away_m))
        if away_m[nearest] <= _SAME_M:
            return nearest
        self.floors.append(self._new_floor(z))
        return len(self.floors) - 1

    def _new_floor(self, z: float) -> Floor:
        return Floor(z, TopDownMap(self._mapping, self._embodiment))
