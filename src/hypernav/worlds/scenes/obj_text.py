"""Text of OBJ files, put into the form that trimesh reads: one object per name, counted indices."""

import re
from dataclasses import dataclass

from hypernav.core.text.unicode_words import composed

_NAME_LINE = re.compile(rb"^[ \t]*([og])(?:[ \t]+([^\r\n]*?))?[ \t]*\r?$", re.MULTILINE)
_RELATIVE = re.compile(rb"^[ \t]*f[ \t][^\r\n]*?[ \t/]-", re.MULTILINE)
_INDEX = re.compile(rb"-\d+")
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


def _absolute(corner: bytes, counts: dict[bytes, int]) -> bytes:
    indices = zip(corner.split(b"/"), counts.values(), strict=False)
    return b"/".join(
        b"%d" % (count + 1 + int(text)) if _INDEX.fullmatch(text) else text
        for text, count in indices
    )
