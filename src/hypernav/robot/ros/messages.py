"""Headers, frames and poses of ROS messages, and the camera of a ``sensor_msgs/CameraInfo``."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float32, UInt8
from scipy.spatial.transform import Rotation

from hypernav.core.errors import CameraError, RosMessageError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform


def frame_name(name: str) -> str:
    """The name of a frame, without the slash that ROS 1 may put before it."""
    return name.lstrip("/")


def stamp_s(header: Any) -> float:
    """Time of a message's header, seconds."""
    return header.stamp.sec + 1e-9 * header.stamp.nanosec


def rigid_transform(position: Any, rotation: Any) -> Transform:
    """The transform of a position and a quaternion.

    Raises:
        RosMessageError: The values are no pose.
    """
    quaternion = np.array([rotation.x, rotation.y, rotation.z, rotation.w], dtype=np.float64)
    translation = np.array([position.x, position.y, position.z], dtype=np.float64)
    length = float(np.linalg.norm(quaternion))
    if not (np.isfinite(translation).all() and 0.9 < length < 1.1):
        raise RosMessageError(
            "expected a position and a quaternion of length 1, found "
            f"{translation.tolist()} and {quaternion.tolist()}"
        )
    return Transform(Rotation.from_quat(quaternion).as_matrix(), translation)


_Maps = tuple[Float32[np.ndarray, "height width"], Float32[np.ndarray, "height width"]]
_COEFFICIENTS = {
    "plumb_bob": (4, 5, 8, 12, 14),
    "rational_polynomial": (4, 5, 8, 12, 14),
    "equidistant": (4,),
}
"""Numbers of coefficients that OpenCV takes for each model of distortion."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Intrinsics of an image topic.

    Attributes:
        camera: Intrinsics without distortion.
        frame: The optical frame.
        straightening: For every pixel of the undistorted image its column and its row in the
            distorted one; None where the images have no distortion.
    """

    camera: PinholeCamera
    frame: str
    straightening: _Maps | None

    def straightened_colour(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> UInt8[np.ndarray, "height width 3"]:
        """A colour image without distortion.

        Raises:
            RosMessageError: The image has another size than the camera.
        """
        return self._straightened(rgb, cv2.INTER_LINEAR)

    def straightened_depth(
        self, depth: Float32[np.ndarray, "height width"]
    ) -> Float32[np.ndarray, "height width"]:
        """A depth image without distortion; depths are never interpolated.

        Raises:
            RosMessageError: The image has another size than the camera.
        """
        return self._straightened(depth, cv2.INTER_NEAREST)

    def _straightened(self, image: np.ndarray, interpolation: int) -> np.ndarray:
        height, width = image.shape[:2]
        if (width, height) != (self.camera.width, self.camera.height):
            raise RosMessageError(
                f"expected an image of {self.camera.width} × {self.camera.height} pixels as its "
                f"camera info says, found {width} × {height}; depth must be registered to colour"
            )
        if self.straightening is None:
            return image
        return cv2.remap(image, *self.straightening, interpolation)


def calibration_of(message: Any, *, rectified: bool) -> Calibration:
    """The camera that a message describes.

    Args:
        message: The ``CameraInfo``; ROS 1 writes its matrices in capitals.
        rectified: Whether the images are already undistorted (``image_rect``), so that the
            projection matrix holds, not the camera matrix and its distortion.

    Raises:
        RosMessageError: The camera is not calibrated, or cannot exist.
    """
    frame = frame_name(message.header.frame_id)
    if rectified:
        matrix, distortion = _field(message, "p").reshape(3, 4)[:, :3], np.zeros(0)
    else:
        matrix, distortion = _field(message, "k").reshape(3, 3), _field(message, "d")
    values = np.concatenate([matrix.ravel(), distortion])
    if not np.isfinite(values).all():
        raise RosMessageError(f"the camera info of '{frame}' holds numbers that are not finite")
    width, height, matrix = _of_image(message, matrix)
    try:
        # ROS measures from the centre of the first pixel, our cameras from its corner.
        camera = PinholeCamera(
            width,
            height,
            float(matrix[0, 0]),
            float(matrix[1, 1]),
            float(matrix[0, 2]) + 0.5,
            float(matrix[1, 2]) + 0.5,
        )
    except CameraError as error:
        raise RosMessageError(
            f"the camera info of '{frame}' is no calibration ({error}); calibrate the camera"
        ) from error
    if not distortion.any():
        return Calibration(camera, frame, None)
    model = message.distortion_model
    counts = _COEFFICIENTS.get(model)
    if counts is None:
        raise RosMessageError(
            f"expected a distortion of {' or '.join(_COEFFICIENTS)}, found '{model:.40}'; use the "
            "rectified topics (image_rect)"
        )
    distortion = np.trim_zeros(distortion, "b")
    count = next((count for count in counts if count >= distortion.size), None)
    if count is None:
        raise RosMessageError(
            f"expected at most {counts[-1]} coefficients of the distortion {model}, found "
            f"{distortion.size}; calibrate the camera"
        )
    padded = np.pad(distortion, (0, count - distortion.size))
    return Calibration(camera, frame, _straightening(model, (width, height), matrix, padded))


def _of_image(message: Any, matrix: np.ndarray) -> tuple[int, int, np.ndarray]:
    """Width, height and camera matrix of the images; REP 104 gives those of the whole sensor."""
    roi = message.roi
    left, top = roi.x_offset, roi.y_offset
    across, down = max(message.binning_x, 1), max(message.binning_y, 1)
    width = (roi.width or message.width - left) // across
    height = (roi.height or message.height - top) // down
    of_image = matrix.copy()
    of_image[0] /= across
    of_image[1] /= down
    # In these columns and rows, 0 is the centre of the first pixel, however large it is.
    of_image[0, 2] = (matrix[0, 2] + 0.5 - left) / across - 0.5
    of_image[1, 2] = (matrix[1, 2] + 0.5 - top) / down - 0.5
    return width, height, of_image


def _field(message: Any, name: str) -> np.ndarray:
    value = getattr(message, name, None)
    return np.asarray(getattr(message, name.upper()) if value is None else value, dtype=np.float64)


def _straightening(
    model: str, size: tuple[int, int], matrix: np.ndarray, distortion: np.ndarray
) -> _Maps:
    is_fisheye = model == "equidistant"
    maps = cv2.fisheye.initUndistortRectifyMap if is_fisheye else cv2.initUndistortRectifyMap
    columns, rows = maps(matrix, distortion, np.eye(3), matrix, size, cv2.CV_32FC1)
    return columns, rows
