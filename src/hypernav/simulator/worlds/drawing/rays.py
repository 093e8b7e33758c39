"""The nearest triangle along rays into a scene, and in every pixel of an image."""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

from hypernav.core.errors import MissingExtraError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.io.kept_arrays import digest_of, kept_arrays
from hypernav.simulator.worlds.drawing.raster_kernels import draw_triangles, find_visible
from hypernav.simulator.worlds.scenes.scene import Scene

_GROUP = 64
"""Number of triangles that are skipped together when they are outside the image."""
_CURVE_BITS = 10


class RayCaster:
    """Embree's search tree over all triangles of a scene. Safe to use from several threads."""

    def __init__(self, scene: Scene) -> None:
        """Build the tree.

        Raises:
            MissingExtraError: The package embreex is not installed.
        """
        try:
            from embreex.mesh_construction import TriangleMesh
            from embreex.rtcore_scene import EmbreeScene
        except ModuleNotFoundError as error:
            raise MissingExtraError(
                "the simulator needs the package 'embreex', which is not installed (it has no "
                "build for Linux on ARM); everything but the simulator works without it; "
                "elsewhere try: pip install embreex"
            ) from error
        # Embree's robust mode costs a fifth more and shows the same instance in every pixel.
        self._tree: Any = EmbreeScene()
        self._face_instance = scene.face_instance
        TriangleMesh(self._tree, scene.vertices, scene.faces)
        # The tree is built on the first use, which must not happen in two threads at once.
        self.faces(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))

    def faces(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> Int32[np.ndarray, "rays"]:
        """First triangle that each ray meets, -1 where it meets none."""
        return self._tree.run(origins, directions)

    def instances(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float32[np.ndarray, "rays 3"]
    ) -> Int32[np.ndarray, "rays"]:
        """First instance that each ray meets, -1 where it meets none."""
        faces = self.faces(origins, directions)
        return np.where(faces >= 0, self._face_instance[faces], np.int32(-1))

    def distances(
        self,
        origins: Float32[np.ndarray, "rays 3"],
        directions: Float32[np.ndarray, "rays 3"],
        reach_m: float,
    ) -> Float32[np.ndarray, "rays"]:
        """Distance to the first triangle in lengths of the direction, at most `reach_m`."""
        reach = np.full(len(origins), reach_m, dtype=np.float32)
        return self._tree.run(origins, directions, reach, query="DISTANCE")


class Rasterizer:
    """A scene's triangles, in groups of neighbours. Safe to use from several threads.

    It gives the same result as rays through the pixel centres, several times faster, because rays
    need a search for every pixel. But scans are not seen from behind: habitat-sim draws no back of
    a triangle unless it shades physically, which it does not for scans.
    """

    def __init__(self, scene: Scene) -> None:
        """Sort the triangles."""
        sorted_once = kept_arrays(scene.cache, f"triangles-{_version()}", lambda: _sorted(scene))
        self._faces = sorted_once["faces"]
        self._corners = sorted_once["corners"]
        self._boxes = sorted_once["boxes"]
        self._one_sided = scene.stored_z_up

    def faces(
        self, camera: PinholeCamera, camera_rows: Float64[np.ndarray, "4 3"], rows: slice
    ) -> Int32[np.ndarray, "rows width"]:
        """First triangle behind every pixel of some rows, -1 where there is none.

        Args:
            camera: Intrinsics of the camera.
            camera_rows: Pose of the camera, as for `ray_kernels.fill_rays`.
            rows: Rows of the image; a pixel does not depend on which others are asked for.
        """
        groups = np.empty(len(self._boxes), dtype=np.int64)
        distances = np.empty(len(self._boxes), dtype=np.float64)
        cx, cy = camera.cx, camera.cy
        count = find_visible(
            self._boxes, camera_rows, camera.width, cx, cy, rows.start, rows.stop, groups, distances
        )
        # Near groups are drawn first, so that hidden triangles are not written.
        groups = groups[:count][np.argsort(distances[:count], kind="stable")]
        shape = (rows.stop - rows.start, camera.width)
        shown, nearness = np.full(shape, -1, dtype=np.int32), np.zeros(shape, dtype=np.float64)
        draw_triangles(
            self._corners,
            groups,
            _GROUP,
            camera_rows,
            cx,
            cy,
            rows.start,
            self._one_sided,
            shown,
            nearness,
        )
        return np.where(shown >= 0, self._faces[shown], np.int32(-1))


@lru_cache(maxsize=1)
def _version() -> str:
    return digest_of([Path(__file__)])


def _sorted(scene: Scene) -> dict[str, np.ndarray]:
    """Triangles along a curve, their corners, and the boxes of their groups."""
    corners = scene.vertices[scene.faces]
    faces = _along_a_curve(corners).astype(np.int32)
    corners = np.ascontiguousarray(corners[faces], dtype=np.float32)
    starts = np.arange(0, len(corners), _GROUP)
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    high = np.maximum.reduceat(corners.max(axis=1), starts)
    return {"faces": faces, "corners": corners, "boxes": np.stack([low, high], axis=1)}


def _along_a_curve(
    corners: Float32[np.ndarray, "triangles 3 3"],
) -> Int64[np.ndarray, " triangles"]:
    """An order in which neighbours in space follow each other (Morton, 1966)."""
    middles = corners.mean(axis=1, dtype=np.float64)
    low = middles.min(axis=0)
    extent = max(float((middles.max(axis=0) - low).max()), 1e-9)
    steps = ((middles - low) / extent * (2**_CURVE_BITS - 1)).astype(np.int64)
    key = np.zeros(len(steps), dtype=np.int64)
    for bit in range(_CURVE_BITS):
        for axis in range(3):
            key |= ((steps[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")
