"""What counts as ground around a robot on stairs, and what stands on it."""

import numpy as np
import pytest

from hypernav.mapping.elevation_kernels import OBSTACLE_HITS, sort_ground

STEP_M, TALL_M, BLIND_M = 0.24, 1.0, 1.0
TREAD_Z = 1.66


@pytest.mark.parametrize(
    ("top_z", "has_tread", "is_clear"),
    [
        (TREAD_Z + 0.19, True, True),  # the riser of the next tread, which is out of sight
        (TREAD_Z + 0.4, True, False),  # a post
        (TREAD_Z + TALL_M + 0.1, True, True),  # the underside of the flight above
        (TREAD_Z + 0.19, False, False),  # nothing tells how high the ground is there
    ],
)
def test_a_step_up_on_unseen_ground_is_no_obstacle(top_z: float, has_tread: bool, is_clear: bool):
    known = np.full((1, 5), np.float32(np.nan))
    if has_tread:
        known[0, :2] = TREAD_Z
    measured = ~np.isnan(known)
    hits, hit_z = np.zeros((1, 5), np.uint8), np.zeros((1, 5), np.float32)
    hits[0, 2], hit_z[0, 2] = OBSTACLE_HITS, top_z
    _, blind, _, clear = sort_ground(
        (known, hits, hit_z, np.full((1, 5), np.float32(np.inf))),
        (measured, measured, measured),
        (-0.1, 0.0, 0.05),
        np.float32(TREAD_Z),
        (BLIND_M, STEP_M, np.float32(TALL_M)),
        False,
    )
    assert blind[0, 2]
    assert clear[0, 2] == is_clear
