"""Colour, depth and instances of a scene on a GPU, by NVIDIA Warp, many views at a time.

It draws what `CpuRenderer` draws, by rays in place of a rasterizer. Four rays go through every
pixel, not only through those at edges: where thousands of threads keep step, sparing the rays of
some would spare no time. Every ray is computed the same way whichever thread computes it, and a
node of the light grid depends on its position alone, so on one device the same pose gives the same
bytes, alone or among others.
"""

import logging
from collections.abc import Sequence
from types import ModuleType
from typing import Any

import numpy as np

from hypernav.core.components.registry import require
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import RenderedView
from hypernav.simulator.worlds.drawing.renderer import OFFSETS, RenderConfig, camera_rows
from hypernav.simulator.worlds.drawing.shading import (
    CONTRAST,
    RAYS,
    REACH_M,
    MaterialArrays,
    box_of,
    even_directions,
    extent_of_grid,
    sky_light,
    tone_curve,
)
from hypernav.simulator.worlds.drawing.textures import textures_of
from hypernav.simulator.worlds.scenes.scene import Scene

_LOGGER = logging.getLogger(__name__)
_MOST_TEXTURES_MB = 8_000.0
"""Warp's arrays have less than 2^31 elements, and a texel has four bytes."""


class WarpRenderer:
    """Draws a scene on a GPU; satisfies `hypernav.core.world.Renderer`.

    Without a GPU, the same code runs on one core of the CPU, ten times slower than `CpuRenderer`:
    for tests, not for work.

    Attributes:
        device: Warp's name of the device, such as ``cuda:0`` or ``cpu``.
        colours: Whether images are drawn, at first as configured; may change between two renders.
    """

    def __init__(
        self, scene: Scene, config: RenderConfig | None = None, device: str | None = None
    ) -> None:
        """Bring a scene to the device.

        Args:
            scene: Scene to draw.
            config: Configuration of the renderer, whose number of threads is not used.
            device: Warp's name of a device; by default the first GPU, or else the CPU.

        Raises:
            MissingExtraError: The package warp-lang is not installed.
        """
        config = config or RenderConfig()
        self._warp = _require_warp()
        self.device = device or _best_device(self._warp)
        self.colours = config.colours
        self._texture_budget_mb = min(config.texture_budget_mb, _MOST_TEXTURES_MB)
        from hypernav.simulator.worlds.drawing import warp_kernels  # it imports Warp

        self._kernels = warp_kernels
        samples = [np.zeros((1, 2)), OFFSETS] if config.antialias else [np.zeros((1, 2))]
        self._offsets = self._array(np.concatenate(samples), self._warp.vec2)
        corners = self._array(scene.faces.reshape(-1), int)
        # The slower way to build the tree gives the faster one, and the same on every device.
        self._mesh = self._warp.Mesh(
            self._array(scene.vertices, self._warp.vec3), corners, bvh_constructor="sah"
        )
        self._scene = self._triangles(scene)
        self._nodes = self._light_nodes(scene, config.light_cell_m)
        self._rays, self._look = self._light_rays(), self._look_of(config)
        self._wanted = self._empty(self._nodes.asked.shape, int)

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as seen from a pose in the scene's frame.

        Args:
            camera: Intrinsics of the camera.
            camera_to_scene: Pose of the optical frame (x right, y down, z forward).

        Returns:
            Depth along the optical axis in metres, 0 where nothing is hit; instances are -1 there.
        """
        return self.render_batch(camera, [camera_to_scene])[0]

    def render_batch(
        self, camera: PinholeCamera, cameras_to_scene: Sequence[Transform]
    ) -> list[RenderedView]:
        """The same from several poses at a time, which keeps a GPU busier than one by one.

        Args:
            camera: Intrinsics of all cameras.
            cameras_to_scene: Poses of their optical frames.
        """
        if not cameras_to_scene:
            return []
        poses = np.stack([camera_rows(camera, pose) for pose in cameras_to_scene])
        shape = (len(poses), camera.height, camera.width)
        offsets = self._offsets if self.colours else self._offsets[:1]
        rays = (self._array(poses, self._warp.vec3), camera.cx, camera.cy, offsets)
        faces = self._empty((*shape, len(offsets)), int)
        depth, ids = self._empty(shape, float), self._empty(shape, int)
        self._launch(
            self._kernels.find_surfaces, faces.shape, self._scene, *rays, faces, depth, ids
        )
        rgb = np.zeros((*shape, 3), dtype=np.uint8)
        if self.colours:
            rgb = self._shade(rays, faces, shape)
        return [RenderedView(*view) for view in zip(rgb, depth.numpy(), ids.numpy(), strict=True)]

    def _shade(self, rays: tuple[Any, ...], faces: Any, shape: tuple[int, ...]) -> np.ndarray:
        """Colours of pixels, after the light that is not known yet."""
        kernels, scene, nodes = self._kernels, self._scene, self._nodes
        count = self._warp.zeros(1, dtype=int, device=self.device)
        self._launch(
            kernels.want_light, faces.shape, scene, nodes, *rays, faces, self._wanted, count
        )
        unknown = int(count.numpy()[0])
        if unknown:
            self._launch(kernels.bake_light, unknown, scene, nodes, self._rays, self._wanted)
        rgb = self._empty(shape, self._warp.vec3ub)
        self._launch(kernels.shade, shape, scene, nodes, self._look, *rays, faces, rgb)
        return rgb.numpy()

    def _triangles(self, scene: Scene) -> Any:
        warp, materials = self._warp, MaterialArrays.of(scene)
        textures = textures_of(scene, self._texture_budget_mb)
        normals = scene.normals if scene.normals is not None else np.zeros((0, 3, 3), np.float32)
        arrays = self._kernels.Triangles()
        arrays.mesh = self._mesh.id
        arrays.one_sided = scene.stored_z_up
        arrays.smooth = scene.normals is not None
        arrays.vertices, arrays.corners = self._mesh.points, self._mesh.indices
        arrays.normals = self._array(normals, warp.vec3)
        arrays.uv = self._array(scene.uv, warp.vec2)
        arrays.colors = self._array(scene.colors, warp.vec3ub)
        arrays.instance = self._array(scene.face_instance, int)
        arrays.material = self._array(materials.face, int)
        arrays.flags = self._array(materials.flags, warp.uint8)
        arrays.color = self._array(materials.color, warp.vec3)
        arrays.wrap = self._array(materials.wrap, warp.vec2ub)
        arrays.texture = self._array(textures.of_material, int)
        arrays.texels = self._array(textures.texels, warp.uint32)
        arrays.levels = self._array(textures.levels.astype(np.int32), int)
        arrays.level_count = self._array(textures.level_count, int)
        return arrays

    def _light_nodes(self, scene: Scene, cell_m: float) -> Any:
        nodes = self._kernels.LightNodes()
        origin, cell_m, shape = extent_of_grid(*box_of(scene), cell_m)
        nodes.cell_m = cell_m
        nodes.z, nodes.y, nodes.x = (
            self._array(np.arange(count) * cell_m + start, float)
            for count, start in zip(shape, origin[::-1], strict=True)
        )
        count = int(np.prod(shape))
        nodes.light = self._empty((count, 6), self._warp.uint8)
        nodes.asked = self._warp.zeros(count, dtype=int, device=self.device)
        return nodes

    def _light_rays(self) -> Any:
        rays, directions = self._kernels.LightRays(), even_directions(RAYS)
        rays.directions = self._array(directions, self._warp.vec3)
        rays.sky = self._array(sky_light(directions), float)
        rays.reach_m, rays.contrast = REACH_M, CONTRAST
        return rays

    def _look_of(self, config: RenderConfig) -> Any:
        look = self._kernels.Look()
        look.ambient, look.headlight = config.ambient, config.headlight
        look.tone = self._array(tone_curve(config.exposure), self._warp.uint8)
        look.background = self._warp.vec3ub(*config.background)
        return look

    def _array(self, values: np.ndarray, dtype: Any) -> Any:
        """A copy of an array on the device."""
        return self._warp.array(values, dtype=dtype, device=self.device)

    def _empty(self, shape: tuple[int, ...], dtype: Any) -> Any:
        return self._warp.empty(shape, dtype=dtype, device=self.device)

    def _launch(self, kernel: Any, shape: tuple[int, ...] | int, *arguments: Any) -> None:
        self._warp.launch(kernel, dim=shape, inputs=arguments, device=self.device)


def _require_warp() -> ModuleType:
    """Warp, which prints nothing but warnings.

    Raises:
        MissingExtraError: It is not installed.
    """
    warp = require("warp", extra="gpu")
    warp.config.log_level = warp.LOG_WARNING
    warp.init()
    return warp


def _best_device(warp: ModuleType) -> str:
    if warp.is_cuda_available():
        return "cuda:0"
    _LOGGER.warning(
        "Warp finds no CUDA device and draws on its CPU back end, ten times slower than the "
        "renderer 'cpu'"
    )
    return "cpu"
