"""Sizes and places of some 200 kinds of things (``kind_shapes.txt``), from common dimensions.

Ranges are wide, since what lies outside is refuted: they span what shops sell and what homes,
offices and shops hold, from children's to oversized pieces. The table holds COCO's indoor classes,
HM3D's six goals, usual names of OVON and all things of the generated buildings. Supports of
plants, widths of chairs and some faces were corrected after a look at detections in training
buildings (`benchmarks/shape_evidence.py`).
"""

from dataclasses import dataclass
from importlib.resources import files
from typing import Literal

from hypernav.core.naming.labels import canonical, names_of

Support = Literal["floor", "flat", "on", "wall", "ceiling", ""]
Face = Literal["level", "upright", ""]


@dataclass(frozen=True)
class KindShape:
    """Size and place of a kind of thing.

    Attributes:
        support: Where it is: stands on the "floor", lies "flat" on it, stands "on" something or on
            the floor, hangs on a "wall" or stands before it, hangs from the "ceiling"; empty if it
            may be anywhere.
        height_m: Least and greatest height, metres, without what it stands on or hangs from.
        long_m: Least and greatest of its longer horizontal extent, metres.
        face: "level" if it has a level top, "upright" if it shows a flat upright face, which its
            neighbours may continue, as of built-in units.
    """

    support: Support
    height_m: tuple[float, float]
    long_m: tuple[float, float]
    face: Face = ""


def kind_shape(name: str) -> KindShape | None:
    """What is known of a kind; None for one that is not in the table.

    A synonym counts ("couch" for "sofa"), and so does the head noun ("dining chair" for "chair").
    """
    words = canonical(name).split()[-_MOST_WORDS:]
    tails = (canonical(" ".join(words[k:])) for k in range(len(words)))
    return next((KINDS[tail] for tail in tails if tail in KINDS), None)


def _parsed(table: str) -> dict[str, KindShape]:
    kinds: dict[str, KindShape] = {}
    support: Support = ""
    for line in table.strip().splitlines():
        match line.split():
            case ["floor" | "flat" | "on" | "wall" | "ceiling" | "anywhere" as place]:
                support = "" if place == "anywhere" else place
            case [*name, height, long, "level" | "upright" as face]:
                kinds[canonical(" ".join(name))] = KindShape(
                    support, _range(height), _range(long), face
                )
            case [*name, height, long]:
                kinds[canonical(" ".join(name))] = KindShape(support, _range(height), _range(long))
    return kinds


def _range(text: str) -> tuple[float, float]:
    low, _, high = text.partition("-")
    return float(low), float(high)


KINDS = _parsed(files("hypernav.core.naming").joinpath("kind_shapes.txt").read_text("utf-8"))
"""The table: under each place the kinds with height, longer extent, and face."""
_MOST_WORDS = max(len(name.split()) for kind in KINDS for name in names_of(kind))
