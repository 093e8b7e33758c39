"""A robot that takes velocities drives only where its own depth images show no obstacle."""

import math
import threading
from dataclasses import replace

import numpy as np
import pytest

from hypernav.core.embodiment import STAIR_CLIMB_M, Action, BodyConfig, Embodiment
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.client.robot import Executed, Sensed
from hypernav.robot.driving.base import STANDSTILL, DepthView, Velocity
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.driving.obstacles import Ahead, DepthSafety

ROBOT = Embodiment.model_validate({"camera": {"width": 80, "height": 60}})
CAMERA = ROBOT.camera.intrinsics


def seen(
    pole: tuple[float, float] | None = None,
    robot: Pose2 | None = None,
    *,
    stamp_s: float = 0.0,
    missing: float = 0.0,
    edge_x: float = math.inf,
) -> DepthView:
    """An endless floor with a pole of 20 cm radius, as the robot's camera measures it.

    Beyond an edge it lies 0.5 m lower.
    """
    robot = robot or Pose2(0.0, 0.0, 0.0)
    to_base = ROBOT.camera.camera_to_base
    rays = CAMERA.rays() @ to_base.rotation.T
    down = rays[..., 2] < 0.0
    depth = np.where(down, -to_base.translation[2] / np.where(down, rays[..., 2], -1.0), np.inf)
    far = robot.x + math.cos(robot.yaw) * depth * rays[..., 0] if edge_x < math.inf else 0.0
    depth = np.where(far > edge_x, depth * (1.0 + 0.5 / to_base.translation[2]), depth)
    if pole is not None:
        x, y = robot.to_transform().inverse().apply(np.array([[*pole, 0.0]]))[0, :2]
        a = (rays[..., :2] ** 2).sum(axis=-1)
        b = -(rays[..., 0] * x + rays[..., 1] * y)
        root = b**2 - a * (x * x + y * y - 0.2**2)
        near = np.where(root > 0.0, (-b - np.sqrt(np.maximum(root, 0.0))) / a, np.inf)
        depth = np.minimum(depth, np.where(near > 0.0, near, np.inf))
    lens = ROBOT.camera
    measured = (depth > lens.min_depth_m) & (depth < lens.max_depth_m)
    image = np.where(measured, depth, missing).astype(np.float32)
    return DepthView(image, CAMERA, to_base, stamp_s, robot)


class FloorBase:
    """Wheels that do what they are told, on a floor with a pole that can be taken away."""

    def __init__(
        self,
        pole: tuple[float, float] | None = None,
        *,
        stuck: bool = False,
        edge_x: float = math.inf,
        crossed: bool = False,
    ) -> None:
        self.embodiment, self.edge_x, self.crossed = ROBOT, edge_x, crossed
        self.pose, self.pole, self.stuck = Pose2(0.0, 0.0, 0.0), pole, stuck
        self.moving, self.ticks = threading.Event(), 0
        self.pole_stays = 10**9
        self.camera_hangs_at = 10**9

    def sense(self) -> Sensed:
        raise NotImplementedError

    def odometry(self) -> Pose2:
        return self.pose

    def depth_view(self) -> DepthView:
        pole = self.pole if self.ticks < self.pole_stays else None
        stamp_s = min(self.ticks, self.camera_hangs_at) / 10.0
        return seen(pole, self.pose, stamp_s=stamp_s, edge_x=self.edge_x)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        self.ticks += 1
        self.moving.set()
        if self.crossed:
            velocity = Velocity(velocity.linear_m_s, -velocity.angular_rad_s)
        if not self.stuck:
            self.pose = velocity.moved(self.pose, seconds)

    def halt(self) -> None:
        return None


def test_steps_and_turns_are_made_exactly():
    base = FloorBase()
    robot = DrivenRobot(base)
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD, Action.TURN_RIGHT):
        assert robot.execute(action) is Executed.DONE
    assert base.pose.x == pytest.approx(0.5 + 0.5 * math.cos(math.radians(30.0)), abs=0.005)
    assert base.pose.y == pytest.approx(0.5 * math.sin(math.radians(30.0)), abs=0.005)
    assert base.pose.yaw == pytest.approx(0.0, abs=0.003)


def test_it_waits_for_what_is_in_its_way_and_says_so_if_it_stays():
    base = FloorBase(pole=(0.75, 0.0))
    robot = DrivenRobot(base, patience_s=2.0)
    assert robot.execute(Action.MOVE_FORWARD) is Executed.BLOCKED
    assert base.pose.x + ROBOT.body.radius_m < 0.75 - 0.2
    assert robot.waits == 1


def test_a_rotation_too_slow_to_notice_is_no_motion():
    """What is left to turn after rounding is no reason to wait for ever."""
    base = FloorBase()
    base.pose = Pose2(4.226411214167034, 0.9319804534843522, 1.089428786299802)
    base.pole = base.pose.ahead(0.45).xy
    robot = DrivenRobot(base, patience_s=2.0)
    path = [(4.086457932345431, 1.1195757459359463), (4.275, 1.025)]
    assert robot.follow(path, lambda _: base.ticks > 400) is Executed.BLOCKED
    assert robot.waits == 1


def test_turning_that_leads_nowhere_comes_to_an_end():
    """With crossed wires it turns away from where it wants to look, and never arrives."""
    base = FloorBase(crossed=True)
    robot = DrivenRobot(base)
    assert robot.execute(Action.TURN_LEFT) is Executed.BLOCKED
    assert robot.follow([(0.0, 0.0), (0.0, 2.0)], lambda _: False) is Executed.BLOCKED
    assert base.ticks < 250


def test_it_goes_on_when_the_way_is_free_again():
    base = FloorBase(pole=(0.75, 0.0))
    base.pole_stays = 60
    robot = DrivenRobot(base)
    assert robot.execute(Action.MOVE_FORWARD) is Executed.DONE
    assert base.pose.x == pytest.approx(0.5, abs=0.005)


def test_what_is_beside_its_way_is_none_of_its_business():
    base = FloorBase(pole=(0.8, 0.6))
    assert DrivenRobot(base).execute(Action.MOVE_FORWARD) is Executed.DONE


@pytest.mark.parametrize("action", [Action.MOVE_FORWARD, Action.TURN_LEFT])
def test_wheels_that_do_not_turn_are_noticed(action):
    assert DrivenRobot(FloorBase(stuck=True)).execute(action) is Executed.BLOCKED


class LateBase(FloorBase):
    """Wheels that do what they were told two ticks ago, as over a network."""

    def __init__(self) -> None:
        super().__init__()
        self._told = [STANDSTILL, STANDSTILL]

    def drive(self, velocity: Velocity, seconds: float) -> None:
        self._told.append(velocity)
        super().drive(self._told.pop(0), seconds)


@pytest.mark.parametrize("action", [Action.MOVE_FORWARD, Action.TURN_LEFT])
def test_wheels_that_turn_late_are_not_blocked(action):
    base = LateBase()
    assert DrivenRobot(base).execute(action) is Executed.DONE
    assert base.ticks < 60


class LateCamera(FloorBase):
    """A camera whose images show what was two ticks ago."""

    def __init__(self, pole: tuple[float, float]) -> None:
        super().__init__(pole)
        self._taken: list[DepthView] = []

    def depth_view(self) -> DepthView:
        self._taken.append(super().depth_view())
        return self._taken[max(len(self._taken) - 3, 0)]


def test_a_late_image_shows_where_things_are_and_not_where_they_seem_from_here(monkeypatch):
    shown, look = [], DepthSafety.look

    def noted(safety: DepthSafety, view: DepthView) -> Ahead:
        shown.append(look(safety, view))
        return shown[-1]

    monkeypatch.setattr(DepthSafety, "look", noted)
    base = LateCamera(pole=(1.5, 0.0))
    assert DrivenRobot(base).execute(Action.MOVE_FORWARD) is Executed.DONE
    front = np.array([[1.3, 0.0]])
    assert max(ahead.obstacles.distances(front)[0] for ahead in shown) < 0.05


def test_stop_ends_a_motion_from_another_thread():
    base = FloorBase(pole=(0.6, 0.0))
    robot, outcome = DrivenRobot(base, patience_s=1e6), []
    motion = threading.Thread(target=lambda: outcome.append(robot.execute(Action.MOVE_FORWARD)))
    motion.start()
    assert base.moving.wait(30.0)
    robot.stop()
    motion.join(30.0)
    assert outcome == [Executed.STOPPED]


@pytest.mark.parametrize("missing", [0.0, math.nan, math.inf])
def test_something_too_near_to_be_measured_makes_it_blind(missing):
    safety = DepthSafety(ROBOT)
    assert not safety.look(seen(missing=missing)).is_blind
    assert DepthSafety(ROBOT).look(seen(pole=(0.6, 0.0), missing=missing)).is_blind


def test_a_camera_that_hangs_makes_it_blind():
    base = FloorBase()
    base.camera_hangs_at = 3
    assert DrivenRobot(base, patience_s=1.0).execute(Action.MOVE_FORWARD) is Executed.BLOCKED
    assert base.pose.x < 0.3


def test_a_slow_camera_does_not():
    safety = DepthSafety(ROBOT)
    looks = [safety.look(seen(stamp_s=tick // 3)) for tick in range(12)]
    assert not any(ahead.is_blind for ahead in looks)


def test_what_came_too_near_to_be_measured_is_remembered():
    safety = DepthSafety(ROBOT)
    far, near = Pose2(0.0, 0.0, 0.0), Pose2(0.45, 0.0, 0.0)
    point = np.array([[0.8, 0.0]])
    before = safety.look(seen((1.0, 0.0), far)).obstacles.distances(point)[0]
    after = safety.look(seen((1.0, 0.0), near)).obstacles.distances(point)[0]
    fresh = DepthSafety(ROBOT).look(seen((1.0, 0.0), near)).obstacles.distances(point)[0]
    assert before < 0.05
    assert after < 0.05
    assert fresh > 0.05


def low_box(x: float, robot: Pose2) -> DepthView:
    """A floor with a wide box of 25 cm height, whose front is at x, as the camera measures it."""
    view, ahead_m = seen(robot=robot, stamp_s=robot.x), x - robot.x
    rays, eye_z = CAMERA.rays() @ view.camera_to_base.rotation.T, view.camera_to_base.translation[2]
    front = ahead_m / rays[..., 0]
    is_box = (front > 0.0) & (np.abs(eye_z + front * rays[..., 2] - 0.125) <= 0.125)
    return replace(view, depth=np.where(is_box, front, view.depth).astype(np.float32))


def test_what_slipped_below_the_image_is_remembered():
    safety, box = DepthSafety(ROBOT), np.array([[1.1, 0.0]])
    far, near = low_box(1.1, Pose2(0.0, 0.0, 0.0)), low_box(1.1, Pose2(0.5, 0.0, 0.0))
    assert not np.array_equal(far.depth, seen().depth)
    assert np.array_equal(near.depth, seen().depth)
    assert safety.look(far).obstacles.distances(box)[0] < 0.05
    assert safety.look(near).obstacles.distances(box)[0] < 0.05


def test_what_is_gone_from_the_image_is_forgotten():
    safety, box = DepthSafety(ROBOT), np.array([[1.1, 0.0]])
    safety.look(low_box(1.1, Pose2(0.0, 0.0, 0.0)))
    gone = replace(seen(), stamp_s=1.0)
    assert safety.look(gone).obstacles.distances(box)[0] > 0.5


@pytest.mark.slow
def test_it_stops_before_the_head_of_stairs_although_the_edge_leaves_the_image():
    base = FloorBase(edge_x=2.2)
    robot = DrivenRobot(base, patience_s=20.0)  # longer than what is in its way is remembered
    done = [robot.execute(Action.MOVE_FORWARD) for _ in range(6)]
    assert done[0] is Executed.DONE
    assert done[-1] is Executed.BLOCKED
    gap_m = base.edge_x - base.pose.x
    assert ROBOT.body.radius_m < gap_m < 1.0, "it sees no floor nearer than 1.4 m"


def test_a_drop_is_forgotten_where_floor_is_seen_and_where_the_robot_has_left_it():
    safety, edge = DepthSafety(ROBOT), np.array([[2.0, 0.0]])
    start = Pose2(0.0, 0.0, 0.0)
    assert safety.look(seen(robot=start, edge_x=1.9)).obstacles.distances(edge)[0] < 0.2
    assert safety.look(seen(robot=start)).obstacles.distances(edge)[0] > 1.0
    safety.look(seen(robot=start, edge_x=1.9))
    assert safety.look(seen(robot=Pose2(-3.0, 0.0, math.pi))).obstacles.distances(edge)[0] > 1.0


def test_a_robot_that_climbs_takes_stairs_for_no_drop():
    climber = ROBOT.model_copy(update={"body": BodyConfig(max_step_m=STAIR_CLIMB_M)})
    ahead = DepthSafety(climber).look(seen(edge_x=1.9))
    assert ahead.obstacles.distances(np.array([[2.0, 0.0]]))[0] > 1.0


@pytest.mark.parametrize("instead", [0.0, 0.8], ids=["no return", "somebody before it"])
def test_a_drop_is_remembered_where_an_image_does_not_show_floor(instead):
    safety, lower = DepthSafety(ROBOT), seen(edge_x=1.9)
    safety.look(lower)
    depth = np.where(lower.depth == seen().depth, lower.depth, np.float32(instead))
    ahead = safety.look(replace(lower, depth=depth))
    assert ahead.obstacles.distances(np.array([[2.0, 0.0]]))[0] < 0.2


@pytest.mark.parametrize("tilt_deg", [2.0, 4.0])
def test_single_pixels_and_a_camera_that_points_higher_than_is_known_make_no_drop(tilt_deg):
    view = seen()
    depth = view.depth.copy()
    depth[::6, ::6] = 5.0
    tilted = optical_to_base(ROBOT.camera.height_m, ROBOT.camera.pitch_deg + tilt_deg)
    ahead = DepthSafety(ROBOT).look(replace(view, depth=depth, camera_to_base=tilted))
    assert ahead.obstacles.distances(np.array([[1.5, 0.0], [2.0, 0.5]])).min() > 0.5
