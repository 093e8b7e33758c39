"""What stand-ins are told of a world: true paths, in the frame of the robot."""

import math

import numpy as np
import pytest

from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import TruthMissingError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from small_episodes import episode_from
from small_worlds import two_rooms

START = Pose2(2.5, 1.0, math.pi / 2)
"""In the living room, facing along y: ahead of the robot is the scene's y, left of it minus x."""


class Idle:
    def reset(self, goal): ...
    def act(self, observation): ...


def told(goal="bed", seed: int | None = 0, **values):
    truth = EpisodeTruth()
    rng = None if seed is None else np.random.default_rng(seed)
    EpisodeRun(
        Idle(), two_rooms(coloured=False), episode_from(START, goal, **values), rng=rng, told=truth
    )
    return truth


def test_paths_are_asked_for_in_the_frame_of_the_robot():
    door = np.array([[5.0, 3.1, 0.0]])
    truth = told(view_points=door)
    assert truth.path_left_m(2.1, -2.5) == pytest.approx(0.0, abs=0.1)
    assert truth.path_left_m(2.1, -1.5) == pytest.approx(1.0, abs=0.1)  # 1 m to the left of it
    assert truth.path_left_m(0.0, 0.0) == pytest.approx(math.hypot(2.5, 2.1), abs=0.1)


def test_paths_go_round_walls():
    behind_the_wall = np.array([[5.6, 1.0, 0.0]])
    x, y = 5.6, 1.0
    left_m = told(view_points=behind_the_wall).path_left_m(0.0, 0.0)
    by_the_door = math.dist((2.5, 1.0), (4.9, 2.7)) + math.dist((5.1, 2.7), (x, y))
    assert left_m > math.dist((2.5, 1.0), (x, y)) + 0.7
    assert left_m == pytest.approx(by_the_door, abs=0.6)


def test_off_the_floor_the_gap_is_part_of_the_path():
    door = np.array([[5.0, 3.1, 0.0]])
    truth = told(view_points=door)
    in_the_sofa = truth.path_left_m(1.0, 2.0)
    beside_it = truth.path_left_m(1.0, 1.3)
    assert beside_it < in_the_sofa < beside_it + 1.2


def test_a_goal_that_nobody_can_reach_is_infinitely_far():
    assert told("umbrella").path_left_m(0.0, 0.0) == math.inf


def test_draws_depend_on_the_seed_alone_and_leave_the_worlds_noise_alone():
    assert told(seed=3).rng.random() == told(seed=3).rng.random() != told(seed=4).rng.random()
    rng = np.random.default_rng(3)
    assert told(seed=3).rng.random() != rng.random()


def test_the_truth_of_the_last_episode_is_forgotten():
    truth = told()
    truth.tell()
    with pytest.raises(TruthMissingError):
        truth.path_left_m(0.0, 0.0)
    with pytest.raises(TruthMissingError, match="generator"):
        told(seed=None).rng  # noqa: B018
