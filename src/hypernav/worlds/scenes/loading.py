"""Loads scenes from files."""

import logging
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from hypernav.core.errors import SceneError
from hypernav.core.files.reading import check_file
from hypernav.core.labels import ObjectLabel
from hypernav.worlds.scenes.gltf import read_gltf
from hypernav.worlds.scenes.node_names import category_of
from hypernav.worlds.scenes.objects_file import read_objects
from hypernav.worlds.scenes.scene import Material, Scene
from hypernav.worlds.scenes.scene_assembly import MeshPart, SceneObject, assemble
from hypernav.worlds.scenes.stray_parts import in_one_line, without_surroundings

OBJECTS_FILE = "objects.json"
_GLTF_SUFFIXES = (".glb", ".gltf")
_MESH_SUFFIXES = (".obj", ".ply", ".stl", ".off")
_COLLADA_SUFFIX = ".dae"
_WORLD_SUFFIXES = (".world", ".sdf")
_IFC_SUFFIX = ".ifc"
_FAR_M = 30_000.0
"""Beyond this, single precision is coarser than a few millimetres."""
_LOGGER = logging.getLogger(__name__)


def read_scene(path: Path) -> Scene:
    """Read a scene from a file that is no scan; `hypernav.load_scene` opens any.

    A file ``objects.json`` beside it says which nodes make up which object. Without it every node
    is an instance of its own, labelled by its name. glTF files (y up) become ``(x, -z, y)``; for
    the other formats see `read_mesh`. Units are metres. Stray parts (`without_surroundings`) are
    left out, with a warning that names them.

    Args:
        path: A ``.glb``, ``.gltf``, ``.dae``, ``.ifc``, ``.obj``, ``.ply``, ``.stl`` or ``.off``
            file, or a Gazebo world (``.world``, ``.sdf``).

    Raises:
        MissingExtraError: It is an ``.ifc`` file, and ifcopenshell is not installed.
        SceneError: The file is missing, broken, empty or not a mesh, or ``objects.json`` doesn't
            belong to it.
    """
    path = Path(path)
    _check_readable(path)
    try:
        parts, materials, missing = _read(path)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not parts:
        raise SceneError(f"{path}: holds no triangles; export a mesh with faces")
    objects, storeys = _scene_objects(path, parts)
    building, stray = without_surroundings(parts)
    left_out = [*missing, *stray]
    if left_out:
        _LOGGER.warning("%s: leaves out %s", path, in_one_line(left_out))
    scene = replace(assemble(_name(path), building, objects, materials), storeys=storeys)
    _warn_if_far_away(path, scene)
    return scene


def _read(path: Path) -> tuple[list[MeshPart], list[Material], list[str]]:
    """Parts and materials of a file, and what its reader leaves out."""
    suffix = path.suffix.lower()
    if suffix in _GLTF_SUFFIXES:
        parts, materials = read_gltf(path)
        return parts, materials, []
    if suffix in _MESH_SUFFIXES:
        from hypernav.worlds.scenes.mesh_files import read_mesh

        parts, materials = read_mesh(path)
        return parts, materials, []
    if suffix == _COLLADA_SUFFIX:
        from hypernav.worlds.collada.scene_file import read_collada_scene

        parts, materials = read_collada_scene(path)
        return parts, materials, []
    if suffix in _WORLD_SUFFIXES:
        from hypernav.worlds.gazebo.world import read_world

        return read_world(path)
    if suffix == _IFC_SUFFIX:
        from hypernav.worlds.scenes.ifc_file import read_ifc

        parts, materials = read_ifc(path)
        return parts, materials, []
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
        raise SceneError(f"{path}: no such scene file; check the path") from error
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if empty:
        raise SceneError(f"{path}: the file is empty; copy or download it again")


def _warn_if_far_away(path: Path, scene: Scene) -> None:
    """Say where coordinates of a map leave too few digits for walls and doors."""
    farthest = np.abs(scene.vertices[scene.faces]).max()
    if farthest > _FAR_M:
        _LOGGER.warning(
            "%s: lies %.0f km from its origin, where positions are exact to %.2g m only, so that "
            "walls and doors may vanish; export it with coordinates near the origin",
            path,
            farthest / 1000.0,
            np.spacing(farthest),
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
            objects.append(SceneObject(name, frozenset({node}), _label(descriptive_name)))
    return objects, storeys


def _label(descriptive_name: str) -> ObjectLabel | None:
    category = category_of(descriptive_name)
    return ObjectLabel(category) if category is not None else None
