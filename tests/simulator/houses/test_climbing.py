"""A simulated robot walks between the storeys of a generated building."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from hypernav.core.embodiment import Action, CameraConfig, Embodiment, MotionConfig
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.world import Position
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.building_truth import CLIMBING_BODY
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from

CAMERA = CameraConfig(width=32, height=24)
TURN_DEG = 10.0
MESH_ERROR_M = 0.3
"""Height of a mesh over treads: a voxel of 0.2 m, and some more."""
MESH_CELL_M = 0.05
"""Side of a mesh's cells, to which it knows the edges of treads."""


@cache
def world_of(number: int) -> SimulatedWorld:
    embodiment = Embodiment(
        body=CLIMBING_BODY,
        camera=CAMERA,
        motion=MotionConfig(forward_m=0.25, turn_angle_deg=TURN_DEG),
    )
    scene = generate(Building("storeys", number))
    return SimulatedWorld(scene, SimulationConfig(sliding=True), embodiment)


def walk(world: SimulatedWorld, start: Position, end: Position) -> list[Position]:
    """Positions of a robot that takes turns and steps along shortest paths, first to last."""
    surface = world.walkable
    assert isinstance(surface, NavmeshSurface)
    field = surface.goal_field(np.array([end]))
    world.reset(episode_from(Pose2(start[0], start[1], 0.0), start_z=start[2]))
    positions = [world.position]
    for _ in range(1000):
        here = world.position
        if field.distance(*here) < 0.3:
            break
        ahead = [p for p in field.path(*here) if math.dist(p, here[:2]) > 0.1]
        (x, y), pose = ahead[0], world.pose
        turn = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        if abs(turn) > math.radians(TURN_DEG) / 2.0:
            world.step(Action.TURN_LEFT if turn > 0.0 else Action.TURN_RIGHT)
            continue
        world.step(Action.MOVE_FORWARD)
        positions.append(world.position)
    return positions


def heights_above_ground(world: SimulatedWorld, positions: list[Position]) -> np.ndarray:
    """Heights of positions above what lies under the cameras there, to within a cell."""
    rays = RayCaster(world.scene)
    eyes = np.array(positions, dtype=np.float32)
    eyes[:, 2] += np.float32(CAMERA.height_m)
    down = np.tile(np.array([0.0, 0.0, -1.0], dtype=np.float32), (len(eyes), 1))
    beside = [(0.0, 0.0), *((x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0))]
    offsets = np.array([(x, y, 0.0) for x, y in beside], dtype=np.float32) * MESH_CELL_M / 2.0
    heights = np.stack([rays.distances(eyes + one, down, 3.0) for one in offsets])
    heights -= CAMERA.height_m
    return heights[np.abs(heights).argmin(axis=0), np.arange(len(eyes))]


@pytest.mark.slow
@pytest.mark.parametrize("number", [3002, 3004, 3008])
@pytest.mark.parametrize("upwards", [True, False], ids=["up", "down"])
def test_a_climbing_robot_walks_to_the_next_storey_step_by_step(number: int, upwards: bool):
    world = world_of(number)
    surface, storeys = world.walkable, world.scene.storeys
    assert isinstance(surface, NavmeshSurface)
    floor = surface.floor
    low, high = ((floor[np.abs(floor[:, 2] - z) < 0.1]) for z in storeys[:2])
    start, end = (tuple(points[0].tolist()) for points in ((low, high) if upwards else (high, low)))
    positions = walk(world, start, end)
    assert abs(world.position[2] - storeys[int(upwards)]) < 0.1
    assert surface.distance(world.position, end) < 0.3
    forward_m = world.embodiment.motion.forward_m
    for before, after in pairwise(positions):
        assert math.dist(before[:2], after[:2]) <= forward_m + 0.01
        assert abs(after[2] - before[2]) <= MESH_ERROR_M
    assert np.abs(heights_above_ground(world, positions)).max() <= MESH_ERROR_M
    assert world.camera_to_scene.translation[2] == pytest.approx(
        world.position[2] + CAMERA.height_m
    )
