"""Reads COLLADA files (``.dae``): nodes with their transforms, triangles and materials."""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

import numpy as np
from jaxtyping import Float32, Float64, Int64

from hypernav.core.errors import SceneError
from hypernav.io.parsing import parse_xml
from hypernav.io.reading import Allowance, path_below, read_file
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scenes.material_images import Paint, materials_of
from hypernav.simulator.worlds.scenes.mesh_parts import (
    TO_Z_UP,
    MeshPart,
    placed,
    triangles_of_polygons,
)
from hypernav.simulator.worlds.scenes.node_names import is_meaningful, unique_name
from hypernav.simulator.worlds.scenes.scene import Material

_KINDS = ("triangles", "polylist", "polygons", "tristrips", "trifans")
_NUMBERS = {
    "matrix": 16,
    "bind_shape_matrix": 16,
    "translate": 3,
    "rotate": 4,
    "scale": 3,
    "lookat": 9,
}
PLAIN = Paint("default", (0.8, 0.8, 0.8))
"""For triangles without a material."""
FindImage = Callable[[str], Path | None]
_MOST_NODES, _DEEPEST = 50_000, 200
_MOST_BYTES = 500_000_000
_BYTES_PER_NUMBER = 8
_UP: dict[str, Axis] = {"X_UP": "x", "Y_UP": "y", "Z_UP": "z"}


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles of one material, in the frame of their mesh.

    Attributes:
        symbol: Name that the material has within the mesh; empty without one.
        vertices: Positions.
        faces: Vertex numbers.
        uv: Texture coordinates of every corner (v upwards).
        normals: Normals of every corner, of any length.
        colors: sRGB colour of every corner, 0 to 1.
    """

    symbol: str
    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    uv: Float32[np.ndarray, "faces 3 2"] | None = None
    normals: Float64[np.ndarray, "faces 3 3"] | None = None
    colors: Float64[np.ndarray, "faces 3 3"] | None = None


def triangles_of(mesh: ElementTree.Element) -> Iterator[Triangles]:
    """All triangles of a mesh; lines and points are left out.

    Args:
        mesh: An element ``mesh``.

    Raises:
        ValueError: It holds something that is no number, or refers to what isn't there.
    """
    sources = {source.get("id", ""): source for source in mesh.iter("source")}
    of_vertices = {
        vertices.get("id", ""): list(vertices.iter("input")) for vertices in mesh.iter("vertices")
    }
    arrays: dict[str, Float64[np.ndarray, "n width"]] = {}
    for primitive in mesh:
        if primitive.tag not in _KINDS:
            continue
        inputs = _inputs(primitive, of_vertices)
        if "POSITION" not in inputs:
            continue
        offsets = [int(item.get("offset", "0")) for item in primitive.iter("input")]
        if min(offsets) < 0:
            raise ValueError("an input has a negative offset")
        width = 1 + max(offsets)
        source, offset = inputs["POSITION"]
        if source not in arrays:
            arrays[source] = _array(sources, source)
        corners = _corners(primitive, width, _three(arrays[source]), offset)
        if not len(corners):
            continue
        read: dict[str, tuple[Float64[np.ndarray, "n width"], Int64[np.ndarray, "faces 3"]]] = {}
        for semantic, (source, offset) in inputs.items():
            if source not in arrays:
                arrays[source] = _array(sources, source)
            numbers = corners[:, :, offset]
            if numbers.min() < 0 or numbers.max() >= len(arrays[source]):
                raise ValueError(f"a triangle uses a {semantic} that is not there")
            read[semantic] = (arrays[source], numbers)
        positions, faces = read["POSITION"]
        yield Triangles(
            primitive.get("material", ""),
            _three(positions),
            faces,
            _of_corners(read, "TEXCOORD", 2, np.float32),
            _of_corners(read, "NORMAL", 3, np.float64),
            _of_corners(read, "COLOR", 3, np.float64),
        )


def numbers_of(text: str | None) -> Float64[np.ndarray, "n"]:
    """The numbers in a text.

    Raises:
        ValueError: Something is no number.
    """
    return np.fromiter(map(float, (text or "").split()), np.float64)


def color_of(text: str) -> tuple[float, float, float]:
    """The colour, 0 to 1, that the first three numbers of a text mean.

    Raises:
        ValueError: Something is no number.
    """
    values = np.nan_to_num(numbers_of(" ".join(text.split()[:3]))).clip(0.0, 1.0).tolist()
    red, green, blue = [*values, 0.0, 0.0, 0.0][:3]
    return red, green, blue


def _inputs(
    primitive: ElementTree.Element, of_vertices: dict[str, list[ElementTree.Element]]
) -> dict[str, tuple[str, int]]:
    """Source and offset of each kind of value; of several sets the first."""
    found: dict[str, tuple[str, int]] = {}
    for item in primitive.iter("input"):
        source, offset = item.get("source", "")[1:], int(item.get("offset", "0"))
        if item.get("semantic") == "VERTEX":
            for inner in of_vertices.get(source, []):
                found.setdefault(inner.get("semantic", ""), (inner.get("source", "")[1:], offset))
        else:
            found.setdefault(item.get("semantic", ""), (source, offset))
    known = ("POSITION", "TEXCOORD", "NORMAL", "COLOR")
    return {semantic: found[semantic] for semantic in known if semantic in found}


def _array(sources: dict[str, ElementTree.Element], name: str) -> Float64[np.ndarray, "n width"]:
    source = sources.get(name)
    array = None if source is None else source.find("float_array")
    if source is None or array is None:
        raise ValueError(f"the source {name:.80} is not there")
    accessor = source.find("technique_common/accessor")
    values = numbers_of(array.text)
    if accessor is None:
        raise ValueError(f"the source {name:.80} has no accessor")
    width, start = int(accessor.get("stride", "1")), int(accessor.get("offset", "0"))
    if width < 1 or start < 0:
        raise ValueError(f"the accessor of {name:.80} steps by {width} from {start}")
    values = values[start:]
    return values[: len(values) // width * width].reshape(-1, width)


def _corners(
    primitive: ElementTree.Element, width: int, positions: Float64[np.ndarray, "n 3"], offset: int
) -> Int64[np.ndarray, "faces 3 width"]:
    """Numbers of every value of every corner of the triangles; a position's is at the offset."""
    runs = [_whole_numbers(item.text) for item in primitive.iter("p")]
    runs = [run[: len(run) // width * width].reshape(-1, width) for run in runs]
    if not runs:
        return np.zeros((0, 3, width), np.int64)
    kind = primitive.tag
    if kind == "tristrips":
        return np.concatenate([_strip(run) for run in runs])
    together = np.concatenate(runs)
    if kind == "triangles":
        return together[: len(together) // 3 * 3].reshape(-1, 3, width)
    if kind == "polylist":
        counts = _whole_numbers(primitive.findtext("vcount"))
    else:
        counts = np.array([len(run) for run in runs])
    if (len(counts) and counts.min() < 0) or counts.sum() > len(together):
        raise ValueError("the polygons have more corners than are listed")
    together = together[: counts.sum()]
    used = together[:, offset]
    if len(used) and (used.min() < 0 or used.max() >= len(positions)):
        raise ValueError("a polygon uses a POSITION that is not there")
    return together[triangles_of_polygons(counts, positions[used])]


def _strip(run: Int64[np.ndarray, "n width"]) -> Int64[np.ndarray, "faces 3 width"]:
    if len(run) < 3:
        return np.zeros((0, 3, run.shape[1]), np.int64)
    strip = np.stack([run[:-2], run[1:-1], run[2:]], axis=1)
    strip[1::2] = strip[1::2, [1, 0, 2]]
    return strip


def _whole_numbers(text: str | None) -> Int64[np.ndarray, "n"]:
    try:
        return np.fromiter(map(int, (text or "").split()), np.int64)
    except OverflowError as error:
        raise ValueError("a number is too large") from error


def _of_corners(
    read: dict[str, tuple[np.ndarray, np.ndarray]], semantic: str, width: int, dtype: type
) -> np.ndarray | None:
    if semantic not in read or read[semantic][0].shape[1] < width:
        return None
    values, numbers = read[semantic]
    return np.nan_to_num(values[:, :width]).astype(dtype)[numbers]


def _three(values: Float64[np.ndarray, "n width"]) -> Float64[np.ndarray, "n 3"]:
    if values.shape[1] < 3:
        raise ValueError(f"positions have {values.shape[1]} numbers, expected 3")
    return np.ascontiguousarray(values[:, :3])


def local_matrix(node: ElementTree.Element) -> Float64[np.ndarray, "4 4"]:
    """The transform of a node to its parent: its steps, the first applied last.

    Raises:
        ValueError: A step hasn't the numbers that it needs.
    """
    whole = np.eye(4)
    for step in node:
        if step.tag in _NUMBERS:
            values = numbers_of(step.text)
            if len(values) != _NUMBERS[step.tag]:
                raise ValueError(
                    f"{step.tag} has {len(values)} numbers, expected {_NUMBERS[step.tag]}"
                )
            whole = whole @ _matrix(step.tag, values)
    return whole


def _matrix(kind: str, values: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "4 4"]:
    if kind in ("matrix", "bind_shape_matrix"):
        return values.reshape(4, 4)
    matrix = np.eye(4)
    if kind == "translate":
        matrix[:3, 3] = values
    elif kind == "scale":
        matrix[:3, :3] = np.diag(values)
    elif kind == "rotate":
        matrix[:3, :3] = _turn(values[:3], math.radians(values[3]))
    else:
        eye, target, up = values.reshape(3, 3)
        back = _unit(eye - target)
        right = _unit(np.cross(up, back))
        matrix[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
        matrix[:3, 3] = eye
    return matrix


def _turn(axis: Float64[np.ndarray, "3"], angle: float) -> Float64[np.ndarray, "3 3"]:
    x, y, z = _unit(axis)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * across + (1.0 - math.cos(angle)) * across @ across


def _unit(vector: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "3"]:
    return vector / max(float(np.linalg.norm(vector)), 1e-12)


def read_paints(root: ElementTree.Element, find_image: FindImage) -> dict[str, Paint]:
    """The materials of a document by their identifiers.

    Args:
        root: The document.
        find_image: The file of an image that the document names, or None.

    Raises:
        ValueError: A colour is no number.
    """
    images = {
        image.get("id", ""): (image.findtext("init_from/ref") or image.findtext("init_from") or "")
        for image in root.iter("image")
    }
    effects = {effect.get("id", ""): effect for effect in root.iter("effect")}
    paints: dict[str, Paint] = {}
    for material in root.iter("material"):
        name = material.get("name") or material.get("id", "")
        instance = material.find("instance_effect")
        effect = None if instance is None else effects.get(instance.get("url", "")[1:])
        paints[material.get("id", "")] = (
            PLAIN if effect is None else _paint(name, effect, images, find_image)
        )
    return paints


def _paint(
    name: str, effect: ElementTree.Element, images: dict[str, str], find_image: FindImage
) -> Paint:
    color, reference = (PLAIN.color, "")
    for channel in _channels(effect, "diffuse"):
        texture = channel.find("texture")
        if texture is not None:
            reference = _image_of(effect, texture.get("texture", ""), images)
        elif (text := channel.findtext("color")) is not None:
            color = color_of(text)
    has_holes = any(
        channel.find("texture") is not None for channel in _channels(effect, "transparent")
    )
    image = find_image(reference) if reference else None
    return Paint(name, color, reference, image, has_holes)


def _channels(effect: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    for model in ("phong", "lambert", "blinn", "constant"):
        yield from effect.iterfind(f"profile_COMMON/technique/{model}/{name}")


def _image_of(effect: ElementTree.Element, sampler: str, images: dict[str, str]) -> str:
    """The file of a texture, through its sampler and surface; some exporters name it at once."""
    parameters = {item.get("sid", ""): item for item in effect.iter("newparam")}
    name = sampler
    for step in ("sampler2D/source", "surface/init_from"):
        if name in parameters:
            name = (parameters[name].findtext(step) or "").strip() or name
    if sampler in parameters:
        instance = parameters[sampler].find("sampler2D/instance_image")
        name = name if instance is None else instance.get("url", "")[1:]
    return unquote(images.get(name, "").strip()).removeprefix("file://").replace("\\", "/")


def read_collada(
    path: Path, find_image: FindImage, allowance: Allowance, *, up: Axis | None = None
) -> tuple[list[MeshPart], list[Paint], Axis]:
    """All triangles that a file's scene shows, in metres, their materials, and the axis up.

    Skinned meshes are shown in the pose in which they were bound.

    Args:
        path: A ``.dae`` file.
        find_image: The file of an image that this one names, or None.
        allowance: Memory that it may take.
        up: The axis of the file that points up; None takes its ``up_axis``, as Gazebo doesn't.

    Raises:
        ValueError: It is no COLLADA file, or is broken.
        OSError: It cannot be read, or would take too much memory.
    """
    content = read_file(path, most=_MOST_BYTES)
    # A number is at least one digit and a space.
    allowance.spend(len(content) // 2 * _BYTES_PER_NUMBER, "its numbers")
    root = parse_xml(content, allowance)
    if root.tag != "COLLADA":
        raise ValueError(f"begins with {root.tag:.40}, expected COLLADA")
    return _Reader(root, read_paints(root, find_image), allowance).read(up)


@dataclass(frozen=True, eq=False)
class _Shown:
    """A node with what it stands in."""

    element: ElementTree.Element
    to_scene: Float64[np.ndarray, "4 4"]
    descriptive_name: str
    depth: int


class _Reader:
    """Walks through the nodes of a document."""

    def __init__(
        self, root: ElementTree.Element, paints: dict[str, Paint], allowance: Allowance
    ) -> None:
        self._root = root
        self._allowance = allowance
        self._paints = [PLAIN, *paints.values()]
        self._numbers = {name: number for number, name in enumerate(paints, start=1)}
        self._by_id = {
            element.get("id", ""): element
            for tag in ("node", "geometry", "controller", "visual_scene")
            for element in root.iter(tag)
        }
        self._meshes: dict[str, list[Triangles]] = {}
        self._names: dict[str, int] = {}
        self._parts: list[MeshPart] = []

    def read(self, up: Axis | None) -> tuple[list[MeshPart], list[Paint], Axis]:
        unit = self._root.find("asset/unit")
        scale = 1.0 if unit is None else float(unit.get("meter", "1"))
        up = up or _UP.get(self._root.findtext("asset/up_axis", "").strip(), "y")
        to_scene = np.eye(4)
        to_scene[:3, :3] = TO_Z_UP[up] * scale
        stack = [_Shown(node, to_scene, "", 0) for node in reversed(self._roots())]
        count = 0
        while stack:
            shown = stack.pop()
            count += 1
            if count > _MOST_NODES or shown.depth > _DEEPEST:
                raise ValueError(
                    f"has more than {_MOST_NODES:,} nodes, or is deeper than {_DEEPEST}"
                )
            stack += reversed(list(self._show(shown)))
        return self._parts, self._paints, up

    def _roots(self) -> list[ElementTree.Element]:
        instance = self._root.find("scene/instance_visual_scene")
        scene = None if instance is None else self._by_id.get(instance.get("url", "")[1:])
        if scene is None:
            scene = self._root.find("library_visual_scenes/visual_scene")
        return [] if scene is None else scene.findall("node")

    def _show(self, shown: _Shown) -> Iterator[_Shown]:
        """Add a node's own meshes to the parts; what it shows besides is yielded."""
        node = shown.element
        to_scene = shown.to_scene @ local_matrix(node)
        own = node.get("name") or node.get("id") or ""
        telling = (
            own if is_meaningful(own) or not shown.descriptive_name else shown.descriptive_name
        )
        for child in node:
            if child.tag == "node":
                yield _Shown(child, to_scene, telling, shown.depth + 1)
            elif child.tag == "instance_node":
                inner = self._by_id.get(child.get("url", "")[1:])
                if inner is not None:
                    yield _Shown(inner, to_scene, telling, shown.depth + 1)
            elif child.tag in ("instance_geometry", "instance_controller"):
                self._add(child, to_scene, own, telling)

    def _add(
        self,
        instance: ElementTree.Element,
        to_scene: Float64[np.ndarray, "4 4"],
        own: str,
        telling: str,
    ) -> None:
        geometry, bound = self._geometry(instance)
        if geometry is None:
            return
        key = geometry.get("id", "")
        if key not in self._meshes:
            self._meshes[key] = [
                item for mesh in geometry.iter("mesh") for item in triangles_of(mesh)
            ]
        symbols = {
            item.get("symbol", ""): item.get("target", "")[1:]
            for item in instance.iter("instance_material")
        }
        name = unique_name(own or geometry.get("name") or key or "node", self._names)
        telling = telling if is_meaningful(telling) else geometry.get("name") or telling or name
        for triangles in self._meshes[key]:
            target = symbols.get(triangles.symbol, triangles.symbol)
            self._allowance.spend(len(triangles.faces) * 150, f"{len(triangles.faces):,} triangles")
            part = _part(name, telling, triangles, self._numbers.get(target, 0))
            self._parts.append(placed(part, to_scene @ bound))

    def _geometry(
        self, instance: ElementTree.Element
    ) -> tuple[ElementTree.Element | None, Float64[np.ndarray, "4 4"]]:
        """The mesh of an instance, through its skin if it has one, and the transform of that."""
        found = self._by_id.get(instance.get("url", "")[1:])
        if found is None or found.tag != "controller":
            return found, np.eye(4)
        skin = found.find("skin")
        if skin is None:
            return None, np.eye(4)
        return self._by_id.get(skin.get("source", "")[1:]), local_matrix(skin)


def _part(node: str, descriptive_name: str, triangles: Triangles, material: int) -> MeshPart:
    normals, colors = triangles.normals, triangles.colors
    if normals is not None:
        lengths = np.linalg.norm(normals, axis=2, keepdims=True)
        # A file whose normals say nothing has none.
        normals = (
            (normals / np.maximum(lengths, 1e-30)).astype(np.float32) if lengths.all() else None
        )
    return MeshPart(
        node=node,
        descriptive_name=descriptive_name,
        vertices=triangles.vertices.astype(np.float32),
        faces=np.ascontiguousarray(triangles.faces, dtype=np.int32),
        material=material,
        uv=triangles.uv,
        colors=None if colors is None else np.rint(np.clip(colors, 0, 1) * 255.0).astype(np.uint8),
        normals=normals,
    )


def read_collada_scene(
    path: Path, up: Axis | None = None
) -> tuple[list[MeshPart], list[Material], Axis]:
    """All triangles that a file's scene shows, in the scene frame, its materials, and its axis up.

    Args:
        path: A ``.dae`` file; its images lie in its folder.
        up: The axis of the file that points up; None takes the one that it declares.

    Raises:
        SceneError: The file is broken.
        OSError: It cannot be read, or would take too much memory.
    """
    allowance = Allowance()
    try:
        parts, paints, up = read_collada(
            path, lambda reference: _beside(path.parent, reference), allowance, up=up
        )
    except ValueError as error:
        raise SceneError(
            f"{path}: cannot be read as COLLADA ({error}); export the file again"
        ) from error
    return parts, materials_of(path, paints, allowance), up


def _beside(folder: Path, reference: str) -> Path | None:
    """An image where the file says, or in its own folder under the same name."""
    for candidate in (reference, PurePosixPath(reference).name):
        try:
            found = path_below(folder, candidate)
        except OSError:
            continue
        if found.is_file():
            return found
    return None
