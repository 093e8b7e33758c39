"""What messages of many ROS types have in common: headers, frames and poses.

Messages are objects with the fields of their ROS type, made by any library.
"""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from hypernav.core.errors import RosMessageError
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
