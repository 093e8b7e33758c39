"""Meshes that furniture is made of, and their finish."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles whose vertices are split where an edge is sharp.

    Attributes:
        positions: Metres.
        normals: Unit normal of every vertex.
        uv: Texture coordinates in metres along the surface, or 0 to 1 across a picture.
        faces: Vertex numbers, counter-clockwise seen from outside.
    """

    positions: Float64[np.ndarray, "vertices 3"]
    normals: Float64[np.ndarray, "vertices 3"]
    uv: Float64[np.ndarray, "vertices 2"]
    faces: Int64[np.ndarray, "faces 3"]

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Mesh":
        """Shifted, metres."""
        return replace(self, positions=self.positions + (x, y, z))

    def turned(self, degrees: float, axis: str = "z") -> "Mesh":
        """Rotated about an axis through the origin, counter-clockwise seen against the axis."""
        rotation = rotation_matrix(degrees, axis)
        return replace(
            self, positions=_rotate(self.positions, rotation), normals=_rotate(self.normals, rotation)
        )

    def scaled(self, x: float, y: float, z: float) -> "Mesh":
        """Stretched about the origin; a negative factor mirrors."""
        factors = np.array([x, y, z])
        normals = self.normals / factors
        normals /= np.sqrt((normals * normals).sum(axis=1, keepdims=True)) + 1e-12
        faces = self.faces[:, ::-1] if x * y * z < 0 else self.faces
        return replace(self, positions=self.positions * factors, normals=normals, faces=faces)

    def textured(self, u: float = 1.0, v: float = 1.0, du: float = 0.0, dv: float = 0.0) -> "Mesh":
        """With texture coordinates scaled and then shifted."""
        return replace(self, uv=self.uv * (u, v) + (du, dv))

    def swapped_uv(self) -> "Mesh":
        """With the texture turned by a quarter, for grain that runs the other way."""
        return replace(self, uv=self.uv[:, ::-1])


@dataclass(frozen=True)
class Finish:
    """What a surface is made of.

    Attributes:
        texture: Key in the texture library; empty for a plain colour.
        color: sRGB 0 to 1, multiplies the texture.
        tile_m: Side of the surface that one picture of the texture covers; 1 for pictures that are
            fitted to their surface.
        hue: Colour word, for names.
        stuff: Material word, for names.
        unlit: Whether it shines by itself, as screens, lamps and windows do.
    """

    texture: str
    color: Vector
    tile_m: float = 1.0
    hue: str = ""
    stuff: str = ""
    unlit: bool = False

    def tinted(self, factor: float) -> "Finish":
        """Darker or lighter."""
        r, g, b = (min(c * factor, 1.0) for c in self.color)
        return replace(self, color=(r, g, b))


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh with its finish."""

    mesh: Mesh
    finish: Finish


def rotation_matrix(degrees: float, axis: str = "z") -> Float64[np.ndarray, "3 3"]:
    """Rotation about a coordinate axis; exact for quarter turns."""
    quarter = degrees / 90.0
    if quarter == round(quarter):
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarter) % 4]
    else:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if axis == "z":
        rows = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    elif axis == "x":
        rows = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    else:
        rows = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    return np.array(rows)


def _rotate(
    points: Float64[np.ndarray, "n 3"], rotation: Float64[np.ndarray, "3 3"]
) -> Float64[np.ndarray, "n 3"]:
    # Column by column instead of a BLAS product, whose order of summation depends on the machine.
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    return np.stack([x * r[0] + y * r[1] + z * r[2] for r in rotation], axis=1)


def join(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    parts = list(meshes)
    starts = np.cumsum([0] + [len(m.positions) for m in parts[:-1]])
    return Mesh(
        np.concatenate([m.positions for m in parts]),
        np.concatenate([m.normals for m in parts]),
        np.concatenate([m.uv for m in parts]),
        np.concatenate([m.faces + start for m, start in zip(parts, starts, strict=True)]),
    )


def unit_vectors(vectors: Float64[np.ndarray, "*n 3"]) -> Float64[np.ndarray, "*n 3"]:
    """Scaled to length 1; a zero vector becomes +z."""
    length = np.sqrt(
        vectors[..., 0] ** 2 + vectors[..., 1] ** 2 + vectors[..., 2] ** 2
    )[..., None]
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), np.array([0.0, 0.0, 1.0]))


def repeat(mesh: Mesh, places: Sequence[Vector]) -> Mesh:
    """Copies of a mesh at several places, as one mesh."""
    return join(mesh.moved(*place) for place in places)
