import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.errors import StartError, WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.config import NoiseConfig, SimulationConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.goal_regions import random_start
from navmesh_files import content_of, two_floors
from small_episodes import episode_from

SMALL = CameraConfig(width=64, height=48)
BED = ("bed", (4.4, 1.0, 0.0), (6.0, 3.0, 0.5))
RUG = ("rug", (2.0, 0.3, 0.0), (3.0, 3.7, 0.04))
START = Pose2(1.0, 2.0, 0.0)


def world_of(*boxes, **options) -> SimulatedWorld:
    embodiment = Embodiment(camera=options.pop("camera", SMALL))
    return SimulatedWorld(scene_of(*room_boxes(), *boxes), SimulationConfig(**options), embodiment)


@pytest.fixture(scope="module")
def world() -> SimulatedWorld:
    return world_of(BED, RUG)


actions = st.lists(
    st.sampled_from([Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT]), max_size=12
)


def test_the_map_frame_starts_at_the_start_pose(world):
    observation = world.reset(episode_from(Pose2(1.5, 2.0, 0.7)))
    assert observation.robot == Pose2(0.0, 0.0, 0.0)
    assert observation.camera_to_map.translation == pytest.approx([0.0, 0.0, 0.88])
    optical_axis = observation.camera_to_map.rotation @ [0.0, 0.0, 1.0]
    assert optical_axis == pytest.approx([1.0, 0.0, 0.0])


def test_habitats_camera_is_the_default():
    camera = CameraConfig().intrinsics
    assert (camera.width, camera.height) == (640, 480)
    assert math.degrees(camera.hfov) == pytest.approx(79.0)


@settings(max_examples=25, deadline=None)
@given(actions, st.floats(-math.pi, math.pi))
def test_map_to_scene_takes_the_reported_pose_to_the_true_one(world, sequence, yaw):
    observation = world.reset(episode_from(Pose2(1.2, 1.5, yaw)))
    for action in sequence:
        observation = world.step(action)
    reported = np.array([observation.robot.x, observation.robot.y, 0.0])
    assert world.map_to_scene.apply(reported)[:2] == pytest.approx(world.pose.xy, abs=1e-9)
    turned = world.map_to_scene.yaw + observation.robot.yaw - world.pose.yaw
    assert math.cos(turned) == pytest.approx(1.0)
    assert world.walkable.is_standable(*world.pose.xy)


@settings(max_examples=10, deadline=None)
@given(actions, st.floats(-math.pi, math.pi))
def test_depth_pixels_land_on_the_scene(world, sequence, yaw):
    observation = world.reset(episode_from(Pose2(1.2, 1.5, yaw)))
    for action in sequence:
        observation = world.step(action)
    points = observation.camera.rays() * observation.depth[..., None]
    camera_to_scene = world.map_to_scene @ observation.camera_to_map
    ids = observation.truth.ids
    for instance in world.scene.instances:
        seen = (ids == instance.id) & (observation.depth > 0)
        hit = camera_to_scene.apply(points[seen])
        low, high = np.array(instance.box_min) - 2e-3, np.array(instance.box_max) + 2e-3
        assert ((hit >= low) & (hit <= high)).all()


def test_actions_move_as_configured(world):
    world.reset(episode_from(START))
    observation = world.step(Action.MOVE_FORWARD)
    assert (observation.robot.x, observation.robot.y) == pytest.approx((0.5, 0.0))
    observation = world.step(Action.TURN_LEFT)
    assert observation.robot.yaw == pytest.approx(math.radians(30.0))
    world.step(Action.TURN_RIGHT)
    observation = world.step(Action.TURN_RIGHT)
    assert observation.robot.yaw == pytest.approx(math.radians(-30.0))
    assert world.path_length_m == pytest.approx(0.5)


def test_twelve_turns_come_round(world):
    first = world.reset(episode_from(START))
    last = [world.step(Action.TURN_LEFT) for _ in range(12)][-1]
    assert last.robot.yaw == pytest.approx(0.0, abs=1e-9)
    assert np.abs(last.depth - first.depth).max() < 1e-3


def test_a_wall_stops_the_robot_at_the_contact():
    world = world_of(BED)
    world.reset(episode_from(Pose2(3.6, 2.0, 0.0)))
    world.step(Action.MOVE_FORWARD)
    assert not world.collided
    before = world.path_length_m
    world.step(Action.MOVE_FORWARD)
    assert world.collided
    assert world.pose.x == pytest.approx(4.4 - 0.18, abs=0.051)
    assert world.path_length_m - before < 0.2
    world.step(Action.TURN_LEFT)
    assert not world.collided


def test_sliding_is_an_option():
    start = Pose2(4.15, 2.0, math.radians(45.0))
    stopping, sliding = world_of(BED), world_of(BED, sliding=True)
    stopping.reset(episode_from(start))
    sliding.reset(episode_from(start))
    stopping.step(Action.MOVE_FORWARD)
    sliding.step(Action.MOVE_FORWARD)
    assert stopping.pose.y < 2.1
    assert sliding.pose.y == pytest.approx(2.0 + 0.5 * math.sin(math.radians(45.0)), abs=0.01)


def test_path_and_camera_follow_the_floor(world):
    world.reset(episode_from(Pose2(1.6, 2.0, 0.0)))
    observation = world.step(Action.MOVE_FORWARD)
    assert world.position[2] == pytest.approx(0.04, abs=1e-5)
    assert observation.camera_to_map.translation[2] == pytest.approx(0.88 + 0.04, abs=1e-5)
    assert world.path_length_m == pytest.approx(math.hypot(0.5, 0.04), abs=1e-5)


def test_the_camera_tilts_down_and_up_until_the_next_reset(world):
    level = world.reset(episode_from(START))
    down = world.tilt(30.0)
    optical_axis = down.camera_to_map.rotation @ [0.0, 0.0, 1.0]
    assert optical_axis == pytest.approx([math.cos(math.pi / 6), 0.0, -0.5])
    assert world.step(Action.TURN_LEFT).camera_to_map.rotation[2, 2] == pytest.approx(-0.5)
    world.tilt(-60.0)
    assert world.observation.camera_to_map.rotation[2, 2] == pytest.approx(0.5)
    assert np.array_equal(world.reset(episode_from(START)).depth, level.depth)


def test_depth_outside_the_sensors_range_is_no_return():
    world = world_of(camera=CameraConfig(width=64, height=48, min_depth_m=1.0, max_depth_m=3.0))
    depth = world.reset(episode_from(Pose2(1.0, 2.0, 0.0))).depth
    assert depth[24, 32] == 0.0
    returns = depth[depth > 0.0]
    assert returns.min() >= 1.0
    assert returns.max() <= 3.0
    depth = world.reset(episode_from(Pose2(5.5, 2.0, 0.0))).depth
    assert depth[24, 32] == 0.0


def test_labels_name_what_is_seen_and_can_be_switched_off(world):
    truth = world.reset(episode_from(START)).truth
    assert truth is not None
    labels = {truth.labels[i].category for i in np.unique(truth.ids).tolist() if i in truth.labels}
    assert labels == {"bed", "rug"}
    assert world_of(BED, labels=False).reset(episode_from(START)).truth is None


@pytest.mark.parametrize(
    "start", [Pose2(5.2, 2.0, 0.0), Pose2(0.1, 2.0, 0.0), Pose2(40.0, -3.0, 0.0)]
)
def test_a_start_in_an_obstacle_or_outside_names_the_nearest_place(world, start):
    with pytest.raises(StartError, match=r"the nearest position is \(") as caught:
        world.reset(episode_from(start))
    x, y = str(caught.value).rsplit("(", 1)[1].strip(")").split(",")
    assert world.walkable.is_standable(float(x), float(y))


def test_a_world_used_out_of_order_says_so():
    world = world_of()
    for use in (
        lambda: world.step(Action.TURN_LEFT),
        lambda: world.observation,
        lambda: world.map_to_scene,
    ):
        with pytest.raises(WorldError, match="place the robot first"):
            use()
    first = world.reset(episode_from(START))
    assert world.step(Action.STOP) is first
    assert world.is_over
    with pytest.raises(WorldError, match="after STOP"):
        world.step(Action.TURN_LEFT)
    world.reset(episode_from(START))
    assert not world.is_over


def drive(world: SimulatedWorld, seed: int) -> list[bytes]:
    rng = np.random.default_rng(seed)
    observation = world.reset(episode_from(START), rng)
    seen = [observation.rgb.tobytes() + observation.depth.tobytes()]
    for action in [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.MOVE_FORWARD] * 3:
        observation = world.step(action)
        seen.append(observation.depth.tobytes() + repr(observation.robot).encode())
    return seen


NOISE = NoiseConfig(
    depth_sigma_m=0.01,
    depth_edge_px=1,
    forward_sigma=0.1,
    turn_sigma_deg=3.0,
    odometry_sigma=0.05,
    odometry_turn_sigma_deg=1.0,
)


def test_the_same_seed_gives_the_same_bytes():
    world, other = world_of(BED, noise=NOISE), world_of(BED, noise=NOISE)
    assert drive(world, 1) == drive(other, 1) == drive(world, 1)
    assert drive(world, 1) != drive(world, 2)


def test_noise_needs_a_generator():
    with pytest.raises(WorldError, match="pass reset a numpy"):
        world_of(noise=NOISE).reset(episode_from(START))


def test_odometry_drifts_and_the_camera_pose_with_it():
    world = world_of(noise=NoiseConfig(odometry_sigma=0.1))
    world.reset(episode_from(START), np.random.default_rng(0))
    observation = [world.step(Action.MOVE_FORWARD) for _ in range(4)][-1]
    assert world.pose.x == pytest.approx(3.0)
    assert abs(observation.robot.x - 2.0) > 1e-3
    assert observation.camera_to_map.translation[:2] == pytest.approx(observation.robot.xy)


def test_random_starts_can_reach_the_goal():
    world = world_of(BED)
    region = world.regions.of(Goal("bed"))
    rng = np.random.default_rng(0)
    starts = [random_start(world.walkable, rng, region, farthest_m=3.0) for _ in range(30)]
    assert all(2.0 <= region.distance(*start.xy) <= 3.0 for start in starts)
    assert np.std([start.yaw for start in starts]) > 1.0
    far = random_start(world.walkable, rng, region, nearest_m=50.0)
    assert region.distance(*far.xy) > 2.5
    nowhere = world.regions.of(Goal("umbrella"))
    assert world.walkable.is_standable(*random_start(world.walkable, rng, nowhere).xy)
    assert world.walkable.is_standable(*random_start(world.walkable, rng).xy)


def test_a_robot_in_a_real_house_sees_it(small_house):
    from hypernav.simulator.worlds.scenes.loading import read_scene

    world = SimulatedWorld(read_scene(small_house))
    region = world.regions.of(Goal("sofa"))
    start = random_start(world.walkable, np.random.default_rng(2), region)
    observation = world.reset(episode_from(start))
    assert observation.rgb.shape == (480, 640, 3)
    assert observation.depth[observation.depth > 0].min() >= 0.5
    assert observation.depth.max() <= 5.0


def test_a_scene_with_a_navigation_mesh_is_walked_on_all_its_storeys(tmp_path):
    path = tmp_path / "floors.navmesh"
    path.write_bytes(content_of(two_floors()))
    scene = replace(scene_of(*room_boxes()), navmesh=path)
    world = SimulatedWorld(scene, embodiment=Embodiment(camera=SMALL))
    goal = np.array([[1.0, 7.0, 3.0]])
    start = Pose2(1.0, 1.0, math.pi / 2)
    first = world.reset(episode_from(start, start_z=0.0, view_points=goal))
    assert world.position == pytest.approx((1.0, 1.0, 0.0))
    to_goal = [world.goal_truth(Goal("bed"), goal).distance(*world.position)]
    for _ in range(12):
        world.step(Action.MOVE_FORWARD)
        to_goal.append(world.goal_truth(Goal("bed"), goal).distance(*world.position))
    assert not world.collided
    assert world.position == pytest.approx((1.0, 7.0, 3.0), abs=1e-4)
    climbed = world.observation.camera_to_map.translation[2] - first.camera_to_map.translation[2]
    assert climbed == pytest.approx(3.0, abs=1e-4)
    assert world.path_length_m == pytest.approx(1.0 + 5.0 + 1.0, abs=1e-3)
    assert to_goal == sorted(to_goal, reverse=True)
    world.step(Action.MOVE_FORWARD)
    for _ in range(4):
        world.step(Action.MOVE_FORWARD)
    assert world.collided
    world.reset(episode_from(start, start_z=0.0))
    assert world.position[2] == pytest.approx(0.0)
    with pytest.raises(StartError, match="can't stand"):
        world.reset(episode_from(start, start_z=3.0))
