"""The mesh files that a Gazebo world shows, each read once."""

from dataclasses import replace
from pathlib import Path, PurePosixPath

from hypernav.core.errors import SceneError
from hypernav.io.reading import Allowance
from hypernav.worlds.collada.document import read_collada
from hypernav.worlds.gazebo.model_folders import Found, found_beside
from hypernav.worlds.scenes.gltf import read_gltf
from hypernav.worlds.scenes.paints import Paint
from hypernav.worlds.scenes.scene import Material
from hypernav.worlds.scenes.scene_assembly import MeshPart

_TEXTURES = "../materials/textures"


class Meshes:
    """Mesh files by their paths, with one list of materials for all."""

    def __init__(self, allowance: Allowance) -> None:
        """Begin with no file.

        Args:
            allowance: Memory that all of them may take.
        """
        self.paints: list[Paint | Material] = []
        self._allowance = allowance
        self._read: dict[Found, list[MeshPart] | str] = {}

    def add(self, paint: Paint) -> int:
        """Add a paint; its number."""
        self.paints.append(paint)
        return len(self.paints) - 1

    def parts_of(self, file: Found) -> list[MeshPart]:
        """The parts of a file, in its own frame.

        Raises:
            ValueError: It is broken, or of a kind that is not read.
            OSError: It cannot be read, or would take too much memory.
        """
        if file not in self._read:
            try:
                parts, paints = self._parts_and_paints(file)
            except (ValueError, SceneError) as error:
                self._read[file] = str(error)
            else:
                first = len(self.paints)
                self.paints += paints
                self._read[file] = [replace(p, material=p.material + first) for p in parts]
        known = self._read[file]
        if isinstance(known, str):
            raise ValueError(known)
        return known

    def _parts_and_paints(self, file: Found) -> tuple[list[MeshPart], list[Paint] | list[Material]]:
        suffix = file.path.suffix.lower()
        if suffix == ".dae":
            return read_collada(
                file.path,
                lambda reference: _texture_of(file, reference),
                self._allowance,
                up="z",
            )[:2]
        if suffix in (".glb", ".gltf"):
            return read_gltf(file.path)
        if suffix in (".stl", ".obj"):
            from hypernav.worlds.scenes.mesh_files import read_mesh

            return read_mesh(file.path, up="z")
        raise ValueError(f"{suffix or file.path.name:.40} files are not read")


def _texture_of(mesh: Found, reference: str) -> Path | None:
    """A texture where the mesh says, or by its name alone where Gazebo looks for it."""
    name = PurePosixPath(reference).name
    for candidate in (reference, name, f"{_TEXTURES}/{name}"):
        found = found_beside(mesh, candidate)
        if found is not None and found.path.is_file():
            return found.path
    return None
