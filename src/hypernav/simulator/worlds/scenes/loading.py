"""Loads scenes from files, with the objects that their ``objects.json`` describes."""

import logging
import math
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.naming.words import composed
from hypernav.io.parsing import Items, parse_json
from hypernav.io.reading import back_slashes, check_file, read_file
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scenes.gltf import read_gltf
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart, SceneObject, assemble, placed
from hypernav.simulator.worlds.scenes.node_names import category_of
from hypernav.simulator.worlds.scenes.scene import Material, Scene
from hypernav.simulator.worlds.scenes.scene_doubts import doubts_of
from hypernav.simulator.worlds.scenes.stray_parts import in_one_line, without_surroundings

OBJECTS_FILE = "objects.json"
_GLTF_SUFFIXES = (".glb", ".gltf")
_MESH_SUFFIXES = (".obj", ".ply", ".stl", ".off")
_COLLADA_SUFFIX = ".dae"
_WORLD_SUFFIXES = (".world", ".sdf")
_IFC_SUFFIX = ".ifc"
_ALWAYS_Z_UP = (*_WORLD_SUFFIXES, _IFC_SUFFIX)
_COARSEST_M = 0.02
"""Largest step between coordinates that a scene may have."""
_LOGGER = logging.getLogger(__name__)


class _Object(BaseModel):
    model_config = ConfigDict(frozen=True)

    name: str = Field(min_length=1)
    category: str = Field(min_length=1)
    structural: bool = False
    nodes: list[Annotated[str, AfterValidator(composed)]] = Field(min_length=1)
    synonyms: list[str] = Field(default_factory=list)
    attributes: list[str] = Field(default_factory=list)
    room: str = ""
    beside: list[str] = Field(default_factory=list)


class _Objects(BaseModel):
    objects: Items[_Object]
    storeys: Items[FiniteFloat] = Field(default_factory=list)


def read_objects(path: Path, node_names: set[str]) -> tuple[list[SceneObject], tuple[float, ...]]:
    """Objects that a file describes, and the heights of its storeys as `Scene` holds them.

    Every object has ``name``, ``category`` and ``nodes``, and may have ``structural``,
    ``synonyms``, ``attributes``, ``room`` and ``beside``; other keys are ignored. Parts of the
    building have no label. A building with stairs may have ``storeys``, the heights of its floors.

    Args:
        path: Path of the JSON file.
        node_names: Names of the scene's nodes.

    Raises:
        SceneError: The file cannot be read, lacks something, or doesn't belong to the scene.
    """
    try:
        parsed = _Objects.model_validate(parse_json(read_file(path)))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    except ValidationError as error:
        first = error.errors()[0]
        location = ".".join(str(part) for part in first["loc"]) or "file"
        raise SceneError(
            f"{path}: {location}: {first['msg']}; every object needs name, category and nodes"
        ) from error
    except ValueError as error:
        raise SceneError(
            f"{path}: is not valid JSON ({error}); correct it, or remove it to label objects "
            "by the names of their nodes"
        ) from error
    _check_nodes(path, parsed.objects, node_names)
    objects = [SceneObject(o.name, frozenset(o.nodes), _described_label(o)) for o in parsed.objects]
    return objects, tuple(sorted(parsed.storeys))


def _described_label(item: _Object) -> ObjectLabel | None:
    if item.structural:
        return None
    return ObjectLabel(
        item.category, tuple(item.synonyms), tuple(item.attributes), item.room, tuple(item.beside)
    )


def _check_nodes(path: Path, objects: list[_Object], node_names: set[str]) -> None:
    """Check that every object's nodes exist and belong only to it, and that names are unique."""
    owner: dict[str, str] = {}
    names: set[str] = set()
    for item in objects:
        if item.name in names:
            raise SceneError(f"{path}: two objects are named {item.name!r}; give each its own name")
        names.add(item.name)
        for node in item.nodes:
            if node not in node_names:
                raise SceneError(
                    f"{path}: object {item.name!r} names the node {node!r}, which the scene does "
                    "not have; the file belongs to another scene or is out of date, "
                    "write it again or remove it"
                )
            if node in owner and owner[node] != item.name:
                raise SceneError(
                    f"{path}: node {node!r} belongs to both {owner[node]!r} and {item.name!r}; "
                    "list it once"
                )
            owner[node] = item.name


def read_scene(path: Path, *, up: Axis | None = None, scale: float | None = None) -> Scene:
    """Read a scene from a file that is no scan; `hypernav.load_scene` opens any.

    A file ``objects.json`` beside it says which nodes make up which object. Without it every node
    is an instance of its own, labelled by its name. glTF and OBJ files (y up) become
    ``(x, -z, y)``, the others are z up, or as a COLLADA file says. Units are metres. Stray parts
    (`without_surroundings`) are left out, with a warning that names them, and a building that seems
    to lie on its side or to have another unit gets a warning that says why.

    Args:
        path: A ``.glb``, ``.gltf``, ``.dae``, ``.ifc``, ``.obj``, ``.ply``, ``.stl`` or ``.off``
            file, or a Gazebo world (``.world``, ``.sdf``).
        up: The axis of the file that points up; None takes that of its format.
        scale: Factor on all lengths, such as 0.001 for a file in millimetres; None is 1.

    Raises:
        MissingExtraError: It is an ``.ifc`` file, and ifcopenshell is not installed.
        SceneError: The file is missing, broken, empty or not a mesh, or ``objects.json`` doesn't
            belong to it.
    """
    path = Path(path)
    _check_readable(path)
    try:
        parts, materials, missing, read_up = _read(path, up)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not parts:
        raise SceneError(f"{path}: holds no triangles; export a mesh with faces")
    if scale is not None:
        parts = [placed(part, np.diag([scale, scale, scale, 1.0])) for part in parts]
    objects, storeys = _scene_objects(path, parts)
    up_is_given = up is not None or path.suffix.lower() in _ALWAYS_Z_UP
    for doubt in doubts_of(
        parts, objects, read_up, up_is_given=up_is_given, scale_is_given=scale is not None
    ):
        _LOGGER.warning("%s: %s", path, doubt)
    building, stray = without_surroundings(parts)
    _check_precision(path, building)
    left_out = [*missing, *stray]
    if left_out:
        _LOGGER.warning("%s: leaves out %s", path, in_one_line(left_out))
    return replace(assemble(_name(path), building, objects, materials), storeys=storeys)


def _read(path: Path, up: Axis | None) -> tuple[list[MeshPart], list[Material], list[str], Axis]:
    """Parts and materials of a file, what its reader leaves out, and the axis that it took for up.

    OBJ is read as y up, as written by modelling tools, the other formats that define no such axis
    as z up, as written by scanners.
    """
    suffix = path.suffix.lower()
    if suffix in _ALWAYS_Z_UP and up not in (None, "z"):
        raise SceneError(f"{path}: files of its kind are z up; leave world.file_up out")
    if suffix in _GLTF_SUFFIXES:
        parts, materials = read_gltf(path, up=up or "y")
        return parts, materials, [], up or "y"
    if suffix in _MESH_SUFFIXES:
        from hypernav.simulator.worlds.scenes.mesh_files import read_mesh

        up = up or ("y" if suffix == ".obj" else "z")
        parts, materials = read_mesh(path, up=up)
        return parts, materials, [], up
    if suffix == _COLLADA_SUFFIX:
        from hypernav.simulator.worlds.scenes.collada import read_collada_scene

        parts, materials, up = read_collada_scene(path, up)
        return parts, materials, [], up
    if suffix in _WORLD_SUFFIXES:
        from hypernav.simulator.worlds.gazebo.gazebo_world import read_world

        return *read_world(path), "z"
    if suffix == _IFC_SUFFIX:
        from hypernav.simulator.worlds.scenes.ifc_file import read_ifc

        parts, materials = read_ifc(path)
        return parts, materials, [], "z"
    meshes = (*_GLTF_SUFFIXES, _COLLADA_SUFFIX, _IFC_SUFFIX, *_MESH_SUFFIXES)
    known = ", ".join((*meshes, *_WORLD_SUFFIXES))
    raise SceneError(f"{path}: unknown kind of file {suffix!r}; give one of {known}")


def _check_readable(path: Path) -> None:
    if os.path.isdir(path):  # Unlike Path.is_dir, it accepts any name.
        inside = sorted(p.name for p in path.iterdir() if p.suffix.lower() in _GLTF_SUFFIXES)
        hint = f"did you mean {path / inside[0]}?" if inside else "it holds no .glb"
        raise SceneError(f"{path}: is a folder, expected a scene file; {hint}")
    try:
        check_file(path)
        empty = path.stat().st_size == 0
    except FileNotFoundError as error:
        raise SceneError(
            f"{path}: no such scene file; check the path{back_slashes(str(path))}"
        ) from error
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if empty:
        raise SceneError(f"{path}: the file is empty; copy or download it again")


def _check_precision(path: Path, building: Sequence[MeshPart]) -> None:
    """Refuse coordinates so large, as of maps, that single precision has moved their surfaces."""
    corners = (part.vertices[part.faces] for part in building if len(part.faces))
    farthest = max((float(np.abs(some).max()) for some in corners), default=0.0)
    step = float(np.spacing(np.float32(farthest))) if math.isfinite(farthest) else 0.0
    if step > _COARSEST_M:
        raise SceneError(
            f"{path}: lies {farthest / 1000.0:,.0f} km from the origin of its coordinates, where "
            f"they are {step:.2g} m apart; move it to the origin and export it again"
        )


def _name(path: Path) -> str:
    """Name of a scene; for files called scene.glb that of their folder."""
    generic = (
        path.stem.lower() in ("scene", "mesh", "model", "stage") and path.resolve().parent.name
    )
    return generic or path.stem


def _scene_objects(
    path: Path, parts: Sequence[MeshPart]
) -> tuple[list[SceneObject], tuple[float, ...]]:
    """Objects of a scene, and the heights of its storeys if its ``objects.json`` has them."""
    descriptive_names = {part.node: part.descriptive_name for part in parts}
    objects_file = path.parent / OBJECTS_FILE
    objects, storeys = list[SceneObject](), ()
    if objects_file.exists():
        objects, storeys = read_objects(objects_file, set(descriptive_names))
    described = {node for item in objects for node in item.nodes}
    taken = {item.name for item in objects}
    for node, descriptive_name in descriptive_names.items():
        if node not in described:
            name = node if node not in taken else f"{node} (node)"
            objects.append(SceneObject(name, frozenset({node}), _label_by_name(descriptive_name)))
    return objects, storeys


def _label_by_name(descriptive_name: str) -> ObjectLabel | None:
    category = category_of(descriptive_name)
    return ObjectLabel(category) if category is not None else None
