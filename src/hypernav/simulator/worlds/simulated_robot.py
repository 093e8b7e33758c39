"""The body of a simulated robot, with its true pose and its pose by odometry."""

import math

import numpy as np

from hypernav.core.embodiment import Action, MotionConfig
from hypernav.core.errors import StartError
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.world import Position, Walkable
from hypernav.simulator.worlds.config import NoiseConfig
from hypernav.simulator.worlds.noise import noisy_forward, noisy_turn, reported_motion
from hypernav.simulator.worlds.surface.walkable_surface import WalkableSurface

_ROUNDING_M = 1e-5


class SimulatedRobot:
    """A robot on a floor, for one episode.

    Attributes:
        pose: True pose, scene frame.
        floor_z: Height of the floor under it, scene frame, metres.
        reported: Pose as odometry reports it, in the frame of the start pose.
        collided: Whether an obstacle stopped the latest action.
        path_length_m: Sum of the true displacements in space, as in Habitat.
    """

    def __init__(
        self,
        walkable: WalkableSurface,
        start: Pose2,
        floor_z: float,
        *,
        motion: MotionConfig,
        noise: NoiseConfig,
        sliding: bool,
        rng: np.random.Generator,
    ) -> None:
        """Place the robot.

        Args:
            walkable: Surface that it stands on.
            start: Start pose, scene frame.
            floor_z: Height of the floor there, scene frame, metres.
            motion: Lengths of its actions.
            noise: Noise of its motion and of its odometry.
            sliding: Whether it slides along obstacles instead of stopping at them.
            rng: Generator of the noise.
        """
        self.pose = start
        self.floor_z = floor_z
        self.reported = Pose2(0.0, 0.0, 0.0)
        self.collided = False
        self.path_length_m = 0.0
        self._walkable = walkable
        self._motion = motion
        self._noise = noise
        self._sliding = sliding
        self._rng = rng

    @property
    def position(self) -> Position:
        """True position on the floor, ``(x, y, z)``, scene frame, metres."""
        return (self.pose.x, self.pose.y, self.floor_z)

    def move(self, action: Action) -> None:
        """Take a step or a turn."""
        before = self.pose
        self.collided = False
        if action == Action.MOVE_FORWARD:
            self._step(noisy_forward(self._motion.forward_m, self._noise, self._rng))
        else:
            angle = math.radians(self._motion.turn_angle_deg)
            angle = angle if action == Action.TURN_LEFT else -angle
            turn = noisy_turn(angle, self._noise, self._rng)
            self.pose = Pose2(before.x, before.y, wrap_angle(before.yaw + turn))
        moved = reported_motion(_motion(before, self.pose), self._noise, self._rng)
        self.reported = _moved(self.reported, moved)

    def _step(self, length_m: float) -> None:
        before, position = self.pose, self.position
        dx, dy = length_m * math.cos(before.yaw), length_m * math.sin(before.yaw)
        x, y, z = self._walkable.move(position, dx, dy, sliding=self._sliding)
        self.collided = math.hypot(x - before.x - dx, y - before.y - dy) > _ROUNDING_M
        self.pose, self.floor_z = Pose2(x, y, before.yaw), z
        self.path_length_m += math.dist(position, self.position)


def check_standable(walkable: Walkable, start: Pose2, z: float | None = None) -> None:
    """Make sure that the robot can stand at a pose.

    Raises:
        StartError: It can't; the message gives the nearest position where it can.
    """
    if not walkable.is_standable(start.x, start.y, z):
        x, y, floor_z = walkable.nearest_standable(start.x, start.y, z)
        here, there = ("", "") if z is None else (f", {z:.2f}", f", {floor_z:.2f}")
        raise StartError(
            f"the robot can't stand at ({start.x:.2f}, {start.y:.2f}{here}): it is inside or too "
            f"close to an obstacle, or off the floor; the nearest position is ({x:.2f}, {y:.2f}"
            f"{there})"
        )


def _motion(before: Pose2, after: Pose2) -> Pose2:
    """The second pose in the frame of the first."""
    dx, dy = after.x - before.x, after.y - before.y
    c, s = math.cos(before.yaw), math.sin(before.yaw)
    return Pose2(c * dx + s * dy, c * dy - s * dx, wrap_angle(after.yaw - before.yaw))


def _moved(pose: Pose2, motion: Pose2) -> Pose2:
    """The pose that a motion, given in a pose's own frame, leads to."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return Pose2(
        pose.x + c * motion.x - s * motion.y,
        pose.y + s * motion.x + c * motion.y,
        wrap_angle(pose.yaw + motion.yaw),
    )
