"""Shading: depth, instance and colour of rays, under the light of a grid of nodes.

The nodes fill the scene. Each holds the light that arrives from +x, -x, +y, -y, +z and -z: a fixed
set of rays is cast from the node, the open ones bring the light of a bright ceiling above and of
dimmer walls and floor, and an object nearby dims its direction (ambient occlusion). A surface reads
the eight nodes around the point just in front of it, so a table darkens the floor under it and a
corner darkens towards its edge. Nodes are computed when a camera first sees a surface beside them
and kept: a frame that shows nothing new costs nothing, and a node's value depends only on its
position, so the order of frames doesn't matter.
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64, UInt8

from hypernav.simulator.worlds.drawing.ray_kernels import POINT, SURFACE_COLUMNS, locate, measure
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.drawing.shading_kernels import (
    FLAG_COLORED,
    FLAG_CUTOUT,
    FLAG_UNLIT,
    TONE_STEPS,
    fill_base_colors,
    find_holes,
    gather_light,
    light,
)
from hypernav.simulator.worlds.drawing.textures import linear_to_srgb, textures_of
from hypernav.simulator.worlds.scenes.scene import Scene

RAYS = 48
"""Directions in which a node looks for light."""
REACH_M = 2.0
"""Distance beyond which a hit does not block light."""
CONTRAST = 1.5
"""Exponent of the light; above 1 deepens the shade."""
_MAX_NODES = 8_000_000
_BATCH = 512
_STATE = 7

CastDistances = Callable[
    [Float32[np.ndarray, "rays 3"], Float32[np.ndarray, "rays 3"], float],
    Float32[np.ndarray, "rays"],
]
"""``(origins, directions, reach)`` to the distance of the first hit; negative or more if none."""
_MAX_LAYERS = 8
_BEYOND = 1e-4
_KNEE = 0.7


class LightGrid:
    """The nodes around a scene.

    Attributes:
        nodes: Bytes 0 to 5: light from +x, -x, +y, -y, +z, -z; byte 7: 1 where known.
        origin: Position of node (0, 0, 0), scene frame, metres.
        cell_m: Distance between nodes.
    """

    nodes: UInt8[np.ndarray, "z y x 8"]
    origin: Float64[np.ndarray, "3"]
    cell_m: float

    def __init__(
        self,
        low: Float64[np.ndarray, "3"],
        high: Float64[np.ndarray, "3"],
        cell_m: float,
        cast: CastDistances,
    ) -> None:
        """Cover a box with nodes; none is computed yet.

        Args:
            low: Lowest corner of the scene, metres.
            high: Highest corner.
            cell_m: Distance between nodes; grows for scenes that would need too many.
            cast: Function that measures distances in the scene.
        """
        self.origin, self.cell_m, shape = extent_of_grid(low, high, cell_m)
        self.nodes = np.zeros((*shape, 8), dtype=np.uint8)
        self._cast = cast
        self._directions = even_directions(RAYS)
        self._sky = sky_light(self._directions)

    def bake(self, cells: Int64[np.ndarray, "cells"], pool: ThreadPoolExecutor) -> None:
        """Compute the unknown ones of the eight nodes around each cell."""
        _, rows, columns = self.nodes.shape[:3]
        corners = [z * rows * columns + y * columns + x for z, y, x in np.ndindex(2, 2, 2)]
        flat = self.nodes.reshape(-1, 8)
        numbers = np.unique(cells[:, None] + np.array(corners, dtype=np.int64))
        numbers = numbers[flat[numbers, _STATE] == 0]
        batches = [numbers[start : start + _BATCH] for start in range(0, len(numbers), _BATCH)]
        for batch, around in zip(batches, pool.map(self._light_at, batches), strict=True):
            flat[batch, :6] = around
            flat[batch, _STATE] = 1

    def _light_at(self, numbers: Int64[np.ndarray, "n"]) -> UInt8[np.ndarray, "n 6"]:
        z, y, x = np.unravel_index(numbers, self.nodes.shape[:3])
        positions = (np.stack([x, y, z], axis=1) * self.cell_m + self.origin).astype(np.float32)
        # All positions along one direction, then the next: neighbouring rays take similar paths.
        origins = np.tile(positions, (len(self._directions), 1))
        directions = np.repeat(self._directions, len(positions), axis=0)
        distances = self._cast(origins, directions, REACH_M)
        light = np.empty((len(positions), 6), dtype=np.uint8)
        shape = (len(self._directions), len(positions))
        gather_light(
            distances.reshape(shape), self._directions, self._sky, REACH_M, CONTRAST, light
        )
        return light


def box_of(scene: Scene) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """Lowest and highest corner of a scene's triangles, metres."""
    used = np.zeros(len(scene.vertices), dtype=bool)
    used[scene.faces.ravel()] = True
    corners = scene.vertices[used].astype(np.float64)
    return corners.min(axis=0), corners.max(axis=0)


def extent_of_grid(
    low: Float64[np.ndarray, "3"], high: Float64[np.ndarray, "3"], cell_m: float
) -> tuple[Float64[np.ndarray, "3"], float, tuple[int, int, int]]:
    """Position of the first node, distance of the nodes, and their number along z, y and x.

    Args:
        low: Lowest corner of the scene, metres.
        high: Highest corner.
        cell_m: Distance between nodes; grows for scenes that would need too many.
    """
    margin = 3.0
    while np.prod((high - low) / cell_m + 2 * margin + 1) > _MAX_NODES:
        cell_m *= 1.25
    size = np.ceil((high - low) / cell_m + 2 * margin).astype(int) + 1
    return low - margin * cell_m, cell_m, (int(size[2]), int(size[1]), int(size[0]))


def even_directions(count: int) -> Float32[np.ndarray, "count 3"]:
    """Directions spread evenly over the sphere (Fibonacci lattice)."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    angle = index * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1).astype(np.float32)


def sky_light(directions: Float32[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n"]:
    """Light from every direction of an empty room, at most 1.

    Brightest from above. A little brighter from one side, not parallel to the axes, so that the
    four sides of a box differ.
    """
    upward = directions[:, 2].astype(np.float64)
    sideways = directions[:, 0] * 0.8 + directions[:, 1] * 0.6
    return 0.66 + 0.22 * upward + 0.12 * sideways


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays from one camera with memory for their results and for intermediate values.

    Attributes:
        origins: Origins, scene frame, metres.
        directions: Directions, scene frame, 1 long along the optical axis.
        depth: Depth along the optical axis in metres, 0 where nothing is hit.
        ids: Instances, -1 where nothing is hit.
        rgb: Colours as shown.
        surface: Points, normals and texture coordinates, see `ray_kernels`.
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
        return Rays(*(getattr(self, field.name)[:count] for field in fields(self)))


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
            camera: As for `ray_kernels.fill_rays`.
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
        arrays = (scene.vertices, scene.faces, normals, scene.uv, scene.face_instance, scene.colors)
        return _Geometry(*(np.ascontiguousarray(array) for array in arrays))


class MaterialArrays(NamedTuple):
    """Materials in the form that the kernels take, see `shading_kernels`."""

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
