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
from hypernav.mapping.memory.target import GoalEvidence
from hypernav.mapping.top_down_map import TopDownMap

_ANOTHER_M = 1.0
"""Least height between two floors, metres; less is a step, a ramp or odometry's drift."""
_SAME_M = 0.5
"""Greatest difference in height, metres, at which the robot is on a floor that it knows."""
_LEVEL_M = 0.1
_WALKED_M = 0.75
"""Distance at one height, metres, that tells a floor from stairs: treads are shorter."""


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
    """

    evidence: GoalEvidence = field(default_factory=GoalEvidence)
    visits: list[tuple[float, float]] = field(default_factory=list)
    looked: Looked | None = None
    notes: dict[str, Any] = field(default_factory=dict)

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
    """

    def __init__(self, mapping: MappingConfig, embodiment: Embodiment) -> None:
        """Begin on a floor of which nothing is known.

        Args:
            mapping: Cells, evidence and height band of the maps.
            embodiment: The robot; the height of its camera tells that of the floor.
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
        """Keep floors, maps and things seen; forget what the search for another goal learned."""
        for floor in self.floors:
            floor.search = SearchMemory()

    def copy(self) -> "Memory":
        """A copy that shares nothing that changes."""
        return copy.deepcopy(self)

    def follow(self, observation: Observation) -> Floor:
        """Note the robot's height, in every step; return the floor that the robot is on now."""
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
        """The number of the floor at a height, metres, which is added if none is near it."""
        away_m = [abs(floor.z - z) for floor in self.floors]
        nearest = away_m.index(min(away_m))
        if away_m[nearest] <= _SAME_M:
            return nearest
        self.floors.append(self._new_floor(z))
        return len(self.floors) - 1

    def _new_floor(self, z: float) -> Floor:
        return Floor(z, TopDownMap(self._mapping, self._embodiment))
