"""Checks what a robot senses against its commands, to find wrong units and signs."""

import math

import numpy as np

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import SensorError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.robot.client.robot import Sensed

_MOVED_M, _TURNED_RAD = 0.1, math.radians(5.0)
"""Smallest motion after which the images must be new."""
_JUMP_M = 1.0
"""Length by which a motion may exceed that of a step: a robot rolls on while it waits."""
_WRONG_SHARE = 0.6
"""Share of a turn that odometry must show in the wrong direction to have the wrong sign."""
_OTHER_TURN_RAD = math.radians(60.0)
"""Angle by which a turn may differ from the one that was ordered."""
_METRES_RANGES = 3.0
"""Multiple of the camera's range from which on a depth cannot be in metres."""
_MOST_BLOCKED = 40
"""Number of motions in a row that may fail."""


class PlausibleSensing:
    """Ends a search with an error that names the mistake, before the robot uses wrong numbers."""

    def __init__(self, embodiment: Embodiment) -> None:
        """Create it; nothing has been sensed yet.

        Args:
            embodiment: Camera, step and turn of the robot.
        """
        self._embodiment = embodiment
        self._last: Sensed | None = None
        self._blocked = 0

    def check(self, sensed: Sensed, action: Action | None, blocked: bool) -> None:
        """Look at what the robot senses now.

        Args:
            sensed: What it senses.
            action: Action that it was told before; None at the beginning.
            blocked: Whether that motion did not happen.

        Raises:
            SensorError: The data cannot be right.
        """
        self._check_images(sensed)
        if self._last is not None:
            self._check_motion(self._last, sensed, action, blocked=blocked)
        self._blocked = self._blocked + 1 if blocked else 0
        if self._blocked >= _MOST_BLOCKED:
            raise SensorError(
                f"{self._blocked} motions in a row did not happen, according to the robot or its "
                "odometry; does it move, and does its odometry show it?"
            )
        self._last = sensed

    def _check_images(self, sensed: Sensed) -> None:
        if sensed.rgb.dtype != np.uint8 or sensed.rgb.ndim != 3 or sensed.rgb.shape[2] != 3:
            raise SensorError(
                "Sensed.rgb: expected height × width × 3 of type uint8, got "
                f"{' × '.join(map(str, sensed.rgb.shape))} of type {sensed.rgb.dtype}"
            )
        if sensed.depth.ndim != 2 or not np.issubdtype(sensed.depth.dtype, np.floating):
            raise SensorError(
                "Sensed.depth: expected height × width of type float32, metres, got "
                f"{' × '.join(map(str, sensed.depth.shape))} of type {sensed.depth.dtype}"
            )
        if not (math.isfinite(sensed.stamp_s) and sensed.stamp_s >= 0.0):
            raise SensorError(f"Sensed.stamp_s: expected seconds from 0 on, got {sensed.stamp_s}")
        depth = sensed.depth[is_measured(sensed.depth)]
        limit_m = _METRES_RANGES * self._embodiment.camera.max_depth_m
        if depth.size > 0 and depth.min() > limit_m:
            raise SensorError(
                f"all depth is from {depth.min():g} to {depth.max():g}, and the camera measures "
                f"up to {self._embodiment.camera.max_depth_m:g} m; Sensed.depth is in metres"
            )

    def _check_motion(
        self, before: Sensed, now: Sensed, action: Action | None, *, blocked: bool
    ) -> None:
        motion = self._embodiment.motion
        moved_m = before.odometry.distance_to(*now.odometry.xy)
        turned = wrap_angle(now.odometry.yaw - before.odometry.yaw)
        if now.stamp_s == before.stamp_s and (moved_m > _MOVED_M or abs(turned) > _TURNED_RAD):
            raise SensorError(
                f"the robot moved {moved_m:.2f} m and turned {math.degrees(turned):.0f}°, but its "
                f"images are still those of {now.stamp_s:.3f} s; is the camera frozen?"
            )
        if moved_m > motion.forward_m + _JUMP_M:
            raise SensorError(
                f"odometry moved {moved_m:.2f} m in one step of {motion.forward_m:g} m; it may "
                "drift, but not jump: what localisation finds belongs in Sensed.odom_to_map"
            )
        turn = math.radians(motion.turn_angle_deg)
        ordered = {Action.TURN_LEFT: turn, Action.TURN_RIGHT: -turn}.get(action or Action.STOP)
        if ordered is None or blocked:
            return
        is_mirrored = turned * ordered < 0.0 and abs(turned) > _WRONG_SHARE * turn
        if is_mirrored or abs(wrap_angle(turned - ordered)) > _OTHER_TURN_RAD:
            raise SensorError(
                f"the robot was told to turn {math.degrees(ordered):+.0f}°, and its odometry "
                f"turned {math.degrees(turned):+.0f}°; yaw is in radians and grows to the left "
                "(REP 103)"
            )
