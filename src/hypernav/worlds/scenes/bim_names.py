"""Names that come from building information models (BIM): Revit, ArchiCAD, Bonsai, IfcConvert.

Two parts of such a name say what a thing is: the class of IFC, as in ``IfcFurniture/Chair``, and
Revit's family, the part before the first colon of ``M_Bed-Standard:1525 x 2007mm - Queen:168449``,
whose noun comes first. Sources: IFC 4.3 (ISO 16739-1), and the families of Revit's templates.
"""

import re

from hypernav.core.kind_shapes import kind_shape

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
    | (?:.*\ )?(?:railing|handrail|top\ rail|baluster|stairs?|landing|mullion|slab\ edge)
    | (?:non-)?monolithic\ run | system\ panel | ramp | gutter | fascia | roof\ soffit
    | topography | toposolid | surface | wall\ sweep | curtain\ system
    | (?:door|window|skylight|column|beam|opening)s?(?:[\s\d]*[^\w\s].*|_.*|\s*\d.*)?
    | (?:door|window|skylight|column|beam|opening)s?\ (?:.*\ )?(?:
        frame|casing|leaf|opening|sill|lintel|jamb|unit|casement|transom|int(?:erior)?|ext(?:erior)?
        |flush|glazed|glass|single|double|sliding|bifold|fixed|round|square|rectangular|concrete
        |steel|timber|wood
    )(?:\ [\d\W].*)?
    | (?:single|double|bifold|sliding|overhead|curtain\ wall)-(?:flush|panel|glass|\d).*
    | fixed | casement.* | double\ hung | .*-(?:door|window|column|beam)\b.*
    """,
    re.VERBOSE | re.IGNORECASE,
)
"""Revit's system families, and the doors, windows, columns and beams of its templates. The last
word of an English compound says what it is: a ``Door mat`` is no door."""
_KINDS_OF_THE_BUILDING = frozenset({"door", "window", "column"})


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
    if family is None or _FAMILIES_OF_THE_BUILDING.fullmatch(family) is None:
        return False
    noun = _PARTS.split(family)[0].strip().lower()  # Refrigerator-Two-Door
    return kind_shape(noun) is None or noun.split()[-1].rstrip("s") in _KINDS_OF_THE_BUILDING


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
