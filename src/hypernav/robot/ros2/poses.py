"""Times and poses as messages of ROS 2."""

import math

from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.ros2.idl_types import Header, Point, Pose, PoseStamped, Quaternion, Time


def ros_time(seconds: float) -> Time:
    """A time as a message."""
    whole = math.floor(seconds)
    return Time(whole, int((seconds - whole) * 1e9))


def pose_message(pose: Pose2, header: Header) -> PoseStamped:
    """A pose on the floor."""
    rotation = Quaternion(z=math.sin(pose.yaw / 2.0), w=math.cos(pose.yaw / 2.0))
    return PoseStamped(header, Pose(Point(pose.x, pose.y), rotation))
