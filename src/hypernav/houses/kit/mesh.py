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
        return Mesh(self.positions + np.array((x, y, z)), self.normals, self.uv, self.faces)

    def turned(self, degrees: float, axis: str = "z") -> "Mesh":
        """Rotated about an axis through the origin, counter-clockwise seen against the axis."""
        rotation = rotation_matrix(degrees, axis)
        positions, normals = _rotate(self.positions, rotation), _rotate(self.normals, rotation)
        return Mesh(positions, normals, self.uv, self.faces)

    def scaled(self, x: float, y: float, z: float) -> "Mesh":
        """Stretched about the origin; a negative factor mirrors."""
        factors = np.array([x, y, z])
        normals = self.normals / factors
        normals /= np.sqrt((normals * normals).sum(axis=1, keepdims=True)) + 1e-12
        faces = self.faces[:, ::-1] if x * y * z < 0 else self.faces
        return Mesh(self.positions * factors, normals, self.uv, faces)

    def textured(self, u: float = 1.0, v: float = 1.0, du: float = 0.0, dv: float = 0.0) -> "Mesh":
        """With texture coordinates scaled and then shifted."""
        uv = self.uv * (u, v) + (du, dv)
        return Mesh(self.positions, self.normals, uv, self.faces)

    def swapped_uv(self) -> "Mesh":
        """With the texture turned by a quarter, for grain that runs the other way."""
        return Mesh(self.positions, self.normals, self.uv[:, ::-1], self.faces)


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
    result = np.empty_like(points)
    for k, (a, b, c) in enumerate(rotation.tolist()):
        result[:, k] = x * a + y * b + z * c
    return result


def join(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    parts = list(meshes)
    starts, total = [], 0
    for part in parts:
        starts.append(total)
        total += len(part.positions)
    return Mesh(
        np.concatenate([m.positions for m in parts]),
        np.concatenate([m.normals for m in parts]),
        np.concatenate([m.uv for m in parts]),
        np.concatenate([m.faces + start for m, start in zip(parts, starts, strict=True)]),
    )


def unit_vectors(vectors: Float64[np.ndarray, "*n 3"]) -> Float64[np.ndarray, "*n 3"]:
    """Scaled to length 1; a zero vector becomes +z."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    length = np.sqrt(x * x + y * y + z * z)[..., None]
    units = vectors / np.maximum(length, 1e-12)
    none = length[..., 0] <= 1e-12
    if none.any():
        units[none] = (0.0, 0.0, 1.0)
    return units


def repeat(mesh: Mesh, places: Sequence[Vector]) -> Mesh:
    """Copies of a mesh at several places, as one mesh."""
    return join(mesh.moved(*place) for place in places)
