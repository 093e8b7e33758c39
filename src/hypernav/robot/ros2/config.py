"""Configuration of a robot on a ROS 2 network: the sections of ``ros2.yaml``."""

import os
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import ConfigError
from hypernav.robot.driving.driven_robot import CAREFUL
from hypernav.robot.driving.pure_pursuit import DriveConfig
from hypernav.robot.ros2.guarded_output import NTP_DRIFT, VALID_S

_MOST_DOMAINS = 232
_STILL_M_S, _STILL_DEG_S = 0.1, 10.0
"""Largest speeds of a body that only sways; at higher speeds the robot is driving."""
_TopicName = Annotated[str, Field(pattern="[^/]")]


class TopicsConfig(RoomConfig):
    """Names of the topics.

    Attributes:
        colour: Colour images; None looks for them by type, as for the two below.
        depth: Depth images, registered to colour.
        camera_info: Calibration of the colour images.
        odometry: ``nav_msgs/Odometry``, for a robot whose tf lacks the pose of the base.
        cmd_vel: Velocity commands to the base; where Nav2 drives through a multiplexer, the
            multiplexer's output.
        goal_pose: Goals of Nav2, where that drives the robot.
        stop_cmd_vel: An input of the robot's velocity multiplexer with a priority above Nav2's. It
            receives zero velocity while Nav2 is to stand still; None without one.
        nav2_lock: A lock of that multiplexer, open only while Nav2 may drive; None without one.
        tf: Poses of frames that change, ``tf2_msgs/TFMessage``.
        tf_static: Poses of frames that do not change.
        output: Prefix of the topics that are published for people.
    """

    colour: _TopicName | None = None
    depth: _TopicName | None = None
    camera_info: _TopicName | None = None
    odometry: _TopicName | None = None
    tf: _TopicName = "/tf"
    tf_static: _TopicName = "/tf_static"
    cmd_vel: _TopicName = "/cmd_vel"
    goal_pose: _TopicName = "/goal_pose"
    stop_cmd_vel: _TopicName | None = None
    nav2_lock: _TopicName | None = None
    output: _TopicName = "/hypernav"


class FramesConfig(RoomConfig):
    """Names of the frames (REP 105), and where the floor is.

    Attributes:
        base: Frame of the robot's base, x forward.
        odom: Frame of the odometry, which never jumps.
        map: Frame of a localisation, which publishes the pose of ``odom`` in it; None without one.
        floor_z_m: Height of the floor in the frame of the odometry, metres. Legged robots often
            have its origin where the body was at the start, which is above the floor.
    """

    base: str = Field(default="base_link", min_length=1)
    odom: str = Field(default="odom", min_length=1)
    map: str | None = Field(default=None, min_length=1)
    floor_z_m: float = Field(default=0.0, ge=-10.0, le=10.0)


class TimingConfig(RoomConfig):
    """What counts as late, and which messages belong together.

    Attributes:
        fresh_s: Age of images and odometry beyond which the robot stands still, seconds. It must
            cover the time between two images and their transmission.
        clock_drift: Largest share of time by which the robot's clock may run slower than this
            machine's. A simulator at half of real time needs 0.5; slowly growing delays are then
            not noticed.
        apart_s: Largest difference of the times of colour and depth that belong together, seconds.
        find_s: Time in which topics, images and frames must be found at the start, seconds.
        patience_s: Time without fresh data after which the search ends, seconds.
    """

    fresh_s: float = Field(default=0.4, ge=0.05, le=0.5)
    clock_drift: float = Field(default=NTP_DRIFT, ge=NTP_DRIFT, lt=1.0)
    apart_s: float = Field(default=0.03, ge=0.0, le=0.5)
    find_s: float = Field(default=10.0, ge=0.5, le=300.0)
    patience_s: float = Field(default=60.0, ge=1.0, le=3600.0)


class Nav2Config(RoomConfig):
    """How a running Nav2 drives the robot, and which odometry counts as arrival.

    Attributes:
        ahead_m: Largest length along the agent's path up to the next goal, metres.
        corner_cut_m: Largest distance of the path's corners from the straight line to that goal,
            metres. Larger ones leave more of the route to Nav2.
        reached_m: Distance from a goal at which it is reached, metres; not below
            ``xy_goal_tolerance`` of Nav2's goal checker.
        reached_deg: Difference of the heading at which it is reached, degrees; not below
            ``yaw_goal_tolerance``, which is in radians.
        blocked_s: Time without coming nearer to a goal after which it can't be reached, seconds.
        motion_s: Longest time of one step, turn or piece of a path, seconds; a motion that takes
            longer counts as blocked. Times without fresh data don't count.
        still_s: Time over which odometry shows whether the robot stands still, seconds: longer than
            the sway of a legged body.
        still_m: Distance moved in that time below which the robot stands still, metres; at most
            0.1 m/s.
        still_deg: Angle turned in that time below which it stands still, degrees; at most 10 °/s.
    """

    ahead_m: float = Field(default=1.5, ge=0.2, le=50.0)
    corner_cut_m: float = Field(default=0.1, ge=0.01, le=50.0)
    reached_m: float = Field(default=0.15, ge=0.01, le=1.0)
    reached_deg: float = Field(default=10.0, ge=1.0, le=90.0)
    blocked_s: float = Field(default=15.0, ge=1.0, le=600.0)
    motion_s: float = Field(default=60.0, ge=5.0, le=3600.0)
    still_s: float = Field(default=0.3, ge=0.1, le=3.0)
    still_m: float = Field(default=0.01, gt=0.0, le=0.2)
    still_deg: float = Field(default=1.5, gt=0.0, le=20.0)

    @model_validator(mode="after")
    def _stands_when_still(self) -> Self:
        """Refuse values by which a driving robot would count as standing still."""
        for name, moved, unit, most in (
            ("still_m", self.still_m, "m", _STILL_M_S),
            ("still_deg", self.still_deg, "°", _STILL_DEG_S),
        ):
            if moved > most * self.still_s * (1.0 + 1e-9):
                raise ValueError(
                    f"{name} {moved:g} in still_s {self.still_s:g} is {moved / self.still_s:g} "
                    f"{unit}/s, so a driving robot would count as standing still; expected at most "
                    f"{most:g} {unit}/s: a smaller {name} or a larger still_s"
                )
        return self


class Ros2Config(RoomConfig):
    """A robot on a ROS 2 network.

    Attributes:
        domain: Number of the DDS domain; None takes that of ``ROS_DOMAIN_ID``, else 0.
        cmd_vel_type: Type of the velocity: newer distributions have it stamped.
        topics: Names of the topics.
        frames: Names of the frames.
        timing: What counts as late.
        nav2: How Nav2 drives the robot, where it does.
        speed: Limits of the velocity, where hypernav drives itself; see `driving`.
        embodiment: Body and actions of the robot, and the range of its depth; the rest of the
            camera is taken from camera info and tf.
    """

    domain: int | None = Field(default=None, ge=0, le=_MOST_DOMAINS)
    cmd_vel_type: Literal["Twist", "TwistStamped"] = "Twist"
    topics: TopicsConfig = TopicsConfig()
    frames: FramesConfig = FramesConfig()
    timing: TimingConfig = TimingConfig()
    nav2: Nav2Config = Nav2Config()
    speed: DriveConfig = CAREFUL
    embodiment: Embodiment = Embodiment()

    @property
    def driving(self) -> DriveConfig:
        """Limits of the velocity, for the latest reaction that the timing allows.

        An image may be `fresh_s` old, and a command stays in force for a while if this process
        hangs; the robot's own reaction time is added.
        """
        reaction_s = self.timing.fresh_s + VALID_S + self.speed.reaction_s
        return self.speed.model_copy(update={"reaction_s": reaction_s})

    @property
    def domain_id(self) -> int:
        """Number of the DDS domain.

        Raises:
            ConfigError: ``ROS_DOMAIN_ID`` is not a domain number.
        """
        if self.domain is not None:
            return self.domain
        text = os.environ.get("ROS_DOMAIN_ID") or "0"
        if not (text.isdecimal() and int(text) <= _MOST_DOMAINS):
            raise ConfigError(
                f"ROS_DOMAIN_ID={text:.20}: expected a number from 0 to {_MOST_DOMAINS}"
            )
        return int(text)
