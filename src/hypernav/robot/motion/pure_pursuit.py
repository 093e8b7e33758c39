"""Pure pursuit: bounded velocities along a path.

Source: R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", 1992; the
speed is regulated by curvature and obstacles as in Macenski et al., "Regulated Pure Pursuit for
Robot Path Tracking", 2023.
"""

import math
from collections.abc import Sequence

import numpy as np

from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.motion.config import DriveConfig
from hypernav.robot.motion.obstacles import NoObstacles, Obstacles
from hypernav.robot.motion.path_ahead import PathAhead
from hypernav.robot.motion.velocity import STANDSTILL, Velocity

_SAMPLE_M = 0.025
"""Distance between the points at which the way ahead is examined: half a cell of a map."""
_TOUCH_M = 1e-6
_AIMS = (1.0, 0.5, 0.25, 0.125)
"""Shares of the look-ahead to try, for a robot beside its path among obstacles."""

Path = Sequence[tuple[float, float]]
"""Corners ``(x, y)`` of a path, metres, in the frame of the robot's pose."""


class PurePursuit:
    """Follows a path by velocities: drives arcs to a point ahead on it, rotates at sharp corners.

    The pose may jump between commands, when the robot's position in the ``map`` frame is corrected:
    velocities still change by no more than the acceleration allows.
    """

    def __init__(self, config: DriveConfig, radius_m: float) -> None:
        """Begin at a standstill.

        Args:
            config: Limits of the velocity.
            radius_m: Radius of the robot's body, metres.
        """
        self._config = config
        self._radius_m = radius_m
        self.reset()

    def reset(self) -> None:
        """Start again from standstill, for example after an emergency stop."""
        self._last = STANDSTILL
        self._path: Path = ()
        self._ahead: PathAhead | None = None

    def command(
        self,
        robot: Pose2,
        path: Path,
        seconds: float,
        obstacles: Obstacles | None = None,
    ) -> Velocity:
        """The velocity until the next command.

        Args:
            robot: Pose of the robot.
            path: Path to follow; without corners the robot brakes to a standstill.
            seconds: Time until the next command.
            obstacles: Obstacles around the robot, in the frame of the path; None if none is known.

        Returns:
            A velocity within all limits. The robot keeps its margin to obstacles; if one is nearer
            already, it comes no nearer.
        """
        obstacles = obstacles or NoObstacles()
        self._last = self._chosen(robot, path, seconds, obstacles)
        return self._last

    def rotate(self, angle: float, seconds: float) -> Velocity:
        """The velocity of a rotation on the spot until the next command.

        Args:
            angle: Angle that is left, radians, positive to the left.
            seconds: Time until the next command.
        """
        self._last = self._spin(Pose2(0.0, 0.0, 0.0), angle, seconds, NoObstacles())
        return self._last

    def go_straight(
        self, robot: Pose2, left_m: float, seconds: float, obstacles: Obstacles | None = None
    ) -> Velocity:
        """The velocity of a drive straight ahead until the next command.

        Args:
            robot: Pose of the robot.
            left_m: Length that is left, metres.
            seconds: Time until the next command.
            obstacles: Obstacles around the robot, in the frame of its pose; None if none is known.
        """
        speed = _braking(left_m, self._config.max_acceleration_m_s2, seconds)
        self._last = self._drive(robot, speed, 0.0, seconds, obstacles or NoObstacles())
        return self._last

    def has_arrived(self, robot: Pose2, path: Path) -> bool:
        """Whether the robot is at the end of a path, which has at least one corner."""
        return robot.distance_to(*path[-1]) <= self._config.arrival_m

    def _followed(self, path: Path) -> PathAhead | None:
        """The path, with the progress on it so far if it is the previous one."""
        if tuple(path) != self._path or self._ahead is None:
            self._path = tuple(path)
            sharp_deg = self._config.turn_in_place_deg
            self._ahead = PathAhead(path, sharp_deg) if len(path) else None
        return self._ahead

    def _chosen(self, robot: Pose2, path: Path, seconds: float, obstacles: Obstacles) -> Velocity:
        ahead = self._followed(path)
        if ahead is None or self.has_arrived(robot, path):
            return self._drive(robot, 0.0, 0.0, seconds, obstacles)
        config = self._config
        along_m = ahead.pass_to(*robot.xy, within_m=config.look_ahead_m)
        aim = self._aim(robot, ahead, along_m, obstacles)
        bearing = robot.bearing_to(*aim)
        if self._is_aside(bearing):
            return self._spin(robot, bearing, seconds, obstacles)
        left_m = ahead.next_stop_m(along_m, config.corner_cut_m)
        speed = _braking(left_m, config.max_acceleration_m_s2, seconds)
        found = self._drive(robot, speed, _curvature(robot, aim), seconds, obstacles)
        if found.linear_m_s == 0.0 and self._last.linear_m_s == 0.0:
            return self._spin(robot, bearing, seconds, obstacles)  # a straight line may be free
        return found

    def _aim(
        self, robot: Pose2, ahead: PathAhead, along_m: float, obstacles: Obstacles
    ) -> tuple[float, float]:
        """The farthest point of the path ahead that the robot may go to, else the nearest one."""
        aim = robot.xy
        for part in _AIMS:
            look_m = part * self._config.look_ahead_m
            cut_m = part * self._config.corner_cut_m
            aim = ahead.point(ahead.aim_m(*robot.xy, along_m, look_m, cut_m))
            if self._may_go(robot, aim, obstacles):
                break
        return aim

    def _may_go(self, robot: Pose2, aim: tuple[float, float], obstacles: Obstacles) -> bool:
        """Whether the arc to a point is free, or the line for a robot that stands or must turn."""
        bearing, away_m = robot.bearing_to(*aim), robot.distance_to(*aim)
        is_aside = self._is_aside(bearing)
        if is_aside or self._last.linear_m_s == 0.0:
            turned = Pose2(robot.x, robot.y, robot.yaw + bearing)
            if self._free_m(turned, 0.0, away_m, obstacles) >= away_m:
                return True
        arc = _curvature(robot, aim)
        return not is_aside and self._free_m(robot, arc, away_m, obstacles) >= away_m

    def _is_aside(self, bearing: float) -> bool:
        return abs(bearing) > math.radians(self._config.turn_in_place_deg)

    def _spin(self, robot: Pose2, angle: float, seconds: float, obstacles: Obstacles) -> Velocity:
        """Brake to no forward speed, and rotate by an angle."""
        config = self._config
        rate = _braking(abs(angle), config.max_turn_acceleration, seconds)
        rate = math.copysign(min(rate, config.max_turn_rate), angle)
        speed = max(self._last.linear_m_s - config.max_acceleration_m_s2 * seconds, 0.0)
        return self._safe(robot, speed, self._near_rate(rate, seconds), seconds, obstacles)

    def _drive(
        self,
        robot: Pose2,
        speed: float,
        curvature: float,
        seconds: float,
        obstacles: Obstacles,
    ) -> Velocity:
        """Drive an arc, at most at a given speed."""
        config, last = self._config, self._last
        speed = min(speed, config.max_speed_m_s)
        if curvature != 0.0:
            speed = min(speed, config.max_turn_rate / abs(curvature))
        if speed > 0.0:
            speed *= self._share_beside(robot, obstacles)
        change = config.max_acceleration_m_s2 * seconds
        speed = min(max(speed, last.linear_m_s - change, 0.0), last.linear_m_s + change)
        rate = speed * curvature
        return self._safe(robot, speed, self._near_rate(rate, seconds), seconds, obstacles)

    def _near_rate(self, rate: float, seconds: float) -> float:
        """The rate of rotation nearest to a wanted one that the limits allow."""
        config, last = self._config, self._last.angular_rad_s
        change = config.max_turn_acceleration * seconds
        rate = min(max(rate, -config.max_turn_rate), config.max_turn_rate)
        return min(max(rate, last - change), last + change)

    def _share_beside(self, robot: Pose2, obstacles: Obstacles) -> float:
        """Share of the speed that is left beside obstacles."""
        config = self._config
        gap_m = float(obstacles.distances(np.array([robot.xy]))[0]) - self._radius_m
        share = max(gap_m, 0.0) / config.slow_within_m
        return min(config.slowest_share + (1.0 - config.slowest_share) * share, 1.0)

    def _safe(
        self, robot: Pose2, speed: float, rate: float, seconds: float, obstacles: Obstacles
    ) -> Velocity:
        """The velocity, reduced if the robot could not brake before an obstacle on its arc."""
        if speed > 0.0:
            deceleration = self._config.max_acceleration_m_s2
            held_s = seconds + self._config.reaction_s
            reach_m = speed * held_s + speed**2 / (2.0 * deceleration) + _SAMPLE_M
            free_m = self._free_m(robot, rate / speed, reach_m, obstacles)
            slower = min(speed, _braking(free_m, deceleration, held_s))
            # A lower speed at the same rate of rotation is another, tighter arc.
            is_free = slower > 0.0 and (
                slower == speed
                or self._free_m(robot, rate / slower, reach_m, obstacles) > slower * held_s
            )
            speed = slower if is_free else 0.0
        return Velocity(speed, rate)

    def _free_m(
        self, robot: Pose2, curvature: float, reach_m: float, obstacles: Obstacles
    ) -> float:
        """Length of an arc up to the first obstacle, metres; infinite if there is none."""
        lengths = np.arange(1, math.ceil(reach_m / _SAMPLE_M) + 1) * _SAMPLE_M
        half = curvature * lengths / 2.0
        chords = lengths * np.sinc(half / np.pi)
        angles = robot.yaw + half
        points = np.stack(
            [robot.x + chords * np.cos(angles), robot.y + chords * np.sin(angles)], axis=1
        )
        distances = obstacles.distances(np.vstack([[robot.xy], points]))
        here = float(distances[0])
        least = max(min(self._radius_m + self._config.margin_m, here) - _TOUCH_M, _TOUCH_M)
        hit = distances[1:] < least
        return float(lengths[hit.argmax()] - _SAMPLE_M) if hit.any() else math.inf


def _curvature(robot: Pose2, aim: tuple[float, float]) -> float:
    """Curvature of the arc from a robot's pose to a point, per metre, positive to the left."""
    return 2.0 * math.sin(robot.bearing_to(*aim)) / max(robot.distance_to(*aim), _SAMPLE_M)


def _braking(left: float, deceleration: float, seconds: float) -> float:
    """The largest velocity from which a robot still stops within a length or an angle.

    Args:
        left: What is left, metres or radians.
        deceleration: Largest deceleration, per second squared.
        seconds: Time until the robot may brake.
    """
    change = deceleration * seconds
    return math.sqrt(change**2 + 2.0 * deceleration * left) - change
