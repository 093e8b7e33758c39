"""The turn that shows most unseen floor from where the robot stands."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.memory.floor import Looked
from hypernav.mapping.sight_lines import unseen_by_bearing

_RAYS = 72
_SAME_SPOT_M = 0.1


class Gaze:
    """Chooses turns by the unseen floor that they would show. It has no state of its own.

    Floor that is still unknown in a direction in which the robot has looked is hidden from there.
    """

    def __init__(self, embodiment: Embodiment, least_m2: float) -> None:
        """Create it.

        Args:
            embodiment: Camera, and angle of a turn.
            least_m2: Unseen floor that a look must be able to show, square metres.
        """
        camera = embodiment.camera
        self._half_view = math.radians(camera.hfov_deg) / 2.0
        below = math.radians(camera.pitch_deg) + math.atan2(
            camera.height / 2.0, camera.intrinsics.fy
        )
        self._nearest_m = camera.height_m / math.tan(below) if below > 0.0 else camera.max_depth_m
        self._farthest_m = camera.max_depth_m
        self._turn = math.radians(embodiment.motion.turn_angle_deg)
        self._turns_of_a_circle = embodiment.motion.turns_of_a_circle
        self._least_m2 = least_m2
        self._bearings = np.arange(_RAYS) * (2.0 * math.pi / _RAYS)

    def after_image(self, looked: Looked | None, robot: Pose2) -> Looked:
        """Where the robot has looked from its position, its present image included."""
        if looked is None or robot.distance_to(*looked.spot) > _SAME_SPOT_M:
            looked = Looked(robot.xy, np.zeros(_RAYS, dtype=bool))
        return Looked(looked.spot, looked.bearings | self._in_view(robot.yaw))

    def worthwhile_turn(
        self, grid: OccupancyGrid, robot: Pose2, looked: Looked | None
    ) -> Action | None:
        """The first turn to the heading that shows most per turn; None if none shows enough.

        Args:
            grid: The map.
            robot: Pose of the robot.
            looked: Where it has looked from its position; None if nowhere yet.
        """
        unseen = unseen_by_bearing(
            grid,
            robot.xy,
            self._bearings,
            nearest_m=self._nearest_m,
            farthest_m=self._farthest_m,
        )
        if looked is not None:
            unseen[looked.bearings] = 0.0
        best, most = None, 0.0
        for turns in range(1, self._turns_of_a_circle // 2 + 1):
            for action, sign in ((Action.TURN_LEFT, 1.0), (Action.TURN_RIGHT, -1.0)):
                shown = float(unseen[self._in_view(robot.yaw + sign * turns * self._turn)].sum())
                if shown >= self._least_m2 and shown / turns > most:
                    best, most = action, shown / turns
        return best

    def _in_view(self, yaw: float) -> Bool[np.ndarray, " rays"]:
        """The directions that an image at this heading shows."""
        away: Float64[np.ndarray, " rays"] = np.mod(self._bearings - yaw + math.pi, 2 * math.pi)
        return np.abs(away - math.pi) <= self._half_view
