"""All that a robot's camera sees from one position in a full turn."""

import io
import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int32, UInt8
from PIL import Image

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.world import Instance
from hypernav.houses.export.views import camera_pose
from hypernav.worlds.drawing.renderer import CpuRenderer
from hypernav.worlds.surface.walkable import WalkableGrid

SLICES = 8
"""Number of images side by side that make a panorama."""
_SLICE_WIDTH = 232
_LEAST_PIXELS = 200
"""Size from which an object counts as seen, pixels."""
_QUALITY = 50


@dataclass(frozen=True)
class Sighting:
    """An object that a panorama shows.

    Attributes:
        instance: Number of the object in its scene.
        yaw: Direction of the middle column that shows it, radians in the scene frame.
        distance_m: Median horizontal distance of its visible part, metres.
        pixels: Number of pixels that show it.
    """

    instance: int
    yaw: float
    distance_m: float
    pixels: int


@dataclass(frozen=True, eq=False)
class Panorama:
    """Slices of a circle side by side: images of a pinhole camera, each turned further right.

    The first slice begins at a yaw of 180°. Drawn on the faces of a prism, the panorama gives the
    camera's perspective without kinks at the seams.

    Attributes:
        rgb: Colours.
        depth: Metres along the axis of the slice's camera; 0 where nothing was hit.
        instance_ids: Instance of every pixel, -1 where nothing was hit.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    instance_ids: Int32[np.ndarray, "height width"]

    def webp(self) -> bytes:
        """The colours as a file."""
        file = io.BytesIO()
        Image.fromarray(self.rgb).save(file, "WEBP", quality=_QUALITY, method=2)
        return file.getvalue()

    def sightings(self, instances: tuple[Instance, ...]) -> list[Sighting]:
        """The labelled objects that are large enough to be noticed, largest first.

        Args:
            instances: Instances of the scene.
        """
        yaws = column_yaws()
        off_axis = np.tile(np.arctan(slice_camera().ray_slopes()[0]), SLICES)
        distances = self.depth / np.cos(off_axis)[None, :]
        pixels = np.bincount(self.instance_ids[self.instance_ids >= 0], minlength=len(instances))
        found = []
        for number in np.flatnonzero(pixels >= _LEAST_PIXELS).tolist():
            if instances[number].label is None:
                continue
            shown = self.instance_ids == number
            columns = np.flatnonzero(shown.any(axis=0))
            middle = np.exp(1j * yaws[columns]).mean()
            column = columns[np.argmax((np.exp(1j * yaws[columns]) * np.conj(middle)).real)]
            found.append(
                Sighting(
                    number,
                    float(yaws[column]),
                    float(np.median(distances[shown])),
                    int(pixels[number]),
                )
            )
        return sorted(found, key=lambda sighting: (-sighting.pixels, sighting.instance))


def slice_camera() -> PinholeCamera:
    """Camera of one slice, high enough for the robot's camera in every direction."""
    half = math.pi / SLICES
    focal = _SLICE_WIDTH / 2.0 / math.tan(half)
    height = 2 * math.ceil(focal * half_slope() / math.cos(half))
    return PinholeCamera(_SLICE_WIDTH, height, focal, focal, _SLICE_WIDTH / 2.0, height / 2.0)


def half_slope() -> float:
    """Tangent of half the vertical field of view of the robot's camera."""
    camera = CameraConfig().intrinsics
    return camera.height / 2.0 / camera.fy


def column_yaws() -> Float64[np.ndarray, " width"]:
    """Direction of every column of a panorama, radians in the scene frame, falling from pi."""
    middles = math.pi - (np.arange(SLICES) + 0.5) * 2.0 * math.pi / SLICES
    off_axis = np.arctan(slice_camera().ray_slopes()[0])
    return (middles[:, None] - off_axis[None, :]).ravel()


def draw_panorama(
    position: tuple[float, float], *, grid: WalkableGrid, renderer: CpuRenderer
) -> Panorama:
    """Draw what the robot's camera sees around a position.

    Args:
        position: Standable point, metres, scene frame.
        grid: Where the robot can stand.
        renderer: Renderer of the scene.
    """
    camera, config = slice_camera(), CameraConfig()
    views = [
        renderer.render(camera, camera_pose(grid, config, Pose2(*position, yaw)))
        for yaw in math.pi - (np.arange(SLICES) + 0.5) * 2.0 * math.pi / SLICES
    ]
    return Panorama(
        np.concatenate([view.rgb for view in views], axis=1),
        np.concatenate([view.depth for view in views], axis=1),
        np.concatenate([view.instance_ids for view in views], axis=1),
    )
