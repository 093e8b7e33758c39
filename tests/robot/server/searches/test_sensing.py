"""Wrong and stale data of a robot end its search by a sentence that names the mistake."""

import math

import numpy as np
import pytest

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import SensorError
from hypernav.robot.server.searches.sensing import Sensing
from hypernav.robot.wire.frames import decode_observation, pack_observation, unpack_observation
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose

ROBOT = Embodiment.model_validate({"camera": {"width": 8, "height": 8}})
TURN = math.radians(ROBOT.motion.turn_angle_deg)


class Robot:
    """A robot whose every image is new, unless it is told otherwise."""

    def __init__(self, robot: Embodiment = ROBOT) -> None:
        self.lens = robot.camera
        self.sensing = Sensing(robot)
        self.count = 0
        self.rng = np.random.default_rng(0)
        self.new_images()

    def new_images(self) -> None:
        self.rgb = self.rng.integers(0, 255, (8, 8, 3), dtype=np.uint8)
        self.depth = self.rng.uniform(1.0, 3.0, (8, 8)).astype(np.float32)

    def senses(
        self,
        pose: tuple[float, ...] = (0.0, 0.0, 0.0),
        told: Action | None = None,
        *,
        depth: float | None = None,
        is_new: bool = True,
        **facts: object,
    ) -> None:
        """The next observation, which is checked and noted."""
        if is_new:
            self.new_images()
        said = ObservationFacts.model_validate(
            {
                "sequence": self.count,
                "stamp_s": float(self.count),
                "base_to_odom": PlanarPose(x=pose[0], y=pose[1], yaw=pose[2], z=sum(pose[3:])),
            }
            | facts
        )
        far = self.depth if depth is None else np.full_like(self.depth, depth)
        packed = unpack_observation(pack_observation(said, self.rgb, far, jpeg_quality=None))
        seen = decode_observation(packed, self.lens.intrinsics, self.lens.camera_to_base)
        self.sensing.check(packed, seen, told)
        self.sensing.note(packed, seen, told)
        self.count += 1


@pytest.mark.parametrize("depth", [0.0, math.nan, 0.2, 4.0, 9.0])
def test_possible_depth_is_taken(depth):
    Robot().senses(depth=depth)


def test_depth_in_millimetres_is_named():
    with pytest.raises(SensorError, match=r"from 65\.535 to 65\.535.*in metres"):
        Robot().senses(depth=2000.0)


@pytest.mark.parametrize(
    ("action", "after"),
    [
        (Action.TURN_LEFT, (0.0, 0.0, TURN)),
        (Action.TURN_RIGHT, (0.0, 0.0, -0.7 * TURN)),
        (Action.TURN_RIGHT, (0.0, 0.0, 0.05)),  # blocked wheels and drift
        (Action.MOVE_FORWARD, (0.6, 0.1, 0.2)),
        (Action.MOVE_FORWARD, (0.0, 0.0, 0.0)),
    ],
)
def test_possible_motions_are_taken(action, after):
    robot = Robot()
    robot.senses()
    robot.senses(after, action)


@pytest.mark.parametrize(
    ("step", "yaw", "words"),
    [
        ((-0.5, 0.0), 0.0, r"forward.* 0\.50 m at 180° to its heading.*REP 103"),
        ((0.0, 0.5), 0.0, "at 90° to its heading"),
        ((0.5, 0.0), 2.0, "at 115° to its heading"),
    ],
)
def test_steps_in_another_direction_are_named(step, yaw, words):
    robot, at = Robot(), np.zeros(2)
    robot.senses((*at, yaw))
    for _ in range(2):
        at += step
        robot.senses((*at, yaw), Action.MOVE_FORWARD)
        robot.senses((*at, yaw + TURN), Action.TURN_LEFT)  # turns in between change nothing
        robot.senses((*at, yaw), Action.TURN_RIGHT)
    at += step
    with pytest.raises(SensorError, match=words):
        robot.senses((*at, yaw), Action.MOVE_FORWARD)


def test_steps_that_never_happen_are_named_though_turns_do():
    robot = Robot()
    robot.senses()
    yaw = 0.0
    for _ in range(39):
        robot.senses((0.0, 0.0, yaw), Action.MOVE_FORWARD, blocked=True)
        yaw += TURN
        robot.senses((0.0, 0.0, yaw), Action.TURN_LEFT)
    with pytest.raises(SensorError, match="40 steps in a row"):
        robot.senses((0.0, 0.0, yaw), Action.MOVE_FORWARD, blocked=True)


def test_a_room_that_looks_the_same_from_two_sides_is_no_frozen_camera():
    robot = Robot()
    robot.senses()
    seen = robot.depth
    robot.senses((0.0, 0.0, TURN), Action.TURN_LEFT)
    robot.new_images()
    robot.depth = seen
    robot.senses((0.0, 0.0, 2 * TURN), Action.TURN_LEFT, is_new=False)


@pytest.mark.parametrize(
    ("turned", "words"),
    [
        (2 * TURN, r"\+30°.* \+60°"),
        (-TURN, r"\+30°.* -30°.*REP 103"),
        (math.degrees(TURN), "radians"),
    ],
)
def test_turns_of_another_sign_or_unit_are_named(turned, words):
    robot = Robot()
    robot.senses()
    for number in (1, 2):
        robot.senses((0.0, 0.0, number * turned), Action.TURN_LEFT)
    with pytest.raises(SensorError, match=words):
        robot.senses((0.0, 0.0, 3 * turned), Action.TURN_LEFT)


def test_a_robot_that_is_pushed_is_not_wrong():
    robot = Robot()
    for number, told in enumerate((None, *3 * (Action.TURN_LEFT, Action.TURN_RIGHT))):
        robot.senses((0.0, 0.0, -number * TURN), told)


@pytest.mark.parametrize("after", [(5.8, 0.0, 0.0), (0.0, -100.0, 0.0), (0.0, 0.0, 0.0, 90.0)])
def test_odometry_that_jumps_is_named(after):
    robot = Robot()
    robot.senses()
    with pytest.raises(SensorError, match="may drift, but not jump"):
        robot.senses(after, Action.MOVE_FORWARD)


def test_a_robot_that_was_driven_while_nobody_asked_has_not_jumped():
    robot = Robot()
    robot.senses()
    robot.senses((15.0, 0.0, 0.0), stamp_s=11.0)
    with pytest.raises(SensorError, match="not jump"):
        robot.senses((115.0, 0.0, 0.0), stamp_s=10_000.0)


def test_a_localisation_may_jump():
    robot = Robot()
    robot.senses()
    robot.senses(odom_to_map={"x": 100.0})


def test_a_robot_that_never_moves_is_named():
    robot = Robot()
    for _ in range(40):
        robot.senses(told=Action.MOVE_FORWARD, blocked=robot.count > 0)
    with pytest.raises(SensorError, match="40 steps in a row"):
        robot.senses(told=Action.MOVE_FORWARD, blocked=True)


def test_a_large_turn_that_was_blocked_is_no_wrong_one():
    motion = ROBOT.motion.model_copy(update={"turn_angle_deg": 90.0})
    robot = Robot(ROBOT.model_copy(update={"motion": motion}))
    robot.senses()
    for _ in range(3):
        robot.senses(told=Action.TURN_LEFT, blocked=True)
    for _ in range(2):
        robot.senses(told=Action.TURN_LEFT)
    with pytest.raises(SensorError, match=r"told to turn \+90"):
        robot.senses(told=Action.TURN_LEFT)


@pytest.mark.parametrize(
    ("stamp_s", "words"), [(0.0, "observation 0 again"), (-0.0, "again"), (0.9, "went back")]
)
def test_a_time_that_does_not_go_on_is_named(stamp_s, words):
    robot = Robot()
    if words == "went back":
        robot.senses(stamp_s=1.0)
    else:
        robot.senses()
    with pytest.raises(SensorError, match=words):
        robot.senses((0.3, 0.0, 0.0), stamp_s=stamp_s)


@pytest.mark.parametrize("pose", [(0.2, 0.0, 0.0), (0.0, 0.0, 0.2)])
def test_images_of_elsewhere_are_named_at_once(pose):
    robot = Robot()
    robot.senses()
    with pytest.raises(SensorError, match=r"the colour image .* byte for byte.* frozen"):
        robot.senses(pose, is_new=False)


def test_a_depth_camera_that_is_frozen_but_for_a_pixel_is_named():
    robot = Robot()
    robot.senses()
    robot.rgb = robot.rgb + 1
    robot.depth[3, 4] = 1.5
    robot.senses((0.5, 0.0, 0.0), Action.MOVE_FORWARD, is_new=False)  # a corridor may look so
    robot.depth[3, 4] = 1.6
    robot.rgb = robot.rgb + 1
    with pytest.raises(SensorError, match=r"98\.41% of the depth of observation 2.*frozen"):
        robot.senses((0.5, 0.0, TURN), Action.TURN_LEFT, is_new=False)


def test_a_hall_with_one_thing_looks_the_same_in_all_directions_but_one():
    """Level floor is as far away in all of a row, so that a turn doesn't change it."""
    robot = Robot()
    rows = np.linspace(1.0, 4.0, robot.depth.shape[0], dtype=np.float32)
    robot.depth[:] = rows[:, None]
    robot.depth[3, 4] = 0.8
    robot.senses(is_new=False)
    robot.depth[:] = rows[:, None]
    robot.depth[3, 6] = 0.8
    robot.rgb = robot.rgb + 1
    robot.senses((0.0, 0.0, TURN), Action.TURN_LEFT, is_new=False)


def test_a_depth_camera_that_clips_may_see_nothing_but_its_limit_again():
    robot = Robot()
    robot.depth[:] = 2.5
    robot.depth[3, 4] = 1.5
    robot.senses(is_new=False)
    robot.rgb = robot.rgb + 1
    robot.depth[3, 4], robot.depth[3, 5] = 2.5, 1.5
    robot.senses((0.0, 0.0, TURN), Action.TURN_LEFT, is_new=False)


def test_one_frozen_camera_of_two_is_named():
    robot = Robot()
    robot.senses()
    robot.rgb = robot.rng.integers(0, 255, (8, 8, 3), dtype=np.uint8)
    with pytest.raises(SensorError, match="the depth image of observation 1"):
        robot.senses((0.2, 0.0, 0.0), is_new=False)


def test_a_loop_of_images_is_named():
    robot = Robot()
    robot.senses()
    first = robot.rgb, robot.depth
    robot.senses((0.3, 0.0, 0.0))
    robot.rgb, robot.depth = first
    with pytest.raises(SensorError, match="is that of observation 0"):
        robot.senses((0.6, 0.0, 0.0), is_new=False)


def test_an_image_that_creeps_along_is_named():
    robot = Robot()
    robot.senses()
    robot.senses((0.08, 0.0, 0.0), is_new=False)
    with pytest.raises(SensorError, match="frozen"):
        robot.senses((0.16, 0.0, 0.0), is_new=False)


def test_a_robot_that_stands_sees_the_same_again_a_few_times():
    robot = Robot()
    for _ in range(5):
        robot.senses(is_new=robot.count == 0)
    robot.senses()
    for _ in range(4):
        robot.senses(is_new=False)
    with pytest.raises(SensorError, match="the last 6 observations are the same"):
        robot.senses(is_new=False)


def test_images_of_one_colour_and_without_any_depth_may_come_again():
    robot = Robot()
    robot.rgb = np.zeros((8, 8, 3), dtype=np.uint8)
    robot.senses(is_new=False, depth=0.0)
    robot.senses((0.4, 0.0, 0.0), is_new=False, depth=0.0)


def test_a_robot_that_sees_no_depth_for_too_long_is_named():
    robot = Robot()
    for _ in range(23):
        robot.senses(depth=0.0)
    assert robot.sensing.blind == 23
    with pytest.raises(SensorError, match="24 images without any depth"):
        robot.senses(depth=0.0)


@pytest.mark.parametrize("grey", [0, None])
def test_a_covered_camera_that_repeats_its_image_is_blind_not_frozen(grey):
    robot = Robot()
    robot.rgb = robot.rgb if grey is None else np.full((8, 8, 3), grey, dtype=np.uint8)
    for _ in range(23):
        robot.senses(depth=0.0, is_new=False)
    with pytest.raises(SensorError, match="24 images without any depth"):
        robot.senses(depth=0.0, is_new=False)


def test_a_clock_that_is_set_forward_is_taken_and_one_that_ends_is_named():
    robot = Robot()
    robot.senses(stamp_s=12.0)
    robot.senses((0.3, 0.0, 0.0), stamp_s=1.8e9)
    robot.senses((0.6, 0.0, 0.0), stamp_s=1e12)
    with pytest.raises(SensorError, match="observation 2 again"):
        robot.senses((0.9, 0.0, 0.0), stamp_s=1e12)
