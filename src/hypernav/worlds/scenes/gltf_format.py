"""The parts of a glTF 2.0 document that a scene is made from, checked when read.

Names and meaning follow the specification of the Khronos Group; other fields are ignored.
"""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field
from pydantic.alias_generators import to_camel

from hypernav.io.parsing import Items


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, alias_generator=to_camel, allow_inf_nan=False)


class _Extensible(_Part):
    extensions: dict[str, Any] = Field(default_factory=dict)


class Asset(_Part):
    """The version of the format."""

    version: str
    generator: str = ""


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
