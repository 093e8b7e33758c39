"""What counts as ground around a robot on stairs, and what stands on it."""

import numpy as np
import pytest

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import OCCUPIED_EVIDENCE
from hypernav.search.mapping.elevation_kernels import (
    highest_around,
    is_level,
    open_ground,
    sort_ground,
    survey,
)

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
    hits[0, 2], hit_z[0, 2], hit_top[0, 2] = OCCUPIED_EVIDENCE, TREAD_Z + low_m, TREAD_Z + high_m
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


RANDOM = np.random.default_rng(0)


def test_ground_can_be_walked_on_where_it_is_known_clear_and_even():
    shape = (9, 13)
    heights = RANDOM.choice([0.0, 0.1, 0.2, np.nan], shape, p=(0.7, 0.15, 0.05, 0.1))
    heights = heights.astype(np.float32)
    known, clear = RANDOM.uniform(size=(2, *shape)) < 0.9
    presumed = RANDOM.uniform(size=shape) < 0.05
    to_robot, under_m, step_m = (-0.9, -0.35, 0.1), 0.25, 0.15
    found = open_ground(heights, known, clear, presumed, to_robot, under_m, step_m)
    rows, columns = np.indices(shape) + 0.5
    away = np.hypot(columns * 0.1 + to_robot[0], rows * 0.1 + to_robot[1])
    told = np.where(away > under_m, heights, np.nan)
    for i, j in np.ndindex(shape):
        around = told[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2]
        around = around[~np.isnan(around)]
        is_even = len(around) == 0 or np.ptp(around) <= 0.15 + 1e-6
        expected = presumed[i, j] or (known[i, j] and clear[i, j] and is_even)
        assert (found[i, j] == Cell.FREE) == expected
    assert 20 < (found == Cell.FREE).sum() < 100


def test_the_highest_around_a_cell_is_that_of_the_eight_and_itself():
    heights = RANDOM.uniform(0.0, 1.0, (5, 6)).astype(np.float32)
    mask = RANDOM.uniform(size=(5, 6)) < 0.5
    for i, j in np.ndindex(heights.shape):
        part = (slice(max(i - 1, 0), i + 2), slice(max(j - 1, 0), j + 2))
        expected = heights[part][mask[part]].max(initial=-np.inf)
        assert highest_around(heights, mask, i, j) == expected


@pytest.mark.parametrize("slope", [0.0, 0.27, -0.27, 0.45, -0.45, 2.0])
@pytest.mark.parametrize("towards", [0.0, 1.1, -2.0])
def test_a_surface_is_level_by_its_slope_in_any_direction(slope: float, towards: float):
    """It is told along the line of sight, up the column of the image."""
    camera = PinholeCamera(24, 18, 20.0, 20.0, 12.0, 9.0)
    pose = Pose2(3.0, -2.0, towards).to_transform() @ optical_to_base(0.9, 35.0)
    rays = camera.rays() @ pose.rotation.T
    ahead = np.array([np.cos(towards), np.sin(towards)])
    # The plane z = slope * (way ahead of the point below the camera - 0.9)
    with np.errstate(divide="ignore"):
        depth = (pose.translation[2] + 0.9 * slope) / (
            slope * (rays[..., :2] @ ahead) - rays[..., 2]
        )
    depth = np.where((depth > 0.0) & (depth < 4.0), depth, 0.0).astype(np.float32)
    across = (rays[0] - rays[0, 12]).astype(np.float32)
    down = np.ascontiguousarray(rays[:, 12], dtype=np.float32)
    start = pose.translation.astype(np.float32)
    found = set[bool]()
    for v in range(4, 18):
        for u in range(0, 24, 3):
            d = depth[v, u]
            x, y, z = start + d * (across[u] + down[v])
            is_seen = d > 0.0 and depth[v - 2, u] > 0.0 and z < start[2] - 0.1
            other = start + depth[v - 2, u] * (across[u] + down[v - 2])
            if is_seen and np.hypot(other[0] - x, other[1] - y) < 0.35:
                found.add(bool(is_level(depth, u, v - 2, across, down, start, (0.1, 4.0), x, y, z)))
    assert found == {abs(slope) < 0.3}


SLOPES, FALLS = (np.arange(33) - 16) / 16.0, 0.25 - np.arange(41) / 32.0
"""Pixels whose points lie on sixteenths of a metre, as edges of cells do: nothing is rounded."""
SIDE_M = 1.0 / 16.0


CAMERA_AT = (2.0, -1.0)


def surveyed(depth: np.ndarray, quarters: int, rows: slice, columns: slice) -> list[np.ndarray]:
    """What a frame adds to a part of a map of 8 m x 8 m around the robot."""
    c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters]
    across = np.column_stack([-s * SLOPES, c * SLOPES, 0.0 * SLOPES])
    down = np.column_stack([c + 0.0 * FALLS, s + 0.0 * FALLS, FALLS])
    shape = rows.stop - rows.start, columns.stop - columns.start
    starts = columns.start, rows.start
    kinds = ((np.nan, "f4"), (0, "u1"), (0, "f4"), (0, "f4"), (np.inf, "f4"))
    maps = tuple(np.full(shape, value, kind) for value, kind in kinds)
    survey(
        depth.astype(np.float32),
        across.astype(np.float32),
        down.astype(np.float32),
        (*CAMERA_AT, 1.0),
        (0.1, 4.0),
        (0.0, 1.0, 0.2),
        (*(SIDE_M * k + c - 4.0 for k, c in zip(starts, CAMERA_AT, strict=True)), SIDE_M),
        maps,
        (np.full(shape, -np.inf, "f4"), np.zeros(shape, "u1"), np.zeros(shape[0] * shape[1], "i4")),
    )
    return list(maps)


WHOLE = slice(0, 128), slice(0, 128)


def assert_part_of_whole(depth: np.ndarray, quarters: int, part: tuple[slice, slice]) -> None:
    for whole, found in zip(
        surveyed(depth, quarters, *WHOLE), surveyed(depth, quarters, *part), strict=True
    ):
        np.testing.assert_array_equal(found, whole[part])


@pytest.mark.parametrize("quarters", range(4))
def test_a_part_of_the_map_holds_what_the_whole_map_holds_there(quarters: int):
    with np.errstate(divide="ignore"):
        floor_m = np.round(np.where(FALLS < 0.0, -16.0 / FALLS, np.inf)) / 16.0
    seen_m = np.minimum(floor_m, 2.25)[:, None] * RANDOM.choice([0.5, 1.0, 1.0, 1.0], (41, 33))
    seen_m[-1] = RANDOM.choice([1.0, 2.0], 33)  # past an edge half as far away
    heights, hits, _, _, below = surveyed(seen_m, quarters, *WHOLE)
    assert min((heights == heights).sum(), (hits > 0).sum(), (below < np.inf).sum()) > 5
    for low, high in RANDOM.integers((0, 64), (64, 128), (40, 2, 2)).transpose(0, 2, 1):
        part = slice(low[0], high[0]), slice(low[1], high[1])
        assert_part_of_whole(seen_m, quarters, part)


@pytest.mark.parametrize("quarters", range(4))
def test_a_drop_is_noted_where_the_line_of_sight_meets_the_height_of_the_floor(quarters: int):
    """The ground lies 1 m below the robot's, and the camera 1 m above that."""
    with np.errstate(divide="ignore"):
        lower_m = np.where(FALLS < -0.5, -2.0 / FALLS, 0.0)
    below = surveyed(np.tile(lower_m[:, None], 33), quarters, *WHOLE)[4]
    rows, columns = np.nonzero(below < np.inf)
    x, y = ((at + 0.5) * SIDE_M - 4.0 for at in (columns, rows))
    ahead_m = (x, y, -x, -y)[quarters]
    assert ahead_m.min() == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("quarters", range(4))
def test_a_drop_is_noted_as_far_as_the_map_reaches(quarters: int):
    """From 2 m on nothing comes back, where a floor would return depth up to 2.8 m."""
    with np.errstate(divide="ignore"):
        floor_m = np.where(FALLS < 0.0, -1.0 / FALLS, np.inf)
    seen_m = np.tile(np.where(floor_m < 2.0, np.round(16.0 * floor_m) / 16.0, 0.0)[:, None], 33)
    assert (surveyed(seen_m, quarters, *WHOLE)[4] < np.inf).sum() > 20
    for ahead in range(34, 46):
        part = list(WHOLE)
        part[1 - quarters % 2] = slice(0, 64 + ahead) if quarters < 2 else slice(64 - ahead, 128)
        assert_part_of_whole(seen_m, quarters, (part[0], part[1]))
