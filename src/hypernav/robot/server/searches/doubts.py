"""Looks in a search's first images for what is plausible but misread.

`Sensing` ends a search by what can't be right. What could be, such as a floor that is really ten
times as far away, is only said: the robot's owner knows more.
"""

import math
from collections import deque
from collections.abc import Callable
from itertools import compress

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, UInt8

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.observation import Observation
from hypernav.robot.wire.requests import ObservationFacts

_FLOOR_COLUMNS = 80
"""Number of image columns that are looked at: floors are large."""
_FARTHEST_M = 5.0
"""Distance up to which floor is expected to be measured."""
_BIN = 0.05
_BINS = np.arange(-8.0, 8.0 + _BIN / 2.0, _BIN)
"""Logarithms of ratios of depths: factors up to 3000."""
_NEAR = 2.5 * _BIN
"""Logarithm of the ratio within which a depth is that of the floor: 13 %."""
_LEAST_FLOOR_PIXELS = 50
_LEAST_IMAGES = 12
"""Number of images, as in a look around, before which nothing is said."""
_LEAST_SHARE = 0.2
"""Share of floor in what looks down, below which another reading of the images is none. In rooms of
houses floor has 0.2 to 0.96; walls and furniture alone, read wrongly, up to 0.19."""
_LESS, _MUCH_LESS = 0.5, 0.3
"""Largest share of floor as the robot says it is, relative to that of another reading; the second
for floor that seems higher, where table tops could be mistaken for it."""
_ALIKE = 0.05
"""Difference of shares within which two readings fit alike: the first of them is named."""
_OTHER_FACTOR = 0.2
"""Least logarithm of the ratio of depths that is said: a tilt by a few degrees explains less."""
_OF_THE_LARGEST = 0.6
"""Share, relative to the largest level, from which a lower one is the floor: tables are higher."""
_UNITS = (10.0, 5.0, 4.0, 0.25, 0.2, 0.1)
_BODY = optical_to_base(0.0).rotation


def _about_the_axis(angle_deg: float) -> Float64[np.ndarray, "3 3"]:
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


_FRAME_MISREADINGS = {
    "its pose is in the convention of OpenGL (y up, z backward)": np.diag([1.0, -1.0, -1.0]),
    "its frame is that of a body (x forward, z up)": _BODY,
    "its images are turned by 90° to the left, as of a camera on its side": _about_the_axis(90.0),
    "its images are turned by 90° to the right, as of a camera on its side": _about_the_axis(-90.0),
    "its images are upside down": np.diag([-1.0, -1.0, 1.0]),
}
"""Rotations from the true optical frame to the one whose pose the robot gives."""


class FloorFit:
    """Compares depth with the floor below the camera, over several images.

    A wrong unit, another camera's calibration, unregistered depth and a wrong height change the
    distance of all floor by one factor; a wrong frame puts it elsewhere. Which of several causes it
    is, depth alone can't tell.
    """

    def __init__(self, camera: PinholeCamera) -> None:
        """Begin without images.

        Args:
            camera: Camera of the images.
        """
        self._every = max(camera.width // _FLOOR_COLUMNS, 1)
        self._rays = camera.rays()[:: self._every, :: self._every].reshape(-1, 3)
        self._factors: list[Float64[np.ndarray, " bins"]] = []
        self._shares: list[list[float]] = []
        self._height_m = 0.0

    def note(self, depth: Float32[np.ndarray, "height width"], camera_to_base: Transform) -> None:
        """Take an image that shows another place than the one before.

        Args:
            depth: Depth, metres; what is farthest may be the limit of the sensor's range.
            camera_to_base: Pose of the camera over the floor, as the robot says.
        """
        seen = depth[:: self._every, :: self._every].astype(np.float64).ravel()
        measured = is_measured(seen, 0.0, float(seen.max(initial=0.0)))
        self._height_m = float(camera_to_base.translation[2])
        claimed = self._logs(seen, measured, camera_to_base.rotation)
        counts, _ = np.histogram(claimed, _BINS)
        self._factors.append(counts / max(claimed.size, 1))
        turned = (camera_to_base.rotation @ by for by in _FRAME_MISREADINGS.values())
        logs = [claimed, *(self._logs(seen, measured, rotation) for rotation in turned)]
        self._shares.append(
            [float(np.mean(np.abs(one) < _NEAR)) if one.size else 0.0 for one in logs]
        )

    def doubt(self) -> str | None:
        """What may be misread, in a sentence that names the evidence; None if all fits."""
        if len(self._shares) < _LEAST_IMAGES:
            return None
        claimed, *others = np.mean(self._shares, axis=0).tolist()
        log, share = _lowest_level(np.mean(self._factors, axis=0))
        best = max(others)
        if best >= max(_LEAST_SHARE, share) and claimed <= _LESS * best:
            fitting = (one > best - _ALIKE for one in others)
            return _words_of_a_frame(claimed, best, next(compress(_FRAME_MISREADINGS, fitting)))
        most = (_MUCH_LESS if log > 0.0 else _LESS) * share
        if abs(log) < _OTHER_FACTOR or share < _LEAST_SHARE or claimed > most:
            return None
        return self._words_of_a_factor(math.exp(-log), share)

    def _words_of_a_factor(self, factor: float, share: float) -> str:
        nearest = min(_UNITS, key=lambda unit: abs(math.log(factor / unit)))
        is_unit = abs(math.log(factor / nearest)) < _NEAR
        unit = (
            "is depth in another unit (png-mm and 16UC1 count millimetres; some cameras count 0.1 "
            "or 0.25 mm)? Else "
        )
        return (
            f"the floor ({share:.0%} of the depth that looks down) is "
            f"{nearest if is_unit else factor:.2g} times as far "
            f"away as it is for a camera {self._height_m:.2f} m above it; {unit if is_unit else ''}"
            "are the camera's height and tilt right, fx and fy those of this image size, and depth "
            "registered to colour?"
        )

    def _logs(
        self,
        depth: Float64[np.ndarray, " n"],
        measured: Bool[np.ndarray, " n"],
        camera_to_base: Float64[np.ndarray, "3 3"],
    ) -> Float64[np.ndarray, " m"]:
        """Logarithms of floor distance by depth, of the pixels that look down at near floor."""
        down = -(self._rays @ camera_to_base[2])
        looks = measured & (down * _FARTHEST_M > self._height_m)
        if np.count_nonzero(looks) < _LEAST_FLOOR_PIXELS:
            return np.zeros(0)
        return np.log(self._height_m / down[looks] / depth[looks])


def _words_of_a_frame(claimed: float, best: float, misreading: str) -> str:
    return (
        f"{claimed:.0%} of the depth that looks down is floor where the camera's pose puts it, and "
        f"{best:.0%} would be if {misreading}; camera_to_base leads from the optical frame (x "
        "right, y down, z forward) to the base, and on ROS frame_id names the optical frame"
    )


def _lowest_level(shares: Float64[np.ndarray, " bins"]) -> tuple[float, float]:
    """Logarithm of the ratio of the lowest of the large levels, and its share.

    Args:
        shares: Share of the depth in every bin of the logarithm.
    """
    window = np.ones(5)
    near = np.convolve(shares, window, mode="same")
    peak = int(np.argmax(near >= _OF_THE_LARGEST * near.max()))
    peak += int(near[peak : peak + 5].argmax())
    around = slice(max(peak - 2, 0), peak + 3)
    middles = _BINS[:-1] + _BIN / 2.0
    return float(np.average(middles[around], weights=shares[around] + 1e-9)), float(near[peak])


_TURN_COLUMNS = 64
"""Width to which images are reduced: the rest is detail that moves with every centimetre."""
_TURNED_RAD = math.radians(5.0)
_MOVED_M = 0.1
"""Least turn that is looked at, and the largest motion beside it."""
_LEAST_OVERLAP, _LEAST_OVERLAP_PIXELS = 0.25, 200
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
        height = max(round(_TURN_COLUMNS * camera.height / camera.width), 2)
        across, down = _TURN_COLUMNS / camera.width, height / camera.height
        self._camera = PinholeCamera(
            _TURN_COLUMNS,
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
            claimed = self._correlation(signals[name], image, turn, camera_to_base)
            for other, angle in angles.items():
                found = self._correlation(signals[name], image, angle, camera_to_base)
                if claimed is not None and found is not None:
                    pairs = self._seen.setdefault((name, other), deque(maxlen=_MOST_TURNS))
                    pairs.append((claimed, found))

    def doubt(self) -> str | None:
        """What may be misread, in a sentence that names the evidence; None if all fits."""
        means = {
            key: tuple(np.mean(pairs, axis=0).tolist())
            for key, pairs in self._seen.items()
            if len(pairs) >= _LEAST_TURNS
        }
        doubted = [
            (found, claimed, other)
            for (_, other), (claimed, found) in means.items()
            if found >= _FITS and claimed < _DOES_NOT_FIT and found - claimed >= _BETTER
        ]
        if not doubted:
            return None
        found, claimed, other = max(doubted)
        names = " and ".join(
            name
            for (name, one), (as_told, as_other) in means.items()
            if one == other and as_other >= max(as_told, _FITS)
        )
        words = _WORDS.get(other) or _OF_ANOTHER_ANGLE.format(factor=_FACTORS[other])
        return (
            f"the {names} images {words} Correlation {found:.2f} so, {claimed:.2f} as the poses say"
        )

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
        if np.count_nonzero(known) < _LEAST_OVERLAP_PIXELS:
            return None
        first, second = (_varying(one[known], rows[known]) for one in (first, second))
        size = float(np.linalg.norm(first) * np.linalg.norm(second))
        return float(first @ second) / size if size > 1e-6 else None


def _varying(values: Float32[np.ndarray, " n"], rows: np.ndarray) -> Float64[np.ndarray, " n"]:
    """Values without the mean of their row."""
    counts = np.maximum(np.bincount(rows), 1)
    return values - (np.bincount(rows, values) / counts)[rows]


_MOST_IMAGES = 40
"""Number of observations that are looked at: a look around, and the beginning of the path."""
_VIEW_MOVED_M, _VIEW_TURNED_RAD = 0.1, math.radians(5.0)
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
    return turned > _VIEW_TURNED_RAD or before.distance_to(*now.xy) > _VIEW_MOVED_M
