"""The transform from a recording's own world to the ``map`` frame, with the floor at z = 0."""

import math

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import RecordingError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.recording import Recording

_MOST_FRAMES = 40
"""Number of frames, spread over the recording, in which the floor is searched."""
_STRIDE = 8
_FARTHEST_M = 5.0
_BIN_M = 0.02
_FLOOR_SHARE = 0.2
"""Smallest share of the floor's points in those of the fullest level."""


def world_to_map(recording: Recording) -> Transform:
    """The transform from the recording's world to the ``map`` frame.

    The world's axis that points up most in the images is up; the floor is the lowest level with
    many points; the first camera stands at x = y = 0 and looks along x.

    Raises:
        RecordingError: No image has depth, or the first camera looks straight up or down.
    """
    upright = _turned_upright(recording)
    floor_m = _floor_height(recording, upright)
    first = upright @ recording.frames[0].camera_to_world
    forward = first.rotation[:, 2]
    if math.hypot(forward[0], forward[1]) < 0.2:
        raise RecordingError(
            f"{recording.name}: the first camera looks straight up or down; begin the recording "
            "with a look along the floor"
        )
    yaw = math.atan2(forward[1], forward[0])
    c, s = math.cos(yaw), math.sin(yaw)
    to_start = Transform(np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
    x, y, _ = first.translation
    return to_start @ Transform(np.eye(3), np.array([-x, -y, -floor_m])) @ upright


def _turned_upright(recording: Recording) -> Transform:
    """The rotation that takes the world's upward axis to z."""
    ups = np.array([-frame.camera_to_world.rotation[:, 1] for frame in recording.frames])
    mean = ups.mean(axis=0)
    axis = int(np.abs(mean).argmax())
    up = np.zeros(3)
    up[axis] = math.copysign(1.0, float(mean[axis]))
    side = np.roll(np.abs(up), 1)
    return Transform(np.array([side, np.cross(up, side), up]), np.zeros(3))


def _floor_height(recording: Recording, upright: Transform) -> float:
    """Height of the lowest level with many points, metres."""
    every = max(len(recording.frames) // _MOST_FRAMES, 1)
    heights: list[Float64[np.ndarray, " n"]] = []
    for frame in recording.frames[::every]:
        depth = frame.depth()[::_STRIDE, ::_STRIDE]
        rows, columns = np.nonzero(is_measured(depth, 0.0, _FARTHEST_M))
        points = recording.camera.unproject_pixels(
            rows * _STRIDE, columns * _STRIDE, depth[rows, columns].astype(np.float64)
        )
        heights.append((upright @ frame.camera_to_world).apply(points)[:, 2])
    levels = np.concatenate(heights)
    if levels.size == 0:
        raise RecordingError(f"{recording.name}: no depth image has a return within 5 m")
    edges = np.arange(levels.min() - _BIN_M, levels.max() + 2 * _BIN_M, _BIN_M)
    counts, edges = np.histogram(levels, edges)
    # Noise and tilt spread a floor over several bins.
    smooth = np.convolve(counts, np.ones(5), mode="same")
    is_peak = (smooth >= np.roll(smooth, 1)) & (smooth >= np.roll(smooth, -1))
    lowest = np.flatnonzero(is_peak & (smooth > _FLOOR_SHARE * smooth.max()))[0]
    near = levels[np.abs(levels - edges[lowest] - _BIN_M / 2.0) < 2.5 * _BIN_M]
    return float(np.median(near))
