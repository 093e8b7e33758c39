"""Scenes that a stranger may send: a sound one with something changed."""

import copy
import json
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gltf_writer import SQUARE_UV, GltfWriter

RED = np.full((4, 4, 3), (200, 20, 20), np.uint8)
FLAT = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
"""Rotation that lays the unit square on the floor."""


def sound() -> GltfWriter:
    """A textured floor of 6 × 6 m with a chair on it."""
    writer = GltfWriter()
    uv = writer.array(SQUARE_UV)
    floor = writer.mesh(writer.square(material=writer.textured(RED, wrapS=10497), TEXCOORD_0=uv))
    writer.node(name="floor", mesh=floor, scale=[6.0, 6.0, 1.0], rotation=FLAT)
    chair = writer.mesh(
        writer.square(NORMAL=writer.array(np.tile([[0, 0, 1]], (4, 1)).astype("f")))
    )
    writer.node(name="chair", mesh=chair, translation=[3.0, 0.2, -3.0])
    return writer


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all values in a document."""
    if path:
        yield path
    keyed = isinstance(value, dict)
    items = value.items() if keyed else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield from places(inner, (*path, key))


def replaced(document: Any, path: tuple[Any, ...], value: Any) -> Any:
    """The document with another value at a place."""
    changed = copy.deepcopy(document)
    at = changed
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return changed


def png(
    width: int, height: int, *, color: int = 2, bits: int = 8, rows: bytes | None = None
) -> bytes:
    """A PNG whose header says whatever one likes; few bytes of it exist."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        )

    header = struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, 0)
    body = zlib.compress(b"\0" * 1000 if rows is None else rows)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
    )


def jpeg(*frames: tuple[int, int], scans: int = 1) -> bytes:
    """A JPEG of headers alone."""
    parts = [b"\xff\xd8"]
    parts += [b"\xff\xc2" + struct.pack(">HBHHB", 11, 8, h, w, 1) + b"\1\x11\0" for w, h in frames]
    parts += [b"\xff\xda" + struct.pack(">HB", 8, 1) + b"\1\0\0\x3f\0"] * scans
    return b"".join(parts) + b"\xff\xd9"


def webp(width: int, height: int) -> bytes:
    """The header of a WebP image."""
    sides = (width - 1).to_bytes(3, "little") + (height - 1).to_bytes(3, "little")
    return b"RIFF\x40\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0" + sides + bytes(40)


IMAGES = {
    "png 30000": png(30_000, 30_000),
    "png 2 billion": png(2**31 - 1, 2**31 - 1),
    "png wide": png(2**31 - 1, 1),
    "png zero": png(0, 0),
    "png 16 bit": png(9_000, 9_000, bits=16, color=6),
    "png without data": png(8_000, 4_000),
    "png of one chunk": png(4, 4)[:33] + b"\xff\xff\xff\xf0IDAT" + bytes(6000),
    "png bad bits": png(4, 4, bits=77),
    "png cut": png(4, 4)[:20],
    "jpeg 65500": jpeg((65_500, 65_500)),
    "jpeg twice": jpeg((4, 4), (65_500, 65_500)),
    "jpeg no frame": jpeg(),
    "jpeg no height": jpeg((4, 0)),
    "jpeg scans": jpeg((4_000, 4_000), scans=100_000),
    "webp 16383": webp(16_383, 16_383),
    "webp 16 million": webp(2**24, 2**24),
    "webp empty": webp(4, 4),
    "gif": b"GIF89a\xff\xff\xff\xff\xf7\0\0" + bytes(100),
    "bmp": b"BM" + struct.pack("<IHHIIiiHH", 100, 0, 0, 54, 40, 30_000, 30_000, 1, 24) + bytes(60),
    "tiff": b"II*\0\x08\0\0\0" + bytes(100),
    "exr": b"\x76\x2f\x31\x01" + bytes(100),
    "pnm": b"P6 30000 30000 255\n",
    "text": b"<svg xmlns='http://www.w3.org/2000/svg'/>",
    "nothing": b"",
}
"""Textures."""


def with_texture(content: bytes) -> GltfWriter:
    """The sound scene with another texture."""
    writer = sound()
    writer.document["images"][0]["bufferView"] = writer.view(content)
    return writer


ACCESSORS = {
    "count 1e9": {"count": 10**9},
    "count 1e18": {"count": 10**18},
    "nothing, 1e9": {"count": 10**9, "bufferView": None},
    "nothing, 1e18": {"count": 10**18, "bufferView": None},
    "nothing, 1e30": {"count": 10**30, "bufferView": None},
    "sparse": {
        "count": 10**9,
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 0, "componentType": 5125},
            "values": {"bufferView": 0},
        },
    },
    "offset": {"byteOffset": 2**63},
    "negative": {"count": -1},
    "signed": {"componentType": 5122},
    "float": {"componentType": 5126, "count": 3},
    "matrix": {"type": "MAT4"},
}
"""Changes of the accessor of the triangles' corners."""


def with_accessor(change: dict[str, Any]) -> GltfWriter:
    """The sound scene with another accessor for its corners."""
    writer = sound()
    number = writer.document["meshes"][0]["primitives"][0]["indices"]
    accessor = writer.document["accessors"][number] | change
    writer.document["accessors"][number] = {k: v for k, v in accessor.items() if v is not None}
    return writer


REFERENCES = (
    "/dev/zero",
    "/etc/passwd",
    "../../../../../../etc/passwd",
    "../scene.bin",
    "a/../../b",
    "%2e%2e/b",
    "file:///dev/zero",
    "http://127.0.0.1:1/a.png",
    "a%00b",
    "pipe",
    "zero",
    "folder",
    "x" * 5000,
    "data:,!",
    "data:;base64,AAA",
    "",
    ".",
)
"""References to a buffer. The folder of the scene holds a pipe, a link to a device and a folder."""


def with_reference(uri: str, kind: str) -> bytes:
    """The sound scene with a buffer or an image that is elsewhere."""
    writer = sound()
    document = document_of(writer)
    if kind == "images":
        document["images"][0] = {"uri": uri}
    else:
        document["buffers"].append({"byteLength": 4, "uri": uri})
        document["bufferViews"][0]["buffer"] = 1
    return as_glb(json.dumps(document).encode(), bytes(writer.binary))


def with_nodes(nodes: list[dict[str, Any]]) -> GltfWriter:
    """The sound scene's first mesh, shown by other nodes; the first of them is the root."""
    writer = sound()
    writer.document["nodes"] = nodes
    writer.document["scenes"] = [{"nodes": [0]}]
    return writer


def chain(count: int, **node: Any) -> list[dict[str, Any]]:
    """Nodes that each hang below the one before."""
    return [{**node, **({"children": [n + 1]} if n + 1 < count else {})} for n in range(count)]


NODES: dict[str, Callable[[], list[dict[str, Any]]]] = {
    "chain of 50000": lambda: [{"mesh": 0}, *chain(50_001)[1:]],
    "chain of 50000 floors": lambda: chain(50_000, mesh=0, name="floor"),
    "chain of 19000 floors": lambda: chain(19_000, mesh=0, name="floor", scale=[0.01, 0.01, 0.01]),
    "million children": lambda: [{"mesh": 0, "children": [0] * 1_000_000}],
    "circle": lambda: [{"mesh": 0, "children": [1]}, {"children": [0]}],
    "itself": lambda: [{"mesh": 0, "children": [0]}],
    "twice": lambda: [{"mesh": 0, "children": [1, 1]}, {"mesh": 0}],
    "floor of 350 m": lambda: [{"mesh": 0, "scale": [350, 350, 1], "rotation": FLAT}],
    "floor of 1e9 m": lambda: [{"mesh": 0, "scale": [1e9, 1e9, 1], "rotation": FLAT}],
    "floor of 1e38 m": lambda: [{"mesh": 0, "scale": [1e38, 1e38, 1], "rotation": FLAT}],
    "wall of 1e6 m": lambda: [{"mesh": 0, "scale": [5, 1e6, 1]}],
    "40 floors of 150 m": lambda: [
        {"children": list(range(1, 41)), "rotation": FLAT},
        *({"mesh": 0, "scale": [150, 150, 1], "translation": [0, 0, 3 * n]} for n in range(40)),
    ],
    "overflow": lambda: chain(200, mesh=0, scale=[1e30, 1e30, 1e30]),
    "underflow": lambda: chain(200, mesh=0, scale=[1e-30, 1e-30, 1e-30]),
    "no scale": lambda: [{"mesh": 0, "scale": [0, 0, 0]}],
    "no rotation": lambda: [{"mesh": 0, "rotation": [0, 0, 0, 0]}],
    "huge rotation": lambda: [{"mesh": 0, "rotation": [1e200, 1e200, 1e200, 1e200]}],
    "huge matrix": lambda: [{"mesh": 0, "matrix": [1e308] * 16}],
    "far away": lambda: [{"mesh": 0, "translation": [1e30, 1e30, 1e30]}],
}
"""Nodes in place of the sound ones; some are many, so each is made in its test."""

WHOLE_FILES = {
    "empty": b"",
    "four bytes": b"glTF",
    "header": b"glTF\x02\0\0\0\x0c\0\0\0",
    "length": b"glTF\x02\0\0\0\xff\xff\xff\xff" + bytes(20),
    "chunk": b"glTF\x02\0\0\0\x1c\0\0\0\xff\xff\xff\xffJSON{}      ",
    "version": b"glTF\x01\0\0\0\x14\0\0\0" + bytes(8),
    "no json": b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0JSON",
    "zip": b"PK\3\4" + bytes(100),
}
"""Files that are called scene.glb."""


def write(content: GltfWriter | bytes, path: Path) -> Path:
    """Write a scene."""
    if isinstance(content, GltfWriter):
        return content.write(path)
    path.write_bytes(content)
    return path


def as_glb(text: bytes, binary: bytes = b"") -> bytes:
    """A GLB of any JSON text."""
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I", len(text)) + b"JSON" + text
    if binary:
        chunks += struct.pack("<I", len(binary)) + b"BIN\0" + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def document_of(writer: GltfWriter) -> dict[str, Any]:
    """The document with its buffer."""
    return writer.document | {"buffers": [{"byteLength": len(writer.binary)}]}


def broken_documents(values: tuple[Any, ...]) -> Iterator[tuple[str, bytes]]:
    """Every place of the sound document with a value in turn."""
    writer = sound()
    document, binary = document_of(writer), bytes(writer.binary)
    for number, path in enumerate(places(document)):
        value = values[number % len(values)]
        text = json.dumps(replaced(document, path, value)).encode()
        yield f"{'.'.join(map(str, path))} {value!r:.20}", as_glb(text, binary)
