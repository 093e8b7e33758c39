"""A robot whose base is driven by a running Nav2."""

import logging
import math
import threading
from collections.abc import Callable, Sequence

from hypernav.core.embodiment import Action
from hypernav.core.errors import Nav2Error
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.client.robot import Executed, Sensed
from hypernav.robot.driving.driven_robot import TICK_S
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.guarded_output import GuardedOutput
from hypernav.robot.ros2.nav2_goals import Nav2Goals
from hypernav.robot.ros2.nav2_progress import Aims, Arrival, Motion, Progress, ShortOfGoals, ToPose
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensing_robot import SensingRobot
from hypernav.robot.ros2.sensors import Ros2Sensors

_LOG = logging.getLogger(__name__)
_STANDS_S = 3.0
"""Time for which Nav2 is told to stand still: it may follow its old path until it plans again."""
_SILENCE_S = 1.0
"""Time for which it must stand still at the end without its wheels being held: more than the
timeout of a multiplexer."""


class Nav2Robot(SensingRobot):
    """A `Robot` that makes its motions with goals for Nav2, and judges them by odometry.

    A step or a turn is a goal at its end. A path is followed by goals on it, each as far ahead as
    the robot can go straight. The goal to stand still is the robot's own position; the
    `GuardedOutput` sends it while images or odometry are not fresh, or the search hangs.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Take over a robot whose Nav2 has no goal.

        Args:
            network: The robot's network.
            config: Topics, frames and body, and what counts as reached.
            sensors: The robot's sensors, which work already.

        Raises:
            ConfigError: The camera's pose is impossible.
            Nav2Error: Nobody reads the goals or the topics that hold the wheels, or others
                bypass them.
            RosNetworkError: Images are not fresh within the patience.
        """
        super().__init__(config, sensors)
        self._config, self._topic = config.nav2, config.topics.goal_pose
        goals = Nav2Goals(network, config, sensors)
        goals.await_readers(config.timing.find_s)
        self._output = GuardedOutput[Pose2 | None](
            goals.send,
            None,
            is_safe=sensors.is_fresh,
            is_standing=sensors.is_standing,
            stands_s=_STANDS_S,
            silence_s=_SILENCE_S,
        )
        self._stopping = threading.Event()
        self._has_progressed = False
        self._aims: Aims | None = None
        self._short = ShortOfGoals(self._config)

    def close(self) -> None:
        """Stand still and let others drive.

        Raises:
            RosNetworkError: The robot does not stand still at the end.
        """
        self._output.close()

    def observe(self) -> Sensed:
        """Images and pose, taken now."""
        return self.sense()

    def execute(self, action: Action) -> Executed:
        """Make a step or a turn."""
        motion, start = self.embodiment.motion, self.odometry()
        if action is Action.MOVE_FORWARD:
            x, y = (
                here + motion.forward_m * share
                for here, share in zip(
                    start.xy, (math.cos(start.yaw), math.sin(start.yaw)), strict=True
                )
            )
            goal = Pose2(x, y, start.yaw)
        else:
            turn = math.radians(motion.turn_angle_deg) * (1 if action is Action.TURN_LEFT else -1)
            goal = Pose2(*start.xy, wrap_angle(start.yaw + turn))
        return self._run(ToPose(start, goal), math.radians(self._config.reached_deg))

    def follow(
        self, path: Sequence[tuple[float, float]], until: Callable[[Pose2], bool]
    ) -> Executed:
        """Drive along a path, and return without braking as soon as `until` says so."""
        if self._aims is None or not self._aims.is_on(path):
            self._aims = Aims(path, self._config)
        return self._run(self._aims, math.pi, is_enough=until)  # a path ends without a heading

    def stop(self) -> None:
        """Stand still at once."""
        self._stopping.set()
        self._output.halt()

    def _run(
        self,
        motion: Motion,
        reached_rad: float,
        *,
        is_enough: Callable[[Pose2], bool] = lambda _: False,
    ) -> Executed:
        """Send goals until a motion is done, blocked or stopped.

        Args:
            motion: The motion.
            reached_rad: Largest difference of the heading at its end, radians.
            is_enough: Function of the robot's position for progress that says whether to end early.

        Raises:
            Nav2Error: The robot has never come nearer to any goal.
            RosNetworkError: No fresh data comes within the patience.
        """
        self._stopping.clear()
        arrival, progress = Arrival(self._config.reached_m, reached_rad), Progress()
        while True:
            self.sensors.wait_for_pair(unless=self._stopping.is_set)
            if self._stopping.is_set():
                return self._stand(Executed.STOPPED)
            robot = self.odometry()
            aim = motion.at(robot)
            if is_enough(aim.made):
                return Executed.DONE
            is_standing = self.sensors.is_standing()
            if arrival.has_settled_at(motion.end, robot, TICK_S, is_standing=is_standing):
                return self._stand(Executed.DONE)
            idle_s = progress.idle_s(aim, TICK_S)
            self._has_progressed |= progress.is_made
            if idle_s > self._config.blocked_s:
                return self._blocked()
            if progress.taken_s > self._config.motion_s:
                _LOG.info("a motion takes Nav2 over %g s (nav2.motion_s)", self._config.motion_s)
                return self._stand(Executed.BLOCKED)
            if aim.is_astray:
                _LOG.info("Nav2 has left the line of the motion; the agent decides again")
                return self._stand(Executed.BLOCKED)
            self._short.look(aim.goal, robot, idle_s)
            self._output.command(aim.goal)
            self._stopping.wait(TICK_S)

    def _blocked(self) -> Executed:
        """Stand still, because Nav2 makes no progress.

        Raises:
            Nav2Error: It has never made any progress.
        """
        self._stand(Executed.BLOCKED)
        if not self._has_progressed:
            raise Nav2Error(
                f"Nav2 has taken goals on '{self._topic}', and the robot has come no nearer "
                f"to any for {self._config.blocked_s:g} s by its odometry (nav2.blocked_s). Are "
                "all nodes of Nav2 active, is the robot localised, does a goal from RViz move it, "
                "and are nav2.reached_m and nav2.reached_deg not below the tolerances of its goal "
                "checker?"
            )
        return Executed.BLOCKED

    def _stand(self, outcome: Executed) -> Executed:
        self._output.halt()
        return outcome
