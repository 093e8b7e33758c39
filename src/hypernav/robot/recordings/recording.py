"""A recording of an RGB-D camera, whatever its format."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform


@dataclass(frozen=True, eq=False)
class RecordedFrame:
    """One frame, whose images are not yet read.

    Attributes:
        name: Name of the frame.
        camera_to_world: Pose of the camera; the world is the recording's own.
        stamp_s: Time of the frame, seconds; its number where no time is known.
        rgb: Reads the colour image; raises `RecordingError` if it is broken.
        depth: Reads the depth image, metres, 0 where there is no return; raises the same error.
    """

    name: str
    camera_to_world: Transform
    stamp_s: float
    rgb: Callable[[], UInt8[np.ndarray, "height width 3"]]
    depth: Callable[[], Float32[np.ndarray, "height width"]]


@dataclass(frozen=True, eq=False)
class Recording:
    """All frames of a recording.

    Attributes:
        name: Name of its folder or file.
        camera: Intrinsics of both images.
        frames: Frames in the order of time.
        depth_per_metre: Value of one metre in its depth images, by its format.
        notes: What a user should know about it, one sentence each.
        close: Closes its open files; no image can be read after that.
    """

    name: str
    camera: PinholeCamera
    frames: Sequence[RecordedFrame]
    depth_per_metre: float
    notes: Sequence[str] = ()
    close: Callable[[], None] = lambda: None


def left_out(count: int, total: int, what: str, why: str) -> list[str]:
    """The note about what is not used; none if everything is.

    Args:
        count: How many are not used.
        total: How many there are.
        what: What they are.
        why: What they have in common.
    """
    return [f"{count} of {total} {what} are left out: {why}"] if count else []
