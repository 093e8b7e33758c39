"""Pure pursuit: bounded velocities along a path.

Source: R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", 1992; the
speed is regulated by curvature and obstacles as in Macenski et al., "Regulated Pure Pursuit for
Robot Path Tracking", 2023.
"""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.transforms import Pose2, distances_to_segment, wrap_angle
from hypernav.robot.driving.base import STANDSTILL, Velocity
from hypernav.robot.driving.obstacles import NoObstacles, Obstacles


class DriveConfig(RoomConfig):
    """Limits of a robot's velocity, and how closely it follows a path. All values are ours.

    Attributes:
        max_speed_m_s: Largest speed forward, metres per second; it never drives backward.
        max_turn_rate_deg_s: Largest rate of rotation, degrees per second.
        max_acceleration_m_s2: Largest change of the speed, metres per second squared. Only an
            obstacle that has newly appeared is braked for harder.
        max_turn_acceleration_deg_s2: Largest change of the rate of rotation, degrees per second
            squared.
        look_ahead_m: Distance along the path of the point that it steers to, metres.
        corner_cut_m: Largest distance by which it leaves the path at a corner, metres.
        turn_in_place_deg: Angle off the heading beyond which it rotates on the spot, degrees.
        margin_m: Distance that the body keeps from obstacles, metres. Paths through narrow gaps
            need 0 (`hypernav.search.planning.config.PlanningConfig.squeeze_m`); people who walk
            need more.
        reaction_s: Time for which a command may stay in force beyond its own duration before the
            robot brakes for an obstacle, seconds: images are late, links fail. The robot slows
            down near obstacles accordingly.
        slow_within_m: Distance between body and obstacles below which it drives slower, metres.
        slowest_share: Share of the largest speed that remains at zero distance to an obstacle.
        arrival_m: Distance from the end of the path at which it has arrived, metres.
    """

    max_speed_m_s: float = Field(default=0.5, gt=0.0, le=5.0)
    max_turn_rate_deg_s: float = Field(default=60.0, gt=0.0, le=720.0)
    max_acceleration_m_s2: float = Field(default=0.5, gt=0.0, le=20.0)
    max_turn_acceleration_deg_s2: float = Field(default=180.0, gt=0.0, le=7200.0)
    look_ahead_m: float = Field(default=0.5, gt=0.0, le=5.0)
    corner_cut_m: float = Field(default=0.03, gt=0.0, le=1.0)
    turn_in_place_deg: float = Field(default=30.0, gt=0.0, le=90.0)
    margin_m: float = Field(default=0.0, ge=0.0, le=1.0)
    reaction_s: float = Field(default=0.0, ge=0.0, le=5.0)
    slow_within_m: float = Field(default=0.4, gt=0.0, le=5.0)
    slowest_share: float = Field(default=0.3, gt=0.0, le=1.0)
    arrival_m: float = Field(default=0.05, gt=0.0, le=5.0)

    @property
    def max_turn_rate(self) -> float:
        """Largest rate of rotation, radians per second."""
        return math.radians(self.max_turn_rate_deg_s)

    @property
    def max_turn_acceleration(self) -> float:
        """Largest change of the rate of rotation, radians per second squared."""
        return math.radians(self.max_turn_acceleration_deg_s2)


_SAME_LINE_M = 0.02
"""Deviation below which a corner is ignored: paths from cell to cell are staircases."""
_BACK_M = 0.3
"""Length by which a robot may have moved back on its path, metres."""
_STEP_M = 0.025
_THERE_M = 0.05
"""Distance from a corner at which a robot is there."""


class PathAhead:
    """A path without superfluous corners, and the robot's progress along it."""

    def __init__(self, path: Sequence[tuple[float, float]], sharp_deg: float) -> None:
        """Take a path of at least one corner.

        Args:
            path: Corners ``(x, y)``, metres.
            sharp_deg: Angle of the corners at which the robot has to stop, degrees.
        """
        self._corners = _simplified(np.array(path, dtype=np.float64).reshape(-1, 2))
        legs = np.diff(self._corners, axis=0)
        self._at = np.concatenate([[0.0], np.cumsum(np.hypot(*legs.T))])
        headings = np.arctan2(legs[:, 1], legs[:, 0])
        sharp = [
            at
            for at, turn in zip(self._at[1:-1], np.diff(headings), strict=True)
            if abs(wrap_angle(float(turn))) > math.radians(sharp_deg)
        ]
        self._stops = [*map(float, sharp), self.length_m]
        self._along_m = self._passed_m = 0.0

    @property
    def length_m(self) -> float:
        """Length of the path, metres."""
        return float(self._at[-1])

    def point(self, along_m: float) -> tuple[float, float]:
        """Point ``(x, y)`` at a length along the path, metres; its end beyond it."""
        x, y = (np.interp(along_m, self._at, self._corners[:, axis]) for axis in (0, 1))
        return (float(x), float(y))

    def pass_to(self, x: float, y: float, within_m: float) -> float:
        """The length along the path to its point nearest to the robot, metres.

        Progress is monotonic: where the path passes the same place twice, the next pass counts, and
        a sharp corner that the robot was at stays behind it, also where the path leads back.

        Args:
            x: Position of the robot, metres.
            y: The same.
            within_m: Length beyond the previous point within which the robot may be now, metres.
        """
        low = max(self._along_m - _BACK_M, self._passed_m)
        count = max(math.ceil((self._along_m + within_m - low) / _STEP_M), 1)
        lengths = np.minimum(low + np.arange(count + 1) * _STEP_M, self.length_m)
        points = np.stack([np.interp(lengths, self._at, self._corners[:, k]) for k in (0, 1)], 1)
        self._along_m = float(lengths[np.hypot(points[:, 0] - x, points[:, 1] - y).argmin()])
        self._passed_m = max(
            (at for at in self._stops[:-1] if self._is_behind(at, x, y)), default=0.0
        )
        self._along_m = max(self._along_m, self._passed_m)
        return self._along_m

    def _is_behind(self, stop_m: float, x: float, y: float) -> bool:
        """Whether the robot is beyond a sharp corner, or at it."""
        left_m = stop_m - self._along_m
        return left_m <= 0.0 or (
            left_m <= _THERE_M and math.dist(self.point(stop_m), (x, y)) <= _THERE_M
        )

    def next_stop_m(self, along_m: float, passed_m: float) -> float:
        """Length from a point of the path to the next sharp corner or the end, metres.

        Args:
            along_m: Length of the path up to the point, metres.
            passed_m: Length before a corner at which it counts as passed, metres.
        """
        ahead = [at - along_m for at in self._stops if at - along_m > passed_m]
        return ahead[0] if ahead else self.length_m - along_m

    def aim_m(self, x: float, y: float, along_m: float, ahead_m: float, cut_m: float) -> float:
        """Length along the path of the farthest point that the robot may go straight to, metres.

        Args:
            x: Position of the robot, metres.
            y: The same.
            along_m: Length along the path to the point nearest to the robot, metres.
            ahead_m: Largest length beyond it, metres.
            cut_m: Largest distance of a corner from that line, metres.
        """
        robot, steps = np.array([x, y]), math.ceil(ahead_m / _STEP_M)
        for step in range(steps, 1, -1):
            end_m = min(along_m + step * _STEP_M, self.length_m)
            between = self._corners[(self._at > along_m) & (self._at < end_m)]
            cuts_m = distances_to_segment(between, robot, np.array(self.point(end_m)))
            if cuts_m.max(initial=0.0) <= cut_m:
                return end_m
        return min(along_m + _STEP_M, self.length_m)


def _simplified(corners: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "m 2"]:
    if len(corners) < 3:
        return corners
    curve = corners.astype(np.float32).reshape(-1, 1, 2)
    kept = cv2.approxPolyDP(curve, _SAME_LINE_M, False).reshape(-1, 2).astype(np.float64)
    # Single precision is used only to choose corners; both ends stay exact.
    kept[0], kept[-1] = corners[0], corners[-1]
    return kept


_SAMPLE_M = 0.025
"""Distance between the points at which the path ahead is examined: half a cell of a map."""
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
