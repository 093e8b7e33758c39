"""Writes small glTF files for tests, byte by byte: every corner of the format is in reach."""

import json
import struct
from pathlib import Path
from typing import Any

import cv2
import numpy as np

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_CODES = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
SQUARE_FACES = np.array([0, 1, 2, 0, 2, 3], np.uint16)
SQUARE_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)


class GltfWriter:
    """Collects the parts of a file; `document` may be changed at will before it is written."""

    def __init__(self) -> None:
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
        }
        self.binary = bytearray()

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Append an item to one of the document's lists."""
        items = self.document.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def view(self, content: bytes) -> int:
        """Append bytes."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        start = len(self.binary)
        self.binary += content
        view = {"buffer": 0, "byteOffset": start, "byteLength": len(content)}
        return self.add("bufferViews", view)

    def array(self, values: np.ndarray, **more: Any) -> int:
        """Append an array ``[count, width]`` or ``[count]``."""
        width = values.shape[1] if values.ndim == 2 else 1
        accessor = {
            "bufferView": self.view(np.ascontiguousarray(values).tobytes()),
            "componentType": _CODES[values.dtype.char],
            "count": len(values),
            "type": _TYPES[width],
            **more,
        }
        return self.add("accessors", accessor)

    def square(self, *, material: int | None = None, **attributes: int) -> dict[str, Any]:
        """A primitive: the unit square in the xy plane, facing +z of glTF."""
        primitive = {
            "attributes": {"POSITION": self.array(SQUARE), **attributes},
            "indices": self.array(SQUARE_FACES),
        }
        return primitive if material is None else {**primitive, "material": material}

    def mesh(self, *primitives: dict[str, Any], name: str = "") -> int:
        """A mesh of primitives."""
        return self.add("meshes", {"primitives": list(primitives), "name": name})

    def node(self, *, root: bool = True, **node: Any) -> int:
        """A node, shown by the scene itself if it is a root."""
        number = self.add("nodes", node)
        if root:
            self.document["scenes"][0]["nodes"].append(number)
        return number

    def textured(self, image: np.ndarray, *, suffix: str = ".png", **sampler: int) -> int:
        """A material with an image (RGB or RGBA)."""
        code = cv2.COLOR_RGB2BGR if image.shape[2] == 3 else cv2.COLOR_RGBA2BGRA
        _, content = cv2.imencode(suffix, cv2.cvtColor(image, code))
        file = {"bufferView": self.view(content.tobytes()), "mimeType": "image/png"}
        texture: dict[str, Any] = {"source": self.add("images", file)}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        info = {"index": self.add("textures", texture)}
        return self.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": info}})

    def write(self, path: Path) -> Path:
        """Write a ``.glb`` file."""
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        length = 12 + 8 + len(text) + 8 + len(binary)
        path.write_bytes(
            struct.pack("<4sII", b"glTF", 2, length)
            + struct.pack("<II", len(text), 0x4E4F534A)
            + text
            + struct.pack("<II", len(binary), 0x004E4942)
            + binary
        )
        return path
