"""Laws of the value map."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.rivals.vlfm.value_map import ValueMap

CAMERA = CameraConfig(width=160, height=120)
HERE = Pose2(0.0, 0.0, 0.0)


def looking(robot: Pose2 = HERE, depth_m: float = 3.0, pitch_deg: float = 0.0) -> Observation:
    """A view of a wall across the optical axis."""
    return Observation(
        rgb=np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8),
        depth=np.full((CAMERA.height, CAMERA.width), depth_m, np.float32),
        camera=CAMERA.intrinsics,
        camera_to_map=robot.to_transform() @ optical_to_base(0.88, pitch_deg),
        robot=robot,
    )


def value_map() -> ValueMap:
    return ValueMap(CAMERA, cell_size_m=0.05)


def at(world: ValueMap, numbers: np.ndarray, x: float, y: float) -> float:
    column, row = (np.array([x, y]) - world.origin) / 0.05
    return float(numbers[int(row), int(column)])


def test_the_confidence_is_one_on_the_axis_and_a_quarter_at_the_edge():
    world = value_map()
    world.integrate(looking(), 0.7)
    assert at(world, world.confidences, 2.0, 0.0) == pytest.approx(1.0, abs=0.01)
    edge = 2.0 * math.tan(math.radians(79.0 / 2.0)) - 0.06
    assert at(world, world.confidences, 2.0, edge) == pytest.approx(0.25, abs=0.01)
    half = 2.0 * math.tan(math.radians(79.0 / 4.0))
    assert at(world, world.confidences, 2.0, half) == pytest.approx(0.25 + 0.75 / 2.0, abs=0.02)


def test_only_what_is_in_view_gets_the_value():
    world = value_map()
    world.integrate(looking(), 0.7)
    assert at(world, world.values, 2.0, 0.0) == pytest.approx(0.7)
    for x, y in ((3.2, 0.0), (-0.5, 0.0), (1.0, 1.0)):
        assert math.isnan(at(world, world.values, x, y))


@pytest.mark.parametrize("yaw", [-2.5, -0.7, 0.3, 1.0, 1.9, 3.1])
def test_all_that_is_in_view_gets_the_value_whatever_the_heading(yaw):
    world, robot = value_map(), Pose2(0.4, -0.3, yaw)
    world.integrate(looking(robot), 0.7)
    for side in (-1.0, 0.0, 1.0):  # the view ends at 39.5 degrees on each side, 3 m ahead
        towards = Pose2(robot.x, robot.y, yaw + math.radians(38.0) * side)
        far_m = 3.0 / math.cos(towards.yaw - yaw)
        assert at(world, world.values, *towards.ahead(far_m - 0.1).xy) == pytest.approx(0.7)
        wide = Pose2(robot.x, robot.y, yaw + math.radians(43.0) * side)
        out = wide.ahead(2.0 if side else 3.1)
        assert math.isnan(at(world, world.values, *out.xy))


@given(st.floats(0.0, 1.0), st.integers(1, 4), st.floats(-3.0, 3.0))
def test_fusing_the_same_value_again_leaves_it_unchanged(value, times, yaw):
    world = value_map()
    for _ in range(times + 1):
        world.integrate(looking(Pose2(0.3, -0.2, yaw)), value)
    values = world.values[~np.isnan(world.values)]
    np.testing.assert_allclose(values, value, atol=1e-6)


def test_values_are_weighed_by_how_sure_they_are(monkeypatch):
    monkeypatch.setattr("hypernav.search.rivals.vlfm.value_map._LEAST_CONFIDENCE", 0.0)
    world = value_map()
    world.integrate(looking(), 1.0)
    world.integrate(looking(Pose2(0.0, 0.0, math.radians(79.0 / 2.0 - 1.0))), 0.0)
    # The point ahead is at the edge of the second view: 1 and about a quarter are their weights.
    assert at(world, world.values, 2.0, 0.0) == pytest.approx(1.0 / 1.25, abs=0.02)
    sure = (1.0 + 0.25**2) / 1.25
    assert at(world, world.confidences, 2.0, 0.0) == pytest.approx(sure, abs=0.02)


def test_an_unsure_view_changes_nothing_that_is_known_better():
    world = value_map()
    world.integrate(looking(), 1.0)
    world.integrate(looking(Pose2(0.0, 0.0, math.radians(79.0 / 2.0 - 1.0))), 0.0)
    assert at(world, world.values, 2.0, 0.0) == 1.0


def test_a_wall_is_as_far_ahead_for_a_tilted_camera():
    level, tilted = value_map(), value_map()
    level.integrate(looking(depth_m=3.0), 0.5)
    # The topmost row of a tilted camera still looks up: it measures the wall along its own axis.
    tilted.integrate(looking(depth_m=3.0, pitch_deg=20.0), 0.5)
    assert at(level, level.values, 2.9, 0.0) == pytest.approx(0.5)
    assert math.isnan(at(level, level.values, 3.1, 0.0))
    up = math.radians(20.0)
    slope = math.tan(math.radians(79.0) / 2.0) * 120 / 160
    farthest = 3.0 * (math.cos(up) + slope * math.sin(up))
    assert at(tilted, tilted.values, farthest - 0.1, 0.0) == pytest.approx(0.5)
    assert math.isnan(at(tilted, tilted.values, farthest + 0.1, 0.0))


def test_the_map_grows_without_forgetting():
    world = value_map()
    world.integrate(looking(), 0.7)
    for x in (-20.0, 20.0):
        world.integrate(looking(Pose2(x, 3.0 * x, 0.0)), 0.1)
    assert at(world, world.values, 2.0, 0.0) == pytest.approx(0.7)
    assert at(world, world.values, -18.0, -60.0) == pytest.approx(0.1)


def test_a_view_without_depth_shows_nothing():
    world = value_map()
    world.integrate(looking(depth_m=0.0), 0.7)
    assert np.isnan(world.values).all()
    assert world.median_near(np.array([[0.0, 0.0], [500.0, -500.0]]), 0.5).tolist() == [-1.0, -1.0]


def test_the_median_is_of_the_cells_with_values_nearby():
    world = value_map()
    world.integrate(looking(), 0.2)
    world.integrate(looking(Pose2(0.0, 0.0, math.pi)), 0.8)
    near = world.median_near(np.array([[2.0, 0.0], [-2.0, 0.0], [3.2, 0.0], [0.0, 2.0]]), 0.5)
    np.testing.assert_allclose(near, [0.2, 0.8, 0.2, -1.0], atol=1e-6)
