"""What counts as ground around a robot on stairs, and what stands on it."""

import numpy as np
import pytest

from hypernav.search.mapping.elevation_kernels import OBSTACLE_HITS, sort_ground

STEP_M, TALL_M, BLIND_M = 0.24, 1.0, 1.0
TREAD_Z = 1.66


def is_clear(low_m: float, high_m: float, tread_m: float | None, *, down: bool) -> bool:
    """Whether something on unseen ground, beside a tread, is none that hinders the robot.

    Args:
        low_m: Its lowest point, above the robot, metres.
        high_m: Its highest point.
        tread_m: Height of the tread; None without one.
        down: Whether the robot goes down.
    """
    known = np.full((1, 5), np.float32(np.nan))
    if tread_m is not None:
        known[0, :2] = TREAD_Z + tread_m
    measured, (hit_z, hit_top) = ~np.isnan(known), np.zeros((2, 1, 5), np.float32)
    hits = np.zeros((1, 5), np.uint8)
    hits[0, 2], hit_z[0, 2], hit_top[0, 2] = OBSTACLE_HITS, TREAD_Z + low_m, TREAD_Z + high_m
    _, blind, _, clear = sort_ground(
        (known, hits, hit_z, hit_top, np.full((1, 5), np.float32(np.inf))),
        (measured, measured, measured),
        (-0.1, 0.0, 0.05),
        np.float32(TREAD_Z),
        (BLIND_M, STEP_M, np.float32(TALL_M)),
        down,
    )
    assert blind[0, 2]
    return bool(clear[0, 2])


@pytest.mark.parametrize("low_m", [0.0, 0.15])
def test_on_the_way_up_the_riser_of_a_tread_out_of_sight_is_no_obstacle(low_m: float):
    assert is_clear(low_m, 0.19, 0.0, down=False)
    assert is_clear(low_m + 0.19, 0.38, 0.19, down=False)
    assert not is_clear(low_m, 0.19, 0.0, down=True)
    assert not is_clear(low_m, 0.19, None, down=False)  # nothing tells how high the ground is


@pytest.mark.parametrize("down", [True, False])
@pytest.mark.parametrize("tread_m", [-0.36, 0.0, 0.19, None])
def test_posts_and_walls_are_obstacles_beside_treads_of_any_height(
    tread_m: float | None, down: bool
):
    assert not is_clear(0.3, 0.5, tread_m, down=down)
    assert not is_clear(0.3, 1.4, tread_m, down=down)
    assert is_clear(TALL_M + 0.1, TALL_M + 0.3, tread_m, down=down)  # a flight above
