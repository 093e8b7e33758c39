"""A robot that changes floor keeps what it knows of each."""

import numpy as np
import pytest

from hypernav.build.agents import build_search
from hypernav.core.actions import Action
from hypernav.core.episodes.episode import Episode
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.mapping.memory.memory import Memory
from hypernav.perception.local.ground_truth import GroundTruthDetector
from hypernav.worlds.scans.loading import open_scene
from hypernav.worlds.simulation import SimulatedWorld
from scan_writers.buildings import STOREY_M, two_storeys
from scan_writers.scans import write_scan
from small_worlds import small_config

CONFIG = small_config(embodiment={"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}})


def seen_at(x: float, z: float) -> Observation:
    """What a robot at a position of the map frame sees: nothing."""
    camera = CONFIG.embodiment.camera
    size = (camera.height, camera.width)
    return Observation(
        rgb=np.zeros((*size, 3), np.uint8),
        depth=np.zeros(size, np.float32),
        camera=camera.intrinsics,
        camera_to_map=Pose2(x, 0.0, 0.0).to_transform(z) @ optical_to_base(camera.height_m, 0.0),
        robot=Pose2(x, 0.0, 0.0),
    )


def building() -> Memory:
    return Memory(CONFIG.mapping, CONFIG.embodiment)


def walk(found: Memory, *positions: tuple[float, float]) -> list[float]:
    """Heights of the floors in use after each position ``(x, z)``."""
    return [found.follow(seen_at(x, z)).z for x, z in positions]


UP = [(0.25 * k, 0.175 * k) for k in range(17)]
LANDED = [(4.0 + 0.25 * k, 2.8) for k in range(1, 5)]


def test_stairs_belong_to_the_floor_that_they_begin_on():
    assert walk(building(), *UP) == [0.0] * 17


def test_a_robot_that_walks_level_again_has_come_to_another_floor():
    heights = walk(building(), *UP, *LANDED)
    assert heights[-2:] == pytest.approx([2.8, 2.8])


def test_back_on_a_floor_its_map_is_taken_up_again():
    found = building()
    first = found.floor
    walk(found, *UP, *LANDED)
    assert found.floor is not first
    walk(found, *reversed(UP), *((-0.25 * k, 0.02) for k in range(4)))
    assert found.floor is first
    assert found.number == 0
    assert len(found.floors) == 2


@pytest.mark.parametrize("height", [0.2, 0.9, -0.5])
def test_steps_and_ramps_and_drift_are_no_floors(height):
    assert set(walk(building(), *((0.25 * k, height) for k in range(20)))) == {0.0}


def test_heights_are_counted_from_the_floor():
    found = building()
    walk(found, *UP, *LANDED)
    seen = seen_at(5.0, 2.8)
    lowered = found.floor.seen_from(seen)
    camera_m = CONFIG.embodiment.camera.height_m
    assert lowered.camera_to_map.translation[2] == pytest.approx(camera_m)
    assert lowered.robot == seen.robot


@pytest.mark.slow
def test_a_search_draws_the_upper_floor_on_a_map_of_its_own(tmp_path):
    scene = open_scene(write_scan(two_storeys(), tmp_path / "00802-wcojb4TFT35"))
    world = SimulatedWorld(scene, CONFIG.world, CONFIG.embodiment)
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog(), agent="hypernav")
    agent.reset(Goal("umbrella"))
    foot = Episode("x", "0", Goal("umbrella"), Pose2(3.0, 0.5, 0.0), start_z=0.0)
    agent.act(world.reset(foot))
    below = agent.grid
    for _ in range(24):
        agent.act(world.step(Action.MOVE_FORWARD))
    assert world.position[2] == pytest.approx(STOREY_M, abs=1e-3)
    steps = agent.last_step.step
    above = agent.grid
    assert above.cells is not below.cells
    # The stairwell's treads are obstacles below; above there is free floor around the landing.
    row, column = above.cell_of(world.position[0] - 3.0, 0.0)
    assert above.cells[row, column] == Cell.FREE
    assert steps == 24
