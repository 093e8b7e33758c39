"""COLLADA files as scenes of their own."""

from pathlib import Path, PurePosixPath

from hypernav.core.errors import SceneError
from hypernav.io.reading import Allowance, path_below
from hypernav.worlds.collada.document import read_collada
from hypernav.worlds.config import Axis
from hypernav.worlds.scenes.paints import materials_of
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart


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
