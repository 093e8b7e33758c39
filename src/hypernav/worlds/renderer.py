"""Colour, depth and instances of a scene as a camera sees them, on the CPU.

Embree finds the triangle behind every pixel, compiled kernels shade it. The picture is cut into
bands of rows that all cores work on; every pixel is computed the same way whichever core does it,
so the same pose gives the same bytes.
"""

import os
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64, UInt8
from pydantic import Field

from hypernav.core.camera import PinholeCamera
from hypernav.core.config import RoomConfig
from hypernav.core.geometry import Transform
from hypernav.core.protocols import RenderedView
from hypernav.worlds.light import LightGrid
from hypernav.worlds.rays import RayCaster
from hypernav.worlds.scene import Scene
from hypernav.worlds.shading_kernels import (
    FLAG_COLORED,
    FLAG_UNLIT,
    SURFACE_COLUMNS,
    TONE_STEPS,
    fill_rays,
    light,
    locate,
    paint,
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

    exposure: float = Field(default=1.2, gt=0.0)
    ambient: float = Field(default=0.95, ge=0.0)
    headlight: float = Field(default=0.1, ge=0.0)
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
        self._shape = _Shape.of(scene)
        self._looks = _Looks.of(scene, self._config.texture_budget_mb)
        corners = scene.vertices[scene.faces.ravel()].astype(np.float64)
        self._grid = LightGrid(
            corners.min(axis=0), corners.max(axis=0), self._config.light_cell_m, self.rays.distances
        )
        self._shares = np.array([self._config.ambient, self._config.headlight])
        self._tone = _tone_curve(self._config.exposure)
        self._background = np.array(self._config.background, dtype=np.uint8)
        self._desks = threading.local()

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame.

        Args:
            camera: Intrinsics.
            camera_to_scene: Pose of the optical frame (x right, y down, z forward).

        Returns:
            Depth along the optical axis in metres, 0 where nothing is hit; instances are -1 there.
        """
        frame = _Frame.empty(camera, camera_to_scene)
        bands = [
            slice(start, min(start + _BAND_ROWS, camera.height))
            for start in range(0, camera.height, _BAND_ROWS)
        ]
        waiting = [
            band
            for band in self._pool.map(lambda rows: self._draw(frame, rows), bands)
            if band is not None
        ]
        if waiting:
            self._grid.bake(np.concatenate([band.wanted for band in waiting]), self._pool)
            list(self._pool.map(lambda band: self._light(frame, band), waiting))
        return RenderedView(frame.rgb, frame.depth, frame.ids)

    def _draw(self, frame: "_Frame", rows: slice) -> "_Band | None":
        """Fill some rows of a frame; returns them if they wait for light."""
        desk = self._desk(len(frame.ids[rows]) * frame.camera.width)
        frame.fill_rays(rows, desk.origins, desk.directions)
        hits = self.rays.faces(desk.origins, desk.directions)
        band = _Band(rows, hits, desk.surface, desk.colors, desk.wanted)
        locate(
            hits,
            desk.directions,
            frame.camera_rows,
            *self._shape,
            frame.depth[rows].reshape(-1),
            frame.ids[rows].reshape(-1),
            band.surface,
        )
        paint(hits, band.surface, *self._looks.paint_tables, band.colors)
        missing = self._light(frame, band)
        return band.kept(missing) if missing else None

    def _light(self, frame: "_Frame", band: "_Band") -> int:
        """Fill the colours of a band; returns how many places lack light."""
        return light(
            band.hits,
            band.surface,
            band.colors,
            self._looks.face_material,
            self._looks.flags,
            self._grid.nodes.reshape(-1),
            self._grid.nodes.shape,
            self._grid.origin,
            self._grid.cell_m,
            self._shares,
            self._tone,
            self._background,
            frame.rgb[band.rows].reshape(-1, 3),
            band.wanted,
        )

    def _desk(self, rays: int) -> "_Desk":
        """Scratch memory of this thread: fresh memory for every band would cost a tenth more."""
        desk = getattr(self._desks, "desk", None)
        if desk is None or len(desk.origins) < rays:
            desk = self._desks.desk = _Desk.of(rays)
        return desk.first(rays)


@dataclass(frozen=True, eq=False)
class _Desk:
    """Scratch memory for a band of rays."""

    origins: Float32[np.ndarray, "rays 3"]
    directions: Float32[np.ndarray, "rays 3"]
    surface: Float32[np.ndarray, "rays columns"]
    colors: Float32[np.ndarray, "rays 3"]
    wanted: Int64[np.ndarray, "rays"]

    @staticmethod
    def of(rays: int) -> "_Desk":
        arrays = (np.empty((rays, n), np.float32) for n in (3, 3, SURFACE_COLUMNS, 3))
        return _Desk(*arrays, np.empty(rays, np.int64))

    def first(self, rays: int) -> "_Desk":
        return _Desk(
            self.origins[:rays],
            self.directions[:rays],
            self.surface[:rays],
            self.colors[:rays],
            self.wanted[:rays],
        )


@dataclass(frozen=True, eq=False)
class _Band:
    """Rows of a frame between the passes of shading."""

    rows: slice
    hits: Int32[np.ndarray, "rays"]
    surface: Float32[np.ndarray, "rays columns"]
    colors: Float32[np.ndarray, "rays 3"]
    wanted: Int64[np.ndarray, "cells"]

    def kept(self, missing: int) -> "_Band":
        """A copy that outlives the desk, with room for as many wanted cells."""
        return _Band(
            self.rows,
            self.hits,
            self.surface.copy(),
            self.colors.copy(),
            self.wanted[:missing].copy(),
        )


class _Shape(NamedTuple):
    """The scene's geometry, laid out as the kernels take it."""

    vertices: Float32[np.ndarray, "vertices 3"]
    faces: Int32[np.ndarray, "faces 3"]
    normals: Float32[np.ndarray, "faces_or_0 3_or_0 3"]
    uv: Float32[np.ndarray, "faces 3 2"]
    face_instance: Int32[np.ndarray, "faces"]

    @staticmethod
    def of(scene: Scene) -> "_Shape":
        normals = scene.normals if scene.normals is not None else np.zeros((0, 0, 3), np.float32)
        return _Shape(
            np.ascontiguousarray(scene.vertices),
            np.ascontiguousarray(scene.faces),
            np.ascontiguousarray(normals),
            np.ascontiguousarray(scene.uv),
            np.ascontiguousarray(scene.face_instance),
        )


@dataclass(frozen=True, eq=False)
class _Looks:
    """The scene's materials, laid out as the kernels take them."""

    face_material: Int32[np.ndarray, "faces"]
    flags: UInt8[np.ndarray, "materials"]
    paint_tables: tuple[np.ndarray, ...]

    @staticmethod
    def of(scene: Scene, budget_mb: float) -> "_Looks":
        textures = collect_textures(scene.materials, budget_mb)
        face_material = np.ascontiguousarray(scene.face_material)
        unlit = [scene.unlit or material.unlit for material in scene.materials]
        flags = np.array(unlit, dtype=np.uint8) * np.uint8(FLAG_UNLIT)
        colored = np.any(scene.colors != 255, axis=(1, 2))
        flags[np.unique(face_material[colored])] |= FLAG_COLORED
        tables = (
            np.ascontiguousarray(scene.colors),
            face_material,
            flags,
            np.array([material.color for material in scene.materials], dtype=np.float32),
            np.array([material.wrap for material in scene.materials], dtype=np.uint8),
            textures.of_material,
            textures.texels,
            textures.levels,
            textures.level_count,
        )
        return _Looks(face_material, flags, tables)


@dataclass(frozen=True, eq=False)
class _Frame:
    """Three images in the making, and the camera that sees them."""

    camera: PinholeCamera
    camera_to_scene: Transform
    camera_rows: Float64[np.ndarray, "4 3"]
    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    ids: Int32[np.ndarray, "height width"]

    @staticmethod
    def empty(camera: PinholeCamera, camera_to_scene: Transform) -> "_Frame":
        shape = (camera.height, camera.width)
        rotation = camera_to_scene.rotation
        rows = [
            camera_to_scene.translation,
            rotation[:, 2],
            rotation[:, 0] / camera.fx,
            rotation[:, 1] / camera.fy,
        ]
        return _Frame(
            camera,
            camera_to_scene,
            np.array(rows, dtype=np.float64),
            np.empty((*shape, 3), dtype=np.uint8),
            np.empty(shape, dtype=np.float32),
            np.empty(shape, dtype=np.int32),
        )

    def fill_rays(
        self,
        rows: slice,
        origins: Float32[np.ndarray, "rays 3"],
        directions: Float32[np.ndarray, "rays 3"],
    ) -> None:
        """Rays through the pixels of some rows."""
        shape = (rows.stop - rows.start, self.camera.width, 3)
        fill_rays(
            np.ascontiguousarray(self.camera_to_scene.rotation),
            np.ascontiguousarray(self.camera_to_scene.translation),
            self.camera.fx,
            self.camera.fy,
            self.camera.cx,
            self.camera.cy,
            rows.start,
            origins.reshape(shape),
            directions.reshape(shape),
        )


def _tone_curve(exposure: float) -> UInt8[np.ndarray, "steps"]:
    """SRGB codes of light 0 to 1: proportional, with a soft shoulder at the top."""
    shown = np.arange(TONE_STEPS) / (TONE_STEPS - 1) * exposure
    knee = 0.7
    over = np.maximum(shown - knee, 0.0) / (1.0 - knee)
    shown = np.where(shown > knee, knee + (1.0 - knee) * (1.0 - np.exp(-over)), shown)
    return np.rint(linear_to_srgb(shown) * 255.0).astype(np.uint8)


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
