"""A glTF 2.0 file: its container, buffers, arrays and images, and its document, checked when read.

Names and meaning follow the specification of the Khronos Group; other fields are ignored.
"""

import base64
import binascii
import struct
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any, Literal, TypeVar
from urllib.parse import unquote

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.alias_generators import to_camel

from hypernav.core.errors import SceneError
from hypernav.io.parsing import Items, parse_json
from hypernav.io.reading import Allowance, path_below, read_file

_MAGIC = b"glTF"
_LEAST_BYTES = 20
"""Bytes of the header of a GLB and of its first chunk."""
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942
_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_EXTENSIONS = frozenset(
    {
        "EXT_instance_features",
        "EXT_mesh_features",
        "EXT_mesh_gpu_instancing",
        "EXT_structural_metadata",
        "CESIUM_primitive_outline",
        "FB_geometry_metadata",
        "KHR_materials_unlit",
        "KHR_materials_emissive_strength",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_specular",
        "KHR_materials_ior",
        "KHR_materials_clearcoat",
        "KHR_materials_sheen",
        "KHR_materials_transmission",
        "KHR_materials_volume",
        "KHR_materials_anisotropy",
        "KHR_materials_iridescence",
        "KHR_materials_variants",
        "KHR_lights_punctual",
        "KHR_mesh_quantization",
        "KHR_node_hoverability",
        "KHR_node_selectability",
        "KHR_node_visibility",
        "KHR_physics_rigid_bodies",
        "KHR_xmp_json_ld",
        "MOZ_hubs_components",
        "MSFT_lod",
        "OMI_physics_body",
        "KHR_texture_basisu",
        "KHR_texture_transform",
        "EXT_texture_webp",
        "GOOGLE_texture_basis",
    }
)
"""Extensions that are read, or that change no surface: all others may where a mesh has them."""
_Item = TypeVar("_Item")


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, alias_generator=to_camel, allow_inf_nan=False)


class _Extensible(_Part):
    extensions: dict[str, Any] = Field(default_factory=dict)


class Asset(_Part):
    """The version of the format."""

    version: str


class Buffer(_Part):
    """Bytes: the binary chunk of a GLB, a data URI or a file beside it."""

    byte_length: int = Field(ge=0)
    uri: str | None = None


class BufferView(_Extensible):
    """A stretch of a buffer."""

    buffer: int = Field(ge=0)
    byte_offset: int = Field(default=0, ge=0)
    byte_length: int = Field(ge=0)
    byte_stride: int | None = Field(default=None, ge=1)


class SparseIndices(_Part):
    """Indices of the elements of an accessor that are replaced."""

    buffer_view: int = Field(ge=0)
    byte_offset: int = Field(default=0, ge=0)
    component_type: Literal[5121, 5123, 5125]


class SparseValues(_Part):
    """Values of the replaced elements of an accessor."""

    buffer_view: int = Field(ge=0)
    byte_offset: int = Field(default=0, ge=0)


class Sparse(_Part):
    """Elements of an accessor that differ from its buffer view."""

    count: int = Field(ge=0)
    indices: SparseIndices
    values: SparseValues


class Accessor(_Extensible):
    """An array in a buffer view."""

    buffer_view: int | None = Field(default=None, ge=0)
    byte_offset: int = Field(default=0, ge=0)
    component_type: Literal[5120, 5121, 5122, 5123, 5125, 5126]
    normalized: bool = False
    count: int = Field(ge=0)
    type: Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
    sparse: Sparse | None = None


class Image(_Part):
    """An encoded image."""

    uri: str | None = None
    buffer_view: int | None = Field(default=None, ge=0)


class Sampler(_Part):
    """Wrapping modes of a texture beyond its edges."""

    wrap_s: Literal[10497, 33648, 33071] = 10497
    wrap_t: Literal[10497, 33648, 33071] = 10497


class Texture(_Extensible):
    """An image with its sampler."""

    source: int | None = Field(default=None, ge=0)
    sampler: int | None = Field(default=None, ge=0)


class TextureTransform(_Part):
    """The extension KHR_texture_transform."""

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, float] = (1.0, 1.0)
    tex_coord: int | None = Field(default=None, ge=0)


class TextureInfo(_Extensible):
    """Reference to a texture and to the texture coordinates it uses."""

    index: int = Field(ge=0)
    tex_coord: int = Field(default=0, ge=0)


class PbrMetallicRoughness(_Part):
    """Colour of a material; the factor is linear light."""

    base_color_factor: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    base_color_texture: TextureInfo | None = None


class SpecularGlossiness(_Part):
    """The extension KHR_materials_pbrSpecularGlossiness, an older form of a colour."""

    diffuse_factor: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    diffuse_texture: TextureInfo | None = None


class GltfMaterial(_Extensible):
    """Appearance of a surface."""

    name: str = ""
    pbr_metallic_roughness: PbrMetallicRoughness = PbrMetallicRoughness()
    emissive_factor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    emissive_texture: TextureInfo | None = None
    alpha_mode: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    alpha_cutoff: float = 0.5


class Primitive(_Extensible):
    """Triangles of one material; mode 4 are triangles, 5 strips, 6 fans, others have no surface."""

    attributes: dict[str, int]
    indices: int | None = Field(default=None, ge=0)
    material: int | None = Field(default=None, ge=0)
    mode: int = 4


class Mesh(_Extensible):
    """Primitives that belong together."""

    name: str = ""
    primitives: Items[Primitive]


class Node(_Extensible):
    """A mesh with its transform, and children that move with it."""

    name: str = ""
    mesh: int | None = Field(default=None, ge=0)
    skin: int | None = Field(default=None, ge=0)
    children: Items[int] = Field(default_factory=list)
    matrix: list[float] | None = Field(default=None, min_length=16, max_length=16)
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


class Skin(_Part):
    """The nodes that a mesh moves with, and their inverse transforms when it was bound to them."""

    joints: Items[int] = Field(min_length=1)
    inverse_bind_matrices: int | None = Field(default=None, ge=0)


class Instancing(_Part):
    """The extension EXT_mesh_gpu_instancing: accessors with a transform for every copy."""

    attributes: dict[str, int] = Field(default_factory=dict)


class LevelsOfDetail(_Part):
    """The extension MSFT_lod: the nodes that may be shown in place of one, from farther away."""

    ids: Items[int] = Field(default_factory=list)


class NodeVisibility(_Part):
    """The extension KHR_node_visibility: whether a node and what it holds is shown."""

    visible: bool = True


class GltfScene(_Part):
    """The nodes that a file shows."""

    nodes: Items[int] = Field(default_factory=list)


class Document(_Extensible):
    """A whole glTF document."""

    asset: Asset
    extensions_required: Items[str] = Field(default_factory=list)
    scene: int | None = Field(default=None, ge=0)
    scenes: Items[GltfScene] = Field(default_factory=list)
    nodes: Items[Node] = Field(default_factory=list)
    meshes: Items[Mesh] = Field(default_factory=list)
    skins: Items[Skin] = Field(default_factory=list)
    materials: Items[GltfMaterial] = Field(default_factory=list)
    textures: Items[Texture] = Field(default_factory=list)
    samplers: Items[Sampler] = Field(default_factory=list)
    images: Items[Image] = Field(default_factory=list)
    accessors: Items[Accessor] = Field(default_factory=list)
    buffer_views: Items[BufferView] = Field(default_factory=list)
    buffers: Items[Buffer] = Field(default_factory=list)


class GltfFile:
    """An opened glTF file.

    Attributes:
        path: Path of the file, for messages.
        document: Validated JSON part of the file.
        allowance: Memory that the file may still take.
    """

    def __init__(self, path: Path) -> None:
        """Read a ``.glb`` or ``.gltf`` file.

        Raises:
            SceneError: The file is not glTF 2.0, is cut off, or needs an extension that is not
                supported.
            OSError: It cannot be read, or would take too much memory.
        """
        self.path = path
        self.allowance = Allowance()
        text, binary = _split(path, self.allowance)
        self.document = _parse(path, text, self.allowance)
        if unknown := sorted(set(self.document.extensions_required) - _EXTENSIONS):
            raise self._needs(unknown)
        self._binary = binary
        self._buffers: dict[int, bytes] = {}

    def invalid(self, what: str) -> SceneError:
        """Error for a file that violates the format."""
        return SceneError(f"{self.path}: is not valid glTF: {what}; export the file again")

    def _needs(self, extensions: Sequence[str]) -> SceneError:
        return SceneError(
            f"{self.path}: needs the glTF extension {', '.join(extensions)}, which is not "
            "supported; export it again without compression, for example with "
            "'gltf-transform copy' or Blender"
        )

    def unread_extensions(self) -> list[str]:
        """Extensions that may change surfaces, and are not read."""
        document = self.document
        primitives = (one for mesh in document.meshes for one in mesh.primitives)
        shapes = (document.nodes, document.meshes, document.accessors, document.buffer_views)
        having = chain([document], primitives, *shapes)
        return sorted({name for one in having for name in one.extensions} - _EXTENSIONS)

    def item(self, items: Sequence[_Item], index: int, what: str) -> _Item:
        """One item of the document's lists.

        Raises:
            SceneError: The list is not that long.
        """
        if not 0 <= index < len(items):
            raise self.invalid(f"refers to {what} {index}, but there are {len(items)}")
        return items[index]

    def array(self, index: int) -> np.ndarray:
        """An accessor's elements ``[count, width]``; normalised integers become float32.

        Raises:
            SceneError: The file does not hold them.
            OSError: They would take too much memory.
        """
        accessor = self.item(self.document.accessors, index, "accessor")
        width, dtype = _WIDTHS[accessor.type], np.dtype(_DTYPES[accessor.component_type])
        if accessor.buffer_view is None or accessor.sparse is not None:
            self.allowance.spend(accessor.count * width * dtype.itemsize, f"accessor {index}")
        if accessor.buffer_view is None:
            data = np.zeros((accessor.count, width), dtype=dtype)
        else:
            data = self._elements(
                accessor.buffer_view,
                accessor.byte_offset,
                accessor.component_type,
                accessor.count,
                width,
            )
        if accessor.sparse is not None:
            data = self._with_sparse(accessor, data)
        if accessor.normalized and data.dtype.kind in "iu":
            limit = np.iinfo(data.dtype).max
            data = np.maximum(data.astype(np.float32) / limit, -1.0)
        return data

    def image_bytes(self, image: Image) -> bytes:
        """The encoded bytes of an image."""
        if image.buffer_view is not None:
            data, _ = self._view(image.buffer_view)
            self.allowance.spend(len(data), "an image")
            return bytes(data)
        if image.uri is None:
            raise self.invalid("an image has neither bytes nor a file")
        return self._fetch(image.uri)

    def _with_sparse(self, accessor: Accessor, data: np.ndarray) -> np.ndarray:
        assert accessor.sparse is not None
        part = accessor.sparse
        rows = self._elements(
            part.indices.buffer_view,
            part.indices.byte_offset,
            part.indices.component_type,
            part.count,
            1,
        )[:, 0]
        if rows.size and int(rows.max()) >= accessor.count:
            raise self.invalid("a sparse accessor replaces elements that it doesn't have")
        data = data.copy()
        data[rows] = self._elements(
            part.values.buffer_view,
            part.values.byte_offset,
            accessor.component_type,
            part.count,
            data.shape[1],
        )
        return data

    def _elements(
        self, view: int, offset: int, component_type: int, count: int, width: int
    ) -> np.ndarray:
        data, stride = self._view(view)
        dtype = np.dtype(_DTYPES[component_type])
        packed = dtype.itemsize * width
        stride = stride or packed
        if count and offset + stride * (count - 1) + packed > len(data):
            raise self.invalid(
                f"an array of {count} elements reaches beyond its buffer view {view}"
            )
        if count == 0:
            return np.zeros((0, width), dtype=dtype)
        return np.ndarray((count, width), dtype, data, offset, (stride, dtype.itemsize))

    def _view(self, index: int) -> tuple[memoryview, int | None]:
        view = self.item(self.document.buffer_views, index, "buffer view")
        has_own_bytes = self._binary is not None and view.buffer == 0
        if (unread := sorted(set(view.extensions) - _EXTENSIONS)) and not has_own_bytes:
            buffers = self.document.buffers
            if self.item(buffers, view.buffer, "buffer").uri is None:
                raise self._needs(unread)  # the buffer holds no fallback for the extension
        buffer = self._buffer(view.buffer)
        end = view.byte_offset + view.byte_length
        if end > len(buffer):
            raise SceneError(
                f"{self.path}: is cut off: buffer {view.buffer} has {len(buffer)} bytes, but "
                f"{end} are needed; copy or download the file again"
            )
        return memoryview(buffer)[view.byte_offset : end], view.byte_stride

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            uri = self.item(self.document.buffers, index, "buffer").uri
            if uri is None and (index != 0 or self._binary is None):
                raise self.invalid(f"buffer {index} has no data")
            self._buffers[index] = self._fetch(uri) if uri is not None else self._binary or b""
        return self._buffers[index]

    def _fetch(self, uri: str) -> bytes:
        """Bytes of a data URI, or of a file beside this one or in a folder there."""
        if uri.startswith("data:"):
            self.allowance.spend(len(uri), "embedded data")
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except binascii.Error as error:
                raise self.invalid(f"embedded data cannot be decoded ({error})") from error
        name = unquote(uri)
        try:
            data = read_file(path_below(self.path.parent, name))
        except OSError as error:
            raise SceneError(
                f"{self.path}: needs the file {name[:80]!r}, which cannot be read "
                f"({error.strerror or error}); put it beside the scene, or convert the scene to "
                "one .glb"
            ) from error
        self.allowance.spend(len(data), f"the file {name[:80]!r}")
        return data


def check_glb(path: Path) -> None:
    """Refuse a file that is no GLB or is truncated, by its first bytes and its size.

    Raises:
        SceneError: It is no GLB, is truncated, or cannot be read.
    """
    try:
        with path.open("rb") as file:
            _checked_length(path, file.read(_LEAST_BYTES), path.stat().st_size)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error


def _checked_length(path: Path, head: bytes, size: int) -> int:
    """The length in the header of a GLB, which its size must reach."""
    if head[:4] != _MAGIC:
        raise SceneError(
            f"{path}: is not a GLB file: it begins with {head[:4]!r} instead of {_MAGIC!r}; "
            "give a binary glTF 2.0 file"
        )
    if size < _LEAST_BYTES:
        raise SceneError(f"{path}: is cut off after {size} bytes; copy the file again")
    version, length = struct.unpack_from("<II", head, 4)
    if version != 2:
        raise SceneError(f"{path}: is glTF {version}, only glTF 2 can be read; convert it first")
    if length > size:
        raise SceneError(
            f"{path}: is cut off: it has {size} of {length} bytes; copy or download the file again"
        )
    return length


def _split(path: Path, allowance: Allowance) -> tuple[bytes, bytes | None]:
    """The JSON text and the binary chunk of a file."""
    data = read_file(path)
    allowance.spend(len(data), "its content")
    if data[:4] != _MAGIC and path.suffix.lower() != ".glb":
        return data, None
    length = _checked_length(path, data[:_LEAST_BYTES], len(data))
    chunks: dict[int, bytes] = {}
    offset = 12
    while offset + 8 <= length:
        size, kind = struct.unpack_from("<II", data, offset)
        chunks.setdefault(kind, data[offset + 8 : offset + 8 + size])
        offset += 8 + size
    return chunks.get(_JSON_CHUNK, b""), chunks.get(_BINARY_CHUNK)


def _parse(path: Path, text: bytes, allowance: Allowance) -> Document:
    try:
        raw = parse_json(text, allowance)
    except ValueError as error:
        raise SceneError(
            f"{path}: is not valid glTF: its JSON part cannot be read ({error}); "
            "export the file again"
        ) from error
    try:
        document = Document.model_validate(raw)
    except ValidationError as error:
        first = error.errors()[0]
        location = ".".join(str(part) for part in first["loc"]) or "document"
        raise SceneError(
            f"{path}: is not valid glTF: {location}: {first['msg']}; export the file again"
        ) from error
    if not document.asset.version.startswith("2."):
        raise SceneError(
            f"{path}: is glTF {document.asset.version}, only glTF 2 can be read; convert it first"
        )
    return document
