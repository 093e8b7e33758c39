"""Wrong units and signs of a robot's sensors end a search by a sentence that names them."""

import math

import numpy as np
import pytest

from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import SensorError
from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.client.plausible_sensing import PlausibleSensing
from hypernav.robot.client.robot import Sensed

ROBOT = Embodiment.model_validate({"camera": {"width": 8, "height": 8}})
TURN = math.radians(ROBOT.motion.turn_angle_deg)


def sensed(pose=(0.0, 0.0, 0.0), *, stamp_s=0.0, depth=1.0, rgb=np.uint8) -> Sensed:
    return Sensed(
        np.zeros((8, 8, 3), dtype=rgb),
        np.full((8, 8), depth, dtype=np.float32),
        Pose2(*pose),
        stamp_s,
    )


@pytest.mark.parametrize("depth", [0.0, math.nan, 0.2, 4.0, 9.0])
def test_possible_depth_is_taken(depth):
    PlausibleSensing(ROBOT).check(sensed(depth=depth), None, False)


def test_depth_in_millimetres_is_named():
    with pytest.raises(SensorError, match=r"from 2000 to 2000.*in metres"):
        PlausibleSensing(ROBOT).check(sensed(depth=2000.0), None, False)


def test_a_time_before_all_times_is_named():
    with pytest.raises(SensorError, match="stamp_s"):
        PlausibleSensing(ROBOT).check(sensed(stamp_s=-1.0), None, False)


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
    sensing = PlausibleSensing(ROBOT)
    sensing.check(sensed(), None, False)
    sensing.check(sensed(after, stamp_s=1.0), action, False)


@pytest.mark.parametrize(
    ("action", "after", "words"),
    [
        (Action.TURN_LEFT, (0.0, 0.0, -TURN), "REP 103"),
        (Action.TURN_LEFT, (0.0, 0.0, math.degrees(TURN)), "radians"),
        (Action.MOVE_FORWARD, (5.8, 0.0, 0.0), "not jump"),
    ],
    ids=["mirrored", "degrees", "jump"],
)
def test_impossible_motions_are_named(action, after, words):
    sensing = PlausibleSensing(ROBOT)
    sensing.check(sensed(), None, False)
    with pytest.raises(SensorError, match=words):
        sensing.check(sensed(after, stamp_s=1.0), action, False)


def test_a_robot_that_never_moves_is_named():
    sensing = PlausibleSensing(ROBOT)
    for _ in range(39):
        sensing.check(sensed(), Action.MOVE_FORWARD, True)
    with pytest.raises(SensorError, match="40 motions in a row"):
        sensing.check(sensed(), Action.MOVE_FORWARD, True)


def test_a_large_turn_that_was_blocked_is_no_wrong_one():
    robot = Embodiment.model_validate({"motion": {"turn_angle_deg": 90.0}})
    checks = PlausibleSensing(robot)
    checks.check(sensed(), None, False)
    checks.check(sensed(stamp_s=1.0), Action.TURN_LEFT, True)
    with pytest.raises(SensorError, match=r"told to turn \+90"):
        checks.check(sensed(stamp_s=2.0), Action.TURN_LEFT, False)
