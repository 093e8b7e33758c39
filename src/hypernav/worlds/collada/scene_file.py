"""COLLADA files as scenes of their own."""

from pathlib import Path, PurePosixPath

from hypernav.core.errors import SceneError
from hypernav.core.files.allowance import Allowance
from hypernav.core.files.reading import path_below
from hypernav.worlds.collada.document import read_collada
from hypernav.worlds.scenes.paints import materials_of
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart


def read_collada_scene(path: Path) -> tuple[list[MeshPart], list[Material]]:
    """All triangles that a file's scene shows, in the scene frame, and its materials.

    Args:
        path: A ``.dae`` file; its images lie in its folder.

    Raises:
        SceneError: The file is broken.
        OSError: It cannot be read, or would take too much memory.
    """
    allowance = Allowance()
    try:
        parts, paints = read_collada(
            path, lambda reference: _beside(path.parent, reference), allowance
        )
    except ValueError as error:
        raise SceneError(
            f"{path}: cannot be read as COLLADA ({error}); export the file again"
        ) from error
    return parts, materials_of(path, paints, allowance)


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
