"""Reading of Gazebo worlds: models with their poses, and what they look like.

A world is an SDF file that places models, most of them kept in folders of their own. What cannot be
shown is left out and named; what remains is a building, in which each model is one thing.
"""

import errno
import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import SceneError
from hypernav.io.parsing import parse_xml
from hypernav.io.reading import Allowance, read_file
from hypernav.simulator.worlds.gazebo.model_folders import Found, Meshes, ModelFolders, sdf_of
from hypernav.simulator.worlds.gazebo.visuals import endless_ground, paint_of, shape_of
from hypernav.simulator.worlds.scenes.collada import PLAIN, numbers_of
from hypernav.simulator.worlds.scenes.material_images import materials_of
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart, placed, rotation_of
from hypernav.simulator.worlds.scenes.node_names import is_meaningful, unique_name
from hypernav.simulator.worlds.scenes.scene import Material

Matrix = Float64[np.ndarray, "4 4"]
_ROOM_M = 6.0
"""What is longer and wider is no single thing."""
_MOST_BYTES = 100_000_000
_MOST_MODELS, _MOST_PARTS, _DEEPEST = 10_000, 50_000, 20
_BYTES_PER_TRIANGLE = 150
_INVISIBLE = 0.95
_GROUND, _SUN = "ground_plane", "sun"
_NO_SURFACE = ("actor", "road", "population")


def matrix_of(pose: ElementTree.Element | None) -> Matrix:
    """The transform of a pose to what it is relative to; that of none is no motion.

    Args:
        pose: An element ``pose``: x, y, z and roll, pitch, yaw, or a quaternion x, y, z, w.

    Raises:
        ValueError: It hasn't the numbers that it needs.
    """
    matrix = np.eye(4)
    if pose is None or not (pose.text or "").strip():
        return matrix
    values = numbers_of(pose.text)
    if pose.get("rotation_format") == "quat_xyzw":
        if len(values) != 7:
            raise ValueError(f"a pose has {len(values)} numbers, expected 7")
        matrix[:3, :3] = rotation_of(values[3:])
    elif len(values) == 6:
        angles = np.radians(values[3:]) if pose.get("degrees") in ("true", "1") else values[3:]
        matrix[:3, :3] = _from_angles(*angles.tolist())
    else:
        raise ValueError(f"a pose has {len(values)} numbers, expected 6")
    matrix[:3, 3] = values[:3]
    return matrix


def frame_of(pose: ElementTree.Element | None) -> str:
    """Name of what a pose is relative to; empty for what the element stands in."""
    name = "" if pose is None else pose.get("relative_to") or pose.get("frame") or ""
    return "" if name in ("world", "__model__", "/map") else name


def _from_angles(roll: float, pitch: float, yaw: float) -> Float64[np.ndarray, "3 3"]:
    about_x, about_y, about_z = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    (c, s), (d, t), (e, u) = about_x, about_y, about_z
    return (
        np.array([[e, -u, 0.0], [u, e, 0.0], [0.0, 0.0, 1.0]])
        @ np.array([[d, 0.0, t], [0.0, 1.0, 0.0], [-t, 0.0, d]])
        @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    )


@dataclass(frozen=True, eq=False)
class NamedPart:
    """A part and the names of what it belongs to.

    Attributes:
        names: Model, models within it, link, visual, node of the mesh file: from the outside in.
        part: The part.
    """

    names: tuple[str, ...]
    part: MeshPart


def named_instances(parts: Sequence[NamedPart]) -> list[MeshPart]:
    """The parts with one node for each thing.

    A model is one thing, called as the world calls it. One that is as large as a room is none, and
    the models, links, visuals and nodes within it are looked at in the same way.
    """
    taken: dict[str, int] = {}
    return [part for group in _things(parts, 1) for part in _as_one(group, taken)]


@dataclass(frozen=True, eq=False)
class _Thing:
    level: int
    parts: Sequence[NamedPart]


def _things(parts: Sequence[NamedPart], level: int) -> Iterator[_Thing]:
    groups: dict[tuple[str, ...], list[NamedPart]] = {}
    for part in parts:
        groups.setdefault(part.names[:level], []).append(part)
    for names, group in groups.items():
        has_more = any(len(part.names) > len(names) for part in group)
        if has_more and _is_large(group):
            yield from _things(group, level + 1)
        else:
            yield _Thing(len(names), group)


def _is_large(parts: Sequence[NamedPart]) -> bool:
    corners = np.concatenate([item.part.vertices[:, :2] for item in parts])
    corners = corners[np.isfinite(corners).all(axis=1)]
    return len(corners) > 0 and bool((np.ptp(corners, axis=0) > _ROOM_M).all())


def _as_one(thing: _Thing, taken: dict[str, int]) -> Iterator[MeshPart]:
    names = thing.parts[0].names
    node = unique_name("/".join(name for name in names[: thing.level] if name), taken)
    within = names[thing.level - 1 :]
    telling = next((name for name in within if is_meaningful(name)), names[thing.level - 1])
    for item in thing.parts:
        yield replace(item.part, node=node, descriptive_name=telling)


def read_world(path: Path) -> tuple[list[MeshPart], list[Material], list[str]]:
    """All that a world shows, in the scene frame, and what is left out.

    Args:
        path: A ``.world`` or ``.sdf`` file, of a world or of one model.

    Returns:
        The parts, their materials, and "NAME (why)" for what is left out.

    Raises:
        SceneError: The file is broken, or nothing in it can be shown.
        OSError: It cannot be read, or would take too much memory.
    """
    world = _World(path)
    try:
        world.read()
    except ValueError as error:
        raise SceneError(f"{path}: is no Gazebo world: {error}; save it again") from error
    left_out = [f"{name} ({why})" for name, why in world.left_out.items()]
    if not world.parts:
        what = f": {', '.join(left_out[:3])}" if left_out else ""
        raise SceneError(
            f"{path}: nothing in this world can be shown{what}; put its models beside it, or their "
            "folder into GAZEBO_MODEL_PATH"
        )
    parts = named_instances(world.parts)
    return parts, materials_of(path, world.meshes.paints, world.allowance), left_out


@dataclass(frozen=True)
class _Place:
    """Where an element stands: in the world, in a file, in a model.

    Attributes:
        to_scene: Transform from its parent's frame to the scene.
        names: Names of the models and the link around it, from the outside in.
        file: The file that holds the element.
        depth: Number of files and models around it.
    """

    to_scene: Matrix
    names: tuple[str, ...]
    file: Found
    depth: int

    def within(self, name: str, matrix: Matrix) -> "_Place":
        """The place of what an element of this name here holds."""
        return replace(
            self, to_scene=self.to_scene @ matrix, names=(*self.names, name), depth=self.depth + 1
        )


class _World:
    """Collects what a world shows."""

    def __init__(self, path: Path) -> None:
        self.parts: list[NamedPart] = []
        self.left_out: dict[str, str] = {}
        self.allowance = Allowance()
        self.meshes = Meshes(self.allowance)
        self._file = Found(path.resolve(), path.resolve().parent)
        self._folders = ModelFolders(path)
        self._documents: dict[Path, ElementTree.Element] = {}
        self._names: dict[str, int] = {}
        self._moved: dict[str, Matrix] = {}
        self._plain = self.meshes.add(PLAIN)
        self._models = 0

    def read(self) -> None:
        root = self._document(self._file.path)
        if root.tag not in ("sdf", "gazebo"):
            raise ValueError(f"begins with {root.tag:.40}, expected sdf")
        world = root.find("world")
        content = root if world is None else world
        top = _Place(np.eye(4), (), self._file, 0)
        for model in content.iterfind("state/model"):
            # Where things stood when the world was saved; Gazebo puts them there again.
            name = model.get("name", "")
            with self._left_out_if_broken(top, name):
                self._moved[name] = matrix_of(model.find("pose"))
        self._models_in(content, top)

    def _document(self, path: Path) -> ElementTree.Element:
        if path not in self._documents:
            content = read_file(path, most=_MOST_BYTES)
            self.allowance.spend(len(content), "its content")
            self._documents[path] = parse_xml(content, self.allowance)
        return self._documents[path]

    def _models_in(self, parent: ElementTree.Element, place: _Place) -> None:
        if place.depth > _DEEPEST:
            raise ValueError(f"holds models within models, more than {_DEEPEST} deep")
        for element in parent:
            if element.tag in ("model", "include"):
                self._place_one(element, parent, place)
            elif element.tag in _NO_SURFACE:
                name = element.get("name") or element.tag
                self.left_out.setdefault(name, f"{element.tag}s are not read")

    def _place_one(
        self, element: ElementTree.Element, parent: ElementTree.Element, place: _Place
    ) -> None:
        """Show a model or an included one; a broken one is left out and named."""
        self._models += 1
        if self._models > _MOST_MODELS:
            raise OSError(errno.EFBIG, f"it has more than {_MOST_MODELS:,} models")
        uri = (element.findtext("uri") or "").strip() if element.tag == "include" else ""
        name = element.get("name") or element.findtext("name") or _last_of(uri) or "model"
        if not place.names:
            name = unique_name(name.strip(), self._names)
        with self._left_out_if_broken(place, name):
            if element.tag == "include":
                self._include(name, uri, element, parent, place)
            else:
                self._model(name, element, self._matrix(element, parent, place), place)

    @contextmanager
    def _left_out_if_broken(self, place: _Place, name: str) -> Iterator[None]:
        """Name what cannot be shown by the model in the world that it belongs to."""
        try:
            yield
        except ValueError as error:
            self.left_out.setdefault([*place.names, name][0], str(error))
        except OSError as error:
            if error.errno == errno.EFBIG:
                raise
            self.left_out.setdefault([*place.names, name][0], error.strerror or str(error))

    def _include(
        self,
        name: str,
        uri: str,
        element: ElementTree.Element,
        parent: ElementTree.Element,
        place: _Place,
    ) -> None:
        found = self._folders.find(uri, place.file)
        file = None if found is None else sdf_of(found, self.allowance)
        if file is None:
            self._builtin(name, uri, self._matrix(element, parent, place), place)
            return
        pose = None if element.find("pose") is None else self._matrix(element, parent, place)
        for model in self._document(file.path).iterfind("model"):
            own = element.findtext("name") or model.get("name", "")
            matrix = None if place.names else self._moved.get(own)
            if matrix is None:
                matrix = matrix_of(model.find("pose")) if pose is None else pose
            self._model(name, model, matrix, replace(place, file=file))

    def _builtin(self, name: str, uri: str, matrix: Matrix, place: _Place) -> None:
        """Show a model that comes with Gazebo; the sun has no surface."""
        kind = _last_of(uri).lower().replace(" ", "_")
        if kind == _GROUND:
            ground = replace(endless_ground(), material=self._plain)
            self._add(ground, place.within(name, matrix), "")
        elif kind != _SUN:
            raise ValueError(f"no model {_last_of(uri):.40}")

    def _matrix(
        self,
        element: ElementTree.Element,
        parent: ElementTree.Element,
        place: _Place,
        depth: int = 0,
    ) -> Matrix:
        """The transform of an element to its parent, also where its pose names a sibling."""
        name = element.get("name") or element.findtext("name") or ""
        if not place.names and name in self._moved:
            return self._moved[name]
        pose = element.find("pose")
        matrix, frame = matrix_of(pose), frame_of(pose)
        named = (s for s in parent if (s.get("name") or s.findtext("name")) == frame)
        siblings = (s for s in named if s is not element)
        sibling = next(siblings, None) if frame and depth < _DEEPEST else None
        if sibling is None:
            return matrix
        return self._matrix(sibling, parent, place, depth + 1) @ matrix

    def _model(self, name: str, model: ElementTree.Element, matrix: Matrix, place: _Place) -> None:
        inside = place.within(name, matrix)
        for link in model.iterfind("link"):
            frame = self._matrix(link, model, inside)
            within = inside.within(link.get("name", "link"), frame)
            for visual in link.iterfind("visual"):
                with self._left_out_if_broken(within, ""):
                    self._show(visual, link, within)
        self._models_in(model, inside)

    def _show(self, visual: ElementTree.Element, link: ElementTree.Element, place: _Place) -> None:
        """Add a visual to the parts.

        Raises:
            ValueError: It is broken, or what it shows is not found.
            OSError: A file of it cannot be read.
        """
        here = place.within(visual.get("name", "visual"), self._matrix(visual, link, place))
        geometry = visual.find("geometry")
        if geometry is None or float(visual.findtext("transparency") or 0.0) > _INVISIBLE:
            return
        paint = paint_of(visual.find("material"), self._folders, place.file)
        material = None if paint is None else self.meshes.add(paint)
        mesh = geometry.find("mesh")
        if mesh is not None:
            self._show_mesh(mesh, here, material)
        elif (shape := shape_of(geometry)) is not None:
            self._add(replace(shape, material=material or self._plain), here, "")
        elif len(geometry) and geometry[0].tag != "empty":
            raise ValueError(f"{geometry[0].tag:.40}s are not read")

    def _show_mesh(self, mesh: ElementTree.Element, place: _Place, material: int | None) -> None:
        uri = (mesh.findtext("uri") or "").strip()
        file = self._folders.find(uri, place.file)
        if file is None:
            raise ValueError(f"no file {_last_of(uri):.60}")
        wanted = (mesh.findtext("submesh/name") or "").strip()
        whole = self.meshes.parts_of(file)
        if not any(len(part.faces) for part in whole):
            raise ValueError(f"{file.path.name:.60} holds no triangles")
        chosen = [part for part in whole if wanted in (part.node, part.node.partition("#")[0])]
        parts = chosen or whole
        scale = numbers_of(mesh.findtext("scale"))
        matrix = np.diag([*scale, 1.0]) if len(scale) == 3 else np.eye(4)
        if chosen and (mesh.findtext("submesh/center") or "").strip() in ("true", "1"):
            corners = np.concatenate([part.vertices for part in chosen])
            middle = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
            matrix[:3, 3] = -matrix[:3, :3] @ middle
        to_scene = place.to_scene @ matrix
        for part in parts:
            shown = part if material is None else replace(part, material=material)
            self._add(shown, replace(place, to_scene=to_scene), part.descriptive_name)

    def _add(self, part: MeshPart, place: _Place, node: str) -> None:
        if len(self.parts) == _MOST_PARTS:
            raise OSError(errno.EFBIG, f"it has more than {_MOST_PARTS:,} parts; join its meshes")
        self.allowance.spend(
            len(part.faces) * _BYTES_PER_TRIANGLE, f"{len(part.faces):,} triangles"
        )
        self.parts.append(NamedPart((*place.names, node), placed(part, place.to_scene)))


def _last_of(uri: str) -> str:
    """The last name in a URI."""
    return uri.rstrip("/").rpartition("/")[2]
