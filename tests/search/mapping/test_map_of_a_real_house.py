"""The map against the triangles of a furnished house, from recorded depth."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from drawn_grids import divide_into_blocks
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import find_frontiers
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.simulator.worlds.scenes.loading import read_scene

CONFIG = MappingConfig()
BAND = (0.10, 0.95)
CLEARANCE_M = 0.22
SPACING_M = 0.02


@pytest.fixture(scope="module")
def observations(test_data):
    episode = np.load(test_data / "episodes" / "small_house.npz")
    camera = PinholeCamera.from_hfov(640, 480, float(episode["hfov_deg"]))
    base = optical_to_base(float(episode["cam_h"]))
    black = np.zeros((480, 640, 3), np.uint8)
    frames = []
    for depth_mm, (x, y, yaw) in zip(episode["depth_mm"], episode["xy_yaw"], strict=True):
        # The recording's frame is turned by 90 degrees against the scene's.
        robot = Pose2(-float(y), float(x), float(yaw) + np.pi / 2)
        depth = depth_mm.astype(np.float32) / 1000
        frames.append(Observation(black, depth, camera, robot.to_transform() @ base, robot))
    return frames


@pytest.fixture(scope="module")
def world_map(observations):
    world_map = TopDownMap(CONFIG, Embodiment())
    for observation in observations:
        world_map.integrate(observation)
    return world_map


@pytest.fixture(scope="module")
def surfaces(small_house):
    """Points ``(x, y)`` all over the triangles in the height band, metres."""
    scene = read_scene(small_house)
    corners = scene.vertices[scene.faces].astype(np.float64)
    low, high = corners[..., 2].min(axis=1), corners[..., 2].max(axis=1)
    band = (high > BAND[0]) & (low < BAND[1])
    a, b, c = np.moveaxis(corners[band], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    triangle = np.repeat(np.arange(len(a)), np.ceil(area / SPACING_M**2).astype(int) + 2)
    u, v = np.random.default_rng(0).random((2, len(triangle), 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    points = a[triangle] + u * (b - a)[triangle] + v * (c - a)[triangle]
    height = points[:, 2]
    inside = (height >= BAND[0]) & (height < BAND[1])
    return points[inside, :2]


def test_what_is_drawn_occupied_is_there(world_map, surfaces):
    occupied = world_map.grid.centres_of(np.argwhere(world_map.grid.occupied))
    away, _ = KDTree(surfaces).query(occupied)
    assert len(occupied) > 4000
    assert np.mean(away <= 0.10) >= 0.99  # the issue asks for 0.95
    assert np.mean(away <= 0.05) >= 0.95


def test_what_is_there_is_not_drawn_free(world_map, surfaces):
    grid = world_map.grid
    hits = np.zeros(grid.cells.shape, int)
    cells = grid.cells_of(surfaces)
    cells = cells[grid.contains(cells)]
    np.add.at(hits, tuple(cells.T), 1)
    there = (hits >= 3) & grid.explored
    # The rest is hidden from all views: seats under tables, rear sides.
    assert np.mean(grid.cells[there] == Cell.OCCUPIED) > 0.88


def test_the_robots_way_is_free(world_map, observations):
    states = {world_map.grid.state_at(*o.robot.xy) for o in observations}
    assert states == {Cell.FREE}


def test_seeing_everything_again_changes_next_to_nothing(world_map, observations):
    again = TopDownMap(CONFIG, Embodiment())
    for observation in [*observations, *observations]:
        again.integrate(observation)
    assert again.grid.origin == world_map.grid.origin
    assert np.mean(again.grid.cells != world_map.grid.cells) < 2e-4


def test_frontiers_and_blocks_of_the_house(world_map, observations):
    robot = observations[-1].robot
    frontiers = find_frontiers(world_map.grid, robot, CONFIG, CLEARANCE_M)
    blocks = divide_into_blocks(world_map.grid, robot, CONFIG, CLEARANCE_M)
    assert 5 <= len(frontiers) <= 30
    assert 10 <= len(blocks) <= 40
    again = find_frontiers(world_map.grid, robot, CONFIG, CLEARANCE_M)
    assert [f.destination for f in again] == [f.destination for f in frontiers]
    assert divide_into_blocks(world_map.grid, robot, CONFIG, CLEARANCE_M) == blocks
