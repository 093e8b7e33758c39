"""Laws of the coloured points that a page in three dimensions shows."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform

CAMERA = PinholeCamera.from_hfov(160, 120, 79.0)


def _pose(x: float, yaw: float) -> Transform:
    return Pose2(x, 0.0, yaw).to_transform() @ optical_to_base(0.88)


def _image(value: int) -> np.ndarray:
    return np.full((120, 160, 3), value, dtype=np.uint8)


def _depth(metres: float, stride: int = 1) -> np.ndarray:
    return np.full((120, 160), metres, dtype=np.float32)[::stride, ::stride]


def _middles(cloud: ColouredCloud) -> np.ndarray:
    """The middles of the cells of floor 1, ``map`` frame, metres."""
    assert cloud.origin is not None
    return (cloud.points()[1][0] + 0.5) * cloud.spacing_m + cloud.origin


@given(st.floats(0.5, 7.0), st.floats(-3.0, 3.0), st.floats(-5e6, 5e6))
@settings(max_examples=25, deadline=None)
def test_a_point_lies_in_the_cell_of_what_was_seen(depth: float, yaw: float, x: float) -> None:
    cloud = ColouredCloud()
    cloud.add(_image(9), _depth(depth), CAMERA, _pose(x, yaw), floor=1)
    middles = _pose(x, yaw).inverse().apply(_middles(cloud))
    assert np.abs(middles[:, 2] - depth).max() <= cloud.spacing_m * np.sqrt(3) / 2 + 1e-6


def test_a_kept_depth_of_every_fourth_pixel_shows_the_same_surface() -> None:
    whole, kept = ColouredCloud(), ColouredCloud()
    whole.add(_image(9), _depth(2.0), CAMERA, _pose(0.0, 0.3), floor=1)
    kept.add(_image(9), _depth(2.0, 4), CAMERA, _pose(0.0, 0.3), floor=1)
    cells = [{tuple(one) for one in cloud.points()[1][0].tolist()} for cloud in (whole, kept)]
    assert cells[1] <= cells[0]
    assert len(cells[1]) > 500


def test_the_first_image_of_a_surface_gives_its_colour() -> None:
    cloud = ColouredCloud()
    for value in (40, 200):
        cloud.add(_image(value), _depth(2.0), CAMERA, _pose(0.0, 0.0), floor=1)
    assert set(cloud.points()[1][1].ravel().tolist()) == {40}


def test_floors_are_kept_apart() -> None:
    cloud = ColouredCloud()
    for floor in (1, 3):
        cloud.add(_image(floor), _depth(2.0), CAMERA, _pose(0.0, 0.0), floor=floor)
    assert {floor: int(rgb[0, 0]) for floor, (_, rgb) in cloud.points().items()} == {1: 1, 3: 3}


def test_what_has_no_depth_or_lies_too_far_is_left_out() -> None:
    cloud = ColouredCloud()
    for depth in (0.0, 50.0, np.inf, np.nan):
        cloud.add(_image(9), _depth(depth), CAMERA, _pose(0.0, 0.0), floor=1)
    assert cloud.points() == {}


def test_a_large_building_is_drawn_more_coarsely_and_not_cut_off() -> None:
    fine, bounded = ColouredCloud(), ColouredCloud(most_points=2000)
    for cloud in (fine, bounded):
        for yaw in np.linspace(-3.0, 3.0, 8):
            cloud.add(_image(9), _depth(3.0), CAMERA, _pose(0.0, yaw), floor=1)
    ends = []
    for cloud in (fine, bounded):
        points = _middles(cloud)
        ends.append(np.array([points.min(axis=0), points.max(axis=0)]))
    assert len(bounded.points()[1][0]) <= 2000 < len(fine.points()[1][0])
    assert bounded.spacing_m > fine.spacing_m
    assert np.abs(ends[0] - ends[1]).max() < bounded.spacing_m
