"""Stops the wheels at once while Nav2 drives, by inputs of a velocity multiplexer."""

from hypernav.robot.motion.velocity import STANDSTILL
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Bool
from hypernav.robot.ros2.nav2.publishers import await_sole_command
from hypernav.robot.ros2.nav2.waiting import wait_for
from hypernav.robot.ros2.network import Publisher, Ros2Network
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_publisher import VelocityPublisher


class WheelHold:
    """Holds the wheels by a multiplexer (``twist_mux``) between Nav2 and the base.

    Nav2 stops only when it plans again. Until then an input with a priority above its own receives
    zero velocity. A lock stays open only while it is told so repeatedly: its timeout closes it if
    hypernav or its network dies. Both are optional; without them nothing is held.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Announce the topics.

        Args:
            network: The robot's network.
            config: Names of the topics, and type of the velocity.
            sensors: The robot's sensors, which know its clock.

        Raises:
            RosNetworkError: A topic can't be written.
        """
        stop, lock = config.topics.stop_cmd_vel, config.topics.nav2_lock
        self._network, self._config = network, config
        self._stop = None if stop is None else VelocityPublisher(stop, network, config, sensors)
        self._lock: Publisher[Bool] | None = None if lock is None else network.publisher(lock, Bool)

    def await_multiplexer(self, timeout_s: float) -> None:
        """Wait until the multiplexer is running, and nothing bypasses it.

        Raises:
            Nav2Error: Nobody reads the topics that hold the wheels, or others publish on them.
        """
        wait_for(self._missing_reader, timeout_s)
        await_sole_command(self._network, self._config.topics, timeout_s)

    def hold(self) -> None:
        """Keep the wheels still; to be called repeatedly.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        try:
            if self._stop is not None:
                self._stop.publish(STANDSTILL)
        finally:
            self._say_locked(True)

    def let_go(self) -> None:
        """Let Nav2 drive for a moment; to be called repeatedly.

        Raises:
            RosNetworkError: The network doesn't take it.
        """
        self._say_locked(False)

    def _say_locked(self, is_locked: bool) -> None:
        if self._lock is not None:
            self._lock.publish(Bool(is_locked))

    def _missing_reader(self) -> str | None:
        """What to do about an input that the multiplexer doesn't read; None if it reads all."""
        topics, kind = self._config.topics, self._config.cmd_vel_type
        if self._stop is not None and not self._stop.has_reader():
            return (
                f"nobody reads '{topics.stop_cmd_vel}' (topics.stop_cmd_vel) as geometry_msgs/"
                f"{kind}, expected the robot's velocity multiplexer, which holds the wheels by it; "
                "is twist_mux running, with this input, and does it take this type (cmd_vel_type)?"
            )
        if self._lock is not None and not self._lock.has_reader():
            return (
                f"nobody reads '{topics.nav2_lock}' (topics.nav2_lock) as std_msgs/Bool, expected "
                "the robot's velocity multiplexer; is twist_mux running, with this lock?"
            )
        return None
