"""A robot in a building that speaks nothing but DDS, in a process of its own and in real time.

Reads commands from its standard input, one a line, and answers each with a line of JSON:
``freeze`` (the camera sends nothing any more), ``lose`` (the odometry doesn't), ``thaw`` (both do
again), ``state``. It ends with its input. On ``/wheels/tf`` its odometry is never lost. A lock,
where it has one, keeps ``/cmd_vel`` from the wheels as that of ``twist_mux`` does.
"""

import argparse
import json
import math
import sys
import threading
import time
from contextlib import closing

import numpy as np
from scipy.spatial.transform import Rotation

from hypernav.app.build.data.scenes import load_scene
from hypernav.core.episode import Episode
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.robot.driving.base import STANDSTILL, Velocity
from hypernav.robot.ros2 import idl_types as ros
from hypernav.robot.ros2.network import Quality, Ros2Network
from hypernav.robot.simulation.base import SimulatedBase
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_worlds import small_config

_WHEELS_S, _IMAGES_S = 0.02, 0.06
_DEADMAN_S = _HELD_S = 0.5
_OPTICAL = "camera_optical_frame"
_BASE_M = 0.1
"""Height of ``base_link`` above the floor."""


class DdsRobot:
    """Wheels and camera, each with a thread and a rate of its own."""

    def __init__(self, base: SimulatedBase, network: Ros2Network, lock: str | None) -> None:
        self._base, self._camera = base, base.embodiment.camera
        self._goal = base.world.truth.goal_truth(Goal("bed"))
        self._command, self._commanded_s, self._held_s = STANDSTILL, 0.0, 0.0
        self._has_lock, self._unlocked_s = lock is not None, 0.0
        self.is_frozen = self.is_lost = False
        self.stopped_s = time.time()
        sensor, reliable = Quality.SENSOR, Quality.RELIABLE
        self._colour = network.publisher("/camera/image_raw", ros.Image, sensor)
        self._depth = network.publisher("/camera/depth/image_raw", ros.Image, sensor)
        self._info = network.publisher("/camera/camera_info", ros.CameraInfo, sensor)
        self._tf = network.publisher("/tf", ros.TFMessage, reliable)
        self._own_tf = network.publisher("/wheels/tf", ros.TFMessage, reliable)
        self._static = network.publisher("/tf_static", ros.TFMessage, Quality.STATIC)
        network.subscribe("/cmd_vel", ros.Twist, reliable, self._take)
        network.subscribe("/stop_cmd_vel", ros.Twist, reliable, self._take_stop)
        if lock is not None:
            network.subscribe(lock, ros.Bool, reliable, self._take_lock)
        mount = optical_to_base(self._camera.height_m - _BASE_M, self._camera.pitch_deg)
        self._static.publish(_pose("base_link", _OPTICAL, mount, time.time()))

    def drive(self, seconds: float) -> None:
        """Drive as told for the time that has really passed, and tell where that led."""
        is_late = time.monotonic() - self._commanded_s > _DEADMAN_S
        self._base.drive(STANDSTILL if is_late else self._command, seconds)
        odometry = self._base.odometry().to_transform(_BASE_M)
        message = _pose("odom", "base_link", odometry, time.time())
        self._own_tf.publish(message)
        if not self.is_lost:
            self._tf.publish(message)

    def look(self) -> None:
        """Tell what is to be seen."""
        if not self.is_frozen:
            self._publish_images(time.time())

    def state(self) -> dict[str, float]:
        """How far from the bed it really is, how it drives, and when it last stopped."""
        return {
            "goal_m": self._goal.distance(*self._base.position),
            "x": self._base.pose.x,
            "y": self._base.pose.y,
            "yaw": self._base.pose.yaw,
            "speed": self._command.linear_m_s,
            "now_s": time.time(),
            "stopped_s": self.stopped_s,
        }

    def _take_stop(self, message: ros.Twist) -> None:
        """Prefer this input to the other for a while, as a multiplexer does."""
        self._obey(message)
        self._held_s = time.monotonic()

    def _take_lock(self, message: ros.Bool) -> None:
        self._unlocked_s = 0.0 if message.data else time.monotonic()

    def _take(self, message: ros.Twist) -> None:
        now_s = time.monotonic()
        is_locked = self._has_lock and now_s - self._unlocked_s > _HELD_S
        if now_s - self._held_s > _HELD_S and not is_locked:
            self._obey(message)

    def _obey(self, message: ros.Twist) -> None:
        was_moving = not self._command.is_zero
        self._command = Velocity(message.linear.x, message.angular.z)
        self._commanded_s = time.monotonic()
        if was_moving and self._command.is_zero:
            self.stopped_s = time.time()

    def _publish_images(self, now_s: float) -> None:
        sensed = self._base.sense()
        header = ros.Header(_time(now_s), _OPTICAL)
        height, width = sensed.depth.shape
        camera = self._camera.intrinsics
        cx, cy = camera.cx - 0.5, camera.cy - 0.5
        k = [camera.fx, 0.0, cx, 0.0, camera.fy, cy, 0.0, 0.0, 1.0]
        p = [*k[:3], 0.0, *k[3:6], 0.0, *k[6:], 0.0]
        turn = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        self._info.publish(
            ros.CameraInfo(header, height, width, "plumb_bob", [0.0] * 5, k, turn, p)
        )
        colour = np.ascontiguousarray(sensed.rgb[:, :, ::-1]).tobytes()
        self._colour.publish(ros.Image(header, height, width, "bgr8", 0, 3 * width, colour))
        depth = np.rint(sensed.depth * 1000.0).astype("<u2").tobytes()
        self._depth.publish(ros.Image(header, height, width, "16UC1", 0, 2 * width, depth))


def _pose(parent: str, child: str, pose: Transform, at_s: float) -> ros.TFMessage:
    x, y, z, w = Rotation.from_matrix(pose.rotation).as_quat().tolist()
    transform = ros.Transform(ros.Vector3(*pose.translation.tolist()), ros.Quaternion(x, y, z, w))
    return ros.TFMessage([ros.TransformStamped(ros.Header(_time(at_s), parent), child, transform)])


def _time(seconds: float) -> ros.Time:
    return ros.Time(int(seconds), int(seconds % 1.0 * 1e9))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--scene", required=True)
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--start", type=float, nargs=3, required=True, metavar=("X", "Y", "DEG"))
    parser.add_argument("--camera", type=int, nargs=2, default=(160, 120))
    parser.add_argument("--lock", metavar="TOPIC")
    options = parser.parse_args()
    config = small_config()
    values = config.embodiment.model_dump()
    values["camera"] |= dict(zip(("width", "height"), options.camera, strict=True))
    embodiment = type(config.embodiment).model_validate(values)
    scene = load_scene(options.scene)
    renderer = CpuRenderer(scene)
    x, y, deg = options.start
    with (
        closing(SimulatedWorld(scene, config.world, embodiment, renderer=renderer)) as world,
        closing(Ros2Network(options.domain)) as network,
    ):
        base = SimulatedBase(world, config.world)
        start = Pose2(x, y, math.radians(deg))
        base.place(Episode(options.scene, "", Goal("bed"), start), np.random.default_rng(0))
        robot, ended = DdsRobot(base, network, options.lock), threading.Event()

        def obey() -> None:
            for line in sys.stdin:
                word = line.strip()
                if word != "state":
                    robot.is_frozen, robot.is_lost = word == "freeze", word == "lose"
                print(json.dumps(robot.state()), flush=True)
            ended.set()

        def look() -> None:
            while not ended.wait(_IMAGES_S):
                robot.look()

        looking = threading.Thread(target=look)
        threading.Thread(target=obey, daemon=True).start()
        looking.start()
        last_s = time.monotonic()
        while not ended.wait(_WHEELS_S):
            now_s = time.monotonic()
            robot.drive(now_s - last_s)
            last_s = now_s
        looking.join()


if __name__ == "__main__":
    main()
