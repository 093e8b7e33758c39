"""Writer of binary glTF 2.0 (y up): one node per instance, one primitive per material."""

import json
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int64, UInt8
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from hypernav.simulator.houses.assembly import CompactScene, to_scene
from hypernav.simulator.worlds.scenes.scene import Material, Wrap

_FLOAT, _UINT = 5126, 5125
_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_GL_WRAPS = {Wrap.REPEAT: 10497, Wrap.MIRROR: 33648, Wrap.CLAMP: 33071}


def with_backs(house: CompactScene) -> CompactScene:
    """The same house, in which open surfaces, such as leaves, have a second face from behind.

    habitat-sim leaves out triangles that are seen from behind, also of materials that glTF calls
    double-sided, unless it draws with physically based shading.
    """
    behind = np.flatnonzero(_is_open(house))
    face = np.concatenate([np.arange(len(house.faces)), behind])
    faces = np.concatenate([house.faces, house.faces[behind][:, ::-1]])
    # The faces of an instance follow each other.
    order = np.argsort(house.face_instance[face], kind="stable")
    return replace(
        house,
        faces=faces[order],
        face_instance=house.face_instance[face[order]],
        face_material=house.face_material[face[order]],
    )


def _is_open(house: CompactScene) -> Bool[np.ndarray, " faces"]:
    """Whether each face is part of a surface with a border, which closes around nothing."""
    corners = np.column_stack(
        [house.positions[house.faces.ravel()], np.repeat(house.face_instance, 3)]
    )
    _, places = np.unique(corners, axis=0, return_inverse=True)
    places = places.reshape(-1, 3)
    edges = np.sort(np.stack([places, np.roll(places, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, number, uses = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    count = int(places.max()) + 1
    links = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, part = connected_components(links, directed=False)
    open_parts = np.unique(part[edges[uses[number.ravel()] == 1, 0]])
    return np.isin(part[places[:, 0]], open_parts)


def srgb_to_linear(codes: np.ndarray) -> np.ndarray:
    """Linear light of sRGB values (0 to 1, any shape)."""
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def y_up(points: Float32[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n 3"]:
    """Coordinates of the scene (z up) in glTF's frame (y up)."""
    return np.column_stack([points[:, 0], points[:, 2], -points[:, 1]]).astype(np.float32)


class GlbWriter:
    """Builder of a glTF file."""

    def __init__(self) -> None:
        """Start an empty document."""
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "hypernav"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "textures": [],
            "images": [],
            "samplers": [],
            "accessors": [],
            "bufferViews": [],
            "extensionsUsed": [],
        }
        self._chunks: list[bytes] = []
        self._length = 0

    def _view(self, content: bytes, target: int | None = None) -> int:
        view: dict[str, Any] = {"buffer": 0, "byteOffset": self._length, "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        padded = content + b"\0" * (-len(content) % 4)
        self._chunks.append(padded)
        self._length += len(padded)
        self.document["bufferViews"].append(view)
        return len(self.document["bufferViews"]) - 1

    def vectors(self, values: Float32[np.ndarray, "n width"], *, bounds: bool = False) -> int:
        """Add a vertex attribute and return the index of its accessor."""
        accessor: dict[str, Any] = {
            "bufferView": self._view(np.ascontiguousarray(values).tobytes(), _ARRAY_BUFFER),
            "componentType": _FLOAT,
            "count": len(values),
            "type": f"VEC{values.shape[1]}",
        }
        if bounds:
            accessor["min"] = [float(v) for v in values.min(axis=0)]
            accessor["max"] = [float(v) for v in values.max(axis=0)]
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def indices(self, values: Int64[np.ndarray, "n"]) -> int:
        """Add vertex indices and return the index of their accessor."""
        accessor = {
            "bufferView": self._view(values.astype(np.uint32).tobytes(), _ELEMENT_BUFFER),
            "componentType": _UINT,
            "count": len(values),
            "type": "SCALAR",
        }
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def image(self, rgb: UInt8[np.ndarray, "height width 3"], wrap: tuple[Wrap, Wrap]) -> int:
        """Add a texture image and return the index of the texture."""
        _, png = cv2.imencode(".png", np.ascontiguousarray(rgb[..., ::-1]))
        document = self.document
        document["images"].append(
            {"bufferView": self._view(png.tobytes()), "mimeType": "image/png"}
        )
        sampler = {"wrapS": _GL_WRAPS[wrap[0]], "wrapT": _GL_WRAPS[wrap[1]]}
        if sampler not in document["samplers"]:
            document["samplers"].append(sampler)
        texture = {
            "source": len(document["images"]) - 1,
            "sampler": document["samplers"].index(sampler),
        }
        document["textures"].append(texture)
        return len(document["textures"]) - 1

    def material(self, material: Material, texture: int | None) -> None:
        """Add a material; its index is the number of materials before it."""
        linear = srgb_to_linear(np.array(material.color))
        surface: dict[str, Any] = {
            "baseColorFactor": [*(float(c) for c in linear), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9,
        }
        if texture is not None:
            surface["baseColorTexture"] = {"index": texture}
        entry: dict[str, Any] = {
            "name": material.name,
            "pbrMetallicRoughness": surface,
            "doubleSided": True,
        }
        if material.unlit:
            entry["extensions"] = {"KHR_materials_unlit": {}}
            if "KHR_materials_unlit" not in self.document["extensionsUsed"]:
                self.document["extensionsUsed"].append("KHR_materials_unlit")
        self.document["materials"].append(entry)

    def node(self, name: str, primitives: list[dict[str, Any]]) -> None:
        """Add a node with a mesh."""
        document = self.document
        document["meshes"].append({"name": name, "primitives": primitives})
        document["nodes"].append({"name": name, "mesh": len(document["meshes"]) - 1})
        document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)

    def write(self, path: Path) -> None:
        """Write the file."""
        filled = {key: value for key, value in self.document.items() if value not in ([], {})}
        filled["buffers"] = [{"byteLength": self._length}]
        text = json.dumps(filled, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + self._length
        with path.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, total))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", self._length, b"BIN\0"))
            file.writelines(self._chunks)


def write_house(house: CompactScene, path: Path) -> None:
    """Write a house with all its materials."""
    scene = to_scene(house, path.stem)
    writer = GlbWriter()
    numbers: dict[tuple[int, tuple[Wrap, Wrap]], int] = {}
    for material in scene.materials:
        texture = None
        if material.texture is not None:
            key = (id(material.texture), material.wrap)
            if key not in numbers:
                numbers[key] = writer.image(material.texture, material.wrap)
            texture = numbers[key]
        writer.material(material, texture)
    positions = y_up(scene.vertices)
    normals = y_up(house.normals.astype(np.float32) / np.float32(32_000.0))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-6)
    uv = np.column_stack([house.uv[:, 0], 1.0 - house.uv[:, 1]]).astype(np.float32)
    primitives: dict[int, list[dict[str, Any]]] = {}
    for instance, material, faces in _groups(house):
        used, corners = np.unique(faces, return_inverse=True)
        attributes = {
            "POSITION": writer.vectors(positions[used], bounds=True),
            "NORMAL": writer.vectors(normals[used]),
            "TEXCOORD_0": writer.vectors(uv[used]),
        }
        primitive = {
            "attributes": attributes,
            "indices": writer.indices(corners.ravel()),
            "material": material,
        }
        primitives.setdefault(instance, []).append(primitive)
    for number, name in enumerate(house.names):
        writer.node(name, primitives[number])
    writer.write(path)


def write_semantics(
    house: CompactScene, colors: UInt8[np.ndarray, "instances 3"], path: Path
) -> None:
    """Write a house as one mesh whose vertex colours identify the instances, for Habitat."""
    positions = y_up((house.positions / np.float64(10_000.0)).astype(np.float32))
    owner = np.zeros(len(positions), dtype=np.int64)
    owner[house.faces.ravel()] = np.repeat(house.face_instance.astype(np.int64), 3)
    # glTF stores linear vertex colours; Habitat converts them back to sRGB.
    light = srgb_to_linear(colors[owner] / 255.0).astype(np.float32)
    writer = GlbWriter()
    attributes = {
        "POSITION": writer.vectors(positions, bounds=True),
        "COLOR_0": writer.vectors(light),
    }
    corners = writer.indices(house.faces.ravel().astype(np.int64))
    writer.node("semantics", [{"attributes": attributes, "indices": corners}])
    writer.write(path)


def _groups(house: CompactScene) -> Iterator[tuple[int, int, np.ndarray]]:
    """Faces of every instance and material: ``(instance, material, faces)``."""
    key = house.face_instance.astype(np.int64) * 65_536 + house.face_material
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    for start, end in zip(starts, [*starts[1:], len(order)], strict=True):
        first = order[start]
        yield (
            int(house.face_instance[first]),
            int(house.face_material[first]),
            house.faces[order[start:end]],
        )
