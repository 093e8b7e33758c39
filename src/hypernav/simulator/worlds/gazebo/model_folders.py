"""The files of a Gazebo world: where they are, and the mesh files among them, each read once.

They lie beside the world, and where Gazebo itself would look.
"""

import os
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from hypernav.core.errors import SceneError
from hypernav.io.parsing import parse_xml
from hypernav.io.reading import Allowance, path_below, read_file
from hypernav.simulator.worlds.scenes.collada import read_collada
from hypernav.simulator.worlds.scenes.gltf import read_gltf
from hypernav.simulator.worlds.scenes.material_images import Paint
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart
from hypernav.simulator.worlds.scenes.scene import Material

VARIABLES = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH")
_LEVELS_UP = 4
_FUEL = re.compile(
    r"https?://([^/]+)/(?:[\d.]+/)?([^/]+)/models/([^/]+)(?:/(?:tip/)?files)?(/.*)?$"
)
_FUEL_FOLDERS = (".gz/fuel", ".ignition/fuel")
_SCHEME = re.compile(r"(?:model|package|file)://+")
_TEXTURES = "../materials/textures"


@dataclass(frozen=True)
class Found:
    """A file or folder with the folder that what it names must not leave."""

    path: Path
    root: Path


class ModelFolders:
    """The folders in which the models of a world are looked for, in order.

    They are the folders that hold the world, up to four levels, with what is called ``models`` in
    them; those that Gazebo's own variables list; and ``~/.gazebo/models``. What Gazebo has
    downloaded from Fuel is found, too.
    """

    def __init__(self, world: Path) -> None:
        """Look around."""
        around = list(world.resolve().parents)[:_LEVELS_UP]
        named = [Path(item) for name in VARIABLES for item in _listed(name)]
        beside = [folder for above in around for folder in (above, *_models_in(above))]
        self._roots: list[Path] = [*beside, *named, Path.home() / ".gazebo" / "models"]

    def find(self, uri: str, user: Found) -> Found | None:
        """The file or folder that a URI names, or None.

        Args:
            uri: ``model://NAME/…``, ``package://NAME/…``, ``file://…``, or a path beside the user.
            user: File that names it.
        """
        fuel = _FUEL.match(uri)
        if fuel is not None:
            return _downloaded(*fuel.groups())
        scheme = _SCHEME.match(uri)
        if scheme is None:
            return None if ":" in uri else found_beside(user, uri)
        reference = uri[scheme.end() :]
        for root in self._roots:
            found = _below(root, reference)
            if found is not None:
                return found
        return None


def found_beside(user: Found, reference: str) -> Found | None:
    """What a file names by its path from it, or None."""
    beside = os.path.relpath(user.path.parent, user.root)
    return _below(user.root, f"{beside}/{reference}")


def sdf_of(model: Found, allowance: Allowance) -> Found | None:
    """The SDF file of a model's folder: the newest that its ``model.config`` names, or None."""
    if not model.path.is_dir():
        return model
    names = ["model.sdf"]
    try:
        config = parse_xml(read_file(model.path / "model.config"), allowance)
    except (OSError, ValueError):
        config = ElementTree.Element("model")
    listed = [item for item in config.iter("sdf") if item.text]
    listed.sort(key=lambda item: _version(item.get("version", "")), reverse=True)
    names = [*((item.text or "").strip() for item in listed), *names]
    for name in names:
        found = found_beside(Found(model.path / "model.config", model.root), name)
        if found is not None:
            return found
    return None


def _downloaded(host: str, owner: str, model: str, rest: str | None) -> Found | None:
    """The newest version of a model that Gazebo has downloaded, or a file of it; or None."""
    names = dict.fromkeys((model.lower(), unquote(model).lower()))
    for folder, name in product(_FUEL_FOLDERS, names):
        kept = _below(Path.home() / folder, f"{host}/{owner.lower()}/models/{name}")
        if kept is None or not kept.path.is_dir():
            continue
        versions = sorted(kept.path.glob("[0-9]*"), key=lambda path: _version(path.name))
        found = _below(versions[-1], f".{rest or ''}") if versions else None
        if found is not None:
            return found
    return None


def _version(text: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d{1,9}", text))


def _below(root: Path, reference: str) -> Found | None:
    try:
        path = path_below(root, reference)
        return Found(path, root) if path.exists() else None
    except OSError:  # It leads out of the folder, or no file can be called so.
        return None


def _listed(variable: str) -> list[str]:
    return [item for item in os.environ.get(variable, "").split(os.pathsep) if item]


def _models_in(folder: Path) -> list[Path]:
    try:
        return sorted(item for item in folder.iterdir() if "models" in item.name and item.is_dir())
    except OSError:
        return []


class Meshes:
    """Mesh files by their paths, with one list of materials for all."""

    def __init__(self, allowance: Allowance) -> None:
        """Begin with no file."""
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
                file.path, lambda reference: _texture_of(file, reference), self._allowance, up="z"
            )[:2]
        if suffix in (".glb", ".gltf"):
            return read_gltf(file.path)
        if suffix in (".stl", ".obj"):
            from hypernav.simulator.worlds.scenes.mesh_files import read_mesh

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
