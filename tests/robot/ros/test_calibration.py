"""A camera info says how pixels become points, whatever the lens does."""

from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from hypernav.core.errors import RosMessageError
from hypernav.robot.ros.messages import calibration_of

K = [300.0, 0.0, 160.0, 0.0, 300.0, 120.0, 0.0, 0.0, 1.0]
P = [280.0, 0.0, 158.0, 0.0, 0.0, 280.0, 118.0, 0.0, 0.0, 0.0, 1.0, 0.0]
LENS = [-0.2, 0.05, 0.001, -0.001, 0.0]


def info(d, *, k=K, model="plumb_bob", width=320, roi=(0, 0, 0, 0), binning=0):
    region = dict(zip(("x_offset", "y_offset", "width", "height"), roi, strict=True))
    return SimpleNamespace(
        header=SimpleNamespace(frame_id="/optical"),
        width=width,
        height=240,
        distortion_model=model,
        d=d,
        k=k,
        p=P,
        binning_x=binning,
        binning_y=binning,
        roi=SimpleNamespace(**region),
    )


def test_the_middle_of_the_first_pixel_is_ros_zero():
    calibration = calibration_of(info([]), rectified=False)
    assert (calibration.camera.fx, calibration.camera.cx) == (300.0, 160.5)
    assert calibration.frame == "optical"


def test_rectified_images_have_the_projection_matrix_and_no_distortion():
    calibration = calibration_of(info(LENS), rectified=True)
    assert (calibration.camera.fx, calibration.camera.cx) == (280.0, 158.5)
    assert calibration.straightening is None


def test_points_of_a_distorted_image_come_where_the_pinhole_has_them():
    calibration = calibration_of(info(LENS), rectified=False)
    camera = calibration.camera
    points = np.array([[0.3, 0.2, 1.0], [-0.4, 0.3, 1.0], [0.45, -0.35, 1.0]])
    matrix = np.array(K).reshape(3, 3)
    seen, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(LENS))
    assert np.abs(seen[:, 0] + 0.5 - camera.project(points)).max() > 3.0
    for (column, row), (u, v) in zip(seen[:, 0], camera.project(points), strict=True):
        image = np.zeros((240, 320, 3), dtype=np.uint8)
        cv2.circle(image, (round(column), round(row)), 3, (255, 255, 255), -1)
        rows, columns = np.nonzero(calibration.straightened_colour(image)[:, :, 0] > 127)
        assert columns.mean() + 0.5 == pytest.approx(u, abs=0.7)
        assert rows.mean() + 0.5 == pytest.approx(v, abs=0.7)


def test_depths_are_never_mixed():
    depth = np.where(np.arange(320)[None, :] < 160, 1.0, 3.0).repeat(240, axis=0)
    calibration = calibration_of(info(LENS), rectified=False)
    straight = calibration.straightened_depth(depth.reshape(240, 320).astype(np.float32))
    assert set(np.unique(straight)) <= {0.0, 1.0, 3.0}


def test_an_image_of_another_size_is_refused():
    with pytest.raises(RosMessageError, match=r"320 × 240.*registered"):
        calibration_of(info([]), rectified=False).straightened_depth(
            np.ones((120, 160), dtype=np.float32)
        )


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (info([], k=[0.0] * 9), "calibrate"),
        (info([], width=0), "calibrate"),
        (info([float("nan")]), "finite"),
        (info(LENS, model="thin_prism"), "image_rect"),
    ],
)
def test_a_camera_that_is_not_calibrated_is_refused(message, said):
    with pytest.raises(RosMessageError, match=said):
        calibration_of(message, rectified=False)


def test_a_binned_part_of_the_sensor_keeps_its_rays():
    whole = calibration_of(info([]), rectified=False).camera
    part = calibration_of(info([], roi=(40, 20, 160, 120), binning=2), rectified=False).camera
    assert (part.width, part.height) == (80, 60)
    point = np.array([[0.1, -0.05, 1.0]])
    expected = (whole.project(point) - [40, 20]) / 2
    assert part.project(point) == pytest.approx(expected)


def test_a_region_of_the_whole_sensor_changes_nothing():
    whole = calibration_of(info(LENS), rectified=False)
    assert calibration_of(info(LENS, roi=(0, 0, 320, 240), binning=1), rectified=False).camera == (
        whole.camera
    )


def test_the_distortion_of_a_fisheye_is_undone():
    lens = np.array([-0.02, 0.01, -0.003, 0.0])
    calibration = calibration_of(info(lens, model="equidistant"), rectified=False)
    point = np.array([[0.5, -0.3, 1.0]])
    matrix = np.array(K).reshape(3, 3)
    seen, _ = cv2.fisheye.projectPoints(point[None], np.zeros(3), np.zeros(3), matrix, lens)
    image = np.zeros((240, 320, 3), dtype=np.uint8)
    column, row = seen[0, 0]
    cv2.circle(image, (round(column), round(row)), 3, (255, 255, 255), -1)
    rows, columns = np.nonzero(calibration.straightened_colour(image)[:, :, 0] > 127)
    u, v = calibration.camera.project(point)[0]
    assert columns.mean() + 0.5 == pytest.approx(u, abs=1.0)
    assert rows.mean() + 0.5 == pytest.approx(v, abs=1.0)


@pytest.mark.parametrize("lens", [LENS[:1], [*LENS, 0.0, 0.0, 0.0], [*LENS, 0.0]])
def test_any_number_of_coefficients_is_taken(lens):
    calibration = calibration_of(info(lens), rectified=False)
    same = calibration_of(info(lens[:5] + [0.0] * (5 - len(lens[:5]))), rectified=False)
    assert calibration.straightening is not None
    assert same.straightening is not None
    assert np.array_equal(calibration.straightening[0], same.straightening[0])


def test_too_many_coefficients_are_refused():
    with pytest.raises(RosMessageError, match="at most 4 coefficients"):
        calibration_of(info([0.1] * 5, model="equidistant"), rectified=False)
