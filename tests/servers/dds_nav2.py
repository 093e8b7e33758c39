"""A navigation that speaks nothing but DDS, in a process of its own: straight lines and turns.

Takes ``/goal_pose`` in the frame ``odom``, or in ``base_link`` where its own odometry has that, and
drives the robot there by ``/cmd_vel``; a later goal replaces the one before. Ends with its standard
input.
"""

import argparse
import math
import sys
import threading
import time
from contextlib import closing

from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2.network import Quality, Ros2Network

_PERIOD_S = 0.05
_SPEED_M_S, _RATE_RAD_S = 0.4, 1.2
_NEAR_M, _NEAR_RAD = 0.06, 0.06
_ASIDE_RAD = 0.2


class Nav2:
    """Drives to the last goal."""

    def __init__(self, network: Ros2Network, tf: str, *, is_asleep: bool, replans_s: float) -> None:
        self._is_asleep, self._replans_s = is_asleep, replans_s
        self._next: Pose2 | None = None
        self._planned_s = 0.0
        self._robot: Pose2 | None = None
        self._goal: Pose2 | None = None
        self._wheels = network.publisher("/cmd_vel", ros.Twist)
        network.subscribe(tf, ros.TFMessage, Quality.RELIABLE, self._see)
        network.subscribe("/goal_pose", ros.PoseStamped, Quality.RELIABLE, self._take)

    def drive(self) -> None:
        """Tell the wheels the next velocity, as long as there is a goal."""
        if self._next is not None and time.monotonic() - self._planned_s >= self._replans_s:
            self._goal, self._next, self._planned_s = self._next, None, time.monotonic()
        robot, goal = self._robot, self._goal
        if robot is None or goal is None or self._is_asleep:
            return
        velocity = _towards(goal, robot)
        if velocity == (0.0, 0.0):
            self._goal = None
        linear, angular = velocity
        self._wheels.publish(ros.Twist(ros.Vector3(linear), ros.Vector3(z=angular)))

    def _see(self, message: ros.TFMessage) -> None:
        for one in message.transforms:
            at, turn = one.transform.translation, one.transform.rotation
            self._robot = Pose2(at.x, at.y, 2.0 * math.atan2(turn.z, turn.w))

    def _take(self, message: ros.PoseStamped) -> None:
        at, turn = message.pose.position, message.pose.orientation
        goal = Pose2(at.x, at.y, 2.0 * math.atan2(turn.z, turn.w))
        if message.header.frame_id == "base_link":
            assert self._robot is not None
            assert goal == Pose2(0.0, 0.0, 0.0)
            goal = self._robot
        else:
            assert message.header.frame_id == "odom"
        self._next = goal


def _towards(goal: Pose2, robot: Pose2) -> tuple[float, float]:
    """Speed and rate of rotation; both 0 at the goal."""
    away_m = robot.distance_to(*goal.xy)
    if away_m > _NEAR_M:
        bearing = robot.bearing_to(*goal.xy)
        rate = max(-_RATE_RAD_S, min(3.0 * bearing, _RATE_RAD_S))
        return (0.0 if abs(bearing) > _ASIDE_RAD else min(_SPEED_M_S, 2.0 * away_m), rate)
    turn = wrap_angle(goal.yaw - robot.yaw)
    if abs(turn) <= _NEAR_RAD:
        return (0.0, 0.0)
    return (0.0, math.copysign(min(_RATE_RAD_S, max(3.0 * abs(turn), 0.2)), turn))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--tf", default="/tf", help="topic of its odometry")
    parser.add_argument("--asleep", action="store_true", help="take goals and never move")
    parser.add_argument("--replans", type=float, default=0.0, metavar="SECONDS")
    options = parser.parse_args()
    with closing(Ros2Network(options.domain)) as network:
        nav2 = Nav2(network, options.tf, is_asleep=options.asleep, replans_s=options.replans)
        ended = threading.Event()

        def wait() -> None:
            sys.stdin.read()
            ended.set()

        threading.Thread(target=wait, daemon=True).start()
        while not ended.wait(_PERIOD_S):
            nav2.drive()


if __name__ == "__main__":
    main()
