"""The base of a robot on a ROS 2 network, which drives only while its sensor data is fresh."""

import math
import time

import numpy as np

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.robot.driving.base import DepthView
from hypernav.robot.motion.velocity import STANDSTILL, Velocity
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.guarded_output import GuardedOutput
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensing_robot import SensingRobot
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_publisher import VelocityPublisher

_SAFETY_COLUMNS = 160


class Ros2Base(SensingRobot):
    """Wheels, odometry and camera: a `Base`.

    The robot stands still while images or odometry are not fresh.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Take over a robot that stands still.

        Args:
            network: The robot's network.
            config: Names of topics, limits, body.
            sensors: The robot's sensors, already working.

        Raises:
            RosNetworkError: No fresh images arrive within the patience, or nobody reads the
                velocities.
            ConfigError: The camera's pose is impossible, for example because the floor's height is
                wrong.
        """
        super().__init__(config, sensors)
        self._halts = 0
        wheels = VelocityPublisher(config.topics.cmd_vel, network, config, sensors)
        wheels.await_wheels(config.timing.find_s)
        self._output = GuardedOutput(wheels.publish, STANDSTILL, is_safe=sensors.is_fresh)

    def close(self) -> None:
        """Stand still and let others drive.

        Raises:
            RosNetworkError: The robot does not stand still at the end.
        """
        self._output.close()

    def depth_view(self) -> DepthView:
        """The newest depth image, subsampled; waits if the last one is too old to drive by.

        It includes returns nearer than those that maps are made from. `halt` ends the wait, with an
        image without any return.

        Raises:
            RosNetworkError: None comes within the patience.
            RosMessageError: It is broken.
            TransformMissingError: The camera's pose is not known.
        """
        halts, sensors = self._halts, self.sensors
        pair = sensors.wait_for_pair(unless=lambda: self._halts != halts)
        every = max(self.camera.width // _SAFETY_COLUMNS, 1)
        camera = _coarse(self.camera, every)
        if pair is None:  # tf may not have the present pose, and this image is not used to drive
            nothing = np.zeros((camera.height, camera.width), dtype=np.float32)
            upright = self.embodiment.camera.camera_to_base
            return DepthView(nothing, camera, upright, sensors.robot_now_s, self.odometry())
        depth = np.ascontiguousarray(self.depth_of(pair)[::every, ::every])
        camera_to_base = sensors.camera_to_base(pair.stamp_s)
        robot = sensors.odometry(pair.stamp_s)
        return DepthView(depth, camera, camera_to_base, pair.stamp_s, robot)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity for a number of seconds, then return."""
        self._output.command(velocity)
        time.sleep(seconds)

    def halt(self) -> None:
        """Command the base to stand still at once; may be called from any thread."""
        self._halts += 1
        self._output.halt()


def _coarse(camera: PinholeCamera, every: int) -> PinholeCamera:
    """The camera model of an image of which every n-th pixel is kept."""
    return PinholeCamera(
        math.ceil(camera.width / every),
        math.ceil(camera.height / every),
        camera.fx / every,
        camera.fy / every,
        0.5 + (camera.cx - 0.5) / every,
        0.5 + (camera.cy - 0.5) / every,
    )
