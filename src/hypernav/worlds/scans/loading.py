"""Loads scanned buildings."""

from dataclasses import replace
from pathlib import Path

from hypernav.core.errors import SceneError
from hypernav.worlds.config import Axis
from hypernav.worlds.scans.annotated import annotated
from hypernav.worlds.scans.layout import HOUSE_SUFFIX, ScanFiles
from hypernav.worlds.scans.matterport_house import read_house
from hypernav.worlds.scans.matterport_mesh import objects_of_triangles
from hypernav.worlds.scans.scan_cache import cached_scan
from hypernav.worlds.scans.semantic_mesh import colors_of_triangles
from hypernav.worlds.scans.semantic_text import read_annotations
from hypernav.worlds.scenes.gltf import read_gltf
from hypernav.worlds.scenes.loading import read_scene
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.scenes.scene_assembly import SceneObject, assemble


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

    Args:
        files: Files of the scan.

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
