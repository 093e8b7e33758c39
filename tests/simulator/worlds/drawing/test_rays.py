"""The rasterizer shows what rays through the pixels' centres meet."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.simulator.worlds.drawing.ray_kernels import fill_rays
from hypernav.simulator.worlds.drawing.rays import Rasterizer, RayCaster
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene

CAMERA = PinholeCamera.from_hfov(160, 120, 79.0)
SEEDS = st.integers(0, 2**32 - 1)


def pose_rows(pose: Transform) -> np.ndarray:
    rotation = pose.rotation
    return np.array(
        [pose.translation, rotation[:, 2], rotation[:, 0] / CAMERA.fx, rotation[:, 1] / CAMERA.fy]
    )


def drawn(scene: Scene, pose: Transform, rows: slice = slice(0, CAMERA.height)) -> np.ndarray:
    return Rasterizer(scene).faces(CAMERA, pose_rows(pose), rows)


def cast(scene: Scene, pose: Transform) -> np.ndarray:
    directions = np.empty((CAMERA.height, CAMERA.width, 3), np.float32)
    fill_rays(pose_rows(pose), CAMERA.cx, CAMERA.cy, 0, directions)
    directions = directions.reshape(-1, 3)
    origins = np.broadcast_to(np.float32(pose.translation), directions.shape).copy()
    return RayCaster(scene).faces(origins, directions).reshape(CAMERA.height, CAMERA.width)


def soup(seed: int, count: int = 300) -> Scene:
    """Triangles of all sizes all around the origin, some of them behind it or across it."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform(-4.0, 4.0, (count, 1, 3))
    corners = middles + rng.normal(0.0, 1.0, (count, 3, 3)) * rng.uniform(0.01, 2.0, (count, 1, 1))
    boxes = scene_of(*[("thing", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))] * -(-count // 12))
    object.__setattr__(boxes, "vertices", corners.reshape(-1, 3).astype(np.float32))
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    object.__setattr__(boxes, "faces", faces)
    return boxes


def looking(yaw: float) -> Transform:
    return Pose2(0.0, 0.0, yaw).to_transform() @ optical_to_base(0.0)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, yaw=st.floats(-3.0, 3.0))
def test_it_finds_the_triangles_that_rays_find(seed: int, yaw: float) -> None:
    scene, pose = soup(seed), looking(yaw)
    # Rays are rounded to 32 bits, which shows at edges alone.
    assert (drawn(scene, pose) != cast(scene, pose)).mean() < 0.002


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_a_scan_is_seen_from_the_front_alone(seed: int) -> None:
    scene, pose = soup(seed), looking(0.0)
    a, b, c = np.moveaxis(scene.vertices[scene.faces].astype(np.float64), 1, 0)
    front = (np.cross(b - a, c - a) * (pose.translation - a)).sum(axis=1) > 0.0
    both, alone = drawn(scene, pose), drawn(replace(scene, stored_z_up=True), pose)
    assert front[alone[alone >= 0]].all()
    nearest_is_front = (both >= 0) & front[both]
    assume(nearest_is_front.any())  # one soup in thirty shows only backs
    assert (alone == both)[nearest_is_front].all()


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS, first=st.integers(0, 118), count=st.integers(1, 120))
def test_a_pixel_is_the_same_whatever_rows_are_asked_for(seed: int, first: int, count: int) -> None:
    scene, pose = soup(seed), looking(0.4)
    rows = slice(first, min(first + count, CAMERA.height))
    assert np.array_equal(drawn(scene, pose, rows), drawn(scene, pose)[rows])


@settings(max_examples=20, deadline=None)
@given(x=st.floats(0.3, 5.7), y=st.floats(0.3, 3.7), yaw=st.floats(-3.2, 3.2))
def test_a_closed_room_has_no_gap_between_its_triangles(x: float, y: float, yaw: float) -> None:
    pose = Pose2(x, y, yaw).to_transform() @ optical_to_base(0.88)
    assert (drawn(scene_of(*room_boxes(6.0, 4.0)), pose) >= 0).all()


def test_two_surfaces_in_the_same_place_make_no_pattern() -> None:
    first = scene_of(("picture", (2.0, -3.0, -3.0), (2.1, 3.0, 3.0)))
    both = scene_of(*[("picture", (2.0, -3.0, -3.0), (2.1, 3.0, 3.0))] * 2)
    shown = drawn(both, looking(0.1))
    assert len(np.unique(both.face_instance[shown])) == 1
    assert np.array_equal(shown % 12, drawn(first, looking(0.1)) % 12)


def test_behind_the_camera_is_nothing() -> None:
    scene = scene_of(("box", (-3.0, -1.0, -1.0), (-2.0, 1.0, 1.0)))
    assert (drawn(scene, looking(0.0)) == -1).all()


@pytest.mark.parametrize("place", [(-3.0, -4.0, 0.5), (2.0, 0.0, 2.2), (-1.0, 2.0, -1.6)])
def test_a_furnished_house_looks_as_rays_see_it(small_house, place) -> None:
    scene = read_scene(small_house)
    pose = Pose2(*place).to_transform() @ optical_to_base(0.88)
    by_rays, by_drawing = cast(scene, pose), drawn(scene, pose)
    seen = [np.where(f >= 0, scene.face_instance[f], -1) for f in (by_rays, by_drawing)]
    assert (seen[0] != seen[1]).mean() < 1e-3
