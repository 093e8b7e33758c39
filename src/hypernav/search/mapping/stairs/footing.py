"""What the robot stands on: its floor, another level of it, or stairs.

While the robot is on stairs, it counts as on the floor that it came from, on whose map they are
obstacles. Once it has walked `_WALKED_M` at one height far above or below that floor, it is on
another one.

At a height nearer to it, on a split level or where odometry drifts, it is on the same floor. From
then on all heights are counted from there, so that the map shows what stands in the way of a robot
at this height: its own ground is free, and steps that lead lower are no obstacles. What was drawn
from another height stays until it is seen from here.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.elevation_kernels import HEIGHT_ERROR_M
from hypernav.search.mapping.elevation_map import Ground

ANOTHER_M = 1.0
"""Least height between two floors, metres; less is a step, a ramp or odometry's drift."""
_LEVEL_M = 0.1
_OFF_M = 0.12
"""Difference in height, metres, from which the robot is off the ground that it walked on."""
_LEAST_FLOOR_M2 = 6.0
"""Ground seen at one height in the robot's reach, square metres, that hardly any landing has: a
half landing between flights of 1.5 m has 5."""
_STOREY_M = 2.2
"""Height, metres, above or below the last floor at which hardly any landing lies."""
_LEAST_LANDING_M2 = 1.0
"""Ground that suffices there for a floor, square metres: the head of stairs may be small."""
_WALKED_M = 0.75
"""Distance at one height, metres, that tells a floor from stairs: treads are shorter."""


@dataclass(frozen=True)
class Footing:
    """Where the robot stands, by its height and by how far it has walked at one height.

    Attributes:
        z: Height of the robot, ``map`` frame, metres.
        floor_z: Height of the floor that it counts as on, metres.
        ground_z: Height of the ground that it walked on last, on this floor, metres.
        began: Pose at which it came to its present height.
        level_z: That height, metres.
        walked_m: Distance that it has walked at it since, metres.
        rose_m: By how much the latest step changed its height, metres.
    """

    z: float
    floor_z: float
    ground_z: float
    began: Pose2
    level_z: float
    walked_m: float = 0.0
    rose_m: float = 0.0

    @staticmethod
    def on_level_ground(robot: Pose2, z: float, floor_z: float) -> "Footing":
        """The footing of a robot that takes what it stands on for its ground.

        Args:
            robot: Its pose.
            z: Its height, metres.
            floor_z: Height of its floor, metres.
        """
        return Footing(z, floor_z, z if abs(z - floor_z) > _OFF_M else floor_z, robot, z)

    @staticmethod
    def on_stairs(robot: Pose2, z: float, floor_z: float) -> "Footing":
        """The footing of a robot that is on stairs from its floor; see `on_level_ground`."""
        return Footing(z, floor_z, floor_z, robot, z)

    def after(self, robot: Pose2, z: float, moved_m: float) -> "Footing":
        """The footing after a step, which may have led to another floor; see `on_floor`.

        Args:
            robot: The robot's pose after it.
            z: The robot's height after it, metres.
            moved_m: Its length, metres.
        """
        now = replace(self, z=z, rose_m=z - self.z, walked_m=self.walked_m + moved_m)
        if abs(z - self.level_z) > _LEVEL_M:
            return replace(now, began=robot, level_z=z, walked_m=0.0)
        return now

    def on_floor(self, floor_z: float) -> "Footing":
        """The footing on a floor of this height, metres, on the ground that was walked on last."""
        now = replace(self, floor_z=floor_z)
        if not now.is_off_floor:
            return replace(now, ground_z=floor_z)
        if now._has_walked and abs(now.level_z - floor_z) <= ANOTHER_M:
            return replace(now, ground_z=now.level_z)
        return now

    def as_if_walked(self) -> "Footing":
        """The footing as if the robot had walked as far at its height as tells a floor."""
        return replace(self, level_z=self.z, walked_m=_WALKED_M)

    @property
    def is_off_ground(self) -> bool:
        """Whether the robot is off the ground that it walked on last."""
        return abs(self.z - self.ground_z) > _OFF_M

    @property
    def is_off_floor(self) -> bool:
        """Whether the robot is not at its floor's height: on stairs, landings, split levels."""
        return abs(self.z - self.floor_z) > _OFF_M

    @property
    def is_storey_away(self) -> bool:
        """Whether the robot is so far above or below its floor that hardly a landing lies there."""
        return abs(self.z - self.floor_z) >= _STOREY_M

    @property
    def is_on_slope(self) -> bool:
        """Whether the latest step changed the robot's height, as treads and ramps do."""
        return self.walked_m == 0.0

    @property
    def may_be_another_floor(self) -> bool:
        """Whether the robot has walked at a height that is not its floor's."""
        return self._has_walked and abs(self.level_z - self.floor_z) > ANOTHER_M

    @property
    def _has_walked(self) -> bool:
        return self.walked_m >= _WALKED_M

    def has_room(self, ground: Ground) -> bool:
        """Whether there is enough ground at the robot's height for a floor.

        Args:
            ground: Ground around the robot.
        """
        rises_far = abs(self.level_z - self.floor_z) >= _STOREY_M
        least_m2 = _LEAST_LANDING_M2 if rises_far else _LEAST_FLOOR_M2
        return ground.area_m2(ground.seen & self._level(ground, self.level_z)) >= least_m2

    def way_on(
        self, ground: Ground, z: float, least_m: float, looked: Sequence[tuple[float, float]]
    ) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the level ground so far from where the robot came to it, or has looked around.

        Args:
            ground: Ground around the robot.
            z: Height of the level ground, as it looks, metres.
            least_m: The distance, metres.
            looked: Where the robot has looked around ``(x, y)``, metres.
        """
        on = self._level(ground, z)
        for position in (self.began.xy, *looked):
            on &= ground.distances_m(position) >= least_m
        return on

    def _level(self, ground: Ground, z: float) -> Bool[np.ndarray, "rows columns"]:
        """Mask of the ground about as high as the robot and a height, and between them."""
        low, high = sorted((z, self.z))
        return ground.between(low - HEIGHT_ERROR_M, high + HEIGHT_ERROR_M)
