"""Reads glTF files: materials with their images, nodes, their transforms and their triangles."""

import hashlib
import logging
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from jaxtyping import Float, Float32, Float64, Int32, UInt8
from pydantic import BaseModel, ValidationError

from hypernav.core.errors import SceneError
from hypernav.io.reading import MOST_PIXELS, image_size
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.drawing.textures import linear_to_srgb
from hypernav.simulator.worlds.scenes.gltf_file import (
    GltfFile,
    GltfMaterial,
    Instancing,
    LevelsOfDetail,
    Node,
    NodeVisibility,
    Primitive,
    SpecularGlossiness,
    TextureInfo,
    TextureTransform,
)
from hypernav.simulator.worlds.scenes.material_images import (
    DecodedImage,
    basis_size,
    decode_images,
    is_basis,
)
from hypernav.simulator.worlds.scenes.mesh_parts import TO_Z_UP, MeshPart, rotation_of
from hypernav.simulator.worlds.scenes.node_names import is_meaningful, unique_name
from hypernav.simulator.worlds.scenes.scene import Material, Wrap

_WRAPS = {10497: Wrap.REPEAT, 33648: Wrap.MIRROR, 33071: Wrap.CLAMP}
_IMAGE_EXTENSIONS = ("EXT_texture_webp", "KHR_texture_basisu", "GOOGLE_texture_basis")
"""Extensions that name the image of a texture in place of its source."""
_MIN_EMISSION = 0.5
_LOGGER = logging.getLogger(__name__)
_Part = TypeVar("_Part", bound=BaseModel)
_MOST_NODES, _MOST_PARTS = 50_000, 20_000
_BYTES_PER_VERTEX, _BYTES_PER_CORNER = 50, 50
_OF_COPIES = {
    "TRANSLATION": (0.0, 0.0, 0.0),
    "ROTATION": (0.0, 0.0, 0.0, 1.0),
    "SCALE": (1.0, 1.0, 1.0),
}
"""Attributes of copies, with the values of a copy that has none."""
_NODE_EXTENSIONS = {
    Instancing: "EXT_mesh_gpu_instancing",
    LevelsOfDetail: "MSFT_lod",
    NodeVisibility: "KHR_node_visibility",
}
_Extension = TypeVar("_Extension", Instancing, LevelsOfDetail, NodeVisibility)


def read_materials(file: GltfFile) -> tuple[list[Material], list[TextureTransform]]:
    """All materials of a file, with the transforms of their textures.

    A plain light grey one, for primitives without a material, comes last. A material whose image is
    missing or cannot be decoded has only its colour, with a warning.

    Raises:
        SceneError: An image is too large, or of a kind that cannot be read.
    """
    infos = [_base_color(file, source)[1] for source in file.document.materials]
    sources = {_source(file, info) for info in infos if info is not None}
    images = _decode(file, sorted(sources))
    opaque: dict[tuple[int, float], np.ndarray] = {}
    materials = [_material(file, source, images, opaque) for source in file.document.materials]
    materials.append(Material("default", (0.8, 0.8, 0.8)))
    transforms = [_transform(file, info) for info in infos]
    return materials, [*transforms, TextureTransform()]


def _material(
    file: GltfFile,
    source: GltfMaterial,
    images: dict[int, DecodedImage],
    opaque: dict[tuple[int, float], np.ndarray],
) -> Material:
    color, info = _base_color(file, source)
    light = np.array(color[:3])
    unlit = "KHR_materials_unlit" in source.extensions
    if max(source.emissive_factor) >= _MIN_EMISSION and source.emissive_texture is None:
        light, unlit = np.maximum(light, source.emissive_factor), True
    codes = linear_to_srgb(light)
    srgb = (float(codes[0]), float(codes[1]), float(codes[2]))
    number = None if info is None else _source(file, info)
    image = None if number is None else images.get(number)
    if info is None or number is None or image is None:
        return Material(source.name, srgb, unlit=unlit)
    holes = None
    if image.opacity is not None and source.alpha_mode != "OPAQUE":
        cutoff = source.alpha_cutoff if source.alpha_mode == "MASK" else 0.5
        # One array per image, so that materials that share it share its texels, too.
        holes = opaque.setdefault((number, cutoff), image.opacity >= cutoff * 255.0)
    texture = file.document.textures[info.index]
    wrap = (Wrap.REPEAT, Wrap.REPEAT)
    if texture.sampler is not None:
        sampler = file.item(file.document.samplers, texture.sampler, "sampler")
        wrap = (_WRAPS[sampler.wrap_s], _WRAPS[sampler.wrap_t])
    return Material(source.name, srgb, image.rgb, wrap, holes, unlit)


def _base_color(
    file: GltfFile, source: GltfMaterial
) -> tuple[tuple[float, float, float, float], TextureInfo | None]:
    """Colour factor and texture, from either of their two forms."""
    old = source.extensions.get("KHR_materials_pbrSpecularGlossiness")
    if old is not None and source.pbr_metallic_roughness.base_color_texture is None:
        diffuse = _material_extension(file, SpecularGlossiness, old)
        return diffuse.diffuse_factor, diffuse.diffuse_texture
    surface = source.pbr_metallic_roughness
    return surface.base_color_factor, surface.base_color_texture


def _transform(file: GltfFile, info: TextureInfo | None) -> TextureTransform:
    if info is None:
        return TextureTransform()
    raw = info.extensions.get("KHR_texture_transform", {})
    transform = _material_extension(file, TextureTransform, raw)
    if transform.tex_coord is None:
        return transform.model_copy(update={"tex_coord": info.tex_coord})
    return transform


def _material_extension(file: GltfFile, kind: type[_Part], raw: Any) -> _Part:
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        first = error.errors()[0]
        raise file.invalid(f"an extension holds a wrong value: {first['msg']}") from error


def _source(file: GltfFile, info: TextureInfo) -> int:
    """The number of the image of a texture."""
    texture = file.item(file.document.textures, info.index, "texture")
    for name in _IMAGE_EXTENSIONS:
        other = texture.extensions.get(name)
        if isinstance(other, dict) and isinstance(other.get("source"), int):
            return other["source"]
    if texture.source is None:
        names = ", ".join(texture.extensions) or "nothing"
        raise SceneError(
            f"{file.path}: a texture is stored as {names}, which cannot be read; "
            "export the file again with PNG or JPEG textures"
        )
    return texture.source


def _decode(file: GltfFile, numbers: list[int]) -> dict[int, DecodedImage]:
    """Decode images on all cores; equal bytes give one and the same image.

    Those that are missing or broken are left out.
    """
    data: dict[int, bytes] = {}
    broken: list[str] = []
    for number in numbers:
        image = file.item(file.document.images, number, "image")
        try:
            content = file.image_bytes(image)
        except SceneError as error:
            broken.append(str(error))
            continue
        if _is_image(file, number, content):
            data[number] = content
        else:
            broken.append(_undecodable(file, number))
    keys = {number: hashlib.sha256(content).digest() for number, content in data.items()}
    distinct = {keys[number]: content for number, content in data.items()}
    decoded = decode_images(distinct)
    found = {number: decoded[key] for number, key in keys.items()}
    broken += [_undecodable(file, number) for number, image in found.items() if image is None]
    if broken:
        more = f" and so for {len(broken) - 1} more textures" if len(broken) > 1 else ""
        _LOGGER.warning("%s; until then its surfaces have a plain colour%s", broken[0], more)
    return {number: image for number, image in found.items() if image is not None}


def _undecodable(file: GltfFile, number: int) -> str:
    return (
        f"{file.path}: texture {number} cannot be decoded; export the file again with PNG or JPEG "
        "textures"
    )


def _is_image(file: GltfFile, number: int, content: bytes) -> bool:
    """Whether the header is that of an image; too large images are refused before decoding."""
    size = basis_size(content) if is_basis(content) else image_size(content)
    if size is None:
        return False
    width, height = size
    what = f"texture {number} with {width} × {height} pixels"
    if width * height > MOST_PIXELS:
        raise SceneError(
            f"{file.path}: {what} is too large, at most {MOST_PIXELS:,} pixels are read; make it "
            "smaller"
        )
    file.allowance.spend(3 * width * height, what)
    return True


def read_gltf(
    path: Path, *, up: Axis = "y", color_codes: bool = False
) -> tuple[list[MeshPart], list[Material]]:
    """All triangles that a file's default scene shows, in the scene frame, and its materials.

    Args:
        path: A ``.glb`` or ``.gltf`` file.
        up: The axis of the file that points up; z in scans, contrary to the format's rule.
        color_codes: Whether colours of vertices are sRGB, contrary to the format's rule.

    Raises:
        SceneError: The file is broken or needs something that is not supported.
        OSError: It cannot be read, or would take too much memory.
    """
    file = GltfFile(path)
    if unread := file.unread_extensions():
        _LOGGER.warning(
            "%s: uses the glTF extension %s, which is not read and may change what is shown; "
            "export the file again without it",
            path,
            ", ".join(unread),
        )
    placed = _placed_nodes(file, TO_Z_UP[up])
    meshes = file.document.meshes
    count = sum(len(file.item(meshes, node.mesh, "mesh").primitives) for node in placed)
    if count > _MOST_PARTS:
        raise SceneError(
            f"{path}: has {count:,} parts, at most {_MOST_PARTS:,} are read; join its meshes"
        )
    materials, transforms = read_materials(file)
    # Non-finite corners are left out when the scene is assembled.
    with np.errstate(all="ignore"):
        return [
            part
            for node in placed
            for part in _parts_of(file, node, materials, transforms, color_codes)
        ], materials


@dataclass(frozen=True, eq=False)
class _PlacedMesh:
    """A node that shows a mesh, with its transform to the scene."""

    name: str
    descriptive_name: str
    mesh: int
    to_scene: Float64[np.ndarray, "4 4"]


def _placed_nodes(file: GltfFile, to_scene: Float64[np.ndarray, "3 3"]) -> list[_PlacedMesh]:
    nodes = file.document.nodes
    if len(nodes) > _MOST_NODES:
        raise SceneError(
            f"{file.path}: has {len(nodes):,} nodes, at most {_MOST_NODES:,} are read; join them"
        )
    turned = np.eye(4)
    turned[:3, :3] = to_scene
    stack = [(index, turned, "") for index in reversed(_roots(file))]
    names: dict[str, int] = {}
    parents = {child: k for k, node in enumerate(nodes) for child in node.children}
    # Levels of detail show the same thing once more.
    visited = {k for node in nodes for k in _node_extension(file, node, LevelsOfDetail).ids}
    placed: list[_PlacedMesh] = []
    while stack:
        index, parent, descriptive_name = stack.pop()
        node = file.item(nodes, index, "node")
        if index in visited:  # A file that lists a node twice shows it once.
            continue
        visited.add(index)
        if not _node_extension(file, node, NodeVisibility).visible:
            continue
        to_scene = parent @ _local_matrix(node)
        mesh_name = ""
        if node.mesh is not None:
            mesh_name = file.item(file.document.meshes, node.mesh, "mesh").name
        own = node.name or mesh_name
        descriptive_name = own if is_meaningful(own) or not descriptive_name else descriptive_name
        if node.mesh is not None:
            telling = descriptive_name if is_meaningful(descriptive_name) else mesh_name
            shown = to_scene if node.skin is None else turned @ _bound(file, node.skin, parents)
            for matrix in _copies(file, node):
                name = unique_name(own or f"node {index}", names)
                placed.append(_PlacedMesh(name, telling, node.mesh, shown @ matrix))
        stack += [(child, to_scene, descriptive_name) for child in reversed(node.children)]
    return placed


def _roots(file: GltfFile) -> list[int]:
    document = file.document
    if document.scenes:
        return list(file.item(document.scenes, document.scene or 0, "scene").nodes)
    children = {child for node in document.nodes for child in node.children}
    return [index for index in range(len(document.nodes)) if index not in children]


def _local_matrix(node: Node) -> Float64[np.ndarray, "4 4"]:
    if node.matrix is not None:
        return np.array(node.matrix, dtype=np.float64).reshape(4, 4).T
    return _matrix(*map(np.array, (node.translation, node.rotation, node.scale)))


def _matrix(
    translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray
) -> Float64[np.ndarray, "4 4"]:
    """The transform of a position, a quaternion ``[x, y, z, w]`` and a size."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_of(rotation) * scale
    matrix[:3, 3] = translation
    return matrix


def _copies(file: GltfFile, node: Node) -> list[Float64[np.ndarray, "4 4"]]:
    """The transforms, within a node, of the copies of its mesh: one, or as many as it lists."""
    accessors = _node_extension(file, node, Instancing).attributes
    read = {name: file.array(accessors[name]) for name in _OF_COPIES if name in accessors}
    if not read:
        return [np.eye(4)]
    counts = {len(values) for values in read.values()}
    if len(counts) > 1 or any(v.shape[1] != len(_OF_COPIES[name]) for name, v in read.items()):
        raise file.invalid("the copies of a node have transforms of different number or kind")
    if len(read[next(iter(read))]) > _MOST_PARTS:
        raise SceneError(f"{file.path}: a node has more than {_MOST_PARTS:,} copies; join them")
    values = [read.get(name, np.tile(same, (max(counts), 1))) for name, same in _OF_COPIES.items()]
    return [_matrix(*one) for one in zip(*values, strict=True)]


def _bound(file: GltfFile, number: int, parents: dict[int, int]) -> Float64[np.ndarray, "4 4"]:
    """Where a skin holds its mesh, in the file's frame, in the pose in which it was bound.

    By the specification the transform of the node that shows the mesh doesn't count.
    """
    skin = file.item(file.document.skins, number, "skin")
    matrix = np.eye(4)
    if skin.inverse_bind_matrices is not None:
        inverse = file.array(skin.inverse_bind_matrices)
        if inverse.shape[0] < 1 or inverse.shape[1] != 16:
            raise file.invalid("a skin has no transforms for its joints")
        matrix = inverse[0].astype(np.float64).reshape(4, 4).T
    joint, above = skin.joints[0], set[int]()
    while joint is not None and joint not in above:
        above.add(joint)
        matrix = _local_matrix(file.item(file.document.nodes, joint, "node")) @ matrix
        joint = parents.get(joint)
    return matrix


def _node_extension(file: GltfFile, node: Node, kind: type[_Extension]) -> _Extension:
    """An extension of a node, with its default values where the node has none."""
    try:
        return kind.model_validate(node.extensions.get(_NODE_EXTENSIONS[kind], {}))
    except ValidationError as error:
        first = error.errors()[0]
        raise file.invalid(f"{_NODE_EXTENSIONS[kind]}: {first['msg']}") from error


def _parts_of(
    file: GltfFile,
    placed: _PlacedMesh,
    materials: list[Material],
    transforms: list[TextureTransform],
    color_codes: bool,
) -> Iterator[MeshPart]:
    linear, shift = placed.to_scene[:3, :3], placed.to_scene[:3, 3]
    mirrored = np.linalg.det(linear) < 0.0
    for primitive in file.item(file.document.meshes, placed.mesh, "mesh").primitives:
        if "POSITION" not in primitive.attributes or primitive.mode not in (4, 5, 6):
            continue
        _take_memory(file, primitive)
        positions = _vectors(file, primitive, "POSITION", 3)
        faces = _triangles(file, primitive, len(positions))
        if mirrored:
            faces = np.ascontiguousarray(faces[:, ::-1])
        material = primitive.material if primitive.material is not None else len(materials) - 1
        file.item(materials, material, "material")
        yield MeshPart(
            node=placed.name,
            descriptive_name=placed.descriptive_name,
            vertices=(positions @ linear.T + shift).astype(np.float32),
            faces=faces,
            material=material,
            uv=_texture_coordinates(file, primitive, transforms[material], faces),
            colors=_colors(file, primitive, faces, color_codes),
            normals=_normals(file, primitive, linear, faces),
        )


def _take_memory(file: GltfFile, primitive: Primitive) -> None:
    """Account for the triangles of a primitive; every node that shows it has a copy."""
    used = (primitive.attributes["POSITION"], primitive.indices)
    counts = [
        file.item(file.document.accessors, index, "accessor").count
        for index in used
        if index is not None
    ]
    size = counts[0] * _BYTES_PER_VERTEX + counts[-1] * _BYTES_PER_CORNER
    file.allowance.spend(size, f"{counts[0]:,} vertices with {counts[-1]:,} corners")


def _vectors(
    file: GltfFile, primitive: Primitive, attribute: str, width: int
) -> Float64[np.ndarray, "vertices width"]:
    values = file.array(primitive.attributes[attribute]).astype(np.float64)
    if values.shape[1] < width:
        raise file.invalid(f"{attribute} has {values.shape[1]} numbers, expected {width}")
    return values[:, :width]


def _corners(
    file: GltfFile, attribute: str, values: Float[np.ndarray, "v k"], faces: np.ndarray
) -> Float[np.ndarray, "faces 3 k"]:
    if faces.size and int(faces.max()) >= len(values):
        raise file.invalid(f"{attribute} has {len(values)} entries, fewer than POSITION")
    return values[faces]


def _triangles(file: GltfFile, primitive: Primitive, count: int) -> Int32[np.ndarray, "faces 3"]:
    if primitive.indices is None:
        corners = np.arange(count, dtype=np.int32)
    else:
        raw = file.array(primitive.indices)[:, 0]
        if raw.dtype.kind != "u":
            raise file.invalid("the indices of triangles must be unsigned whole numbers")
        if raw.size and int(raw.max()) >= count:
            raise file.invalid(f"a triangle uses vertex {int(raw.max())}, but there are {count}")
        corners = raw.astype(np.int32)
    if primitive.mode == 4:
        return np.ascontiguousarray(corners[: len(corners) // 3 * 3].reshape(-1, 3))
    if len(corners) < 3:
        return np.zeros((0, 3), dtype=np.int32)
    if primitive.mode == 5:
        strip = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        strip[1::2] = strip[1::2, [1, 0, 2]]
        return np.ascontiguousarray(strip)
    hub = np.full(len(corners) - 2, corners[0])
    return np.ascontiguousarray(np.stack([hub, corners[1:-1], corners[2:]], axis=1))


def _texture_coordinates(
    file: GltfFile, primitive: Primitive, transform: TextureTransform, faces: np.ndarray
) -> Float32[np.ndarray, "faces 3 2"] | None:
    attribute = f"TEXCOORD_{transform.tex_coord or 0}"
    if attribute not in primitive.attributes:
        return None
    uv = _vectors(file, primitive, attribute, 2) * np.array(transform.scale)
    c, s = np.cos(transform.rotation), np.sin(transform.rotation)
    uv = uv @ np.array([[c, -s], [s, c]]) + np.array(transform.offset)
    uv[:, 1] = 1.0 - uv[:, 1]
    return _corners(file, attribute, np.nan_to_num(uv.astype(np.float32)), faces)


def _colors(
    file: GltfFile, primitive: Primitive, faces: np.ndarray, color_codes: bool
) -> UInt8[np.ndarray, "faces 3 3"] | None:
    if "COLOR_0" not in primitive.attributes:
        return None
    light = _vectors(file, primitive, "COLOR_0", 3)
    codes = np.clip(light if color_codes else linear_to_srgb(light), 0.0, 1.0) * 255.0
    return np.rint(_corners(file, "COLOR_0", codes, faces)).astype(np.uint8)


def _normals(
    file: GltfFile, primitive: Primitive, linear: Float64[np.ndarray, "3 3"], faces: np.ndarray
) -> Float32[np.ndarray, "faces 3 3"] | None:
    if "NORMAL" not in primitive.attributes or not abs(np.linalg.det(linear)) > 1e-30:
        return None
    normals = _vectors(file, primitive, "NORMAL", 3) @ np.linalg.inv(linear)
    normals = np.nan_to_num(normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return _corners(file, "NORMAL", normals.astype(np.float32), faces)
