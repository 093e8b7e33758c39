"""Colour, depth and instances of a scene as a camera sees them, on the CPU.

Embree finds the triangle behind every pixel, compiled kernels shade it. The picture is cut into
bands of rows that all cores work on; every pixel is computed the same way whichever core does it,
so the same pose gives the same bytes.
"""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Int32
from pydantic import Field

from hypernav.core.camera import PinholeCamera
from hypernav.core.config import RoomConfig
from hypernav.core.geometry import Transform
from hypernav.core.protocols import RenderedView
from hypernav.worlds.light import LightGrid
from hypernav.worlds.rays import RayCaster
from hypernav.worlds.scene import Scene
from hypernav.worlds.shading_kernels import (
    FLAG_CUTOUT,
    FLAG_UNLIT,
    TONE_STEPS,
    Light,
    Surfaces,
    View,
    fill_rays,
    shade_rows,
)
from hypernav.worlds.textures import collect_textures, linear_to_srgb

_BAND_ROWS = 24


class RenderConfig(RoomConfig):
    """How a scene is drawn.

    Attributes:
        exposure: Multiplies all light; 1 shows a white surface in full light as nearly white.
        ambient: Share of the soft light from ceiling and surroundings.
        headlight: Share of a light at the camera, which gives form to what faces it.
        light_cell_m: Distance of the nodes at which the soft light is measured.
        background: sRGB colour where nothing is hit.
        texture_budget_mb: Memory for textures; the largest lose resolution beyond it.
        threads: Worker threads; all cores of the process where None.
    """

    exposure: float = Field(default=1.25, gt=0.0)
    ambient: float = Field(default=0.85, ge=0.0)
    headlight: float = Field(default=0.2, ge=0.0)
    light_cell_m: float = Field(default=0.08, gt=0.0)
    background: tuple[int, int, int] = (214, 228, 240)
    texture_budget_mb: float = Field(default=400.0, gt=0.0)
    threads: int | None = Field(default=None, ge=1)


class EmbreeRenderer:
    """Draws a scene; satisfies `hypernav.core.protocols.Renderer`.

    Attributes:
        rays: The scene as rays see it, to share with whoever asks what is visible.
    """

    def __init__(self, scene: Scene, config: RenderConfig | None = None) -> None:
        """Prepare triangles, textures and light.

        Args:
            scene: What to draw.
            config: How to draw it.

        Raises:
            MissingExtraError: The package embreex is not installed.
        """
        self._config = config or RenderConfig()
        self.rays = RayCaster(scene)
        self._pool = ThreadPoolExecutor(self._config.threads or _cores())
        self._surfaces = _surfaces(scene, self._config)
        corners = scene.vertices[scene.faces.ravel()].astype(np.float64)
        self._grid = LightGrid(
            corners.min(axis=0), corners.max(axis=0), self._config.light_cell_m, self.rays.distances
        )
        self._light = Light(
            self._grid.nodes,
            self._grid.origin,
            self._grid.cell_m,
            self._config.ambient,
            self._config.headlight,
            _tone_curve(self._config.exposure),
        )

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame.

        Args:
            camera: Intrinsics.
            camera_to_scene: Pose of the optical frame (x right, y down, z forward).

        Returns:
            Depth along the optical axis in metres, 0 where nothing is hit; instances are -1 there.
        """
        shape = (camera.height, camera.width)
        rgb = np.empty((*shape, 3), dtype=np.uint8)
        rgb[:] = self._config.background
        depth = np.zeros(shape, dtype=np.float32)
        ids = np.full(shape, -1, dtype=np.int32)
        faces = np.empty(shape, dtype=np.int32)
        view = View(
            np.ascontiguousarray(camera_to_scene.rotation),
            np.ascontiguousarray(camera_to_scene.translation),
            camera.fx,
            camera.fy,
            camera.cx,
            camera.cy,
        )

        def shade(rows: slice) -> bool:
            return shade_rows(
                self._surfaces,
                self._light,
                view,
                rows.start,
                faces[rows],
                rgb[rows],
                depth[rows],
                ids[rows],
            )

        def trace_and_shade(rows: slice) -> bool:
            self._trace(view, rows, faces)
            return shade(rows)

        bands = [
            slice(start, min(start + _BAND_ROWS, camera.height))
            for start in range(0, camera.height, _BAND_ROWS)
        ]
        missing = list(self._pool.map(trace_and_shade, bands))
        if any(missing):
            self._grid.bake_wanted(self._pool)
            again = [band for band, wanted in zip(bands, missing, strict=True) if wanted]
            list(self._pool.map(shade, again))
        return RenderedView(rgb, depth, ids)

    def _trace(self, view: View, rows: slice, faces: Int32[np.ndarray, "height width"]) -> None:
        """Find the triangle behind every pixel of some rows."""
        shape = (*faces[rows].shape, 3)
        origins, directions = np.empty(shape, np.float32), np.empty(shape, np.float32)
        fill_rays(view, 0.5, rows.start + 0.5, origins, directions)
        hits = self.rays.faces(origins.reshape(-1, 3), directions.reshape(-1, 3))
        faces[rows] = hits.reshape(shape[:2])


def _surfaces(scene: Scene, config: RenderConfig) -> Surfaces:
    textures = collect_textures(scene.materials, config.texture_budget_mb)
    flags = [
        FLAG_UNLIT * (scene.unlit or material.unlit) + FLAG_CUTOUT * (material.opaque is not None)
        for material in scene.materials
    ]
    normals = scene.normals if scene.normals is not None else np.zeros((0, 3, 3), np.float32)
    return Surfaces(
        np.ascontiguousarray(scene.vertices),
        np.ascontiguousarray(scene.faces),
        np.ascontiguousarray(scene.uv),
        np.ascontiguousarray(scene.colors),
        np.ascontiguousarray(normals),
        np.ascontiguousarray(scene.face_material),
        np.ascontiguousarray(scene.face_instance),
        np.array([material.color for material in scene.materials], dtype=np.float32),
        np.array(flags, dtype=np.uint8),
        np.array([material.wrap for material in scene.materials], dtype=np.uint8),
        textures.of_material,
        textures.texels,
        textures.levels,
        textures.level_count,
    )


def _tone_curve(exposure: float) -> np.ndarray:
    """SRGB codes of light, by its square root: straight, with a soft shoulder at the top."""
    light = (np.arange(TONE_STEPS) / (TONE_STEPS - 1)) ** 2 * exposure
    knee = 0.7
    over = np.maximum(light - knee, 0.0) / (1.0 - knee)
    shown = np.where(light > knee, knee + (1.0 - knee) * (1.0 - np.exp(-over)), light)
    return np.rint(linear_to_srgb(shown) * 255.0).astype(np.uint8)


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
