"""One map for each floor of a building that the robot comes to.

A map is a plane: its floor is ``z = 0``. On stairs the robot keeps to the map that it has, in which
they are obstacles. When it has walked a little at one height again, and that is far above or below
the floor of the map, it has come to another floor: it begins a new map there, or takes up the one
that it drew when it was there before.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.mapping.top_down_map import TopDownMap

_ANOTHER_M = 1.0
"""Least height between two floors; less is a step, a ramp or the drift of odometry."""
_SAME_M = 0.5
"""Greatest difference in height at which the robot is back on a floor that it knows."""
_LEVEL_M = 0.1
_WALKED_M = 0.75
"""Distance at one height that tells a floor from stairs, whose treads are shorter."""


@dataclass(frozen=True, eq=False)
class Floor:
    """One floor as the robot knows it.

    Attributes:
        z: Its height in the ``map`` frame, metres.
        map: What the robot has drawn of it.
        trajectory: Positions of the robot on it so far, metres.
    """

    z: float
    map: TopDownMap
    trajectory: list[tuple[float, float]] = field(default_factory=list)

    def seen_from(self, observation: Observation) -> Observation:
        """The observation with heights counted from this floor."""
        if self.z == 0.0:
            return observation
        pose = observation.camera_to_map
        lowered = Transform(pose.rotation, pose.translation - np.array([0.0, 0.0, self.z]))
        return replace(observation, camera_to_map=lowered)


class Floors:
    """The floors that the robot has been on in one search.

    Attributes:
        current: The floor whose map is in use.
    """

    def __init__(self, new_map: Callable[[], TopDownMap], embodiment: Embodiment) -> None:
        """Begin on the floor of the start, whose height is 0.

        Args:
            new_map: Function that makes an empty map.
            embodiment: Robot, whose camera tells its height.
        """
        self._new_map = new_map
        self._camera_m = embodiment.camera.height_m
        self.current = Floor(0.0, new_map())
        self._known = [self.current]
        self._level_z = 0.0
        self._walked_m = 0.0
        self._position: tuple[float, float] | None = None

    def follow(self, observation: Observation) -> Floor:
        """The floor that the robot is on now; call it with every observation."""
        z = float(observation.camera_to_map.translation[2]) - self._camera_m
        here = observation.robot.xy
        moved_m = 0.0 if self._position is None else math.dist(self._position, here)
        self._position = here
        if abs(z - self._level_z) > _LEVEL_M:
            self._level_z, self._walked_m = z, 0.0
        else:
            self._walked_m += moved_m
        is_another = abs(self._level_z - self.current.z) > _ANOTHER_M
        if is_another and self._walked_m >= _WALKED_M:
            self.current = self._floor_at(self._level_z)
        return self.current

    def _floor_at(self, z: float) -> Floor:
        nearest = min(self._known, key=lambda floor: abs(floor.z - z))
        if abs(nearest.z - z) > _SAME_M:
            nearest = Floor(z, self._new_map())
            self._known.append(nearest)
        return nearest
