"""Categories from the names of nodes in 3-D files: ``SM_OfficeChair2`` is an office chair.

Exporters, asset shops and modelling tools decorate names with counters, prefixes and levels of
detail; this module removes them.
"""

import re
from functools import lru_cache

from hypernav.core.text.unicode_words import composed, is_single_letter, words_within
from hypernav.worlds.scenes.bim_names import is_of_the_building, plain_name

_FILE_SUFFIX = re.compile(
    r"\.(?:fbx|obj|dae|gltf|glb|blend|stl|ply|usdz?|cleaner.*)\b", re.IGNORECASE
)
_PREFIXES = frozenset(
    {"sm", "sk", "bp", "st", "geo", "grp", "mesh", "prop", "model", "obj", "asset", "aws"}
)
_SETTINGS = frozenset({"residential", "retail", "hospital", "warehouse", "racetrack"})
_IDENTIFIER = re.compile(r"[0-9a-f]{8}-?(?:[0-9a-f]{4}-?){3}[0-9a-f]{12}", re.IGNORECASE)
_TAILS = frozenset(
    """
    mesh geo geometry lod low lowpoly high highpoly poly model prop asset copy instance inst grp
    group material default primitive node obj object visual collision link clone
    """.split()  # noqa: SIM905
)
_MEANINGLESS = frozenset(
    """
    mesh node object objects geometry scene root group primitive default untitled cube plane
    sphere cylinder cone torus circle curve empty model world sketchfab collada armature material
    entity instance polygon polysurface surface shape component layer part static prefab
    link body base visual collision id sketch up skp product
    """.split()  # noqa: SIM905
)
_STRUCTURAL = frozenset(
    """
    wall walls floor floors flooring ceiling ceilings roof ground room house building apartment
    doorframe doorway baseboard baseboards skirting moulding molding column pillar beam
    stair stairs staircase railing handrail slab opening structure shell architecture
    """.split()  # noqa: SIM905
)
_SIDES = frozenset(
    """
    north south east west left right front back rear inner outer inside outside interior exterior
    upper lower top bottom kitchen bathroom bedroom hall hallway corridor
    """.split()  # noqa: SIM905
)
"""Words after the name of a part of the building that say which part it is."""
_STRUCTURAL_PAIRS = frozenset(
    {
        "door frame",
        "window frame",
        "skirting board",
        "crown molding",
        "door jamb",
        "wall panel",
        "ground plane",
    }
)
_SMALL_HOUSES = frozenset({"doll", "dog", "cat", "bird", "play", "toy"})
"""Words before "house" that make a thing of it."""


@lru_cache(maxsize=4096)
def words_of(name: str) -> tuple[str, ...]:
    """The words in a node's name, lower case, without additions of tools.

    ``Bed_01_001`` gives ``("bed",)``, ``dining-table.003`` gives ``("dining", "table")``,
    ``TVCabinet`` gives ``("tv", "cabinet")``.
    """
    words = words_within(_undecorated(name))
    while len(words) > 1 and (words[-1] in _TAILS or is_single_letter(words[-1])):
        words.pop()
    while len(words) > 1 and words[0] in _PREFIXES:
        words.pop(0)
    if "robomaker" in words[:-1]:  # Amazon's worlds: aws_robomaker_residential_Sofa_01
        words = words[words.index("robomaker") + 1 :]
        words = words[1:] if words[0] in _SETTINGS and len(words) > 1 else words
    return tuple(words)


def _undecorated(name: str) -> str:
    """A name without the suffix of a file and without what identifies it to machines."""
    return _FILE_SUFFIX.sub(" ", _IDENTIFIER.sub(" ", plain_name(name)))


def is_meaningful(name: str) -> bool:
    """Whether a name says what an object is, unlike ``Object_4``, ``Cube.003`` or ``RootNode``."""
    words = words_of(name)
    return any(not is_single_letter(word) and word not in _MEANINGLESS for word in words)


def is_structural(name: str) -> bool:
    """Whether a name means the building itself.

    ``RoomWall_01`` and ``wall_north`` do, ``wall clock`` does not.
    """
    if is_of_the_building(name):
        return True
    words = list(words_of(name))
    while len(words) > 1 and words[-1] in _SIDES:
        words.pop()
    if not words:
        return False
    if words[-1] == "house" and _SMALL_HOUSES.intersection(words[-2:-1]):
        return False
    return words[-1] in _STRUCTURAL or " ".join(words[-2:]) in _STRUCTURAL_PAIRS


def category_of(name: str) -> str | None:
    """Category of an object with this name; None for the building and for names without meaning."""
    if not is_meaningful(name) or is_structural(name):
        return None
    return " ".join(words_of(name))


def unique_name(name: str, taken: dict[str, int]) -> str:
    """A name that no node has yet: itself in composed form, or with a number behind it.

    Args:
        name: Name that the file gives the node.
        taken: Names that are taken, with the last number that was added to each; it gains the one
            that is returned.
    """
    name = composed(name)
    free, number = name, taken.get(name, 1)
    while free in taken:
        number += 1
        free = f"{name}#{number}"
    taken[name] = number
    taken.setdefault(free, 1)
    return free
