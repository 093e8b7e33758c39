"""Scanned buildings in the file formats of HM3D and Matterport3D: their files, cache and loading.

HM3D: ``00802-wcojb4TFT35/`` with ``wcojb4TFT35.basis.glb`` (textures compressed) or
``wcojb4TFT35.glb``, ``wcojb4TFT35.basis.navmesh``, ``wcojb4TFT35.semantic.glb`` and
``wcojb4TFT35.semantic.txt``. Matterport3D: ``17DRP5sb8fy/`` with ``17DRP5sb8fy.glb``, ``.navmesh``,
``.house`` and ``17DRP5sb8fy_semantic.ply``.

A folder of the cache holds one scan, and data computed from it by other modules (`Scene.cache`).
Textures are mapped into memory and read when they are needed. A broken folder is written again;
without a writable cache nothing is kept.
"""

import hashlib
import json
import logging
import re
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int64

from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.io.cache_folder import cache_folder
from hypernav.io.kept_arrays import digest_of, keep, mapped_array
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scans.matterport import objects_of_triangles, read_house
from hypernav.simulator.worlds.scans.scan_annotations import (
    Annotation,
    colors_of_triangles,
    read_annotations,
)
from hypernav.simulator.worlds.scenes.gltf import read_gltf
from hypernav.simulator.worlds.scenes.loading import OBJECTS_FILE, read_scene
from hypernav.simulator.worlds.scenes.mesh_parts import (
    SceneObject,
    assemble,
    instances_of,
    point_of,
)
from hypernav.simulator.worlds.scenes.scene import Material, Scene, Wrap

HOUSE_SUFFIX = ".house"
"""Suffix of Matterport3D's annotation."""

_SCENE = re.compile(r"(?P<stem>.+?)(?:\.basis)?\.glb", re.IGNORECASE)
LEAST_BYTES = 10_000_000
"""Smaller meshes are read as fast without a cache."""
_ARRAYS = ("vertices", "faces", "uv", "colors", "face_material", "face_instance")
_IMAGES = ("texture", "opaque")
_BROKEN = (EOFError, ValueError, KeyError, TypeError, IndexError, zipfile.BadZipFile)
_LOGGER = logging.getLogger(__name__)
_NO_OBJECTS = frozenset({"wall", "floor", "ceiling", "unknown", "unlabeled", "void", "misc"})


@dataclass(frozen=True)
class ScanFiles:
    """The files of one scan.

    Attributes:
        mesh: Triangles and textures.
        semantic_mesh: Triangles with the marks of their instances; None if there is none.
        semantic_text: Instance and category of every mark; None if there is none.
        navmesh: Walkable surface as Habitat computed it; None if there is none.
    """

    mesh: Path
    semantic_mesh: Path | None = None
    semantic_text: Path | None = None
    navmesh: Path | None = None

    @staticmethod
    def of(mesh: Path) -> "ScanFiles | None":
        """The files of a scan; None for a scene that is not a scan.

        Args:
            mesh: Path of a scene's file.
        """
        match = _SCENE.fullmatch(mesh.name)
        if match is None:
            return None
        stem, folder = match["stem"], mesh.parent
        is_hm3d = (
            mesh.name.lower().endswith(".basis.glb")
            or re.fullmatch(rf"\d{{5}}-{re.escape(stem)}", folder.name) is not None
            or _there(folder / f"{stem}.semantic.txt") is not None
        )
        if _there(folder / OBJECTS_FILE) is not None:
            return None  # our export, y up, with the annotation for Habitat
        house = _there(folder / f"{stem}{HOUSE_SUFFIX}")
        if not is_hm3d and house is None:
            return None
        return ScanFiles(
            mesh,
            _there(folder / (f"{stem}.semantic.glb" if is_hm3d else f"{stem}_semantic.ply")),
            _there(folder / f"{stem}.semantic.txt") if is_hm3d else house,
            _there(folder / f"{stem}.basis.navmesh") or _there(folder / f"{stem}.navmesh"),
        )


def _there(path: Path) -> Path | None:
    return path if path.is_file() else None


def cached_scan(
    files: ScanFiles,
    load: Callable[[ScanFiles], Scene],
    *,
    folder: Path | None = None,
    least_bytes: int = LEAST_BYTES,
) -> Scene:
    """A scan from the cache; if it is not there, it is loaded and kept.

    Args:
        files: Files of the scan; if one of them changes, the scan is loaded again.
        load: Function that loads it.
        folder: Cache folder; `cache_folder()` if None.
        least_bytes: Size of the smallest mesh that is kept, bytes.
    """
    if files.mesh.stat().st_size < least_bytes:
        return load(files)
    home = (folder or cache_folder()) / "scans" / _key(files)
    try:
        return _read(home, files)
    except OSError as error:  # it is not there, or nothing can be: `cache_folder` has said so
        _LOGGER.debug("%s is not read (%s)", home, error)
    except _BROKEN as error:
        _LOGGER.warning("%s is broken (%s) and is written again", home, error)
    scene = load(files)
    keep(home, lambda fresh: _write(fresh, scene))
    return replace(scene, cache=home) if home.is_dir() else scene


def _key(files: ScanFiles) -> str:
    """A name that changes with the files and with the code that reads them."""
    digest = hashlib.sha256(_reader_version().encode())
    for path in (files.mesh, files.semantic_mesh, files.semantic_text):
        if path is not None:
            status = path.stat()
            identity = (str(path.resolve()), status.st_size, status.st_mtime_ns)
            digest.update(json.dumps(identity).encode())
    return f"{files.mesh.stem}-{digest.hexdigest()[:16]}"


@lru_cache(maxsize=1)
def _reader_version() -> str:
    here = Path(__file__).parents[1]
    return digest_of(sorted(p for room in ("scans", "scenes") for p in (here / room).glob("*.py")))


def _read(home: Path, files: ScanFiles) -> Scene:
    with (home / "scan.npz").open("rb") as file, np.load(file, allow_pickle=False) as stored:
        about = json.loads(stored["about"].tobytes())
        arrays = {name: stored[name] for name in _ARRAYS}
    images = [mapped_array(home / f"{number}.npy") for number in range(about["images"])]
    return Scene(
        name=about["name"],
        **arrays,
        normals=None,
        materials=tuple(_material(one, images) for one in about["materials"]),
        instances=tuple(_instance(one) for one in about["instances"]),
        unlit=True,
        navmesh=files.navmesh,
        stored_z_up=True,
        cache=home,
    )


def _material(stored: dict[str, Any], images: list[Any]) -> Material:
    texture, opaque = (None if stored[k] is None else images[stored[k]] for k in _IMAGES)
    return Material(
        stored["name"],
        tuple(stored["color"]),
        texture,
        (Wrap(stored["wrap"][0]), Wrap(stored["wrap"][1])),
        opaque,
        stored["unlit"],
    )


def _instance(stored: dict[str, Any]) -> Instance:
    label = None
    if stored["label"] is not None:
        category, synonyms = stored["label"]
        label = ObjectLabel(category, tuple(synonyms))
    low, high = tuple(stored["box_min"]), tuple(stored["box_max"])
    return Instance(stored["id"], stored["name"], label, low, high)


def _write(home: Path, scene: Scene) -> None:
    home.mkdir()
    images: dict[int, int] = {}
    materials = []
    for material in scene.materials:
        about: dict[str, Any] = {"texture": None, "opaque": None}
        for kind in _IMAGES:
            image = getattr(material, kind)
            if image is not None:
                if id(image) not in images:
                    images[id(image)] = len(images)
                    np.save(home / f"{images[id(image)]}.npy", image)
                about[kind] = images[id(image)]
        about |= {"name": material.name, "color": material.color, "unlit": material.unlit}
        materials.append(about | {"wrap": [int(mode) for mode in material.wrap]})
    instances = [
        asdict(one)
        | {"label": None if one.label is None else (one.label.category, one.label.synonyms)}
        for one in scene.instances
    ]
    about = {
        "name": scene.name,
        "materials": materials,
        "instances": instances,
        "images": len(images),
    }
    text = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    arrays = {name: getattr(scene, name) for name in _ARRAYS}
    np.savez(home / "scan.npz", about=text, **arrays)


def annotated(
    scene: Scene, annotations: Sequence[Annotation], marks: Int64[np.ndarray, "faces"]
) -> Scene:
    """The scene with an instance for every annotation that has triangles.

    Instance 0 is everything without annotation. Labels are the annotators' own words.

    Args:
        scene: The scan.
        annotations: Annotations, each with a unique mark.
        marks: Mark of every triangle.
    """
    by_mark = {annotation.mark: annotation for annotation in annotations}
    present, place = np.unique(marks, return_inverse=True)
    found = [by_mark[mark] for mark in present.tolist() if mark in by_mark]
    owners = sorted(found, key=lambda annotation: annotation.id)
    number = {owner.mark: k for k, owner in enumerate(owners, start=1)}
    numbers = np.array([number.get(mark, 0) for mark in present.tolist()], dtype=np.int32)
    face_instance = numbers[place]
    named = [("building", None), *((owner.name, _label(owner)) for owner in owners)]
    building, *things = instances_of(named, scene.vertices[scene.faces], face_instance)
    low, high = point_of(scene.vertices.min(axis=0)), point_of(scene.vertices.max(axis=0))
    building = replace(building, box_min=low, box_max=high)
    return replace(scene, face_instance=face_instance, instances=(building, *things))


def _label(owner: Annotation) -> ObjectLabel | None:
    return (
        None
        if owner.category.lower() in _NO_OBJECTS
        else ObjectLabel(owner.category, owner.synonyms)
    )


def open_scene(path: Path, *, up: Axis | None = None, scale: float | None = None) -> Scene:
    """Open a scene from a file, whether it is a scan or not; large scans are kept in the cache.

    Args:
        path: A file that `read_scene` reads.
        up: The axis of the file that points up; None takes that of its format.
        scale: Factor on all lengths; None is 1.

    Raises:
        SceneError: The file is missing, broken, empty or not a mesh, or is a scan, which has its
            own axis and unit.
    """
    files = ScanFiles.of(path)
    if files is None or not path.is_file():
        return read_scene(path, up=up, scale=scale)
    if up is not None or scale is not None:
        raise SceneError(
            f"{path}: is a scan, z up and in metres; leave world.file_up and world.file_scale out"
        )
    return cached_scan(files, load_scan)


def load_scan(files: ScanFiles) -> Scene:
    """Open a scanned building.

    Scans are stored z up, contrary to glTF's rule: habitat-sim reads them with ``up`` (0, 0, 1) and
    ``front`` (0, 1, 0), the stage attributes of HM3D's scene-dataset configuration and its default
    for all of Matterport's GLBs. Their textures already contain the light.

    Raises:
        SceneError: A file is broken, empty or not a mesh.
    """
    path = files.mesh
    try:
        parts, materials = read_gltf(path, up="z")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not parts:
        raise SceneError(f"{path}: holds no triangles; download it again")
    building = SceneObject("building", frozenset(part.node for part in parts), None)
    scene = assemble(path.stem.removesuffix(".basis"), parts, [building], materials, smooth=False)
    scene = replace(scene, unlit=True, navmesh=files.navmesh, stored_z_up=True)
    if files.semantic_mesh is None or files.semantic_text is None:
        return scene
    if files.semantic_text.suffix == HOUSE_SUFFIX:
        objects = read_house(files.semantic_text)
        numbers = objects_of_triangles(files.semantic_mesh, scene.vertices, scene.faces)
        return annotated(scene, objects, numbers)
    annotations = read_annotations(files.semantic_text)
    known = frozenset(annotation.mark for annotation in annotations)
    colors = colors_of_triangles(files.semantic_mesh, known, scene.vertices, scene.faces)
    return annotated(scene, annotations, colors)
