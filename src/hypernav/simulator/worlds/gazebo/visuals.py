"""What a Gazebo world shows without mesh files: simple shapes, and colours of its visuals."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float64

from hypernav.io.reading import read_file, text_of
from hypernav.simulator.worlds.gazebo.model_folders import Found, ModelFolders, found_beside
from hypernav.simulator.worlds.scenes.collada import color_of, numbers_of
from hypernav.simulator.worlds.scenes.material_images import Paint
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart

_SIDES = 24
_ENDLESS_M = 100.0
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_BOX_SIDES = ((0, 1), (1, 2), (2, 0))
_MOST_BYTES = 1_000_000
_WORDS = re.compile(r"^\s*(material|diffuse|texture)\s+(.+?)\s*$", re.MULTILINE)
_COLORS = {
    "grey": (0.7, 0.7, 0.7),
    "darkgrey": (0.18, 0.18, 0.18),
    "white": (1.0, 1.0, 1.0),
    "flatblack": (0.1, 0.1, 0.1),
    "black": (0.1, 0.1, 0.1),
    "red": (1.0, 0.0, 0.0),
    "green": (0.0, 1.0, 0.0),
    "blue": (0.0, 0.0, 1.0),
    "yellow": (1.0, 1.0, 0.0),
    "orange": (1.0, 0.5, 0.1),
    "purple": (1.0, 0.0, 1.0),
    "turquoise": (0.0, 1.0, 1.0),
    "skyblue": (0.1, 0.7, 1.0),
    "indigo": (0.3, 0.0, 0.5),
    "gold": (0.8, 0.65, 0.1),
    "wood": (0.6, 0.42, 0.25),
    "woodfloor": (0.65, 0.48, 0.3),
    "woodpallet": (0.7, 0.55, 0.35),
    "bricks": (0.6, 0.35, 0.28),
    "ceilingtiled": (0.85, 0.85, 0.82),
    "grass": (0.3, 0.5, 0.2),
    "road": (0.35, 0.35, 0.35),
    "asphalt": (0.3, 0.3, 0.3),
    "residential": (0.6, 0.6, 0.6),
}
"""What Gazebo's own materials look like, by their names without ``Gazebo/``."""


def shape_of(geometry: ElementTree.Element) -> MeshPart | None:
    """The triangles of a simple shape; None if there is none in this element.

    Args:
        geometry: An element ``geometry``.

    Raises:
        ValueError: A size is no number.
    """
    for kind in geometry:
        if kind.tag == "box":
            return _box(_sizes(kind, "size", (1.0, 1.0, 1.0)))
        if kind.tag == "plane":
            return _plane(kind)
        if kind.tag in ("cylinder", "cone", "capsule"):
            (radius,) = _sizes(kind, "radius", (1.0,))
            (length,) = _sizes(kind, "length", (1.0,))
            return _round(kind.tag, radius, length)
        if kind.tag == "sphere":
            (radius,) = _sizes(kind, "radius", (1.0,))
            return _ball(np.full(3, radius))
        if kind.tag == "ellipsoid":
            return _ball(_sizes(kind, "radii", (1.0, 1.0, 1.0)))
    return None


def endless_ground() -> MeshPart:
    """Gazebo's own model ``ground_plane``."""
    return _quads([_rectangle(2, 0, 1, np.array([_ENDLESS_M, _ENDLESS_M, 0.0]), 0.0)], _ENDLESS_M)


def _sizes(
    kind: ElementTree.Element, name: str, default: tuple[float, ...]
) -> Float64[np.ndarray, "n"]:
    values = numbers_of(kind.findtext(name))
    if not len(values):
        return np.array(default)
    if len(values) != len(default):
        raise ValueError(f"{name} has {len(values)} numbers, expected {len(default)}")
    return values


def _box(size: Float64[np.ndarray, "3"]) -> MeshPart:
    sides = []
    for u, v in _BOX_SIDES:
        w = 3 - u - v
        front = _rectangle(w, u, v, size, size[w] / 2.0)
        back = _rectangle(w, u, v, size, -size[w] / 2.0)[[3, 2, 1, 0]]
        sides += [front, back]
    return _quads(sides, 1.0)


def _rectangle(
    w: int, u: int, v: int, size: Float64[np.ndarray, "3"], at: float
) -> Float64[np.ndarray, "4 3"]:
    """Corners of a rectangle along axes `u` and `v`, at a place along axis `w`."""
    corners = np.zeros((4, 3))
    corners[:, u] = (_SQUARE[:, 0] - 0.5) * size[u]
    corners[:, v] = (_SQUARE[:, 1] - 0.5) * size[v]
    corners[:, w] = at
    return corners


def _plane(kind: ElementTree.Element) -> MeshPart:
    width, length = _sizes(kind, "size", (1.0, 1.0))
    normal = _sizes(kind, "normal", (0.0, 0.0, 1.0))
    flat = _quads([_rectangle(2, 0, 1, np.array([width, length, 0.0]), 0.0)], max(width, length))
    turn = np.asarray(trimesh.geometry.align_vectors((0.0, 0.0, 1.0), normal))[:3, :3]
    if abs(normal[0]) + abs(normal[1]) < 1e-9 and normal[2] > 0.0:
        return flat
    return _part(flat.vertices @ turn.T, flat.faces, flat.uv)


def _quads(sides: list[Float64[np.ndarray, "4 3"]], repeats: float) -> MeshPart:
    starts = 4 * np.arange(len(sides))[:, None, None]
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.tile(_SQUARE[halves] * repeats, (len(sides), 1, 1))
    return _part(np.concatenate(sides), (starts + halves).reshape(-1, 3), uv)


def _round(kind: str, radius: float, length: float) -> MeshPart:
    if kind == "cylinder":
        mesh = trimesh.creation.cylinder(radius, length, sections=_SIDES)
    elif kind == "cone":
        mesh = trimesh.creation.cone(radius, length, sections=_SIDES)
        mesh.apply_translation((0.0, 0.0, -length / 2.0))
    else:
        mesh = trimesh.creation.capsule(length, radius, count=[_SIDES, _SIDES])
        mesh.apply_translation((0.0, 0.0, -length / 2.0 - min(mesh.bounds[0][2] + radius, 0.0)))
    return _part(mesh.vertices, mesh.faces, None)


def _ball(radii: Float64[np.ndarray, "3"]) -> MeshPart:
    mesh = trimesh.creation.icosphere(subdivisions=2)
    return _part(mesh.vertices * radii, mesh.faces, None)


def _part(vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray | None) -> MeshPart:
    return MeshPart(
        "",
        "",
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(faces, dtype=np.int32),
        0,
        None if uv is None else np.asarray(uv, dtype=np.float32),
    )


def paint_of(
    material: ElementTree.Element | None, folders: ModelFolders, user: Found
) -> Paint | None:
    """The paint that a visual has of its own; None leaves that of its mesh.

    Args:
        material: Its element ``material``.
        folders: Where files are looked for.
        user: SDF file that holds it.

    Raises:
        ValueError: A colour is no number.
    """
    if material is None:
        return None
    albedo = (material.findtext("pbr/metal/albedo_map") or "").strip()
    if albedo:
        found = folders.find(albedo, user)
        return Paint("albedo", (0.8, 0.8, 0.8), albedo, None if found is None else found.path)
    name = (material.findtext("script/name") or "").strip()
    scripts = [item.text or "" for item in material.iterfind("script/uri")]
    if name and (scripted := _scripted(name, scripts, folders, user)) is not None:
        return scripted
    known = _COLORS.get(name.removeprefix("Gazebo/").lower())
    if known is not None:
        return Paint(name, known)
    if (text := material.findtext("diffuse") or material.findtext("ambient")) is not None:
        return Paint("diffuse", color_of(text))
    return None


def _scripted(name: str, uris: list[str], folders: ModelFolders, user: Found) -> Paint | None:
    """A material of Ogre's scripts."""
    places = [place for uri in uris if (place := folders.find(uri.strip(), user)) is not None]
    for place in places:
        for script in _scripts_at(place.path):
            found = _read_script(script, name)
            if found is None:
                continue
            color, texture = found
            beside = [*places, Found(script.parent, place.root)]
            return Paint(name, color, texture, _texture(texture, beside) if texture else None)
    return None


def _scripts_at(path: Path) -> Iterator[Path]:
    yield from sorted(path.glob("*.material")) if path.is_dir() else [path]


def _read_script(path: Path, wanted: str) -> tuple[tuple[float, float, float], str] | None:
    """Colour and texture of a material; None if the script hasn't it."""
    try:
        text = text_of(read_file(path, most=_MOST_BYTES), errors="replace")
    except OSError:
        return None
    color, texture, is_wanted, was_found = (0.8, 0.8, 0.8), "", False, False
    for word, rest in _WORDS.findall(text):
        if word == "material":
            is_wanted = rest.split(":")[0].strip(' {"') == wanted
            was_found |= is_wanted
        elif is_wanted and word == "diffuse":
            color = color_of(rest) if rest[0].isdigit() else color
        elif is_wanted and not texture:
            texture = rest.split()[0]
    return (color, texture) if was_found else None


def _texture(name: str, places: list[Found]) -> Path | None:
    for place in places:
        inside = Found(place.path / "_", place.root)
        for reference in (name, f"../textures/{name}"):
            found = found_beside(inside, reference)
            if found is not None:
                return found.path
    return None
