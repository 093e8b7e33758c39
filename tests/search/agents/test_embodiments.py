"""Robots of other bodies, cameras and actions find the goal, and misread nothing on the way."""

import math

import numpy as np
import pytest

from hypernav.app.build.agents import build_search
from hypernav.app.build.components.component_specs import PresetName
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import preset
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, ExchangeLog
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.agents import search as search_agent
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.planning.bump_sensor import bumped_points
from hypernav.simulator.worlds.surface.goal_regions import random_start
from small_episodes import episode_from
from small_worlds import colourless_world, two_rooms

BESIDE_THE_SOFA = Pose2(2.5, 1.0, math.pi / 2)
ROBOTS = {
    "0.25 m, 30 degrees": {"motion.forward_m": 0.25},
    "0.3 m, 10 degrees": {"motion.forward_m": 0.3, "motion.turn_angle_deg": 10},
    "0.5 m, 15 degrees": {"motion.turn_angle_deg": 15},
    "1.31 m high": {"camera.height_m": 1.31},
    "portrait": {
        "camera.width": 360,
        "camera.height": 640,
        "camera.hfov_deg": 42,
        "camera.height_m": 1.31,
    },
    "320x240": {"camera.width": 320, "camera.height": 240},
    "wide": {"camera.hfov_deg": 120},
    "looks down": {"camera.pitch_deg": 14},
    "looks up": {"camera.pitch_deg": -14},
    "near and far": {"camera.min_depth_m": 0.1, "camera.max_depth_m": 10},
    "radius 0.25 m": {"body.radius_m": 0.25},
}
SMALL_CAMERA = {"camera.width": 160, "camera.height": 120}
BODY_TOUCHES_M = 0.15
"""What a robot bumps into is drawn where its body was, at most so far from the thing itself."""


def config_of(robot, name: PresetName = "default", *others):
    values = {f"embodiment.{key}": value for key, value in (SMALL_CAMERA | robot).items()}
    assignments = [f"{key}={value}" for key, value in values.items()]
    return layered(preset(name), environment={}, assignments=[*assignments, *others])


class BumpsNoted:
    """Which steps noted a bump, and which were really cut short."""

    def __init__(self, monkeypatch, world):
        self.false, self.true = 0, 0

        def watched(*seen):
            found = bumped_points(*seen)
            self.true += bool(len(found)) and world.collided
            self.false += bool(len(found)) and not world.collided
            return found

        monkeypatch.setattr(search_agent, "bumped_points", watched)


def farthest_from_a_thing(grid, world):
    """How far the occupied cells of a map lie from all things of the scene at most, metres."""
    middles = grid.centres_of(np.argwhere(grid.occupied))
    points = world.map_to_scene.apply(np.column_stack([middles, np.zeros(len(middles))]))[:, :2]
    away = np.full(len(points), np.inf)
    for thing in world.scene.instances:
        low, high = np.array(thing.box_min), np.array(thing.box_max)
        if high[2] > 0.1 and low[2] < 1.0:
            beyond = np.maximum(np.maximum(low[:2] - points, points - high[:2]), 0.0)
            away = np.minimum(away, np.hypot(*beyond.T))
    return float(away.max())


def search(monkeypatch, config, agent="hypernav"):
    world = colourless_world(two_rooms().scene, config)
    bumps = BumpsNoted(monkeypatch, world)
    searcher = build_search(config, GroundTruthDetector(), ExchangeLog(), agent=agent)
    episode = EpisodeRun(searcher, world, episode_from(BESIDE_THE_SOFA, "bed"))
    steps = [step.trace for step in episode]
    assert bumps.false == 0
    tolerance_m = BODY_TOUCHES_M + config.mapping.cell_size_m / 2
    assert farthest_from_a_thing(searcher.grid, world) <= tolerance_m
    return steps, episode.result()


def finds_the_bed(monkeypatch, config, agent="hypernav"):
    steps, result = search(monkeypatch, config, agent)
    assert result.outcome is Outcome.FOUND
    assert steps[-1].ending is Ending.FOUND
    assert result.metrics.distance_to_goal_m < 0.3


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_it_finds_the_goal_and_misreads_nothing(monkeypatch, robot):
    finds_the_bed(monkeypatch, config_of(robot))


@pytest.mark.parametrize("agent", ["hypernav", "frontier"])
def test_coarse_cells_do(monkeypatch, agent):
    finds_the_bed(monkeypatch, config_of({}, "default", "mapping.cell_size_m=0.1"), agent)


@pytest.mark.slow
@pytest.mark.parametrize("agent", ["hypernav", "frontier"])
@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_it_finds_its_way_through_a_furnished_house(monkeypatch, robot, agent):
    config = layered(
        preset("default"),
        environment={},
        assignments=[f"embodiment.{key}={value}" for key, value in robot.items()],
    )
    world = colourless_world(load_scene("builtin"), config)
    bumps = BumpsNoted(monkeypatch, world)
    toilet, rng = Goal("toilet"), np.random.default_rng(2)
    start = random_start(world.walkable, rng, world.regions.of(toilet))
    searcher = build_search(config, GroundTruthDetector(), ExchangeLog(), agent=agent)
    episode = EpisodeRun(searcher, world, episode_from(start, toilet), rng=rng)
    for _ in episode:
        pass
    assert episode.result().outcome is Outcome.FOUND
    assert bumps.false == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["default", "paper"])
@pytest.mark.parametrize("agent", ["hypernav", "frontier"])
@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_so_does_every_agent(monkeypatch, robot, agent, name):
    finds_the_bed(monkeypatch, config_of(robot, name), agent)
