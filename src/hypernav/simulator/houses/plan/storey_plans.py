"""Random floor plans of buildings with two or three storeys, and the stairs between them.

Every storey has a hall or corridor with rooms on both sides, of its own sizes within the same outer
walls, and the stairwell at the end of the hall. In some buildings an opening in its middle goes
through all storeys, so that one looks down from galleries.

Stairs are straight, L-shaped with a corner landing or U-shaped with a half landing; some are ramps
with a half landing instead. A stairwell is a room of the same place on every storey. Its landing
lies at the side of the hall; from there the stairs lead away. The floor above is left out over the
steps, so the rest of it is a gallery from which one sees the storey below.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from hypernav.simulator.houses.plan.floor_plan import (
    WALL_M,
    FloorPlan,
    Place,
    Rail,
    Rect,
    Stairwell,
    Step,
    named_rooms,
)
from hypernav.simulator.houses.plan.openings import sample_entrance
from hypernav.simulator.houses.plan.public_plans import (
    Cell,
    Circulation,
    StripProgram,
    Width,
    WindowRule,
    fill_strip,
    sample_hub_doors,
    sample_window_rows,
    snapped,
)
from hypernav.simulator.houses.random_stream import RandomStream

STAIR_KINDS = ("straight", "L", "U")
LEAST_RISER_M, MOST_RISER_M = 0.155, 0.195
"""Height of a step, metres."""

_HEAD_M = 1.3
"""Length of a landing at the head of stairs, metres."""
_RAMPS_SHARE = 0.12
_RAMP_SLOPE = 0.27
"""Rise of a ramp per metre: 15 degrees."""

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
class StairShape:
    """Stairs away from the wall with the door: u is the distance from it, v runs along it.

    Attributes:
        kind: "straight", "L", "U" or "ramp".
        long: Extent of the stairwell along u between its walls, metres.
        wide: Extent along v, metres.
        wide_flight: Width of the steps, metres.
        landing: Extent of the landing at the door along u, metres.
        tread: Depth of a tread, metres. A flight of a ramp is one long tread.
        risers: Numbers of risers of the one or two flights; 2 for a flight of a ramp.
        pitch: Height of a storey from floor to floor, metres.
    """

    kind: str
    long: float
    wide: float
    wide_flight: float
    landing: float
    tread: float
    risers: tuple[int, ...]
    pitch: float

    @property
    def room_size(self) -> tuple[float, float]:
        """Extents of the room up to the centre lines of its walls: along u and along v, metres."""
        return self.long + WALL_M, self.wide + WALL_M


def sample_shape(rng: RandomStream, pitch: float) -> StairShape:
    """Random stairs for a height of storeys."""
    kind = rng.choice(STAIR_KINDS)
    least, most = math.ceil(pitch / MOST_RISER_M), math.floor(pitch / LEAST_RISER_M)
    risers = rng.integer(least, most)
    tread = rng.uniform(0.26, 0.29, 0.01)
    flight = rng.uniform(1.05, 1.25, 0.05)
    landing = rng.uniform(1.5, 1.8, 0.05)
    half = (risers + 1) // 2
    if rng.fork("ramp").chance(_RAMPS_SHARE):
        run = pitch / 2.0 / _RAMP_SLOPE
        long, wide = _up(landing + run + flight), _up(2 * flight + 0.1)
        return StairShape("ramp", long, wide, flight, landing, round(run, 3), (2, 2), pitch)
    if kind == "straight":
        long = landing + (risers - 1) * tread + _HEAD_M
        wide = flight + rng.uniform(1.2, 1.6, 0.05)
        parts = (risers,)
    elif kind == "L":
        long = landing + (half - 1) * tread + flight
        wide = flight + (risers - half - 1) * tread + _HEAD_M
        parts = (half, risers - half)
    else:
        if 2 * half * LEAST_RISER_M > pitch:
            half -= 1
        long = landing + (half - 1) * tread + flight
        wide = 2 * flight + rng.choice((0.1, 0.3, 0.8))
        parts = (half, half)
    return StairShape(kind, _up(long), _up(wide), flight, landing, round(tread, 3), parts, pitch)


def stairwell(shape: StairShape, room: int, place: Callable[[float, float], Place]) -> Stairwell:
    """The stairs of a shape in a room.

    Args:
        shape: The shape.
        room: Index of the room.
        place: Gives the position in the scene of a place ``(u, v)`` between the room's walls.
    """
    s, n = shape, sum(shape.risers)
    rise, w, a, first = s.pitch / n, s.wide_flight, s.landing, shape.risers[0]
    end = a + (first - 1) * s.tread
    steps = [
        (a + k * s.tread, 0.0, a + (k + 1) * s.tread, w, (k + 1) * rise) for k in range(first - 1)
    ]
    low, high = w - 0.03, w + 0.03
    rails = [((a, low), (end, low), (rise, first * rise))]
    foot = ((a - 0.03, 0.0), (a - 0.03, w))
    if s.kind == "straight":
        well = [(a, 0.0, end, w)]
        guards = [((a, high), (end, high))]
    elif s.kind == "L":
        head = w + (s.risers[1] - 1) * s.tread
        steps.append((end, 0.0, s.long, w, first * rise))
        steps += [
            (end, w + k * s.tread, s.long, w + (k + 1) * s.tread, (first + k + 1) * rise)
            for k in range(s.risers[1] - 1)
        ]
        rails.append(((end + 0.03, w), (end + 0.03, head), ((first + 1) * rise, n * rise)))
        well = [(a, 0.0, s.long, w), (end, w, s.long, head)]
        guards = [((a, high), (end - 0.03, high)), ((end - 0.03, high), (end - 0.03, head))]
    else:
        back = s.wide - w
        steps.append((end, 0.0, s.long, s.wide, first * rise))
        steps += [
            (end - (k + 1) * s.tread, back, end - k * s.tread, s.wide, (first + k + 1) * rise)
            for k in range(s.risers[1] - 1)
        ]
        rails.append(((end, back + 0.03), (a, back + 0.03), ((first + 1) * rise, n * rise)))
        rails.append(((end + 0.03, low), (end + 0.03, back + 0.03), (first * rise, first * rise)))
        well = [(a, 0.0, s.long, s.wide)]
        guards = [((a - 0.03, w), (a - 0.03, back))]
    slopes = [0.0] * len(steps)
    if s.kind == "ramp":
        middle = s.pitch / 2.0
        steps = [(*steps[0][:4], 0.0), steps[1], (*steps[2][:4], s.pitch)]
        slopes = [middle, 0.0, -middle]
        rails[:2] = [(*rails[0][:2], (0.0, middle)), (*rails[1][:2], (middle, s.pitch))]

    def rect(u0: float, v0: float, u1: float, v1: float) -> Rect:
        (x0, y0), (x1, y1) = place(u0, v0), place(u1, v1)
        corners = (min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
        return Rect(*(round(c, 4) for c in corners))

    def step(u0: float, v0: float, u1: float, v1: float, z: float, rise: float) -> Step:
        if place(u1, v1)[0] < place(u0, v0)[0]:
            z, rise = z + rise, -rise
        return Step(rect(u0, v0, u1, v1), round(z, 4), round(rise, 4))

    def rail(start: Place, end: Place, z: tuple[float, float] = (0.0, 0.0)) -> Rail:
        return Rail(place(*start), place(*end), z)

    return Stairwell(
        s.kind,
        room,
        tuple(step(*one, rise) for one, rise in zip(steps, slopes, strict=True)),
        tuple(rail(*one) for one in rails),
        tuple(rail(*one) for one in guards),
        rail(*foot),
        tuple(rect(*one) for one in well),
    )


def _up(metres: float) -> float:
    """Next length on the raster of walls, 5 cm, less a wall's thickness."""
    return round(math.ceil((metres + WALL_M) / 0.05 - 1e-6) * 0.05 - WALL_M, 4)


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
    openings = sample_hub_doors(rng.fork("doors"), rooms, rules)
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
    openings += sample_window_rows(rng.fork("windows"), rooms, openings, height, windows)
    return FloorPlan(rooms, tuple(openings), height)
