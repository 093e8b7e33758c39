import math

import numpy as np
import pytest

from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.worlds.noise import (
    NoiseConfig,
    noisy_depth,
    noisy_forward,
    noisy_turn,
    reported_motion,
)


def step_image() -> np.ndarray:
    depth = np.full((40, 60), 1.0, dtype=np.float32)
    depth[:, 30:] = 4.0
    depth[:3] = 0.0
    return depth


def test_off_changes_nothing_and_draws_nothing():
    rng, untouched = np.random.default_rng(1), np.random.default_rng(1)
    off = NoiseConfig()
    assert off.is_off
    depth = step_image()
    assert np.array_equal(noisy_depth(depth, off, rng), depth)
    assert noisy_forward(0.5, off, rng) == 0.5
    assert noisy_turn(0.1, off, rng) == 0.1
    assert reported_motion(Pose2(0.5, 0.0, 0.1), off, rng) == Pose2(0.5, 0.0, 0.1)
    assert rng.random() == untouched.random()


@pytest.mark.parametrize("field", NoiseConfig.model_fields)
def test_each_kind_of_noise_switches_on_alone(field):
    assert not NoiseConfig(**{field: 1}).is_off


def test_depth_noise_grows_with_the_square_of_the_distance():
    config = NoiseConfig(depth_sigma_m=0.002)
    rng = np.random.default_rng(0)
    near, far = np.full((200, 200), 1.0, np.float32), np.full((200, 200), 4.0, np.float32)
    assert (noisy_depth(near, config, rng) - near).std() == pytest.approx(0.002, rel=0.03)
    assert (noisy_depth(far, config, rng) - far).std() == pytest.approx(0.032, rel=0.03)


def test_no_return_stays_no_return_and_depth_is_never_negative():
    wild = NoiseConfig(depth_sigma_m=5.0)
    depth = noisy_depth(step_image(), wild, np.random.default_rng(0))
    assert depth.dtype == np.float32
    assert (depth[:3] == 0.0).all()
    assert (depth >= 0.0).all()


@pytest.mark.parametrize("width", [1, 3])
def test_depth_is_missing_along_edges_only(width):
    config = NoiseConfig(depth_edge_px=width)
    depth = noisy_depth(step_image(), config, np.random.default_rng(0))
    missing = np.flatnonzero(depth[20] == 0.0)
    assert missing.tolist() == list(range(30 - width, 30 + width))


def test_a_slanted_wall_is_no_edge():
    slant = np.tile(np.linspace(1.0, 4.0, 60, dtype=np.float32), (40, 1))
    config = NoiseConfig(depth_edge_px=1)
    assert (noisy_depth(slant, config, np.random.default_rng(0)) > 0.0).all()


def test_motors_err_by_the_stated_spread_and_never_reverse():
    config = NoiseConfig(forward_sigma=0.1, turn_sigma_deg=2.0)
    rng = np.random.default_rng(0)
    lengths = np.array([noisy_forward(0.5, config, rng) for _ in range(4000)])
    turns = np.array([noisy_turn(0.5, config, rng) for _ in range(4000)])
    assert lengths.std() == pytest.approx(0.05, rel=0.05)
    assert math.degrees(turns.std()) == pytest.approx(2.0, rel=0.05)
    assert noisy_forward(0.5, NoiseConfig(forward_sigma=50.0), np.random.default_rng(3)) >= 0.0


def test_odometry_errs_with_the_motion_and_is_exact_at_rest():
    config = NoiseConfig(odometry_sigma=0.05, odometry_turn_sigma_deg=1.0)
    rng = np.random.default_rng(0)
    assert reported_motion(Pose2(0.0, 0.0, 0.0), config, rng) == Pose2(0.0, 0.0, 0.0)
    moves = [reported_motion(Pose2(0.5, 0.0, 0.0), config, rng) for _ in range(4000)]
    assert np.std([m.x for m in moves]) == pytest.approx(0.025, rel=0.05)
    assert np.std([m.y for m in moves]) == pytest.approx(0.025, rel=0.05)
    assert math.degrees(np.std([m.yaw for m in moves])) == pytest.approx(1.0, rel=0.05)
