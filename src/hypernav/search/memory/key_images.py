"""Key images: few frames that together show most of what the robot has seen.

A frame is kept if it shows enough surface that no key image shows, or a thing that none shows.
Beyond the bound the image is forgotten first whose surfaces the others show, too.
"""

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt8

from hypernav.core.embodiment import CameraConfig
from hypernav.core.errors import MemoryFolderError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.search.memory.image_kernels import points_under

MOST_BYTES = 50_000_000
"""Size of a memory on disk, bytes, unless another is chosen."""
LARGEST_BYTES = 500_000_000
"""The largest that can be chosen: a memory is opened as a whole."""
_PATCH_M = 0.5
"""Side of the cubes that surfaces are counted in, metres."""
_STRIDE = 16
_LEAST_PATCHES = 24
"""Number of patches of surface that no key image shows, from which a frame becomes one."""
_THING_PATCHES = 8
"""Number of patches that a thing is worth which no other key image shows as well."""
_DEPTH_STEP = 4
"""Stride of the pixels whose depth is kept: surfaces are told by every 16th one."""
_JPEG_QUALITY = 85
_NEAREST_M = 0.1
"""Distance in front of a camera, metres, from which a corner of a thing is marked."""
_NOTES_BYTES = 2000
"""Size of an image's pose, files and patches in the files of a memory; rounded up."""
_LAYERS = 1 << 10
_ACROSS = 1 << 16
"""Numbers of patches on top of each other and side by side; more than any building has."""

Corner = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class KeyImage:
    """One frame, compressed.

    Attributes:
        number: Its number in the memory.
        floor: Number of the floor that it was taken on.
        search: Number of the search that took it.
        jpeg: Colour image, JPEG.
        png: Depth, millimetres as 16-bit PNG, every `_DEPTH_STEP`-th pixel; 0 where none is known.
        camera: Intrinsics of the colour image.
        camera_to_map: Pose of the camera, heights above the floor.
        robot: Pose of the robot.
        patches: Sorted numbers of the patches of surface that it shows.
    """

    number: int
    floor: int
    search: int
    jpeg: bytes
    png: bytes
    camera: PinholeCamera
    camera_to_map: Transform
    robot: Pose2
    patches: Int64[np.ndarray, " n"]

    @property
    def size(self) -> int:
        """Size of both images and of what is noted about them, bytes."""
        return len(self.jpeg) + len(self.png) + _NOTES_BYTES

    @property
    def rgb(self) -> UInt8[np.ndarray, "height width 3"]:
        """The colour image.

        Raises:
            MemoryFolderError: It can't be decoded.
        """
        with self._naming_damage():
            bgr = _decoded(self.jpeg, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
        return cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)

    @property
    def depth(self) -> Float32[np.ndarray, "rows columns"]:
        """The kept depth, metres.

        Raises:
            MemoryFolderError: It can't be decoded.
        """
        with self._naming_damage():
            return _metres(self.png)

    @contextmanager
    def _naming_damage(self) -> Iterator[None]:
        try:
            yield
        except ValueError as error:
            raise MemoryFolderError(
                f"key image {self.number} of the memory is damaged ({error}); hypernav memory "
                "FOLDER --forget-images forgets all"
            ) from error

    def box_of(self, low: Corner, high: Corner) -> tuple[float, float, float, float] | None:
        """Where it shows a thing, as the box around the thing's corners.

        Args:
            low: Lowest corner of the thing, heights above the floor, metres.
            high: Its highest corner.

        Returns:
            Left, top, width and height as shares of the image; None if no corner is in front of it.
        """
        corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
        seen = self.camera_to_map.inverse().apply(corners)
        seen = seen[seen[:, 2] > _NEAREST_M]
        if not len(seen):
            return None
        at = self.camera.project(seen) / (self.camera.width, self.camera.height)
        (left, top), (right, bottom) = (
            bound.clip(0.0, 1.0).tolist() for bound in (at.min(0), at.max(0))
        )
        return (left, top, right - left, bottom - top)


@dataclass(eq=False)
class KeyImages:
    """The key images of a building.

    Attributes:
        most_bytes: Size of all images together, bytes, beyond which some are forgotten.
        kept: The images, the oldest first.
        count: Number of key images so far, for the next one's number.
        showing: Number of images that show each patch.
        forgotten: Number of images that were forgotten for want of room.
    """

    most_bytes: int
    kept: list[KeyImage] = field(default_factory=list)
    count: int = 0
    showing: Counter[int] = field(default_factory=Counter)
    forgotten: int = 0

    def take(
        self,
        observation: Observation,
        sensor: CameraConfig,
        *,
        floor: int,
        search: int,
        shows_new_thing: bool,
    ) -> KeyImage | None:
        """Keep a frame if it tells enough.

        Args:
            observation: The frame, with heights counted from the floor.
            sensor: Camera, whose range of depth counts.
            floor: Number of the floor.
            search: Number of the search.
            shows_new_thing: Whether it shows a thing that no key image shows.

        Returns:
            The key image that it became; None if it tells too little.
        """
        patches = patches_of(observation, sensor, floor)
        new = sum(patch not in self.showing for patch in patches.tolist())
        if new < _LEAST_PATCHES and not shows_new_thing:
            return None
        bgr = cv2.cvtColor(observation.rgb, cv2.COLOR_RGB2BGR)
        image = KeyImage(
            number=self.count,
            floor=floor,
            search=search,
            jpeg=_encoded(".jpg", bgr, cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY),
            png=_encoded(".png", _millimetres(observation), cv2.IMWRITE_PNG_COMPRESSION, 1),
            camera=observation.camera,
            camera_to_map=observation.camera_to_map,
            robot=observation.robot,
            patches=patches,
        )
        self.add(image)
        return image

    def find(self, number: int) -> KeyImage | None:
        """The image of a number; None if it was forgotten."""
        return next((one for one in self.kept if one.number == number), None)

    def earlier(self, floor: int, *, before: int) -> list[KeyImage]:
        """The images of a floor that were taken before the search of a number."""
        return [one for one in self.kept if one.floor == floor and one.search < before]

    def most_telling(self, floor: int, *, before: int, most: int) -> tuple[int, ...]:
        """Numbers of images that together show as much of a floor as so many can.

        Each shows the most surface that those before it don't show. Once they show all of it, the
        next ones show it again.

        Args:
            floor: Number of the floor.
            before: Number of the search before which they were taken.
            most: Largest number of images.
        """
        left = self.earlier(floor, before=before)
        chosen, shown = list[int](), np.empty(0, np.int64)
        while left and len(chosen) < most:
            new = [len(one.patches) - int(np.isin(one.patches, shown).sum()) for one in left]
            if max(new) == 0 and len(shown):
                shown = shown[:0]
                continue
            one = left.pop(new.index(max(new)))
            chosen.append(one.number)
            shown = np.union1d(shown, one.patches)
        return tuple(chosen)

    def add(self, image: KeyImage) -> None:
        """Add a key image."""
        self.kept.append(image)
        self.showing.update(image.patches.tolist())
        self.count = max(self.count, image.number + 1)

    def shrink(self, most_bytes: int, shown: Iterable[int | None]) -> list[int]:
        """Forget images until all together are small enough.

        Args:
            most_bytes: Size that is allowed, bytes.
            shown: For every thing the number of the image that shows it best.

        Returns:
            Numbers of the forgotten images.
        """
        things, forgotten = Counter(shown), list[int]()
        size = sum(one.size for one in self.kept)
        while self.kept and size > most_bytes:
            least = min(self.kept, key=lambda one: self._worth(one, things))
            self.kept.remove(least)
            size -= least.size
            forgotten.append(least.number)
            self.showing.subtract(least.patches.tolist())
            self.showing = +self.showing  # without the patches that no image shows any more
        return forgotten

    def _worth(self, one: KeyImage, things: Counter[int | None]) -> int:
        """Number of patches that only this image shows; things count as several."""
        alone = sum(self.showing[patch] == 1 for patch in one.patches.tolist())
        return alone + _THING_PATCHES * things[one.number]


def patches_of(
    observation: Observation, sensor: CameraConfig, floor: int
) -> Int64[np.ndarray, " n"]:
    """Sorted numbers of the patches of surface that a frame shows, different on every floor."""
    camera = observation.camera
    points = points_under(
        None,
        np.require(observation.depth, np.float32, ["C", "W"]),
        (0, 0, camera.width, camera.height),
        _STRIDE,
        sensor.depth_limits_m,
        camera.lens,
        observation.camera_to_map.rows,
    )
    return _patches_at(points, floor)


def with_patches(image: KeyImage) -> KeyImage:
    """The same image with its patches, as its depth shows them.

    Raises:
        ValueError: Its depth can't be decoded.
    """
    kept = _metres(image.png)
    stride = _STRIDE // math.ceil(image.camera.width / kept.shape[1])  # older memories keep more
    depth = kept[::stride, ::stride]
    rows, columns = np.nonzero(depth)
    points = image.camera.unproject_pixels(rows * _STRIDE, columns * _STRIDE, depth[rows, columns])
    return replace(image, patches=_patches_at(image.camera_to_map.apply(points), image.floor))


def _patches_at(points: Float64[np.ndarray, "n 3"], floor: int) -> Int64[np.ndarray, " patches"]:
    cells = np.round(points / _PATCH_M).astype(np.int64)  # floors and walls lie inside, not between
    layers = (floor * _LAYERS + cells[:, 2] + _LAYERS // 2) * _ACROSS
    return np.unique((layers + cells[:, 1] + _ACROSS // 2) * _ACROSS + cells[:, 0] + _ACROSS // 2)


def _encoded(kind: str, image: np.ndarray, *settings: int) -> bytes:
    _, data = cv2.imencode(kind, image, list(settings))
    return data.tobytes()


def _decoded(data: bytes, how: int) -> np.ndarray:
    image = cv2.imdecode(np.frombuffer(data, np.uint8), how) if data else None
    if image is None:
        raise ValueError("it is no image, or a damaged one")
    return np.asarray(image)


def _metres(png: bytes) -> Float32[np.ndarray, "rows columns"]:
    return _decoded(png, cv2.IMREAD_UNCHANGED).astype(np.float32) / np.float32(1000.0)


def _millimetres(observation: Observation) -> np.ndarray:
    metres = np.nan_to_num(observation.depth[::_DEPTH_STEP, ::_DEPTH_STEP], posinf=0.0)
    return np.clip(np.round(metres * 1000.0), 0.0, 65535.0).astype(np.uint16)
