"""Whether images turn as the robot's poses do."""

import math
from collections import deque

import cv2
import numpy as np
from jaxtyping import Float32, Float64, UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle

_COLUMNS = 64
"""Width to which images are reduced: the rest is detail that moves with every centimetre."""
_TURNED_RAD = math.radians(5.0)
_MOVED_M = 0.1
"""Least turn that is looked at, and the largest motion beside it."""
_LEAST_OVERLAP, _LEAST_PIXELS = 0.25, 200
_FARTHEST = 3.0
"""Multiple of the median depth beyond which things count as equally far."""
_LEAST_TURNS, _MOST_TURNS = 3, 12
_FITS, _DOES_NOT_FIT, _BETTER = 0.6, 0.5, 0.4
"""Least correlation of images that show the same; that below which they don't; least difference.
In rooms of houses turns that are read rightly give 0.85 to 1, and other angles up to 0.8."""
_FACTORS = {"other way": -1.0, "not": 0.0, "half": 0.5, "0.7": 0.7, "1.4": 1.4, "twice": 2.0}
_LATE = "late"
_WORDS = {
    "other way": "turn the other way than the poses: are they mirrored, or does yaw grow to the "
    "right (expected: to the left, REP 103)?",
    "not": "don't turn when the poses do: does the camera's program send old images, or does the "
    "odometry turn without the robot?",
    _LATE: "turn one observation later than the poses: does the camera's program send images from "
    "a buffer (read until the newest, or let the robot stand before an image is taken)?",
}
_OF_ANOTHER_ANGLE = (
    "turn {factor:g} times as far as the poses: are fx and fy (or hfov_deg) those of this image "
    "size, and is yaw in radians?"
)
_Signal = Float32[np.ndarray, "rows columns"]


class TurnFit:
    """Correlates every image with the one before, turned as the poses say, and by other angles.

    Colour and depth are looked at separately, since either may be mirrored or old. What is the same
    in all of a row, as level floor is, tells nothing and is left out.
    """

    def __init__(self, camera: PinholeCamera) -> None:
        """Begin without images.

        Args:
            camera: Camera of the images.
        """
        height = max(round(_COLUMNS * camera.height / camera.width), 2)
        across, down = _COLUMNS / camera.width, height / camera.height
        self._camera = PinholeCamera(
            _COLUMNS,
            height,
            camera.fx * across,
            camera.fy * down,
            camera.cx * across,
            camera.cy * down,
        )
        self._rays = self._camera.rays()
        self._range_m = np.linalg.norm(self._rays, axis=2).astype(np.float32)
        self._before: tuple[dict[str, _Signal], Pose2] | None = None
        self._last_turn: float | None = 0.0
        self._seen: dict[tuple[str, str], deque[tuple[float, float]]] = {}

    def note(
        self,
        rgb: UInt8[np.ndarray, "height width 3"],
        depth: Float32[np.ndarray, "height width"],
        pose: Pose2,
        camera_to_base: Transform,
    ) -> None:
        """Take an image.

        Args:
            rgb: Colour.
            depth: Depth, in any unit.
            pose: Pose by odometry, as the robot says.
            camera_to_base: Pose of the camera on the robot.
        """
        now = {"colour": self._grey(rgb), "depth": self._ranges(depth)}
        before, self._before = self._before, (now, pose)
        if before is None:
            return
        signals, was = before
        turn = wrap_angle(pose.yaw - was.yaw)
        last, self._last_turn = self._last_turn, turn
        angles = {name: factor * turn for name, factor in _FACTORS.items()}
        if abs(turn) < _TURNED_RAD or was.distance_to(*pose.xy) > _MOVED_M:
            angles = {}
        if last is not None and abs(wrap_angle(turn - last)) > _TURNED_RAD:
            angles[_LATE] = last
        for name, image in now.items():
            told = self._correlation(signals[name], image, turn, camera_to_base)
            for other, angle in angles.items():
                found = self._correlation(signals[name], image, angle, camera_to_base)
                if told is not None and found is not None:
                    pairs = self._seen.setdefault((name, other), deque(maxlen=_MOST_TURNS))
                    pairs.append((told, found))

    def doubt(self) -> str | None:
        """What may be misread, in a sentence that names the evidence; None if all fits."""
        means = {
            key: tuple(np.mean(pairs, axis=0).tolist())
            for key, pairs in self._seen.items()
            if len(pairs) >= _LEAST_TURNS
        }
        doubted = [
            (found, told, other)
            for (_, other), (told, found) in means.items()
            if found >= _FITS and told < _DOES_NOT_FIT and found - told >= _BETTER
        ]
        if not doubted:
            return None
        found, told, other = max(doubted)
        names = " and ".join(
            name
            for (name, one), (as_told, as_other) in means.items()
            if one == other and as_other >= max(as_told, _FITS)
        )
        words = _WORDS.get(other) or _OF_ANOTHER_ANGLE.format(factor=_FACTORS[other])
        return f"the {names} images {words} Correlation {found:.2f} so, {told:.2f} as the poses say"

    def _grey(self, rgb: UInt8[np.ndarray, "height width 3"]) -> _Signal:
        size = (self._camera.width, self._camera.height)
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        return cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.float32)

    def _ranges(self, depth: Float32[np.ndarray, "height width"]) -> _Signal:
        """Distances from the lens, which turns on the spot don't change; NaN without a return."""
        size = (self._camera.width, self._camera.height)
        coarse = cv2.resize(depth, size, interpolation=cv2.INTER_NEAREST)
        measured = is_measured(coarse)
        if not measured.any():
            return np.full_like(coarse, np.nan)
        ranges = np.where(measured, coarse * self._range_m, np.float32(np.nan))
        return np.minimum(ranges, _FARTHEST * np.nanmedian(ranges))

    def _correlation(
        self, before: _Signal, now: _Signal, turn: float, camera_to_base: Transform
    ) -> float | None:
        """Correlation of an image with that before a turn; None if they share too little."""
        mount = camera_to_base.rotation
        turned = mount.T @ Pose2(0.0, 0.0, turn).to_transform().rotation @ mount
        pixels = self._camera.project(self._rays.reshape(-1, 3) @ turned.T)
        rows = np.repeat(np.arange(self._camera.height), self._camera.width)
        shared = np.flatnonzero(self._camera.contains(pixels))
        if shared.size < _LEAST_OVERLAP * rows.size:
            return None
        u, v = pixels[shared].astype(np.intp).T
        first, second, rows = before[v, u], now.ravel()[shared], rows[shared]
        known = np.isfinite(first) & np.isfinite(second)
        if np.count_nonzero(known) < _LEAST_PIXELS:
            return None
        first, second = (_varying(one[known], rows[known]) for one in (first, second))
        size = float(np.linalg.norm(first) * np.linalg.norm(second))
        return float(first @ second) / size if size > 1e-6 else None


def _varying(values: Float32[np.ndarray, " n"], rows: np.ndarray) -> Float64[np.ndarray, " n"]:
    """Values without the mean of their row."""
    counts = np.maximum(np.bincount(rows), 1)
    return values - (np.bincount(rows, values) / counts)[rows]
