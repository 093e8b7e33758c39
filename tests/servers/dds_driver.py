"""hypernav in a process of its own, which drives the robot straight ahead by Nav2.

Its arguments are settings of the file about a robot.
"""

import math
import sys
from contextlib import closing

from hypernav.io.layered_config import layered
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.nav2_robot import Nav2Robot
from hypernav.robot.ros2.network import Ros2Network
from hypernav.robot.ros2.sensors import Ros2Sensors

_LENGTH_M = 20.0


def main() -> None:
    config = layered(Ros2Config(), environment={}, assignments=sys.argv[1:])
    with closing(Ros2Network(config.domain_id)) as network:
        robot = Nav2Robot(network, config, Ros2Sensors(network, config))
        here = robot.odometry()
        end = (here.x + _LENGTH_M * math.cos(here.yaw), here.y + _LENGTH_M * math.sin(here.yaw))
        robot.follow([here.xy, end], lambda _: False)


if __name__ == "__main__":
    main()
