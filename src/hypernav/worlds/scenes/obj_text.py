"""Text of OBJ files, put into the form that trimesh reads: one object per name, counted indices."""

import re
from dataclasses import dataclass

import numpy as np

from hypernav.core.words import composed
from hypernav.worlds.scenes.polygons import triangles_of_polygons

_NAME_LINE = re.compile(rb"^[ \t]*([og])(?:[ \t]+([^\r\n]*?))?[ \t]*\r?$", re.MULTILINE)
_RELATIVE = re.compile(rb"^[ \t]*f[ \t][^\r\n]*?[ \t/]-", re.MULTILINE)
_INDEX = re.compile(rb"-\d+")
_POLYGON = re.compile(rb"^[ \t]*f[ \t]+(\S+(?:[ \t]+\S+){3,})[ \t]*\r?$", re.MULTILINE)
_VERTEX = re.compile(rb"^[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE)
_MARK = re.compile(r"object (\d+) ")


@dataclass(frozen=True)
class ObjText:
    """An OBJ file whose objects are called by numbers.

    trimesh puts an object's name and its material's into one; a number can be found in it again.

    Attributes:
        content: The text for trimesh.
        names: Names of the objects, by number; empty for a file without any.
    """

    content: bytes
    names: tuple[str, ...] = ()

    @staticmethod
    def of(content: bytes) -> "ObjText":
        """The text of a file.

        Objects are what ``o`` names; if it names no more than one, what ``g`` names.
        """
        if _RELATIVE.search(content):
            content = _with_absolute_indices(content)
        content = _with_triangles(content)
        named: dict[bytes, dict[bytes, int]] = {b"o": {}, b"g": {}}
        for line in _NAME_LINE.finditer(content):
            numbers = named[line[1]]
            numbers.setdefault(line[2] or b"", len(numbers))
        letter = b"g" if len(named[b"o"]) <= 1 and named[b"g"] else b"o"
        numbers = named[letter]
        if not numbers:
            return ObjText(content)

        def numbered(line: re.Match[bytes]) -> bytes:
            return b"o object %d " % numbers[line[2] or b""] if line[1] == letter else b""

        names = (composed(name.decode("utf-8", errors="replace")) for name in numbers)
        return ObjText(_NAME_LINE.sub(numbered, content), tuple(names))

    def name_of(self, geometry: str) -> str:
        """The object that trimesh's name of a geometry means; itself for a file without names."""
        mark = _MARK.match(f"{geometry.replace('_', ' ')} ") if self.names else None
        return geometry if mark is None else self.names[int(mark[1])] or geometry


def _with_absolute_indices(content: bytes) -> bytes:
    """The text with indices from the beginning, where faces count back from their own line."""
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    lines = content.split(b"\n")
    for k, line in enumerate(lines):
        word, _, rest = line.strip().partition(b" ")
        if word in counts:
            counts[word] += 1
        elif word == b"f" and b"-" in rest:
            lines[k] = b"f " + b" ".join(_absolute(corner, counts) for corner in rest.split())
    return b"\n".join(lines)


def _with_triangles(content: bytes) -> bytes:
    """The text with triangles in place of polygons, of which trimesh makes fans."""
    polygons = [line[1].split() for line in _POLYGON.finditer(content)]
    if not polygons:
        return content
    counts = np.array([len(corners) for corners in polygons], dtype=np.int64)
    corners = [corner for polygon in polygons for corner in polygon]
    try:
        vertices = np.array([line.groups() for line in _VERTEX.finditer(content)]).astype(float)
        used = np.array([corner.partition(b"/")[0] for corner in corners]).astype(np.int64)
        points = vertices[used - 1]
    except (ValueError, LookupError):
        return content  # trimesh says what is wrong with it
    triangles = triangles_of_polygons(counts, points)
    owner = np.repeat(np.arange(len(counts)), counts)[triangles[:, 0]]
    lines: list[list[bytes]] = [[] for _ in polygons]
    for k, numbers in zip(owner.tolist(), triangles.tolist(), strict=True):
        lines[k].append(b"f " + b" ".join(corners[number] for number in numbers))
    replacing = iter(lines)
    return _POLYGON.sub(lambda _: b"\n".join(next(replacing)), content)


def _absolute(corner: bytes, counts: dict[bytes, int]) -> bytes:
    indices = zip(corner.split(b"/"), counts.values(), strict=False)
    return b"/".join(
        b"%d" % (count + 1 + int(text)) if _INDEX.fullmatch(text) else text
        for text, count in indices
    )
