"""Looks in a search's first images for what is plausible but misread.

`Sensing` ends a search by what can't be right. What could be, such as a floor that is really ten
times as far away, is only said: the robot's owner knows more.
"""

import math
from collections.abc import Callable

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.observation import Observation
from hypernav.robot.server.doubts.floor import FloorFit
from hypernav.robot.server.doubts.turns import TurnFit
from hypernav.robot.wire.requests import ObservationFacts

_MOST_IMAGES = 40
"""Number of observations that are looked at: a look around, and some of the way."""
_LEAST_IMAGES = 12
_MOVED_M, _TURNED_RAD = 0.1, math.radians(5.0)
_ASIDE = 0.2
"""Largest distance of the principal point from the image's centre, as a share of its size; lenses
have less than 0.1."""
_EVERY = 4
_SATURATION, _BRIGHTNESS = 64, 50
_LEAST_COLOURED = 0.03
_MOST_WARM, _LEAST_COLD = 0.15, 0.6
"""Shares of warm and cold hues in the coloured pixels of images whose red and blue are exchanged.
Wood, skin and lamps are warm: rooms have shares from 0.5 and up to 0.25."""
_WARM_DEG, _COLD_DEG = (0, 60), (180, 240)


class Doubts:
    """Notes a search's first observations, and says each doubt once."""

    def __init__(self, camera: PinholeCamera, camera_to_base: Transform) -> None:
        """Begin without images.

        Args:
            camera: Camera of the search.
            camera_to_base: Pose of the camera on the robot, unless an observation has its own.
        """
        self._camera, self._camera_to_base = camera, camera_to_base
        self._floor, self._turns = FloorFit(camera), TurnFit(camera)
        self._hues = np.zeros(3)  # pixels, coloured ones with warm, and with cold hues
        self._coloured = 0
        self._count, self._views = 0, 0
        self._last: Pose2 | None = None
        self._said: set[str] = set()
        self._checks: dict[str, Callable[[], str | None]] = {
            "lens": self._doubt_of_lens,
            "floor": self._floor.doubt,
            "turns": self._doubt_of_turns,
            "hues": self._doubt_of_hues,
        }

    def look(self, facts: ObservationFacts, seen: Observation) -> list[str]:
        """The doubts that are new with an observation, one sentence each."""
        self._count += 1
        if self._count > _MOST_IMAGES:
            return []
        mount = facts.camera_pose(self._camera_to_base)
        said = facts.base_to_odom
        pose = Pose2(said.x, said.y, said.yaw)
        self._turns.note(seen.rgb, seen.depth, pose, mount)
        if self._last is None or _is_elsewhere(self._last, pose):
            self._last = pose
            self._views += 1
            self._floor.note(seen.depth, mount)
            self._note_hues(seen.rgb)
        new: list[str] = []
        for kind, find in self._checks.items():
            if kind not in self._said and (words := find()) is not None:
                self._said.add(kind)
                new.append(words)
        return new

    def _doubt_of_turns(self) -> str | None:
        """Turns that don't fit; nothing if a wrong lens or pose of the camera may explain them."""
        is_explained = self._said & {"lens", "floor"} or self._views < _LEAST_IMAGES
        return None if is_explained else self._turns.doubt()

    def _doubt_of_lens(self) -> str | None:
        lens = self._camera
        aside = max(abs(lens.cx / lens.width - 0.5), abs(lens.cy / lens.height - 0.5))
        if aside <= _ASIDE:
            return None
        return (
            f"the principal point ({lens.cx:.0f}, {lens.cy:.0f}) is far from the middle of images "
            f"of {lens.width} × {lens.height} pixels; are fx, fy, cx and cy those of this size?"
        )

    def _note_hues(self, rgb: UInt8[np.ndarray, "height width 3"]) -> None:
        coarse = np.ascontiguousarray(rgb[::_EVERY, ::_EVERY])
        hue, saturation, value = np.moveaxis(cv2.cvtColor(coarse, cv2.COLOR_RGB2HSV), 2, 0)
        hues = 2 * hue[(saturation > _SATURATION) & (value > _BRIGHTNESS)].astype(np.int64)
        warm, cold = (
            np.count_nonzero((hues >= low) & (hues <= high)) for low, high in (_WARM_DEG, _COLD_DEG)
        )
        self._hues += hue.size, warm, cold
        self._coloured += hues.size

    def _doubt_of_hues(self) -> str | None:
        pixels, warm, cold = self._hues.tolist()
        if self._views < _LEAST_IMAGES or self._coloured < _LEAST_COLOURED * pixels:
            return None
        if warm > _MOST_WARM * self._coloured or cold < _LEAST_COLD * self._coloured:
            return None
        return (
            f"{cold / self._coloured:.0%} of the coloured pixels are blue and "
            f"{warm / self._coloured:.0%} red to yellow, in rooms usually the reverse; are red and "
            "blue exchanged (OpenCV's arrays are BGR, and its imencode expects them so)?"
        )


def _is_elsewhere(before: Pose2, now: Pose2) -> bool:
    turned = abs(wrap_angle(now.yaw - before.yaw))
    return turned > _TURNED_RAD or before.distance_to(*now.xy) > _MOVED_M
