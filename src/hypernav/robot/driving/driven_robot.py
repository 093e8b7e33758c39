"""A robot that executes actions by velocities, and stops for obstacles."""

import math
import threading
from collections import deque
from collections.abc import Callable, Sequence

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.client.robot import Executed, Sensed
from hypernav.robot.driving.base import STANDSTILL, Base, Velocity
from hypernav.robot.driving.obstacles import DepthSafety, Obstacles
from hypernav.robot.driving.pure_pursuit import DriveConfig, PurePursuit

TICK_S = 0.1
"""Time between two commands, seconds."""
CAREFUL = DriveConfig(margin_m=0.03)
"""Limits for buildings in which people walk."""
_EXACT_M, _EXACT_RAD = 0.001, math.radians(0.05)
_ENOUGH_M, _ENOUGH_RAD = 0.15, 0.3
"""Commanded motion after which odometry must show motion."""
_MOVED_SHARE = 0.3
"""Share of the commanded motion below which the wheels are blocked."""
_VAIN_TURN_RAD = 2.0 * math.pi
"""Rotation on the spot, to and fro or on, that leads nowhere: half as much shows every heading."""
_STILL_RAD_S = 0.001
"""Rate of rotation on the spot below which the robot stands and waits, radians per second."""
_LAG_TICKS = 3
"""Number of ticks from a command to the wheels until odometry shows the motion."""


class DrivenRobot:
    """A `Robot` that makes steps and turns by velocities, in a closed loop over odometry.

    Before every command it checks the latest depth image. If something is in the way the robot
    stops and waits for it to go.

    Attributes:
        waits: Number of times that it stopped and waited.
    """

    def __init__(
        self, base: Base, config: DriveConfig | None = None, *, patience_s: float = 10.0
    ) -> None:
        """Take over a base, which stands still.

        Args:
            base: Wheels, odometry and camera.
            config: Limits of the velocity; `CAREFUL` by default.
            patience_s: Longest wait for something in the way to go, seconds.
        """
        self._base = base
        self._patience_s = patience_s
        self._pursuit = PurePursuit(config or CAREFUL, base.embodiment.body.radius_m)
        self._safety = DepthSafety(base.embodiment)
        self._stopping = threading.Event()
        self.waits: int = 0

    @property
    def embodiment(self) -> Embodiment:
        """Body, camera, and effect of the actions."""
        return self._base.embodiment

    def observe(self) -> Sensed:
        """Images and pose, taken now."""
        return self._base.sense()

    def execute(self, action: Action) -> Executed:
        """Make a step or a turn."""
        motion, start = self.embodiment.motion, self._base.odometry()
        if action is Action.MOVE_FORWARD:

            def left_m(robot: Pose2) -> float:
                return motion.forward_m - _along(start, robot)

            return self._run(
                lambda robot, seen: self._pursuit.go_straight(
                    robot, max(left_m(robot), 0.0), TICK_S, seen
                ),
                lambda robot: left_m(robot) < _EXACT_M,
            )
        turn = math.radians(motion.turn_angle_deg) * (1 if action is Action.TURN_LEFT else -1)

        def left(robot: Pose2) -> float:
            return wrap_angle(start.yaw + turn - robot.yaw)

        return self._run(
            lambda robot, seen: self._pursuit.rotate(left(robot), TICK_S),
            lambda robot: abs(left(robot)) < _EXACT_RAD,
        )

    def follow(
        self, path: Sequence[tuple[float, float]], until: Callable[[Pose2], bool]
    ) -> Executed:
        """Drive along a path, and return without braking as soon as `until` says so."""
        return self._run(
            lambda robot, seen: self._pursuit.command(robot, path, TICK_S, seen),
            lambda robot: until(robot) or self._pursuit.has_arrived(robot, path),
            brakes=False,
        )

    def stop(self) -> None:
        """Stand still at once."""
        self._stopping.set()
        self._base.halt()

    def _run(
        self,
        command: Callable[[Pose2, Obstacles], Velocity],
        is_done: Callable[[Pose2], bool],
        *,
        brakes: bool = True,
    ) -> Executed:
        """Command velocities until a motion is done, blocked, leads nowhere, or is stopped."""
        if self._stopping.is_set():
            self._stopping.clear()
            self._pursuit.reset()
        progress, waited_s = _Progress(self._base.odometry()), 0.0
        while not is_done(self._base.odometry()):
            ahead = self._safety.look(self._base.depth_view())  # waiting may help
            velocity = command(self._base.odometry(), ahead.obstacles)
            if ahead.is_blind and velocity.linear_m_s > 0.0:
                self._pursuit.reset()
                velocity = STANDSTILL
            if self._stopping.is_set():
                return self._stand(Executed.STOPPED)
            if velocity.linear_m_s == 0.0 and abs(velocity.angular_rad_s) < _STILL_RAD_S:
                self.waits += waited_s == 0.0
                waited_s += TICK_S
                if waited_s > self._patience_s:
                    return self._stand(Executed.BLOCKED)
            else:
                waited_s = 0.0
            self._base.drive(velocity, TICK_S)
            if progress.lacks_after(velocity, self._base.odometry()):
                return self._stand(Executed.BLOCKED)
        if brakes:
            self._stand(Executed.DONE)
        return Executed.DONE

    def _stand(self, outcome: Executed) -> Executed:
        self._base.halt()
        self._pursuit.reset()
        return outcome


class _Progress:
    """Compares the commanded motion with odometry."""

    def __init__(self, robot: Pose2) -> None:
        self._robot = robot
        self._moved_m = self._turned_rad = self._spun_rad = 0.0
        self._asked = deque([(0.0, 0.0)], maxlen=1 + _LAG_TICKS)

    def lacks_after(self, velocity: Velocity, robot: Pose2) -> bool:
        """Whether the wheels do not follow the commands of a moment ago, or turn on in vain."""
        turned_rad = abs(velocity.angular_rad_s) * TICK_S
        self._spun_rad = 0.0 if velocity.linear_m_s > 0.0 else self._spun_rad + turned_rad
        if self._spun_rad > _VAIN_TURN_RAD:
            return True
        asked_m, asked_rad = self._asked[-1]
        asked_m += velocity.linear_m_s * TICK_S
        asked_rad += turned_rad
        self._asked.append((asked_m, asked_rad))
        self._moved_m += self._robot.distance_to(*robot.xy)
        self._turned_rad += abs(wrap_angle(robot.yaw - self._robot.yaw))
        self._robot = robot
        due_m, due_rad = self._asked[0]
        return (due_m > _ENOUGH_M and self._moved_m < _MOVED_SHARE * due_m) or (
            due_rad > _ENOUGH_RAD and self._turned_rad < _MOVED_SHARE * due_rad
        )


def _along(start: Pose2, robot: Pose2) -> float:
    """Distance from a start along its heading, metres."""
    return (robot.x - start.x) * math.cos(start.yaw) + (robot.y - start.y) * math.sin(start.yaw)
