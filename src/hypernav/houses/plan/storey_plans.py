"""Random floor plans of buildings with two or three storeys.

Every storey has a hall or corridor with rooms on both sides, of its own sizes within the same outer
walls, and the stairwell at the end of the hall. In some buildings an opening in its middle goes
through all storeys, so that one looks down from galleries.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from hypernav.houses.plan.circulation import Circulation, WindowRule, sample_doors, sample_windows
from hypernav.houses.plan.shapes import WALL_M, FloorPlan, Rect, Stairwell, named_rooms
from hypernav.houses.plan.stairs import StairShape, sample_shape, stairwell
from hypernav.houses.plan.strips import Cell, StripProgram, Width, fill_strip, snapped
from hypernav.houses.plan.windows import sample_entrance
from hypernav.houses.random_stream import RandomStream

SLAB_M = 0.2
"""Thickness of the floors between storeys, metres."""

_ATRIUM_SHARE = 0.25
_GALLERY_M = 1.1
"""Width of a gallery beside an atrium, metres."""
_GALLERY_END_M = 2.2
"""Length of the hall beyond an atrium, metres."""
_ATTEMPTS = 1000
_HEIGHTS_M = (2.4, 2.6, 2.8)
"""Heights of rooms. With the slab they are multiples of 0.2 m, the height of the voxels of
Habitat's navigation meshes, so that all storeys lie equally well on a mesh."""

_Fillers = Sequence[tuple[str, float]]


@dataclass(frozen=True)
class StoreyProgram:
    """The rooms of buildings of one use.

    Attributes:
        hall: Kind of the room in the middle of every storey.
        basement: Rooms of a basement; the first half lies on one side of the hall.
        ground: Rooms of the storey with the entrance.
        upper: Rooms of the storeys above.
        fillers: Kinds that fill the rest, by storey in the same order, with their weights.
        widths: Width of every kind.
        long: Least and greatest length of the hall, metres.
    """

    hall: str
    basement: Sequence[str]
    ground: Sequence[str]
    upper: Sequence[str]
    fillers: tuple[_Fillers, _Fillers, _Fillers]
    widths: Mapping[str, Width]
    long: tuple[float, float]


HOME_STOREYS = StoreyProgram(
    "hall",
    ("laundry", "storage", "office", "bathroom"),
    ("living room", "kitchen", "dining room", "bathroom"),
    ("bedroom", "bathroom", "bedroom", "office"),
    (
        (("storage", 1.0), ("office", 1.0)),
        (("office", 1.0), ("bedroom", 1.0)),
        (("bedroom", 2.0), ("office", 1.0), ("storage", 0.5)),
    ),
    {
        "living room": Width(4.0, 5.4, 8.0),
        "kitchen": Width(2.8, 3.6, 5.5),
        "dining room": Width(3.0, 3.8, 5.5),
        "bedroom": Width(3.0, 3.8, 5.5),
        "bathroom": Width(2.1, 2.6, 3.6),
        "office": Width(2.5, 3.2, 4.6),
        "laundry": Width(2.0, 2.6, 4.0),
        "storage": Width(1.9, 2.4, 4.0),
    },
    (7.0, 11.0),
)
"""Rooms of homes."""

OFFICE_STOREYS = StoreyProgram(
    "corridor",
    ("storage", "server room", "restroom", "storage"),
    ("meeting room", "office", "pantry", "restroom", "copy room"),
    ("open office", "restroom", "office", "meeting room", "lounge"),
    (
        (("storage", 2.0), ("office", 1.0)),
        (("office", 3.0), ("meeting room", 1.0)),
        (("office", 3.0), ("meeting room", 1.0), ("open office", 1.0)),
    ),
    {
        "office": Width(2.6, 3.3, 4.6),
        "open office": Width(6.5, 8.0, 14.0),
        "meeting room": Width(3.3, 4.2, 6.2),
        "restroom": Width(2.1, 2.6, 3.8),
        "pantry": Width(2.8, 3.8, 5.6),
        "copy room": Width(2.0, 2.5, 3.4),
        "storage": Width(1.9, 2.4, 4.5),
        "server room": Width(2.2, 2.7, 3.6),
        "lounge": Width(4.0, 5.2, 8.0),
    },
    (11.0, 20.0),
)
"""Rooms of offices."""


def sample_storeys(rng: RandomStream, program: StoreyProgram) -> tuple[FloorPlan, ...]:
    """Random floor plans, the lowest storey first; the storey with the entrance is at height 0."""
    for attempt in range(_ATTEMPTS):
        plans = _attempt(rng.fork("storeys", attempt), program)
        if plans is not None:
            return plans
    raise AssertionError("rooms fit into one of many attempts")


def _attempt(rng: RandomStream, program: StoreyProgram) -> tuple[FloorPlan, ...] | None:
    count = rng.choice((2, 2, 3))
    first = -1 if rng.chance(0.4) else 0
    height = rng.choice(_HEIGHTS_M)
    shape = sample_shape(rng.fork("stairs"), round(height + SLAB_M, 4))
    long = rng.uniform(*program.long, 0.05)
    hall = rng.uniform(1.6, 2.2, 0.05)
    has_atrium = rng.fork("atrium").chance(_ATRIUM_SHARE)
    hall = rng.fork("atrium", "hall").uniform(3.2, 3.8, 0.1) if has_atrium else hall
    south, north = rng.uniform(3.4, 4.8, 0.05), rng.uniform(3.4, 4.8, 0.05)
    outline = Rect(0.0, 0.0, snapped(long), snapped(south + hall + north))
    middle = (snapped(south), snapped(south + hall))
    has_door, at_the_end = rng.chance(0.4), rng.chance(0.5)
    plans: list[FloorPlan] = []
    for storey in range(count):
        own = rng.fork("storey", storey)
        cells = _cells(own, program, first + storey, outline, middle)
        if not cells:
            return None
        well = _tower(shape, outline, middle, at_the_end)
        plan = _with_openings(
            own, [*cells, ("stairwell", well)], height, has_door, first + storey == 0
        )
        if plan is None:
            return None
        stairs = _stairs(shape, len(cells), well, at_the_end).on_storey(storey, count)
        slab = SLAB_M if stairs.leads_up else 0.0
        floor_z = round((first + storey) * shape.pitch, 4)
        atrium = _atrium(outline, middle) if has_atrium else None
        plans.append(replace(plan, floor_z=floor_z, slab=slab, stairwell=stairs, atrium=atrium))
    return tuple(plans)


def _cells(
    rng: RandomStream,
    program: StoreyProgram,
    level: int,
    outline: Rect,
    middle: tuple[float, float],
) -> list[Cell]:
    """The hall and the rooms on its sides; none if they don't fit."""
    wanted = (program.basement, program.ground, program.upper)[min(level, 1) + 1]
    fillers = program.fillers[min(level, 1) + 1]
    low, high = middle
    cells: list[Cell] = [(program.hall, Rect(outline.x0, low, outline.x1, high))]
    for strip, own in (
        (Rect(outline.x0, outline.y0, outline.x1, low), wanted[::2]),
        (Rect(outline.x0, high, outline.x1, outline.y1), wanted[1::2]),
    ):
        rooms = fill_strip(rng, strip, "x", StripProgram(own, fillers, program.widths))
        if not rooms:
            return []
        cells += rooms
    return cells


def _atrium(outline: Rect, hall: tuple[float, float]) -> Rect:
    """Opening in the middle of the hall, with a gallery on all its sides."""
    middle, half = outline.centre[0], min(2.0, (outline.width - 2.0 * _GALLERY_END_M) / 2.0)
    beside = WALL_M / 2.0 + _GALLERY_M
    x0, x1 = snapped(middle - half), snapped(middle + half)
    return Rect(x0, round(hall[0] + beside, 4), x1, round(hall[1] - beside, 4))


def _tower(shape: StairShape, outline: Rect, middle: tuple[float, float], at_the_end: bool) -> Rect:
    """Cell of the stairwell at one end of the hall."""
    long, wide = (snapped(size) for size in shape.room_size)
    y0 = snapped(min(max((sum(middle) - wide) / 2.0, outline.y0), outline.y1 - wide))
    x0 = outline.x1 if at_the_end else snapped(outline.x0 - long)
    return Rect(x0, y0, snapped(x0 + long), snapped(y0 + wide))


def _stairs(shape: StairShape, room: int, cell: Rect, at_the_end: bool) -> Stairwell:
    inner = cell.grown(-WALL_M / 2.0)

    def place(u: float, v: float) -> tuple[float, float]:
        return (inner.x0 + u if at_the_end else inner.x1 - u), inner.y0 + v

    return stairwell(shape, room, place)


def _with_openings(
    rng: RandomStream, cells: Sequence[Cell], height: float, has_door: bool, has_entrance: bool
) -> FloorPlan | None:
    """The plan of one storey with doors and windows; None if not all rooms get a door."""
    rooms = named_rooms(cells)
    hall = cells[0][0]
    hubs = (hall,) if has_door else (hall, "stairwell")
    rules = Circulation(hubs, {}, (hall,))
    openings = sample_doors(rng.fork("doors"), rooms, rules)
    if openings is None:
        return None
    # Rooms open off the hall, never off the stairs.
    stairs = len(cells) - 1
    if any(stairs in one.rooms and 0 not in one.rooms for one in openings):
        return None
    if has_entrance:
        entrance = sample_entrance(rng.fork("entrance"), rooms, openings, (hall,))
        if entrance is None:
            return None
        openings = [*openings, entrance]
    windows = {kind: WindowRule() for kind, _ in cells if kind not in ("stairwell", "storage")}
    openings += sample_windows(rng.fork("windows"), rooms, openings, height, windows)
    return FloorPlan(rooms, tuple(openings), height)
