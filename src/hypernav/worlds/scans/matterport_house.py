"""The annotations of a Matterport3D scene: ``*.house``, version ASCII 1.1.

A line is a record; its first letter is the kind. Like habitat-sim (Mp3dSemanticScene.cpp), this
reads regions, categories and objects::

    R region level 0 0 label  px py pz …
    C category mapping_index mapping_name mpcat40_index mpcat40_name …
    O object region category  px py pz …
"""

from collections.abc import Sequence
from pathlib import Path

from hypernav.core.errors import SceneError
from hypernav.io.reading import read_file, text_of
from hypernav.worlds.scans.semantic_text import Annotation

HEADER = "ASCII 1.1"

_MOST_BYTES = 200_000_000
"""Largest size of a file; the largest house has some 20 MB, mostly segments."""
_NOTHING = "unknown"


def read_house(path: Path) -> list[Annotation]:
    """Read the objects of a scene; an object's mark is its number.

    An object is named as in the episode files, by level, region and number: ``0_4_89``. Its
    category is that of ObjectNav (mpcat40), and the annotator's own word is a further name.

    Args:
        path: A ``*.house`` file.

    Raises:
        SceneError: The file cannot be read, or a line is no record.
    """
    try:
        text = text_of(read_file(path, most=_MOST_BYTES), errors="replace")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    header, *lines = text.splitlines() or [""]
    if header.strip() != HEADER:
        raise SceneError(
            f"{path}: holds no annotations: expected the first line {HEADER!r}, got {header!r:.60}"
        )
    levels: dict[int, int] = {}
    categories: dict[int, tuple[str, str]] = {}
    found: dict[int, Annotation] = {}
    for number, line in enumerate(lines, start=2):
        fields = line.split()
        try:
            match fields[:1]:
                case ["R"]:
                    levels[int(fields[1])] = int(fields[2])
                case ["C"]:
                    categories[int(fields[1])] = _words(fields[5]), _words(fields[3])
                case ["O"]:
                    annotation = _object(fields, levels, categories)
                    found.setdefault(annotation.id, annotation)
        except (ValueError, IndexError) as error:
            raise SceneError(
                f"{path}: line {number} is no record of a house: {line!r:.80}; download the file "
                "again"
            ) from error
    return list(found.values())


def _object(
    fields: Sequence[str], levels: dict[int, int], categories: dict[int, tuple[str, str]]
) -> Annotation:
    number, region, category = (int(field) for field in fields[1:4])
    if number < 0:
        raise ValueError("objects are counted from 0")
    name = f"{levels[region]}_{region}_{number}" if region in levels else f"_{number}"
    common, own = categories.get(category, (_NOTHING, _NOTHING))
    return Annotation(number, number, name, common, () if own == common else (own,))


def _words(name: str) -> str:
    """A category with spaces in place of ``#`` and ``_``."""
    return name.replace("#", " ").replace("_", " ").strip() or _NOTHING
