"""Whether depth images show the robot moving as far as its odometry says.

Odometry in other units, or of wheels of another radius, is in agreement with itself. Only what the
camera sees tells: a wall ahead comes nearer by the length of a step.
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import SensorError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.robot.wire.requests import ObservationFacts

_SCALES = (1.0, 1.0 / 3.0, 0.5, 2.0, 3.0)
"""Shares of odometry's motion that depth images are compared with, the expected one first."""
_LEAST_M = 0.05
"""Shortest motion that is looked at."""
_ROWS = 40
"""Number of rows of pixels that are compared, and about as many columns."""
_NEAR_M, _NEAR_SHARE = 0.015, 0.015
"""Error of a depth that is as expected, in metres and as a share of the depth."""
_APART = 3.0
"""Multiple of that error from which on a depth is another one."""
_LEAST_SHARE, _CLEARLY = 0.2, 10
"""Share of the pixels that must speak for a scale, and how many times as many as against it."""
_MOST_WRONG = 3


@dataclass(frozen=True)
class _View:
    """A depth image, and from where it was taken.

    Attributes:
        seen: The observation.
        base_to_odom: Pose of the robot by its odometry.
        camera_to_base: Pose of the camera on the robot.
    """

    seen: Observation
    base_to_odom: Transform
    camera_to_base: Transform


class OdometryScale:
    """Counts motions of which depth images show another length than odometry."""

    def __init__(self) -> None:
        """Create it; nothing has been seen yet."""
        self._last: _View | None = None
        self._moved_m = 0.0
        self._wrong: Counter[float] = Counter()

    def note(self, facts: ObservationFacts, seen: Observation) -> None:
        """Compare an observation with the one before."""
        camera_to_base = facts.base_to_map.inverse() @ seen.camera_to_map
        now = _View(seen, facts.base_to_odom.transform, camera_to_base)
        scale = None if self._last is None else _scale_shown(self._last, now)
        if self._last is not None and scale is not None:
            self._moved_m = float(np.linalg.norm(_motion(self._last, now)))
            self._wrong = Counter({scale: self._wrong[scale] + 1} if scale != 1.0 else {})
        self._last = now

    def check(self) -> None:
        """Refuse odometry that depth images have contradicted several times in a row.

        Raises:
            SensorError: They have.
        """
        for scale, count in self._wrong.items():
            if count >= _MOST_WRONG:
                raise SensorError(
                    f"odometry (base_to_odom) moved {self._moved_m:.2f} m, and depth images show "
                    f"about {scale * self._moved_m:.2f} m, {count} times in a row; are both in "
                    "metres, and is the radius of the wheels right?"
                )


def _scale_shown(before: _View, now: _View) -> float | None:
    """Share of odometry's motion that depth images show; None if they show none clearly."""
    if np.linalg.norm(_motion(before, now)) < _LEAST_M:
        return None
    points = _points(before)
    if len(points) == 0:
        return None
    errors = [_errors(points, before, now, scale) for scale in _SCALES]
    expected, *others = errors
    for scale, other in zip(_SCALES[1:], others, strict=True):
        speak_for = np.count_nonzero((other < 1.0) & (expected > _APART))
        speak_against = np.count_nonzero((expected < 1.0) & (other > _APART))
        if speak_for >= max(_LEAST_SHARE * len(points), _CLEARLY * speak_against):
            return scale
        if speak_against >= max(_LEAST_SHARE * len(points), _CLEARLY * speak_for):
            return _SCALES[0]
    return None


def _motion(before: _View, now: _View) -> Float64[np.ndarray, " 3"]:
    return now.base_to_odom.translation - before.base_to_odom.translation


def _points(view: _View) -> Float64[np.ndarray, "n 3"]:
    """Some of the points that a camera sees, in the frame of the odometry."""
    depth = view.seen.depth
    stride = max(1, depth.shape[0] // _ROWS)
    rows, columns = np.nonzero(is_measured(depth[::stride, ::stride]))
    rows, columns = rows * stride, columns * stride
    points = view.seen.camera.unproject_pixels(rows, columns, depth[rows, columns])
    return (view.base_to_odom @ view.camera_to_base).apply(points)


def _errors(
    points: Float64[np.ndarray, "n 3"], before: _View, now: _View, scale: float
) -> Float64[np.ndarray, " n"]:
    """Errors of points' depths if the robot had moved a share of what odometry says.

    In multiples of the error that is expected; NaN of points that aren't seen.
    """
    at = before.base_to_odom.translation + scale * _motion(before, now)
    base_to_odom = Transform(now.base_to_odom.rotation, at)
    seen = (base_to_odom @ now.camera_to_base).inverse().apply(points)
    camera, errors = now.seen.camera, np.full(len(points), np.nan)
    before_it = np.flatnonzero(seen[:, 2] > 0.0)
    pixels = camera.project(seen[before_it])
    inside = camera.contains(pixels)
    at_pixels, shown = pixels[inside].astype(np.intp), before_it[inside]
    measured = now.seen.depth[at_pixels[:, 1], at_pixels[:, 0]]
    far = seen[shown, 2]
    found = np.abs(measured - far) / (_NEAR_M + _NEAR_SHARE * far)
    errors[shown] = np.where(is_measured(measured), found, np.nan)
    return errors
