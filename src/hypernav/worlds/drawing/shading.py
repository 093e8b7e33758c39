"""Shading: depth, instance and colour of rays."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64, UInt8

from hypernav.worlds.drawing.base_color_kernels import (
    FLAG_COLORED,
    FLAG_CUTOUT,
    FLAG_UNLIT,
    fill_base_colors,
    find_holes,
)
from hypernav.worlds.drawing.geometry_kernels import POINT, SURFACE_COLUMNS, locate, measure
from hypernav.worlds.drawing.light_grid import LightGrid, box_of
from hypernav.worlds.drawing.light_kernels import TONE_STEPS, light
from hypernav.worlds.drawing.rays import RayCaster
from hypernav.worlds.drawing.textures import linear_to_srgb, textures_of
from hypernav.worlds.scenes.scene import Scene

_MAX_LAYERS = 8
_BEYOND = 1e-4
_KNEE = 0.7


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays from one camera with memory for their results and for intermediate values.

    Attributes:
        origins: Origins, scene frame, metres.
        directions: Directions, scene frame, 1 long along the optical axis.
        depth: Depth along the optical axis in metres, 0 where nothing is hit.
        ids: Instances, -1 where nothing is hit.
        rgb: Colours as shown.
        surface: Points, normals and texture coordinates, see `geometry_kernels`.
        base_color: Colours without light.
        wanted: Cells of the light grid that are not known yet.
    """

    origins: Float32[np.ndarray, "rays 3"]
    directions: Float32[np.ndarray, "rays 3"]
    depth: Float32[np.ndarray, "rays"]
    ids: Int32[np.ndarray, "rays"]
    rgb: UInt8[np.ndarray, "rays 3"]
    surface: Float32[np.ndarray, "rays columns"]
    base_color: Float32[np.ndarray, "rays 3"]
    wanted: Int64[np.ndarray, "rays"]

    @staticmethod
    def allocate(count: int) -> "Rays":
        """Memory for a number of rays."""
        return Rays(
            np.empty((count, 3), np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.float32),
            np.empty(count, np.int32),
            np.empty((count, 3), np.uint8),
            np.empty((count, SURFACE_COLUMNS), np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.int64),
        )

    def first(self, count: int) -> "Rays":
        """The same memory for fewer rays."""
        return Rays(
            self.origins[:count],
            self.directions[:count],
            self.depth[:count],
            self.ids[:count],
            self.rgb[:count],
            self.surface[:count],
            self.base_color[:count],
            self.wanted[:count],
        )


@dataclass(frozen=True, eq=False)
class PendingRays:
    """Rays whose colours wait until more of the light grid is known."""

    hits: Int32[np.ndarray, "rays"]
    surface: Float32[np.ndarray, "rays columns"]
    base_color: Float32[np.ndarray, "rays 3"]
    wanted: Int64[np.ndarray, "cells"]
    rgb: UInt8[np.ndarray, "rays 3"]


class Shader:
    """A scene's geometry, materials and light in the form that the kernels take."""

    def __init__(
        self,
        scene: Scene,
        caster: RayCaster,
        *,
        light_cell_m: float,
        shares: tuple[float, float],
        exposure: float,
        background: tuple[int, int, int],
        texture_budget_mb: float,
    ) -> None:
        """Prepare a scene; the options are those of `RenderConfig`.

        Args:
            scene: Scene to shade.
            caster: Ray caster of the scene.
            light_cell_m: Distance between the nodes of the light grid.
            shares: Weights of the soft light and of the headlight.
            exposure: Factor of all light.
            background: Colour where nothing is hit.
            texture_budget_mb: Memory for textures.
        """
        self._caster = caster
        self._geometry = _Geometry.of(scene)
        self._materials = MaterialArrays.of(scene)
        self._textures = textures_of(scene, texture_budget_mb)
        self._has_holes = any(material.opaque is not None for material in scene.materials)
        self._grid = LightGrid(*box_of(scene), light_cell_m, caster.distances)
        self._shares = np.array(shares, dtype=np.float64)
        self._tone = tone_curve(exposure)
        self._background = np.array(background, dtype=np.uint8)

    def shade(
        self,
        camera: Float64[np.ndarray, "4 3"],
        hits: Int32[np.ndarray, " rays"],
        rays: Rays,
        *,
        colours: bool = True,
    ) -> PendingRays | None:
        """Fill depth, instance and colour of rays.

        Args:
            camera: As for `geometry_kernels.fill_rays`.
            hits: The first triangle of every ray, -1 for none; replaced where it has a hole.
            rays: Rays, whose directions are read and whose results are filled.
            colours: Whether the colours are filled as well.

        Returns:
            The rays that wait for light, None if none do.
        """
        if self._has_holes:
            self._look_through_holes(camera, hits, rays.directions)
        self._measure(camera, hits, rays)
        if not colours:
            return None
        self._locate(camera, hits, rays)
        fill_base_colors(
            hits,
            rays.surface,
            self._geometry.colors,
            *self._materials,
            *self._textures,
            rays.base_color,
        )
        unlit = PendingRays(hits, rays.surface, rays.base_color, rays.wanted, rays.rgb)
        missing = self._light(unlit)
        if not missing:
            return None
        return replace(
            unlit,
            surface=unlit.surface.copy(),
            base_color=unlit.base_color.copy(),
            wanted=unlit.wanted[:missing].copy(),
        )

    def shade_pending(self, waiting: Sequence[PendingRays], pool: ThreadPoolExecutor) -> None:
        """Compute the light that rays wait for, and fill their colours."""
        if waiting:
            self._grid.bake(np.concatenate([unlit.wanted for unlit in waiting]), pool)
            list(pool.map(self._light, waiting))

    def _measure(
        self, camera: Float64[np.ndarray, "4 3"], hits: Int32[np.ndarray, " rays"], rays: Rays
    ) -> None:
        g = self._geometry
        measure(
            hits,
            rays.directions,
            camera,
            g.vertices,
            g.faces,
            g.face_instance,
            rays.depth,
            rays.ids,
        )

    def _locate(
        self, camera: Float64[np.ndarray, "4 3"], hits: Int32[np.ndarray, " rays"], rays: Rays
    ) -> None:
        g = self._geometry
        locate(
            hits,
            rays.directions,
            rays.depth,
            camera,
            g.vertices,
            g.faces,
            g.normals,
            g.uv,
            rays.surface,
        )

    def _look_through_holes(
        self,
        camera: Float64[np.ndarray, "4 3"],
        hits: Int32[np.ndarray, " rays"],
        directions: Float32[np.ndarray, "rays 3"],
    ) -> None:
        """Continue rays through holes of textures to the surfaces behind."""
        materials, textures = self._materials, self._textures
        is_cutout = materials.flags & FLAG_CUTOUT > 0
        through = np.flatnonzero((hits >= 0) & is_cutout[materials.face[hits]])
        for _ in range(_MAX_LAYERS):
            part = Rays.allocate(len(through))
            part.directions[:] = directions[through]
            self._measure(camera, hits[through], part)
            self._locate(camera, hits[through], part)
            holes = np.empty(len(through), dtype=np.int64)
            count = find_holes(
                hits[through],
                part.surface,
                materials.face,
                materials.flags,
                materials.wrap,
                textures.of_material,
                textures.texels,
                textures.levels,
                holes,
            )
            if count == 0:
                return
            holes = holes[:count]
            beyond = _BEYOND * (1.0 + part.depth[holes, None]) * part.directions[holes]
            origins = part.surface[holes, POINT : POINT + 3] + beyond
            through = through[holes]
            hits[through] = self._caster.faces(origins, part.directions[holes])

    def _light(self, unlit: PendingRays) -> int:
        """Fill colours; returns how many cells of the light grid are missing."""
        grid = self._grid
        return light(
            unlit.hits,
            unlit.surface,
            unlit.base_color,
            self._materials.face,
            self._materials.flags,
            grid.nodes.reshape(-1),
            grid.nodes.shape,
            grid.origin,
            grid.cell_m,
            self._shares,
            self._tone,
            self._background,
            unlit.rgb,
            unlit.wanted,
        )


class _Geometry(NamedTuple):
    vertices: Float32[np.ndarray, "vertices 3"]
    faces: Int32[np.ndarray, "faces 3"]
    normals: Float32[np.ndarray, "faces_or_0 3_or_0 3"]
    uv: Float32[np.ndarray, "faces 3 2"]
    face_instance: Int32[np.ndarray, "faces"]
    colors: UInt8[np.ndarray, "faces 3 3"]

    @staticmethod
    def of(scene: Scene) -> "_Geometry":
        normals = scene.normals if scene.normals is not None else np.zeros((0, 0, 3), np.float32)
        arrays = (
            scene.vertices,
            scene.faces,
            normals,
            scene.uv,
            scene.face_instance,
            scene.colors,
        )
        return _Geometry(*(np.ascontiguousarray(array) for array in arrays))


class MaterialArrays(NamedTuple):
    """Materials in the form that the kernels take, see `base_color_kernels`."""

    face: Int32[np.ndarray, "faces"]
    flags: UInt8[np.ndarray, "materials"]
    color: Float32[np.ndarray, "materials 3"]
    wrap: UInt8[np.ndarray, "materials 2"]

    @staticmethod
    def of(scene: Scene) -> "MaterialArrays":
        """The materials of a scene."""
        face = np.ascontiguousarray(scene.face_material)
        flags = np.zeros(len(scene.materials), dtype=np.uint8)
        for number, material in enumerate(scene.materials):
            flags[number] |= FLAG_UNLIT * (scene.unlit or material.unlit)
            flags[number] |= FLAG_CUTOUT * (material.opaque is not None)
        colored = np.any(scene.colors != 255, axis=(1, 2))
        flags[np.unique(face[colored])] |= FLAG_COLORED
        return MaterialArrays(
            face,
            flags,
            np.array([material.color for material in scene.materials], dtype=np.float32),
            np.array([material.wrap for material in scene.materials], dtype=np.uint8),
        )


def tone_curve(exposure: float) -> UInt8[np.ndarray, "steps"]:
    """SRGB codes of light 0 to 1: proportional, with a soft shoulder at the top."""
    shown = np.arange(TONE_STEPS) / (TONE_STEPS - 1) * exposure
    over = np.maximum(shown - _KNEE, 0.0) / (1.0 - _KNEE)
    shown = np.where(shown > _KNEE, _KNEE + (1.0 - _KNEE) * (1.0 - np.exp(-over)), shown)
    return np.rint(linear_to_srgb(shown) * 255.0).astype(np.uint8)
