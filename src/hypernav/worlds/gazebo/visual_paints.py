"""Colours and textures that a Gazebo world gives its visuals."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hypernav.io.reading import read_file, text_of
from hypernav.worlds.collada.triangles import numbers_of
from hypernav.worlds.gazebo.model_folders import Found, ModelFolders, found_beside
from hypernav.worlds.scenes.paints import Paint

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
        return Paint("diffuse", _color(text))
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
            color = _color(rest) if rest[0].isdigit() else color
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


def _color(text: str) -> tuple[float, float, float]:
    values = np.nan_to_num(numbers_of(" ".join(text.split()[:3]))).clip(0.0, 1.0).tolist()
    red, green, blue = [*values, 0.0, 0.0, 0.0][:3]
    return red, green, blue
