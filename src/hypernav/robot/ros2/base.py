"""The base of a robot on a ROS 2 network: sensors, and a velocity that data must be fresh for."""

import math
import time
from collections.abc import Callable

import numpy as np
from jaxtyping import Float32
from pydantic import ValidationError

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.robot.client.robot import Sensed
from hypernav.robot.driving.base import DepthView
from hypernav.robot.motion.velocity import STANDSTILL, Velocity
from hypernav.robot.ros.images import colour_of, depth_of
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import Header, Time, Twist, TwistStamped, Vector3
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.rgbd_stream import ImagePair
from hypernav.robot.ros2.sensors import Ros2Sensors
from hypernav.robot.ros2.velocity_output import VelocityOutput

_SAFETY_COLUMNS = 160


class Ros2Base:
    """Wheels, odometry and camera: a `Base`.

    While images or odometry are not fresh the robot stands, and goes on when they are again.

    Attributes:
        sensors: What it senses.
    """

    def __init__(self, network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Take over a robot that stands still.

        Args:
            network: The robot's network.
            config: Names of topics, limits, body.
            sensors: The robot's sensors, which work already.

        Raises:
            RosNetworkError: Their images are not fresh within the patience.
            ConfigError: No robot can have their camera: the floor's height is wrong, for example.
        """
        self.sensors = sensors
        self._embodiment = _embodiment(config.embodiment, sensors)
        self._halts = 0
        self._output = VelocityOutput(_velocity_sender(network, config, sensors), sensors.is_fresh)

    def close(self) -> None:
        """Stand still and let others drive."""
        self._output.close()

    @property
    def embodiment(self) -> Embodiment:
        """Body, camera, and effect of the actions."""
        return self._embodiment

    @property
    def camera(self) -> PinholeCamera:
        """The calibrated camera, without distortion."""
        return self.sensors.calibration.camera

    def sense(self) -> Sensed:
        """Images that came after the call, and the pose of their time.

        Raises:
            RosNetworkError: None come within the patience.
            RosMessageError: An image is broken.
            TransformMissingError: The pose is not known.
        """
        sensors = self.sensors
        pair = sensors.wait_for_pair(received_after_s=time.monotonic())
        assert pair is not None, "nothing else ends the wait"
        rgb = sensors.calibration.straightened_colour(colour_of(pair.colour))
        return Sensed(
            rgb=rgb,
            depth=self._measured(pair),
            odometry=sensors.odometry(pair.stamp_s),
            stamp_s=pair.stamp_s,
            odom_to_map=sensors.odom_to_map(),
            camera_to_base=sensors.camera_to_base(pair.stamp_s),
        )

    def odometry(self) -> Pose2:
        """Pose in the frame of the odometry, now."""
        return self.sensors.odometry()

    def depth_view(self) -> DepthView:
        """The newest depth image, coarser; waits for one where the last is too old to drive by.

        A halt ends the wait, by an image without any return.

        It has all returns, also those nearer than what maps are made from.

        Raises:
            RosNetworkError: None comes within the patience.
            RosMessageError: It is broken.
            TransformMissingError: The camera's pose is not known.
        """
        halts, sensors = self._halts, self.sensors
        pair = sensors.wait_for_pair(unless=lambda: self._halts != halts)
        every = max(self.camera.width // _SAFETY_COLUMNS, 1)
        camera = _coarse(self.camera, every)
        if pair is None:  # tf may know nothing of now, and nobody drives by it
            nothing = np.zeros((camera.height, camera.width), dtype=np.float32)
            upright = self._embodiment.camera.camera_to_base
            return DepthView(nothing, camera, upright, sensors.robot_now_s, self.odometry())
        depth = np.ascontiguousarray(self._depth(pair)[::every, ::every])
        camera_to_base = sensors.camera_to_base(pair.stamp_s)
        robot = sensors.odometry(pair.stamp_s)
        return DepthView(depth, camera, camera_to_base, pair.stamp_s, robot)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity, and come back after so many seconds."""
        self._output.command(velocity)
        time.sleep(seconds)

    def halt(self) -> None:
        """Command standstill at once; may be called from any thread."""
        self._halts += 1
        self._output.command(STANDSTILL)

    def _depth(self, pair: ImagePair) -> Float32[np.ndarray, "height width"]:
        return self.sensors.calibration.straightened_depth(depth_of(pair.depth))

    def _measured(self, pair: ImagePair) -> Float32[np.ndarray, "height width"]:
        """Depth for the map: not cut off where it becomes too inexact to be drawn."""
        depth = self._depth(pair)
        measured = is_measured(depth, self._embodiment.camera.min_depth_m)
        return np.where(measured, depth, np.float32(0.0))


def _velocity_sender(
    network: Ros2Network, config: Ros2Config, sensors: Ros2Sensors
) -> Callable[[Velocity], None]:
    """What sends a velocity, in the type that the robot takes."""

    def twist(velocity: Velocity) -> Twist:
        return Twist(Vector3(velocity.linear_m_s), Vector3(z=velocity.angular_rad_s))

    topic, frame = config.topics.cmd_vel, config.frames.base
    if config.cmd_vel_type == "Twist":
        plain = network.publisher(topic, Twist)
        return lambda velocity: plain.publish(twist(velocity))
    stamped = network.publisher(topic, TwistStamped)
    return lambda velocity: stamped.publish(
        TwistStamped(Header(ros_time(sensors.robot_now_s), frame), twist(velocity))
    )


def ros_time(seconds: float) -> Time:
    """A time as a message."""
    whole = math.floor(seconds)
    return Time(whole, int((seconds - whole) * 1e9))


def _embodiment(robot: Embodiment, sensors: Ros2Sensors) -> Embodiment:
    """The robot of the configuration with the camera that is really there.

    Raises:
        ConfigError: No robot can have it.
    """
    camera = sensors.calibration.camera
    pair = sensors.wait_for_pair()
    assert pair is not None, "nothing else ends the wait"
    pose: Transform = sensors.camera_to_base(pair.stamp_s)
    height_m, values = float(pose.translation[2]), robot.model_dump()
    values["camera"] |= {
        "width": camera.width,
        "height": camera.height,
        "hfov_deg": math.degrees(camera.hfov),
        "height_m": height_m,
        "pitch_deg": math.degrees(math.asin(max(min(-pose.rotation[2, 2], 1.0), -1.0))),
    }
    try:
        return Embodiment.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(
            f"the camera as ROS has it, {height_m:.2f} m above the floor, {camera.width} × "
            f"{camera.height} pixels: {'.'.join(map(str, first['loc']))}: {first['msg']}; "
            "frames.floor_z_m must be the floor's height in frames.odom, and large images have "
            "to be made smaller by their driver"
        ) from error


def _coarse(camera: PinholeCamera, every: int) -> PinholeCamera:
    """The camera of every n-th pixel of an image."""
    return PinholeCamera(
        math.ceil(camera.width / every),
        math.ceil(camera.height / every),
        camera.fx / every,
        camera.fy / every,
        0.5 + (camera.cx - 0.5) / every,
        0.5 + (camera.cy - 0.5) / every,
    )
