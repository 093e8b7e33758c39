"""Scenes: triangles, materials and named instances.

The scene frame is z up, metres. A glTF file (y up) becomes ``(x, -z, y)``.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import IntEnum
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, UInt8

from hypernav.core.world import Instance


class Wrap(IntEnum):
    """Wrapping mode of a texture beyond its edges."""

    REPEAT = 0
    MIRROR = 1
    CLAMP = 2


@dataclass(frozen=True, eq=False)
class Material:
    """Appearance of a surface.

    Attributes:
        name: Name, for people.
        color: Colour, sRGB, 0 to 1; multiplies the texture.
        texture: sRGB image, first row at the top (v = 1); None for a plain colour.
        wrap: Wrapping modes along u and along v.
        opaque: Texels where the surface exists, for leaves and lace; None if all of it does.
        unlit: Whether it is drawn in its own colour without light: screens, lamps, scans.
    """

    name: str
    color: tuple[float, float, float]
    texture: UInt8[np.ndarray, "height width 3"] | None = None
    wrap: tuple[Wrap, Wrap] = (Wrap.REPEAT, Wrap.REPEAT)
    opaque: Bool[np.ndarray, "height width"] | None = None
    unlit: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """A furnished building.

    Attributes:
        name: Name, for people and results.
        vertices: Vertex positions, scene frame, metres.
        faces: Vertex numbers of every triangle, counter-clockwise seen from outside.
        uv: Texture coordinates of every corner (v upwards).
        colors: sRGB colour of every corner, multiplies the material; white if the file has none.
        normals: Unit normal of every corner, for smooth shading; None shades every face flat.
        face_material: Index in ``materials`` of every triangle.
        face_instance: Index in ``instances`` of every triangle.
        materials: All materials.
        instances: All instances.
        unlit: Whether light is already in the textures, as in scans.
        navmesh: Navigation mesh file that comes with the scene; None if the walkable surface has
            to be computed from the triangles.
        stored_z_up: Whether the file itself is z up, contrary to glTF's rule, as scans are.
        storeys: Heights of the floors of a building that is known to have several storeys, from
            the lowest on, metres; empty for others.
        cache: Folder for data computed from exactly these triangles and materials; None keeps
            nothing.
    """

    name: str
    vertices: Float32[np.ndarray, "vertices 3"]
    faces: Int32[np.ndarray, "faces 3"]
    uv: Float32[np.ndarray, "faces 3 2"]
    colors: UInt8[np.ndarray, "faces 3 3"]
    normals: Float32[np.ndarray, "faces 3 3"] | None
    face_material: Int32[np.ndarray, "faces"]
    face_instance: Int32[np.ndarray, "faces"]
    materials: tuple[Material, ...]
    instances: tuple[Instance, ...]
    unlit: bool = False
    navmesh: Path | None = None
    stored_z_up: bool = False
    storeys: tuple[float, ...] = ()
    cache: Path | None = None

    def triangles_of(self, ids: Collection[int]) -> Float64[np.ndarray, "n 3 3"]:
        """The triangles of some instances, metres."""
        faces = self.faces[np.isin(self.face_instance, list(ids))]
        return self.vertices[faces].astype(np.float64)

    def of_faces(self, keep: Bool[np.ndarray, "faces"]) -> "Scene":
        """The scene with only some of its triangles; it has no cache.

        Args:
            keep: Whether each triangle stays.
        """
        return replace(
            self,
            faces=self.faces[keep],
            uv=self.uv[keep],
            colors=self.colors[keep],
            normals=None if self.normals is None else self.normals[keep],
            face_material=self.face_material[keep],
            face_instance=self.face_instance[keep],
            navmesh=None,
            cache=None,
        )
