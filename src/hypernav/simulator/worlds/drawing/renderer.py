"""Colour, depth and instances of a scene as a camera sees them, on the CPU.

Triangles are drawn into the image, and compiled kernels shade what every pixel shows; Embree's
rays find the light, what lies behind holes, and what else is seen in pixels at edges. The image
is cut into bands of rows that all cores work on; every pixel is computed the same way whichever
core computes it, so the same pose gives the same bytes.
"""

import math
import os
import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64, UInt8
from pydantic import Field

from hypernav.core.config import MOST_THREADS, RoomConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import RenderedView, Renderer
from hypernav.simulator.worlds.config import RendererName
from hypernav.simulator.worlds.drawing.ray_kernels import (
    fill_rays,
    fill_rays_around,
    find_edges,
    mix_samples,
)
from hypernav.simulator.worlds.drawing.rays import Rasterizer, RayCaster
from hypernav.simulator.worlds.drawing.shading import PendingRays, Rays, Shader
from hypernav.simulator.worlds.scenes.scene import Scene

_BAND_ROWS = 24
OFFSETS = np.array([[-0.35, -0.15], [0.15, -0.35], [0.25, 0.35]])
"""``(right, down)`` from a pixel's centre: with it, spread evenly in both directions of a pixel."""


_Level = Annotated[int, Field(ge=0, le=255)]


class RenderConfig(RoomConfig):
    """How a scene is drawn.

    Attributes:
        exposure: Factor of all light, before bright tones are compressed.
        ambient: Share of the soft light from ceiling and surroundings.
        headlight: Share of a light at the camera, which shows the shape of surfaces that face it.
        light_cell_m: Distance between the nodes at which the soft light is computed.
        antialias: Whether pixels at the edges of objects get several rays for their colour. Depth
            and instances always come from the one ray through the pixel's centre.
        colours: Whether the image is drawn; without, it is black, and drawing takes less
            than half the time. Depth and instances are the same.
        background: sRGB colour where nothing is hit.
        texture_budget_mb: Memory for textures; the largest lose resolution beyond it.
        threads: Worker threads; None uses all cores of the process.
    """

    exposure: float = Field(default=1.6, gt=0.0, le=100.0)
    ambient: float = Field(default=0.95, ge=0.0, le=10.0)
    headlight: float = Field(default=0.1, ge=0.0, le=10.0)
    light_cell_m: float = Field(default=0.08, ge=0.01, le=1.0)
    antialias: bool = True
    colours: bool = True
    background: tuple[_Level, _Level, _Level] = (214, 228, 240)
    texture_budget_mb: float = Field(default=400.0, gt=0.0, le=10_000.0)
    threads: int | None = Field(default=None, ge=1, le=MOST_THREADS)


class CpuRenderer:
    """Draws a scene; satisfies `hypernav.core.world.Renderer`. Its threads end with `close`.

    Attributes:
        rays: Ray caster of the scene, shared with code that tests visibility.
        colours: Whether images are drawn, at first as configured; may change between two renders.
    """

    def __init__(self, scene: Scene, config: RenderConfig | None = None) -> None:
        """Prepare triangles, textures and light.

        Raises:
            MissingExtraError: The package embreex is not installed.
        """
        config = config or RenderConfig()
        self.rays = RayCaster(scene)
        self.colours = config.colours
        self._antialias = config.antialias
        self._rasterizer = Rasterizer(scene)
        self._threads = config.threads or _cores()
        self._pool = ThreadPoolExecutor(self._threads)
        self._scratch = threading.local()
        self._shader = Shader(
            scene,
            self.rays,
            light_cell_m=config.light_cell_m,
            shares=(config.ambient, config.headlight),
            exposure=config.exposure,
            background=config.background,
            texture_budget_mb=config.texture_budget_mb,
        )

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame.

        Args:
            camera: Intrinsics of the camera.
            camera_to_scene: Pose of the optical frame (x right, y down, z forward).

        Returns:
            Depth along the optical axis in metres, 0 where nothing is hit; instances are -1 there.
        """
        frame = _Frame.empty(camera, camera_to_scene)
        # Drawing has a cost for every triangle in every band, shading has not.
        list(
            self._pool.map(
                lambda rows: self._find_hits(frame, rows),
                _bands(camera.height, math.ceil(camera.height / self._threads)),
            )
        )
        bands = _bands(camera.height, _BAND_ROWS)
        pending = self._pool.map(lambda rows: self._draw(frame, rows), bands)
        self._shade_pending(pending)
        rgb = frame.rgb if self.colours else np.zeros_like(frame.rgb)
        if self._antialias and self.colours:
            edges = list(self._pool.map(lambda rows: self._resample(frame, rows), bands))
            self._shade_pending(edge.pending for edge in edges)
            rgb = frame.rgb.copy()
            for edge in edges:
                mix_samples(edge.pixels, edge.samples, rgb.reshape(-1, 3))
        return RenderedView(rgb, frame.depth, frame.ids)

    def close(self) -> None:
        """End the threads; the renderer is not used afterwards."""
        self._pool.shutdown()

    def _shade_pending(self, pending: Iterable[PendingRays | None]) -> None:
        self._shader.shade_pending([rays for rays in pending if rays is not None], self._pool)

    def _find_hits(self, frame: "_Frame", rows: slice) -> None:
        """Find the triangles behind the pixels of some rows of a frame."""
        frame.hits[rows] = self._rasterizer.faces(frame.camera, frame.camera_rows, rows)

    def _draw(self, frame: "_Frame", rows: slice) -> PendingRays | None:
        """Fill some rows of a frame; returns the rays that wait for light."""
        shape = (*frame.depth[rows].shape, 3)
        rays = replace(
            self._buffers(shape[0] * shape[1]),
            depth=frame.depth[rows].reshape(-1),
            ids=frame.ids[rows].reshape(-1),
            rgb=frame.rgb[rows].reshape(-1, 3),
        )
        fill_rays(
            frame.camera_rows,
            frame.camera.cx,
            frame.camera.cy,
            rows.start,
            rays.directions.reshape(shape),
        )
        hits = frame.hits[rows].reshape(-1)
        return self._shader.shade(frame.camera_rows, hits, rays, colours=self.colours)

    def _resample(self, frame: "_Frame", rows: slice) -> "_Edges":
        """Further colours for the pixels of some rows that lie at edges."""
        camera = frame.camera
        pixels = np.empty(frame.depth[rows].size, dtype=np.int64)
        count = find_edges(frame.rgb, frame.ids, frame.depth, rows.start, rows.stop, pixels)
        pixels = pixels[:count].copy()
        samples = np.empty((count, len(OFFSETS), 3), dtype=np.uint8)
        if count == 0:
            return _Edges(pixels, samples, None)
        rays = replace(self._buffers(count * len(OFFSETS)), rgb=samples.reshape(-1, 3))
        fill_rays_around(
            frame.camera_rows,
            camera.cx,
            camera.cy,
            camera.width,
            pixels,
            OFFSETS,
            rays.origins,
            rays.directions,
        )
        hits = self.rays.faces(rays.origins, rays.directions)
        return _Edges(pixels, samples, self._shader.shade(frame.camera_rows, hits, rays))

    def _buffers(self, count: int) -> Rays:
        """Scratch memory of this thread: new memory for every band would take a tenth more time."""
        rays: Rays | None = getattr(self._scratch, "rays", None)
        if rays is None or len(rays.depth) < count:
            rays = self._scratch.rays = Rays.allocate(count)
        return rays.first(count)


def renderer_of(scene: Scene, name: RendererName, config: RenderConfig | None = None) -> Renderer:
    """A renderer of a scene.

    Raises:
        MissingExtraError: A package that it needs is not installed.
    """
    from hypernav.simulator.worlds.drawing.warp_renderer import (
        WarpRenderer,  # it imports this module
    )

    return WarpRenderer(scene, config) if name == "warp" else CpuRenderer(scene, config)


@dataclass(frozen=True, eq=False)
class _Edges:
    """Pixels at edges, with further colours of each."""

    pixels: Int64[np.ndarray, "pixels"]
    samples: UInt8[np.ndarray, "pixels samples 3"]
    pending: PendingRays | None


@dataclass(frozen=True, eq=False)
class _Frame:
    """Three unfinished images, the triangles they show, and their camera."""

    camera: PinholeCamera
    camera_rows: Float64[np.ndarray, "4 3"]
    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    ids: Int32[np.ndarray, "height width"]
    hits: Int32[np.ndarray, "height width"]

    @staticmethod
    def empty(camera: PinholeCamera, camera_to_scene: Transform) -> "_Frame":
        shape = (camera.height, camera.width)
        return _Frame(
            camera,
            camera_rows(camera, camera_to_scene),
            np.empty((*shape, 3), dtype=np.uint8),
            np.empty(shape, dtype=np.float32),
            np.empty(shape, dtype=np.int32),
            np.empty(shape, dtype=np.int32),
        )


def camera_rows(camera: PinholeCamera, camera_to_scene: Transform) -> Float64[np.ndarray, "4 3"]:
    """A camera as the kernels take it, see `ray_kernels.fill_rays`."""
    rotation = camera_to_scene.rotation
    rows = [
        camera_to_scene.translation,
        rotation[:, 2],
        rotation[:, 0] / camera.fx,
        rotation[:, 1] / camera.fy,
    ]
    return np.array(rows, dtype=np.float64)


def _bands(height: int, rows: int) -> list[slice]:
    """All rows of an image, in bands."""
    return [slice(start, min(start + rows, height)) for start in range(0, height, rows)]


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
