"""Whether depth images show a level floor where the camera's pose says that it is."""

import math
from itertools import compress

import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Transform

_COLUMNS = 80
"""Number of image columns that are looked at: floors are large."""
_FARTHEST_M = 5.0
"""Distance up to which floor is expected to be measured."""
_BIN = 0.05
_BINS = np.arange(-8.0, 8.0 + _BIN / 2.0, _BIN)
"""Logarithms of ratios of depths: factors up to 3000."""
_NEAR = 2.5 * _BIN
"""Logarithm of the ratio within which a depth is that of the floor: 13 %."""
_LEAST_PIXELS = 50
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


_MISREADINGS = {
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
        self._every = max(camera.width // _COLUMNS, 1)
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
        told = self._logs(seen, measured, camera_to_base.rotation)
        counts, _ = np.histogram(told, _BINS)
        self._factors.append(counts / max(told.size, 1))
        turned = (camera_to_base.rotation @ by for by in _MISREADINGS.values())
        logs = [told, *(self._logs(seen, measured, rotation) for rotation in turned)]
        self._shares.append(
            [float(np.mean(np.abs(one) < _NEAR)) if one.size else 0.0 for one in logs]
        )

    def doubt(self) -> str | None:
        """What may be misread, in a sentence that names the evidence; None if all fits."""
        if len(self._shares) < _LEAST_IMAGES:
            return None
        told, *others = np.mean(self._shares, axis=0).tolist()
        log, share = _lowest_level(np.mean(self._factors, axis=0))
        best = max(others)
        if best >= max(_LEAST_SHARE, share) and told <= _LESS * best:
            fitting = (one > best - _ALIKE for one in others)
            return _words_of_a_frame(told, best, next(compress(_MISREADINGS, fitting)))
        most = (_MUCH_LESS if log > 0.0 else _LESS) * share
        if abs(log) < _OTHER_FACTOR or share < _LEAST_SHARE or told > most:
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
        if np.count_nonzero(looks) < _LEAST_PIXELS:
            return np.zeros(0)
        return np.log(self._height_m / down[looks] / depth[looks])


def _words_of_a_frame(told: float, best: float, misreading: str) -> str:
    return (
        f"{told:.0%} of the depth that looks down is floor where the camera's pose puts it, and "
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
