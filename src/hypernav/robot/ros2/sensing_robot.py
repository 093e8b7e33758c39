"""A robot's sensor data from a ROS 2 network, whichever program drives it."""

import math
import time

import numpy as np
from jaxtyping import Float32
from pydantic import ValidationError

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.robot.client.robot import Sensed
from hypernav.robot.ros.images import colour_of, depth_of
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.sensors import ImagePair, Ros2Sensors

_MOST_UP_DEG = 60.0
"""Angle above the horizon at which no robot's camera looks: the z axis of its body does."""


class SensingRobot:
    """Images and poses of a robot, and the embodiment that they belong to.

    Attributes:
        sensors: What it senses.
    """

    def __init__(self, config: Ros2Config, sensors: Ros2Sensors) -> None:
        """Read the camera's calibration and pose, and build the embodiment from them.

        Args:
            config: Body of the robot, and the range of its depth.
            sensors: The robot's sensors, already working.

        Raises:
            RosNetworkError: No fresh images arrive within the patience.
            ConfigError: The camera's pose is impossible, for example because the floor's height is
                wrong.
        """
        self.sensors = sensors
        self._embodiment = _embodiment(config.embodiment, sensors)

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

    def observation(self, sensed: Sensed) -> Observation:
        """What was sensed, as an agent's observation."""
        return sensed.observation(self.camera, self._embodiment.camera.camera_to_base)

    def depth_of(self, pair: ImagePair) -> Float32[np.ndarray, "height width"]:
        """All depth of a pair of images, metres, without distortion.

        Raises:
            RosMessageError: It is broken.
        """
        return self.sensors.calibration.straightened_depth(depth_of(pair.depth))

    def _measured(self, pair: ImagePair) -> Float32[np.ndarray, "height width"]:
        """Depth for perception, also beyond the range that is exact enough for the map."""
        depth = self.depth_of(pair)
        measured = is_measured(depth, self._embodiment.camera.min_depth_m)
        return np.where(measured, depth, np.float32(0.0))


def _embodiment(robot: Embodiment, sensors: Ros2Sensors) -> Embodiment:
    """The robot of the configuration with the camera that is really there.

    Raises:
        ConfigError: The values are impossible for a robot.
    """
    camera = sensors.calibration.camera
    pair = sensors.wait_for_pair()
    assert pair is not None, "nothing else ends the wait"
    pose: Transform = sensors.camera_to_base(pair.stamp_s)
    up = math.degrees(math.asin(max(min(float(pose.rotation[2, 2]), 1.0), -1.0)))
    if up > _MOST_UP_DEG:
        frame = sensors.calibration.frame
        raise ConfigError(
            f"by tf the camera looks up by {up:.0f}°: z of the frame '{frame}', which frame_id of "
            "its images names, must point forward, x right and y down (REP 103: "
            "'…_optical_frame'); name an optical frame in the camera's driver or simulator"
        )
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
            f"the camera by tf and camera info, {height_m:.2f} m above the floor, {camera.width} × "
            f"{camera.height} pixels:  {'.'.join(map(str, first['loc']))}: {first['msg']}; "
            "frames.floor_z_m must be the floor's height in frames.odom, and large images have "
            "to be made smaller by their driver"
        ) from error
