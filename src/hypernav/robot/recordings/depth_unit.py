"""The unit of a recording's depth images: another one than its format's, and a doubt about it."""

import math
from dataclasses import replace

import numpy as np
from jaxtyping import Float32, Float64

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.recordings.recording import RecordedFrame, Recording

_MOST_FRAMES = 5
_COLUMNS = 80
_USUAL = (1000.0, 5000.0, 1.0, 10000.0, 4000.0, 100.0)
_MOVED_M = 0.15
"""Way after which a second look at the same things tells their distance."""
_LEAST_POINTS = 50
_CLEAR = 0.02
"""Relative difference of depth that no noise of a camera makes."""
_WRONG = 0.04
"""One that poses of another convention make; noisy odometry and calibration make less."""
_POSES_IN_MM = 50.0
"""Factor by which depth would have to be in a smaller unit, that rather the poses are."""
_NEAR_M, _FAR_M = (1.0, 0.4), (4.0, 8.0)
"""A robot in a room sees a tenth of things beyond the first, and half of them beyond the second; it
also sees a tenth of them before the third, and half of them before the fourth."""


def in_unit(recording: Recording, per_metre: float) -> Recording:
    """A recording whose depth images have another unit than its format says.

    Args:
        recording: The recording, read by its format's unit.
        per_metre: Depth value of one metre.
    """
    factor = np.float32(recording.depth_per_metre / per_metre)

    def scaled(frame: RecordedFrame) -> RecordedFrame:
        def depth() -> Float32[np.ndarray, "height width"]:
            return frame.depth() * factor

        return replace(frame, depth=depth)

    frames = [scaled(frame) for frame in recording.frames]
    return replace(recording, frames=frames, depth_per_metre=per_metre)


def unit_doubt(recording: Recording) -> list[str]:
    """The note that another unit fits the depth better than the recording's; or none.

    Where the camera moved, two looks at the same things agree in the right unit only. Elsewhere,
    things that are all too near or too far for a robot in a room make a note.

    Raises:
        RecordingError: A depth image cannot be read.
    """
    per_metre = recording.depth_per_metre
    depths, looks = _looks(recording)
    units = dict.fromkeys((per_metre, *_USUAL))
    apart = {unit: _difference(recording.camera, looks, per_metre / unit) for unit in units}
    best = min(apart, key=lambda unit: apart[unit])
    if best == per_metre and apart[best] < _WRONG:
        return []
    if apart[best] < _WRONG and apart[per_metre] > max(_CLEAR, 2.0 * apart[best]):
        or_poses = " (or the poses are in millimetres)" if _POSES_IN_MM * best <= per_metre else ""
        return [
            f"depth and poses contradict each other if the value {per_metre:g} is one metre, "
            f"and agree with --depth-per-metre {best:g}{or_poses}"
        ]
    if _WRONG < apart[best] < math.inf and math.isfinite(apart[per_metre]):
        return [
            f"depth and poses contradict each other by {apart[per_metre]:.0%} in every usual unit; "
            "are the poses from camera to world, in metres, with the camera's x to the right, y "
            "down and z forward, and quaternions in the order x y z w?"
        ]
    returns = np.concatenate([depth[depth > 0.0] for depth in depths])
    if returns.size == 0 or (side := _misfit(returns)) is None:
        return []
    least_m = float(np.quantile(returns, 0.9 if side == "nearer" else 0.1))
    fitting = next((u for u in _USUAL if _misfit(returns * (per_metre / u)) is None), None)
    advice = (
        "another value can be said by --depth-per-metre"
        if fitting is None
        else f"--depth-per-metre {fitting:g} would make it {least_m * per_metre / fitting:.2g} m"
    )
    return [
        f"nine tenths of the depth are {side} than {least_m:.2g} m if the value {per_metre:g} is a "
        f"metre; {advice}"
    ]


_Depth = Float32[np.ndarray, "height width"]
_Looks = list[tuple[Transform, _Depth, _Depth]]
"""For two looks at the same things from different places the transform from the first camera to the
second, and the depth of both."""


def _looks(recording: Recording) -> tuple[list[_Depth], _Looks]:
    """Depth spread over the recording, and second looks."""
    frames = recording.frames
    depths, looks = [], []
    for i in range(0, len(frames), max(len(frames) // _MOST_FRAMES, 1)):
        first, depth = frames[i], frames[i].depth()
        depths.append(depth)
        here = first.camera_to_world.translation
        second = next((one for one in frames[i:] if _moved_m(one, here) >= _MOVED_M), None)
        if second is not None:
            way = second.camera_to_world.inverse() @ first.camera_to_world
            looks.append((way, depth, second.depth()))
    return depths, looks


def _moved_m(frame: RecordedFrame, here: Float64[np.ndarray, "3"]) -> float:
    return float(np.linalg.norm(frame.camera_to_world.translation - here))


def _difference(camera: PinholeCamera, looks: _Looks, scale: float) -> float:
    """By how much second looks differ from first ones, relatively, if depth is scaled."""
    stride = max(camera.width // _COLUMNS, 1)
    found = [np.zeros(0)]
    for way, depth, second in looks:
        rows, columns = stride * np.array(np.nonzero(depth[::stride, ::stride] > 0.0))
        points = camera.unproject_pixels(rows, columns, depth[rows, columns].astype(float) * scale)
        seen = way.apply(points)
        seen = seen[seen[:, 2] > 0.0]
        u, v = np.floor(camera.project(seen)).T
        inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        u, v, expected = u[inside].astype(int), v[inside].astype(int), seen[inside, 2]
        measured = second[v, u] * scale
        found.append(np.abs(np.log(expected[measured > 0.0] / measured[measured > 0.0])))
    differences = np.concatenate(found)
    return float(np.median(differences)) if differences.size >= _LEAST_POINTS else math.inf


def _misfit(returns: Float32[np.ndarray, " n"]) -> str | None:
    near_m, half_m, far_m = np.quantile(returns, [0.1, 0.5, 0.9])
    if far_m < _NEAR_M[0] or half_m < _NEAR_M[1]:
        return "nearer"
    return "farther" if near_m > _FAR_M[0] or half_m > _FAR_M[1] else None
