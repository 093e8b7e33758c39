"""A simulated robot finds the bed in a small building, whatever the network and its wheels do."""

import math
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from unittest import mock

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.robot.client import robot_client
from hypernav.robot.client.links import Link
from hypernav.robot.client.robot_client import ClientStep, Patience, RobotClient
from hypernav.robot.driving.base import Velocity
from hypernav.robot.driving.driven_robot import TICK_S, DrivenRobot
from hypernav.robot.simulation.base import MishapConfig, SimulatedBase
from hypernav.robot.simulation.faulty_link import FaultyLink, NetworkFaults
from hypernav.robot.simulation.person import PersonConfig
from hypernav.robot.wire.replies import Reply, SearchEnding
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld
from robot_links import AgentLink
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(2.0, 1.0, 0.0)
BAD_NETWORK = NetworkFaults(loss_share=0.2, jitter_s=0.02, duplicate_share=0.2, reorder_share=0.2)


class AnswerAfterTicks(Future[Reply]):
    """An answer that a driving robot has after some commands, whatever a clock says."""

    def __init__(self, answer: Reply, ticks: int) -> None:
        super().__init__()
        self.set_result(answer)
        self.ticks = ticks

    def done(self) -> bool:
        self.ticks -= 1
        return self.ticks < 0


class SimulatedWait:
    """Lets every answer come within the client's deadline, counted on the robot's own clock."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def submit(self, ask: Callable[..., Reply], *facts: object) -> Future[Reply]:
        latest = round(Patience().deadline_s / TICK_S)
        return AnswerAfterTicks(ask(*facts), int(self.rng.integers(latest + 1)))

    def shutdown(self) -> None:
        """Nothing runs beside the search."""


@dataclass
class Searched:
    """A finished search, and all that took part in it."""

    base: SimulatedBase
    robot: DrivenRobot
    link: AgentLink
    carried: Link
    client: RobotClient
    steps: list[ClientStep]

    @property
    def found(self) -> bool:
        region = self.base.world.truth.goal_truth(Goal("bed"))
        is_claimed = self.link.last is not None and self.link.last.ending is SearchEnding.FOUND
        return is_claimed and region.distance(*self.base.position) < 0.1


def search(
    mishaps: MishapConfig | None = None,
    *,
    faults: NetworkFaults | None = None,
    continuous: bool = False,
    seed: int = 0,
    hold_first: int = 0,
) -> Searched:
    scene, config = two_rooms().scene, small_config()
    renderer = CpuRenderer(scene, RenderConfig(threads=1))
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
    with closing(world):
        base, rng = SimulatedBase(world, config.world, mishaps), np.random.default_rng(seed)
        base.place(episode_from(START), rng)
        robot = DrivenRobot(base)
        link = AgentLink(config, "bed", hold_first=hold_first)
        carried = link if faults is None else FaultyLink(link, faults, rng)
        client = RobotClient(robot, carried, continuous=continuous)
        wait = SimulatedWait(np.random.default_rng(seed))
        with mock.patch.object(robot_client, "ThreadPoolExecutor", return_value=wait):
            steps = list(client)
    return Searched(base, robot, link, carried, client, steps)


@cache
def undisturbed() -> Searched:
    return search()


@pytest.mark.parametrize(
    "continuous", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["steps", "continuous"]
)
def test_it_finds_the_bed(continuous):
    searched = search(continuous=True) if continuous else undisturbed()
    assert searched.found
    assert searched.link.closed
    assert [step.reply.sequence for step in searched.steps] == list(range(len(searched.steps)))
    assert not any(step.blocked for step in searched.steps)


@pytest.mark.parametrize("error_m", [None, 0.0])
def test_a_robot_that_localises_itself_gives_poses_in_the_frame_of_the_building(error_m):
    scene, config = two_rooms().scene, small_config()
    renderer = CpuRenderer(scene, RenderConfig(threads=1))
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
    camera = config.embodiment.camera
    with closing(world):
        base = SimulatedBase(world, config.world, MishapConfig(localisation_error_m=error_m))
        base.place(episode_from(Pose2(2.0, 1.0, 2.0)), np.random.default_rng(0))
        unlocalised = base.sense().observation(camera.intrinsics, camera.camera_to_base)
        assert np.allclose([*unlocalised.robot.xy, unlocalised.robot.yaw], 0.0)
        base.localise()
        base.drive(Velocity(0.5, 0.3), 1.0)
        seen = base.sense().observation(camera.intrinsics, camera.camera_to_base)
        true = base.pose.to_transform(base.position[2]) @ camera.camera_to_base
    assert base.path_length_m > 0.3
    assert np.allclose(seen.camera_to_map.matrix, true.matrix, atol=1e-9)
    assert np.allclose(seen.robot.xy, base.pose.xy)


@pytest.mark.slow
def test_on_hold_it_stands_still_and_asks_again():
    at_once, held = undisturbed(), search(hold_first=2)
    assert [step.reply for step in held.steps] == [step.reply for step in at_once.steps]
    assert held.base.path_length_m == at_once.base.path_length_m


@pytest.mark.slow
def test_a_bad_network_changes_nothing_but_the_time():
    """Lost, late, doubled and reordered: every action is still executed once, in order."""
    good, bad = undisturbed(), search(faults=BAD_NETWORK)
    assert isinstance(bad.carried, FaultyLink)
    assert min(bad.carried.lost, bad.carried.doubled, bad.carried.reordered) > 0
    assert bad.client.resent >= bad.carried.lost
    assert [step.reply for step in bad.steps] == [step.reply for step in good.steps]
    assert bad.base.path_length_m == good.base.path_length_m


@pytest.mark.slow
def test_blocked_wheels_are_reported_and_the_cell_ahead_becomes_an_obstacle():
    searched = search(MishapConfig(stuck_share=0.15), seed=3)
    assert searched.found
    told = [step.reply.sequence for step in searched.steps if step.blocked]
    assert list(searched.link.blocked) == told
    bumps = [
        after.step
        for before, after in pairwise(searched.link.steps)
        if before.action is Action.MOVE_FORWARD and math.dist(before.pose[:2], after.pose[:2]) < 0.1
    ]
    assert bumps
    assert all(searched.link.blocked[step] for step in bumps)


@pytest.mark.slow
def test_it_drives_by_odometry_while_localisation_jumps():
    searched = search(MishapConfig(localisation_error_m=0.02), continuous=True)
    assert searched.found
    assert any(step.sensed.odom_to_map.x != 0.0 for step in searched.steps)


@pytest.mark.slow
@pytest.mark.parametrize("continuous", [False, True], ids=["steps", "continuous"])
@pytest.mark.parametrize("seed", range(20))
def test_it_drives_into_nobody_and_finds_the_bed_all_the_same(seed, continuous):
    searched = search(MishapConfig(person=PersonConfig()), seed=seed, continuous=continuous)
    person = searched.base.person
    assert person is not None
    assert person.visits > 0
    assert searched.base.smallest_gap_m > 0.0
    assert searched.found
