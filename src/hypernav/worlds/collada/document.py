"""Reading of COLLADA files: nodes, their transforms and their triangles."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from hypernav.io.parsing import parse_xml
from hypernav.io.reading import Allowance, read_file
from hypernav.worlds.collada.paints import PLAIN, FindImage, read_paints
from hypernav.worlds.collada.transforms import local_matrix
from hypernav.worlds.collada.triangles import Triangles, triangles_of
from hypernav.worlds.config import Axis
from hypernav.worlds.scenes.axes import TO_Z_UP
from hypernav.worlds.scenes.node_names import is_meaningful, unique_name
from hypernav.worlds.scenes.paints import Paint
from hypernav.worlds.scenes.scene_assembly import MeshPart, placed

_MOST_NODES, _DEEPEST = 50_000, 200
_MOST_BYTES = 500_000_000
_BYTES_PER_NUMBER = 8
_UP: dict[str, Axis] = {"X_UP": "x", "Y_UP": "y", "Z_UP": "z"}


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
    allowance.take(len(content) // 2 * _BYTES_PER_NUMBER, "its numbers")
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
            self._allowance.take(len(triangles.faces) * 150, f"{len(triangles.faces):,} triangles")
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
