"""Free ranges on a floor before a slanting wall, for a camera that is tilted and rolled."""

import math

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.search.rivals.arrows.free_range_kernels import walk_lines

CAMERA = PinholeCamera(160, 120, 95.0, 110.0, 75.0, 65.0)
HEIGHT_M, FARTHEST_M = 1.1, 6.0
WALL = np.array([1.0, 0.45, 0.0])  # nearer on the left: x + 0.45 y = 3
HEADINGS = np.radians(np.arange(-36.0, 37.0, 4.0))


def rotation(pitch_deg: float, roll: float) -> np.ndarray:
    cos, sin = math.cos(roll), math.sin(roll)
    rolled = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return optical_to_base(0.0, pitch_deg).rotation @ rolled


def depth_image(turn: np.ndarray, wall_m: float) -> np.ndarray:
    """Depth of the floor and of a wall on it."""
    rays = CAMERA.rays() @ turn.T
    with np.errstate(divide="ignore"):
        to_floor, to_wall = -HEIGHT_M / rays[..., 2], wall_m / (rays @ WALL)
    depth = np.minimum(*(np.where(one > 0.0, one, np.inf) for one in (to_floor, to_wall)))
    return depth.astype(np.float32)


def expected(turn: np.ndarray, heading: float, wall_m: float) -> float:
    """How far the line lies in the image and before the wall."""
    s = np.arange(0.0, FARTHEST_M, 0.002)
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    seen = (s[:, None] * ahead - (0.0, 0.0, HEIGHT_M)) @ turn
    shown = CAMERA.contains(CAMERA.project(seen)) & (s * (ahead @ WALL) < wall_m)
    return float(s[shown].max()) if shown.any() else 0.0


@pytest.mark.parametrize("pitch_deg", [10.0, 25.0])
@pytest.mark.parametrize("roll", [0.0, 0.25, -0.25])
@pytest.mark.parametrize("wall_m", [3.0, 99.0])
def test_floor_is_free_in_the_image_up_to_the_wall(pitch_deg: float, roll: float, wall_m: float):
    turn = rotation(pitch_deg, roll)
    found = walk_lines(
        depth_image(turn, wall_m),
        CAMERA.lens,
        turn,
        HEIGHT_M,
        HEADINGS,
        (-0.05, 0.05),
        FARTHEST_M,
        (0.1, 50.0),
        5,
    )
    ranges = [expected(turn, heading, wall_m) for heading in HEADINGS]
    np.testing.assert_allclose(found, ranges, rtol=0.05, atol=0.1)


def test_holes_in_the_floor_of_a_pixel_or_two_do_not_end_it():
    turn = rotation(25.0, 0.0)
    depth = depth_image(turn, 3.0)
    whole = walk_lines(
        depth, CAMERA.lens, turn, HEIGHT_M, HEADINGS, (-0.05, 0.05), 6.0, (0.1, 50.0), 5
    )
    rows = np.arange(120) % 9 == 0
    depth[rows] = 0.0
    holed = walk_lines(
        depth, CAMERA.lens, turn, HEIGHT_M, HEADINGS, (-0.05, 0.05), 6.0, (0.1, 50.0), 5
    )
    np.testing.assert_allclose(holed, whole, rtol=0.05, atol=0.1)
    depth[70:75] = 0.0
    cut = walk_lines(
        depth, CAMERA.lens, turn, HEIGHT_M, HEADINGS, (-0.05, 0.05), 6.0, (0.1, 50.0), 5
    )
    assert (cut[whole > 2.5] < whole[whole > 2.5] - 0.1).all()
