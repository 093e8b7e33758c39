"""Laws of the messages: what is sent is read, and what no robot could mean is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from hypernav.core.embodiment import Action
from hypernav.core.geometry.camera import optical_to_base
from hypernav.robot.wire.replies import Reply, StreamMessage
from hypernav.robot.wire.requests import Intrinsics, ObservationFacts, OpenSearch
from hypernav.robot.wire.values import PlanarPose

POSES = st.builds(
    PlanarPose,
    x=st.floats(-200, 200),
    y=st.floats(-200, 200),
    yaw=st.floats(-10, 10),
    z=st.floats(-5, 5),
)


def facts(**others) -> ObservationFacts:
    values = {"sequence": 0, "stamp_s": 0.0, "base_to_odom": {"x": 0.0}} | others
    return ObservationFacts.model_validate(values)


@given(POSES, POSES)
def test_localisation_moves_the_odometry_frame(base_to_odom, odom_to_map):
    header = facts(base_to_odom=base_to_odom, odom_to_map=odom_to_map)
    point = np.array([[0.3, -0.2, 0.1]])
    in_odom = base_to_odom.transform.apply(point)
    assert header.base_to_map.apply(point) == pytest.approx(odom_to_map.transform.apply(in_odom))


def test_a_reply_survives_the_wire():
    reply = Reply(
        sequence=3, action=Action.MOVE_FORWARD, path=((0.0, 1.0), (2.0, 3.0)), reason="there"
    )
    message = StreamMessage(reply=reply)
    assert StreamMessage.model_validate_json(message.model_dump_json()) == message


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e999", "501", "null"])
def test_a_pose_is_finite_and_near(number):
    text = f'{{"sequence": 0, "stamp_s": 0.0, "base_to_odom": {{"x": {number}}}}}'
    with pytest.raises(ValidationError):
        ObservationFacts.model_validate_json(text)


def test_unknown_fields_are_named():
    with pytest.raises(ValidationError, match="speed"):
        facts(speed=3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda m: m * 1.01, "rigid"),
        (lambda m: m @ np.diag([1.0, 1.0, -1.0, 1.0]), "mirrors"),
        (lambda m: m + np.eye(4)[3] * 0.5, "last row"),
        (lambda m: m + 20.0 * np.outer([1.0, 0, 0, 0], [0, 0, 0, 1.0]), "within 10 m"),
    ],
)
def test_a_camera_sits_rigidly_on_the_robot(change, words):
    matrix = optical_to_base(0.9, 10.0).matrix
    assert facts(camera_to_base=matrix.tolist()).camera_to_base is not None
    with pytest.raises(ValidationError, match=words):
        facts(camera_to_base=change(matrix).tolist())


def test_a_calibration_says_the_field_of_view():
    request = OpenSearch(goal="bed", intrinsics=Intrinsics(fx=320.0, fy=320.0, cx=320.0, cy=240.0))
    assert request.robot.camera.hfov_deg == pytest.approx(90.0)
    assert request.camera.fx == 320.0
    assert math.degrees(OpenSearch(goal="bed").camera.hfov) == pytest.approx(79.0)


@pytest.mark.parametrize("fx", [20.0, 7400.0, 13_000.0, 90_000.0])
def test_a_calibration_that_no_camera_may_have_is_refused(fx: float):
    intrinsics = Intrinsics(fx=fx, fy=fx, cx=320.0, cy=240.0)
    with pytest.raises(ValidationError, match="expected hfov_deg from 5 to 170"):
        OpenSearch(goal="bed", intrinsics=intrinsics)


@given(fx=st.floats(29.0, 7300.0))
def test_a_calibration_between_the_bounds_means_a_robot(fx: float):
    intrinsics = Intrinsics(fx=fx, fy=fx, cx=320.0, cy=240.0)
    assert OpenSearch(goal="bed", intrinsics=intrinsics).robot.camera.hfov_deg < 170.0


@pytest.mark.parametrize("key", ["short", "../../etc/passwd", "a" * 65, "with space"])
def test_a_key_is_one_plain_word(key):
    with pytest.raises(ValidationError):
        OpenSearch(goal="bed", key=key)


@pytest.mark.parametrize("agent", ["os:system", "a.b:C", "", "-x", "frontier\n"])
def test_an_agent_of_a_stranger_is_a_plain_name(agent):
    with pytest.raises(ValidationError):
        OpenSearch(goal="bed", agent=agent)
