"""A path as its follower sees it: how far along it the robot is, and what lies ahead."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.core.geometry.transforms import distances_to_segment, wrap_angle

_SAME_LINE_M = 0.02
"""Deviation below which a corner is ignored: paths from cell to cell are staircases."""
_BACK_M = 0.3
"""Length by which a robot may have moved back on its path, metres."""
_STEP_M = 0.025
_THERE_M = 0.05
"""Distance from a corner at which a robot is there."""


class PathAhead:
    """A path without superfluous corners, and the robot's progress along it."""

    def __init__(self, path: Sequence[tuple[float, float]], sharp_deg: float) -> None:
        """Take a path of at least one corner.

        Args:
            path: Corners ``(x, y)``, metres.
            sharp_deg: Angle of the corners at which the robot has to stop, degrees.
        """
        self._corners = _simplified(np.array(path, dtype=np.float64).reshape(-1, 2))
        legs = np.diff(self._corners, axis=0)
        self._at = np.concatenate([[0.0], np.cumsum(np.hypot(*legs.T))])
        headings = np.arctan2(legs[:, 1], legs[:, 0])
        sharp = [
            at
            for at, turn in zip(self._at[1:-1], np.diff(headings), strict=True)
            if abs(wrap_angle(float(turn))) > math.radians(sharp_deg)
        ]
        self._stops = [*map(float, sharp), self.length_m]
        self._along_m = self._passed_m = 0.0

    @property
    def length_m(self) -> float:
        """Length of the path, metres."""
        return float(self._at[-1])

    def point(self, along_m: float) -> tuple[float, float]:
        """Point ``(x, y)`` at a length along the path, metres; its end beyond it."""
        x, y = (np.interp(along_m, self._at, self._corners[:, axis]) for axis in (0, 1))
        return (float(x), float(y))

    def pass_to(self, x: float, y: float, within_m: float) -> float:
        """The length along the path to its point nearest to the robot, metres.

        Progress is monotonic: where the path passes the same place twice, the next pass counts, and
        a sharp corner that the robot was at stays behind it, also where the path leads back.

        Args:
            x: Position of the robot, metres.
            y: The same.
            within_m: Length beyond the previous point within which the robot may be now, metres.
        """
        low = max(self._along_m - _BACK_M, self._passed_m)
        count = max(math.ceil((self._along_m + within_m - low) / _STEP_M), 1)
        lengths = np.minimum(low + np.arange(count + 1) * _STEP_M, self.length_m)
        points = np.stack([np.interp(lengths, self._at, self._corners[:, k]) for k in (0, 1)], 1)
        self._along_m = float(lengths[np.hypot(points[:, 0] - x, points[:, 1] - y).argmin()])
        self._passed_m = max(
            (at for at in self._stops[:-1] if self._is_behind(at, x, y)), default=0.0
        )
        self._along_m = max(self._along_m, self._passed_m)
        return self._along_m

    def _is_behind(self, stop_m: float, x: float, y: float) -> bool:
        """Whether the robot is beyond a sharp corner, or at it."""
        left_m = stop_m - self._along_m
        return left_m <= 0.0 or (
            left_m <= _THERE_M and math.dist(self.point(stop_m), (x, y)) <= _THERE_M
        )

    def next_stop_m(self, along_m: float, passed_m: float) -> float:
        """Length from a point of the path to the next sharp corner or the end, metres.

        Args:
            along_m: Length of the path up to the point, metres.
            passed_m: Length before a corner at which it counts as passed, metres.
        """
        ahead = [at - along_m for at in self._stops if at - along_m > passed_m]
        return ahead[0] if ahead else self.length_m - along_m

    def aim_m(self, x: float, y: float, along_m: float, ahead_m: float, cut_m: float) -> float:
        """Length along the path of the farthest point that the robot may go straight to, metres.

        Args:
            x: Position of the robot, metres.
            y: The same.
            along_m: Length along the path to the point nearest to the robot, metres.
            ahead_m: Largest length beyond it, metres.
            cut_m: Largest distance of a corner from that line, metres.
        """
        robot, steps = np.array([x, y]), math.ceil(ahead_m / _STEP_M)
        for step in range(steps, 1, -1):
            end_m = min(along_m + step * _STEP_M, self.length_m)
            between = self._corners[(self._at > along_m) & (self._at < end_m)]
            cuts_m = distances_to_segment(between, robot, np.array(self.point(end_m)))
            if cuts_m.max(initial=0.0) <= cut_m:
                return end_m
        return min(along_m + _STEP_M, self.length_m)


def _simplified(corners: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "m 2"]:
    if len(corners) < 3:
        return corners
    curve = corners.astype(np.float32).reshape(-1, 1, 2)
    kept = cv2.approxPolyDP(curve, _SAME_LINE_M, False).reshape(-1, 2).astype(np.float64)
    # Single precision is used only to choose corners; both ends stay exact.
    kept[0], kept[-1] = corners[0], corners[-1]
    return kept
