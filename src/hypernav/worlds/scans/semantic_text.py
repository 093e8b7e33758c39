"""The annotations of an HM3D scene: ``*.semantic.txt``."""

from dataclasses import dataclass
from pathlib import Path

from hypernav.core.errors import SceneError
from hypernav.io.reading import read_file, text_of

HEADER = "HM3D Semantic Annotations"

_MOST_BYTES = 20_000_000
_MOST_ANNOTATIONS = 65_535
"""habitat-sim keeps the numbers of instances in 16 bits."""


@dataclass(frozen=True)
class Annotation:
    """One instance of a scan.

    Attributes:
        id: Number in the file; episode files identify their goals by it.
        mark: Mark of the instance in the semantic mesh: a colour ``0xRRGGBB``, or a number.
        name: Name of the instance, composed as by habitat-sim.
        category: Category in the annotator's own words.
        synonyms: Further names of the category.
    """

    id: int
    mark: int
    name: str
    category: str
    synonyms: tuple[str, ...] = ()


def read_annotations(path: Path) -> list[Annotation]:
    """Read the annotations of a scene.

    After the header every line is ``id,RRGGBB,"category",region``. A category may contain commas
    and quotes, so everything between the second and the last comma is the category. If two lines
    have the same colour, the first counts, as in habitat-sim (HM3DSemanticScene.cpp).

    Args:
        path: A ``*.semantic.txt`` file.

    Raises:
        SceneError: The file cannot be read, or a line is no annotation.
    """
    try:
        text = text_of(read_file(path, most=_MOST_BYTES), errors="replace")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    header, *lines = text.splitlines() or [""]
    if HEADER not in header:
        raise SceneError(
            f"{path}: holds no annotations: expected the first line {HEADER!r}, got {header!r:.60}"
        )
    if len(lines) > _MOST_ANNOTATIONS:
        raise SceneError(
            f"{path}: has {len(lines):,} lines, at most {_MOST_ANNOTATIONS:,} are read; is it the "
            "annotation of one scene?"
        )
    found: dict[int, Annotation] = {}
    for number, line in enumerate(lines, start=2):
        if line.strip():
            annotation = _annotation(path, number, line)
            found.setdefault(annotation.mark, annotation)
    return list(found.values())


def _annotation(path: Path, number: int, line: str) -> Annotation:
    head, comma, region = line.rpartition(",")
    try:
        identity, color, category = head.split(",", maxsplit=2)
        if not comma or len(color.strip()) != 6:
            raise ValueError("too few commas, or no colour")
        int(region)
        own = _unquoted(category)
        return Annotation(int(identity), int(color, 16), f"{own}_{int(identity)}", own)
    except ValueError as error:
        raise SceneError(
            f'{path}: line {number} is no annotation: expected id,RRGGBB,"category",region, got '
            f"{line!r:.80}; download the file again"
        ) from error


def _unquoted(category: str) -> str:
    """The category without surrounding quotes; doubled quotes inside become one."""
    text = category.strip()
    if len(text) >= 2 and text[0] == text[-1] == '"':
        text = text[1:-1]
    return text.replace('""', '"').strip() or "unknown"
