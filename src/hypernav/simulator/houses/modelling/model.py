"""Models of objects: meshes with finishes, names, and surfaces that carry other objects."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64, Int64

Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangle mesh whose vertices are duplicated along sharp edges.

    Attributes:
        positions: Vertex positions, metres.
        normals: Unit normals of the vertices.
        uv: Texture coordinates, metres along the surface, or 0 to 1 across an image.
        faces: Vertex indices of every triangle, counter-clockwise seen from outside.
    """

    positions: Float64[np.ndarray, "vertices 3"]
    normals: Float64[np.ndarray, "vertices 3"]
    uv: Float64[np.ndarray, "vertices 2"]
    faces: Int64[np.ndarray, "faces 3"]

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> "Mesh":
        """Translated mesh.

        Args:
            x: Translation, metres.
            y: Translation, metres.
            z: Translation, metres.
        """
        return Mesh(self.positions + np.array((x, y, z)), self.normals, self.uv, self.faces)

    def turned(self, degrees: float, axis: str = "z") -> "Mesh":
        """Mesh rotated about an axis through the origin, counter-clockwise against the axis."""
        rotation = rotation_matrix(degrees, axis)
        positions, normals = _rotate(self.positions, rotation), _rotate(self.normals, rotation)
        return Mesh(positions, normals, self.uv, self.faces)

    def scaled(self, x: float, y: float, z: float) -> "Mesh":
        """Mesh scaled about the origin; a negative factor mirrors it."""
        factors = np.array([x, y, z])
        normals = self.normals / factors
        normals /= np.sqrt((normals * normals).sum(axis=1, keepdims=True)) + 1e-12
        faces = self.faces[:, ::-1] if x * y * z < 0 else self.faces
        return Mesh(self.positions * factors, normals, self.uv, faces)

    def textured(self, u: float, v: float, du: float = 0.0) -> "Mesh":
        """Mesh with texture coordinates scaled, and then shifted along u."""
        uv = self.uv * (u, v) + (du, 0.0)
        return Mesh(self.positions, self.normals, uv, self.faces)

    def swapped_uv(self) -> "Mesh":
        """Mesh with u and v exchanged, for grain that runs along the other axis."""
        return Mesh(self.positions, self.normals, self.uv[:, ::-1], self.faces)


@dataclass(frozen=True)
class Finish:
    """Colour, texture and material of a surface.

    Attributes:
        texture: Key in the texture library; empty for a plain colour.
        color: sRGB 0 to 1, multiplies the texture.
        tile_m: Side of the square that one image of the texture covers, metres; 1 for an image that
            is fitted to its surface.
        hue: Colour in words, an attribute of the object ("red").
        material: Material in words, an attribute of the object ("wooden").
        unlit: Whether it shines by itself, as screens, lamps and windows do.
    """

    texture: str
    color: Vector
    tile_m: float = 1.0
    hue: str = ""
    material: str = ""
    unlit: bool = False

    def tinted(self, factor: float) -> "Finish":
        """Finish with its colour multiplied by a factor."""
        r, g, b = (min(c * factor, 1.0) for c in self.color)
        return replace(self, color=(r, g, b))


@dataclass(frozen=True, eq=False)
class Part:
    """Mesh with its finish."""

    mesh: Mesh
    finish: Finish


def rotation_matrix(degrees: float, axis: str = "z") -> Float64[np.ndarray, "3 3"]:
    """Rotation matrix about a coordinate axis; exact for quarter turns."""
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
    """Union of several meshes as one mesh."""
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
    """Vectors scaled to length 1; a zero vector becomes +z."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    length = np.sqrt(x * x + y * y + z * z)[..., None]
    units = vectors / np.maximum(length, 1e-12)
    none = length[..., 0] <= 1e-12
    if none.any():
        units[none] = (0.0, 0.0, 1.0)
    return units


def repeat(mesh: Mesh, offsets: Sequence[Vector]) -> Mesh:
    """Copies of a mesh at several offsets (metres), as one mesh."""
    return join(mesh.moved(*offset) for offset in offsets)


@dataclass(frozen=True)
class SupportSurface:
    """Level surface that small objects can stand on, in the model's frame.

    Attributes:
        x_min: Left edge, metres.
        y_min: Back edge, metres.
        x_max: Right edge, metres.
        y_max: Front edge, metres.
        z: Height of the surface, metres.
        clearance_m: Free height above it, metres.
    """

    x_min: float
    y_min: float
    x_max: float
    y_max: float
    z: float
    clearance_m: float = 0.6


@dataclass(frozen=True, eq=False)
class Model:
    """Model of an object: x to its right, y to its front, z up, standing on z = 0.

    The footprint is centred on the origin.

    Attributes:
        parts: Meshes with finishes.
        category: Category of the object.
        synonyms: Other names of the category.
        attributes: Words that are true of it, such as colour and material.
        supports: Surfaces that small objects can stand on.
        low: Lowest corner of its bounding box, metres.
        high: Highest corner of its bounding box, metres.
    """

    parts: tuple[Part, ...]
    category: str
    synonyms: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    supports: tuple[SupportSurface, ...] = ()
    low: Vector = (0.0, 0.0, 0.0)
    high: Vector = (0.0, 0.0, 0.0)

    @property
    def width(self) -> float:
        """Extent along x, metres."""
        return self.high[0] - self.low[0]

    @property
    def depth(self) -> float:
        """Extent along y, metres."""
        return self.high[1] - self.low[1]

    @property
    def height(self) -> float:
        """Height of its highest point above the model's z = 0, metres."""
        return self.high[2]

    def named(self, *synonyms: str, attributes: tuple[str, ...] = ()) -> "Model":
        """Model with further synonyms and attributes."""
        return replace(
            self, synonyms=(*self.synonyms, *synonyms), attributes=(*self.attributes, *attributes)
        )


@dataclass
class ModelBuilder:
    """Builder of a model from parts."""

    parts: list[Part] = field(default_factory=list)

    def add(self, finish: Finish, *meshes: Mesh) -> None:
        """Add meshes of one finish."""
        self.parts.extend(Part(mesh, finish) for mesh in meshes)

    def extend(self, parts: Iterable[Part]) -> None:
        """Add parts."""
        self.parts.extend(parts)

    def model(
        self,
        category: str,
        *synonyms: str,
        main: Finish | None = None,
        attributes: tuple[str, ...] = (),
        supports: tuple[SupportSurface, ...] = (),
    ) -> Model:
        """Finished model, shifted so that its footprint is centred on the origin.

        Args:
            category: Category of the object.
            synonyms: Other names of the category.
            main: Finish whose colour and material become attributes ("red", "wooden").
            attributes: Further attributes.
            supports: Surfaces that small objects can stand on, in the frame of the parts.
        """
        low = np.min([p.mesh.positions.min(axis=0) for p in self.parts], axis=0)
        high = np.max([p.mesh.positions.max(axis=0) for p in self.parts], axis=0)
        x, y = (float(low[k] + high[k]) / 2.0 for k in (0, 1))
        words = tuple(w for w in ((main.hue, main.material) if main else ()) if w)
        return Model(
            tuple(Part(p.mesh.moved(-x, -y), p.finish) for p in self.parts),
            category,
            synonyms,
            words + attributes,
            tuple(
                replace(
                    t, x_min=t.x_min - x, x_max=t.x_max - x, y_min=t.y_min - y, y_max=t.y_max - y
                )
                for t in supports
            ),
            (float(low[0]) - x, float(low[1]) - y, float(low[2])),
            (float(high[0]) - x, float(high[1]) - y, float(high[2])),
        )
