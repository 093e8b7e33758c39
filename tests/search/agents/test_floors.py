"""A robot that changes floor keeps what it knows of each."""

from dataclasses import replace

import numpy as np
import pytest

from certainty import certain
from hypernav.app.build.agents import build_search
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.key_images import KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from scan_writers.buildings import STOREY_M, two_storeys
from scan_writers.scans import write_scan
from small_worlds import colourless_world, small_config

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
    lowered = found.seen_from_ground(seen)
    camera_m = CONFIG.embodiment.camera.height_m
    assert lowered.camera_to_map.translation[2] == pytest.approx(camera_m)
    assert lowered.robot == seen.robot


def climber() -> Memory:
    """What a robot that looks for stairs knows at the start."""
    changed = {"motion": {"forward_m": 0.25}, "body": {"max_step_m": 0.2}}
    config = small_config(embodiment=changed)
    found = Memory(config.mapping, config.embodiment, images=KeyImages(1_000_000))
    found.begin_search(lasts=True, sees_stairs=True)
    return found


def test_a_robot_that_climbs_is_on_stairs_and_on_a_split_level_on_its_floor():
    found = climber()
    on_stairs = []
    for x, z in [*UP[:4], *((0.75 + 0.25 * k, 0.525) for k in range(1, 9))]:
        found.follow(seen_at(x, z))
        on_stairs.append(found.on_stairs)
    assert on_stairs[2:6] == [True] * 4
    assert on_stairs[-5:] == [False] * 5
    assert len(found.floors) == 1
    assert found.footing.ground_z == pytest.approx(0.525)


def test_heights_on_a_split_level_are_counted_from_its_ground():
    found = building()
    walk(found, *UP[:4], *((0.75 + 0.25 * k, 0.525) for k in range(1, 9)))
    camera_m = CONFIG.embodiment.camera.height_m
    above = found.seen_from_ground(seen_at(3.0, 0.525))
    assert above.camera_to_map.translation[2] == pytest.approx(camera_m)
    assert found.ground_m == pytest.approx(0.525)
    walk(found, *((3.0 - 0.25 * k, 0.0) for k in range(4)))
    below = found.seen_from_ground(seen_at(2.0, 0.0))
    assert below.camera_to_map.translation[2] == pytest.approx(camera_m)
    assert found.ground_m == 0.0


def test_odometry_that_drifts_in_height_is_no_stairs():
    found = climber()
    on_stairs = []
    for k in range(150):
        found.follow(seen_at(0.25 * k, 0.006 * k))
        on_stairs.append(found.on_stairs)
    assert sum(on_stairs) <= 3
    assert abs(found.footing.z - found.footing.ground_z) <= 0.12


def test_back_from_stairs_the_floor_is_the_ground_at_once():
    found = climber()
    walk(found, *UP[:8], *reversed(UP[:8]))
    assert not found.on_stairs
    assert found.footing.ground_z == 0.0


@pytest.mark.parametrize("z", [0.3, 0.7, 0.95, 2.1, 3.4])
def test_a_search_begins_on_the_nearest_floor_that_is_less_than_a_floor_away(z):
    found = building()
    walk(found, *UP, *LANDED)
    assert found.begin_at(seen_at(5.0, z)) is found.floors[round(z / 2.8)]
    assert len(found.floors) == 2
    assert (found.footing.z, found.footing.ground_z) == (pytest.approx(z), pytest.approx(z))


def test_a_search_that_begins_elsewhere_begins_on_level_ground_there():
    found = climber()
    found.connectors = (Connector(0, True, (4.0, 0.0), 0.0),)
    found.begin_at(seen_at(5.0, 2.8))
    assert not found.on_stairs
    assert found.footing.z == found.floor.z == pytest.approx(2.8)
    found.crossed(0)
    assert found.connectors[-1].end == (5.0, 0.0)


def test_a_search_without_stairs_forgets_that_an_earlier_one_looked_for_them():
    found = climber()
    found.begin_search(sees_stairs=False)
    assert found.elevation is None


def test_heights_in_a_key_image_of_a_split_level_are_counted_from_the_floor():
    found = climber()
    images = certain(found.images)
    taken = []
    for x, z in ((1.0, 0.0), *UP[:4], *((0.75 + 0.25 * k, 0.525) for k in range(1, 9))):
        found.follow(seen_at(x, z))
        wall = replace(seen_at(x, z), depth=np.full_like(seen_at(x, z).depth, 2.0))
        if (x, z) in ((1.0, 0.0), (2.75, 0.525)):
            found.floor.search.has_new_view = True
            found.keep_image(found.seen_from_ground(wall))
            taken.append(wall.camera_to_map.translation[2])
    assert [one.camera_to_map.translation[2] for one in images.kept] == pytest.approx(taken)


def test_no_key_image_is_taken_on_stairs():
    found = climber()
    assert found.images is not None
    for x, z in UP:
        found.follow(seen_at(x, z))
        wall = replace(seen_at(x, z), depth=np.full_like(seen_at(x, z).depth, 2.0))
        found.keep_image(found.seen_from_ground(wall))
    assert len(found.images.kept) == 1


@pytest.mark.slow
def test_a_search_draws_the_upper_floor_on_a_map_of_its_own(tmp_path):
    scene = open_scene(write_scan(two_storeys(), tmp_path / "00802-wcojb4TFT35"))
    world = colourless_world(scene, CONFIG)
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
