"""Categories from the names of nodes in 3-D files: ``SM_OfficeChair2`` is an office chair.

Exporters, asset shops and modelling tools decorate names with counters, prefixes and levels of
detail; this module removes them.

In names that come from building information models (BIM: Revit, ArchiCAD, Bonsai, IfcConvert) two
parts say what a thing is: the class of IFC, as in ``IfcFurniture/Chair``, and Revit's family, the
part before the first colon of ``M_Bed-Standard:1525 x 2007mm - Queen:168449``, whose noun comes
first. Sources: IFC 4.3 (ISO 16739-1), and the families of Revit's templates.
"""

import re
from functools import lru_cache

from hypernav.core.naming.kind_shapes import kind_shape
from hypernav.core.naming.words import composed, is_single_letter, words_within

_CLASS = re.compile(r"^(?:Ifc|IFC)([A-Z][A-Za-z0-9]*)(?:[/:_\s#-]+(.*))?$", re.DOTALL)
_ELEMENT_ID = re.compile(r"\s*\[\d+\]\s*$|:\s*-?\d+(?:[:\s_#.].*)?$")
_SIZE = re.compile(r"\b\d[\d.,'\"]*\s*(?:x\s*\d[\d.,'\"]*\s*)*(?:mm|cm|m|in|ft)?\b", re.IGNORECASE)
_REST = re.compile(r"\b(?:w|with|and)\b.*$", re.IGNORECASE)
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z][a-z]+")
_PARTS = re.compile(r"[-_,]")
_ANY_THING = frozenset({"furniture", "furnishing", "casework", "fixture", "equipment"})
_GLOBAL_ID = re.compile(r"(?<![\w$])[0-3](?=[\w$]*[A-Z])(?=[\w$]*[a-z])[0-9A-Za-z_$]{21}(?![\w$])")

_CLASSES_OF_THE_BUILDING = frozenset(
    """
    Annotation Beam BeamStandardCase Bearing BuildingElementPart Building BuildingStorey Chimney
    Column ColumnStandardCase Covering CurtainWall Door DoorStandardCase Earthworks
    EarthworksElement Footing GeographicElement Grid Kerb Member MemberStandardCase OpeningElement
    OpeningStandardCase Pavement Pile Plate PlateStandardCase Project Railing Ramp RampFlight
    ReinforcingBar ReinforcingMesh Roof ShadingDevice Site Slab SlabElementedCase SlabStandardCase
    Space Stair StairFlight VirtualElement Wall WallElementedCase WallStandardCase Window
    WindowStandardCase
    """.lower().split()
)
_CLASSES_THAT_SAY_LITTLE = frozenset(
    """
    BuildingElementProxy CivilElement DiscreteAccessory DistributionElement ElementAssembly
    EnergyConversionDevice FlowController FlowTerminal FurnishingElement Furniture
    SystemFurnitureElement TransportElement
    """.lower().split()
)
_FAMILIES_OF_THE_BUILDING = re.compile(
    r"""
    (?:basic|stacked|curtain|retaining)\ wall | .*\bwall\ foundation | foundation\ slab
    | (?:basic|sloped)\ (?:roof|glazing) | (?:basic|compound)\ ceiling | floor | roof | pad
    | (?:.*\ )?(?:railing|handrail|top\ rail|stairs?|landing|mullion|slab\ edge)
    | (?:.*\ )?baluster.* | curtain\ wall\ .*
    | (?:non-)?monolithic\ run | system\ panel | ramp | gutter | fascia | roof\ soffit
    | topography | toposolid | surface | wall\ sweep | curtain\ system
    | (?:door|window|skylight|column|beam|opening)s?(?:[\s\d]*[^\w\s].*|_.*|\s*\d.*)?
    | (?:door|window|skylight|column|beam|opening)s?\ (?:.*\ )?(?:
        frame|casing|leaf|opening|sill|lintel|jamb|unit|casement|transom|int(?:erior)?|ext(?:erior)?
        |flush|glazed|glass|single|double|sliding|bifold|fixed|round|square|rectangular|concrete
        |steel|timber|wood
    )(?:\ [\d\W].*)?
    | (?:single|double|bifold|sliding|overhead|curtain\ wall)-(?:
        flush|panel|raised\ panel|glass|closet|sectional|\d
    ).*
    | fixed | casement.* | (?:double|single)\ hung | slider | awning.* | archtop
    | .*[-\ ]doors? | .*-(?:door|window|column|beam)\b.*
    """,
    re.VERBOSE | re.IGNORECASE,
)
"""Revit's system families, and the doors, windows, columns and beams of its templates. The last
word of an English compound says what it is: a ``Door mat`` is no door."""
_KINDS_OF_THE_BUILDING = frozenset({"door", "window", "column", "wall"})
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


def plain_name(name: str) -> str:
    """What a name of a model calls a thing, its noun last; other names stay as they are.

    ``M_Table-Coffee:600 x 600 x 600mm:1234`` is a ``Coffee Table``. Where the name says nothing
    more, ``IfcLightFixture/2O2Fr$t4X7Zf8NOew3FLOH`` is a ``Light Fixture``.
    """
    name = _GLOBAL_ID.sub(" ", name)
    if (found := _CLASS.match(name)) is None:
        return _of_family(name) or name
    kind, rest = found[1], (found[2] or "").strip()
    rest = _of_family(rest) or rest
    if re.search(r"[^\W\d_]", rest):
        return rest
    return "" if kind.lower() in _CLASSES_THAT_SAY_LITTLE else " ".join(_WORDS.findall(kind))


def is_of_the_building(name: str) -> bool:
    """Whether a name of a model means the building itself: walls, slabs, stairs, doors, windows."""
    if (found := _CLASS.match(name)) is not None:
        return found[1].lower() in _CLASSES_OF_THE_BUILDING
    family = _family_in(name)
    if family is None:
        return False
    family = _REST.sub("", family).strip()
    if _FAMILIES_OF_THE_BUILDING.fullmatch(family) is None:
        return False
    noun = _PARTS.split(family)[0].strip().lower()  # Refrigerator-Two-Door
    words = {word.rstrip("s") for word in noun.split()}  # curtain wall dbl glass
    return kind_shape(noun) is None or not words.isdisjoint(_KINDS_OF_THE_BUILDING)


def _family_in(name: str) -> str | None:
    """Revit's family in a name, without the prefix of metric ones; None if there is none.

    A name has one if its number follows (``Chair:Task:1234``, ``Chair [1234]``), or if it has a
    colon and spaces: the colons of modelling tools separate namespaces without any.
    """
    plain = _ELEMENT_ID.sub("", name)
    has_number = plain != name and (":" in plain or "[" in name)
    if "::" in name or not (has_number or (":" in name and " " in name)):
        return None
    return re.sub(r"^M_", "", plain.partition(":")[0]).strip()


def _of_family(name: str) -> str | None:
    family = _family_in(name)
    if family is None:
        return None
    noun, *kinds = (part.strip() for part in _PARTS.split(_SIZE.sub(" ", _REST.sub("", family))))
    if noun.casefold() in _ANY_THING and kinds:
        noun, *kinds = kinds
    first = " ".join(kinds).split()[:1]
    return " ".join((*first, noun)) if noun else " ".join(kinds)


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
