"""Random floor plans of homes: a program of rooms, their positions, doors and windows.

The floor is subdivided into rooms by the best of many random plans that satisfies the rules. Two
families of plans are sampled. *Strips*: rooms in one or two rows along a hall, the public rooms as
a block at its end or in the rows (a squarified row layout with a corridor, after Marson and Musse,
"Automatic real-time generation of floor plans based on squarified treemaps", 2010). *Slices*: the
footprint is cut recursively in proportion to the rooms' areas, as in slicing floor plans of circuit
design. A plan counts if every room keeps its least width and its proportions and can be reached by
the rules of `hypernav.simulator.houses.plan.openings`; of these, the one with the smallest penalty
is taken.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from hypernav.simulator.houses.plan.floor_plan import WALL_M, FloorPlan, Rect, Room, named_rooms
from hypernav.simulator.houses.plan.openings import (
    find_connections,
    sample_balcony,
    sample_doors,
    sample_entrance,
    sample_windows,
)
from hypernav.simulator.houses.random_stream import RandomStream

LIMITS: dict[str, tuple[float, float]] = {
    # Least width between walls (metres) and greatest ratio of the sides.
    "living room": (3.2, 2.0),
    "kitchen": (2.1, 2.2),
    "dining room": (2.6, 1.8),
    "bedroom": (2.6, 1.9),
    "bathroom": (1.65, 2.3),
    "hall": (1.02, 99.0),
    "office": (2.1, 2.0),
    "laundry": (1.6, 2.4),
    "storage": (1.2, 2.6),
    "balcony": (1.2, 99.0),
}

_STEP_M = 0.05
_ATTEMPTS = 400
_KEPT = 12


@dataclass(frozen=True)
class RoomSpec:
    """Specification of a room before it has a position.

    Attributes:
        kind: Kind of the room.
        area: Intended area, square metres.
    """

    kind: str
    area: float


@dataclass(frozen=True)
class Program:
    """Building program of a house.

    Attributes:
        public: Living room, kitchen and dining room.
        private: All other rooms, which open off the hall.
        has_hall: Whether rooms lie along a hall.
        balcony: Whether there is a balcony.
    """

    public: tuple[RoomSpec, ...]
    private: tuple[RoomSpec, ...]
    has_hall: bool
    balcony: bool

    @property
    def area(self) -> float:
        """Intended area of all rooms but the hall and the balcony, square metres."""
        return sum(w.area for w in (*self.public, *self.private))


def small_flat() -> Program:
    """Program of the built-in house."""
    public = (RoomSpec("living room", 20.0), RoomSpec("kitchen", 9.5))
    private = (RoomSpec("bedroom", 13.5), RoomSpec("bathroom", 5.5))
    return Program(public, private, has_hall=True, balcony=False)


def sample_program(rng: RandomStream) -> Program:
    """Random program of a house of 45 to 220 square metres."""
    total = 45.0 + 175.0 * rng.unit() ** 1.5
    if total < 52.0 and rng.chance(0.5):
        public = (RoomSpec("living room", 27.0),)
        private = (RoomSpec("bedroom", 14.5), RoomSpec("bathroom", 5.5))
        return Program(public, private, has_hall=False, balcony=rng.chance(0.4))
    public = [
        RoomSpec("living room", _within(total * 0.2, 15.0, 42.0)),
        RoomSpec("kitchen", _within(total * 0.1, 7.5, 20.0)),
    ]
    if total > 75.0 and rng.chance(0.65):
        public.append(RoomSpec("dining room", _within(total * 0.1, 9.5, 20.0)))
    bedrooms = _within(round((total - 20.0) / 38.0 + rng.uniform(-0.5, 0.5)), 1, 5)
    bathrooms = 1 + (bedrooms >= 2 and total > 85) + (bedrooms >= 4)
    private = [
        RoomSpec("bedroom", _within(total * (0.135 if k == 0 else 0.105), 9.5, 21.0))
        for k in range(int(bedrooms))
    ]
    private += [RoomSpec("bathroom", rng.uniform(4.6, 7.0)) for _ in range(bathrooms)]
    for kind, least, chance, area in (
        ("office", 70.0, 0.5, 0.07),
        ("laundry", 75.0, 0.5, 0.04),
        ("storage", 60.0, 0.4, 0.03),
    ):
        if total > least and rng.chance(chance):
            low = {"office": 7.0, "laundry": 4.2, "storage": 2.6}[kind]
            private.append(RoomSpec(kind, _within(total * area, low, low * 2.0)))
    free = max(total * 0.9, 47.0) - sum(w.area for w in (*public, *private))
    if free > 0.0:
        share = free / sum(w.area for w in public)
        public = [RoomSpec(w.kind, w.area * (1.0 + share)) for w in public]
    while len(public) + len(private) > 10:
        private.pop()
    has_hall = len(private) > 2 or rng.chance(0.7)
    return Program(tuple(public), tuple(private), has_hall, balcony=rng.chance(0.45))


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


Cells = list[tuple[RoomSpec, Rect]]


def sample_rooms(
    rng: RandomStream, program: Program, reachable: Callable[[tuple[Room, ...]], bool]
) -> tuple[Room, ...] | None:
    """Random subdivision into rooms, or None if no plan satisfies the rules.

    Args:
        rng: Source of randomness.
        program: Rooms of the house.
        reachable: Whether doors can connect these rooms by the rules.
    """
    found: list[tuple[float, tuple[Room, ...]]] = []
    rooms_wanted = len(program.public) + len(program.private)
    for _ in range(_ATTEMPTS):
        strips = program.has_hall and (rng.chance(0.75) or rooms_wanted > 7)
        cells = _strips(rng, program) if strips else _slices(rng, program)
        if cells is None:
            continue
        cells = [(spec, _snapped(rect)) for spec, rect in cells]
        if any(_breaks_limits(spec.kind, rect) for spec, rect in cells):
            continue
        if not 45.0 <= sum(r.area for _, r in cells) <= 220.0:
            continue
        rooms = named_rooms([(spec.kind, rect) for spec, rect in cells])
        penalty = sum(_penalty(spec, rect) for spec, rect in cells) + _outline_penalty(rooms)
        if found and len(found) >= _KEPT // 2 and penalty > 1.5 * min(f[0] for f in found):
            continue
        if not reachable(rooms):
            continue
        found.append((penalty, rooms))
        if len(found) >= _KEPT:
            break
    return min(found, key=lambda f: f[0])[1] if found else None


def _snapped(rect: Rect) -> Rect:
    values = (round(v / _STEP_M) * _STEP_M for v in (rect.x0, rect.y0, rect.x1, rect.y1))
    x0, y0, x1, y1 = (round(v, 4) for v in values)
    return Rect(x0, y0, x1, y1)


def _breaks_limits(kind: str, rect: Rect) -> bool:
    least, longest = LIMITS[kind]
    a, b = rect.width - WALL_M, rect.depth - WALL_M
    return min(a, b) < least - 1e-6 or max(a, b) > longest * min(a, b)


def _penalty(spec: RoomSpec, rect: Rect) -> float:
    a, b = rect.width, rect.depth
    if spec.kind == "hall":
        return 0.02 * rect.area
    return (max(a, b) / min(a, b) - 1.0) ** 2 * 0.5 + 2.0 * abs(rect.area / spec.area - 1.0)


def _outline_penalty(rooms: Sequence[Room]) -> float:
    """Penalty for rooms without an outer wall, for an elongated outline, for a far dining room."""
    penalty = 0.0
    x0, x1 = min(r.cell.x0 for r in rooms), max(r.cell.x1 for r in rooms)
    y0, y1 = min(r.cell.y0 for r in rooms), max(r.cell.y1 for r in rooms)
    for room in rooms:
        c = room.cell
        outer = c.x0 <= x0 + 1e-6 or c.x1 >= x1 - 1e-6 or c.y0 <= y0 + 1e-6 or c.y1 >= y1 - 1e-6
        if not outer:
            penalty += {"living room": 3.0, "bedroom": 3.0, "kitchen": 1.0, "office": 1.0}.get(
                room.kind, 0.1
            )
    long, short = max(x1 - x0, y1 - y0), min(x1 - x0, y1 - y0)
    penalty += 2.5 * max(long / short - 1.6, 0.0) + 0.03 * max(long - 14.0, 0.0) ** 2
    covered = sum(r.cell.area for r in rooms) / (long * short)
    penalty += 3.0 * max(0.85 - covered, 0.0)
    kitchen = next((r.cell for r in rooms if r.kind == "kitchen"), None)
    dining = next((r.cell for r in rooms if r.kind == "dining room"), None)
    if kitchen is not None and dining is not None and not kitchen.overlaps(dining, 0.01):
        penalty += 2.0
    return penalty


def _slices(rng: RandomStream, program: Program) -> Cells | None:
    specs = [*program.public, *program.private]
    if program.has_hall:
        specs.append(RoomSpec("hall", rng.uniform(4.0, 7.5)))
    area = sum(w.area for w in specs)
    wide = (area * rng.uniform(1.0, 1.8)) ** 0.5
    return _sliced(rng, Rect(0.0, 0.0, wide, area / wide), specs)


def _sliced(
    rng: RandomStream, rect: Rect, specs: Sequence[RoomSpec], tries: int = 5
) -> Cells | None:
    """Rectangle cut into rooms in proportion to their areas; None if a room breaks its limits."""
    if len(specs) == 1:
        return None if _breaks_limits(specs[0].kind, rect) else [(specs[0], rect)]
    if min(rect.width, rect.depth) < min(LIMITS[w.kind][0] for w in specs):
        return None
    for _ in range(tries):
        order = rng.shuffled(specs)
        cut = rng.integer(1, len(order) - 1)
        share = sum(w.area for w in order[:cut]) / sum(w.area for w in order)
        if (rect.width > rect.depth) != rng.chance(0.2):
            x = rect.x0 + rect.width * share
            low, high = Rect(rect.x0, rect.y0, x, rect.y1), Rect(x, rect.y0, rect.x1, rect.y1)
        else:
            y = rect.y0 + rect.depth * share
            low, high = Rect(rect.x0, rect.y0, rect.x1, y), Rect(rect.x0, y, rect.x1, rect.y1)
        first = _sliced(rng, low, order[:cut], 2)
        second = _sliced(rng, high, order[cut:], 2) if first is not None else None
        if first is not None and second is not None:
            return first + second
    return None


def _strips(rng: RandomStream, program: Program) -> Cells | None:
    """Rows of rooms on one or both sides of a hall, randomly rotated and mirrored."""
    block = list(program.public) if rng.chance(0.7) else []
    rest = [*program.private, *([] if block else program.public)]
    columns = _columns(rng, rest)
    rows = _rows(rng, columns, single=bool(block) and sum(w.area for w in rest) < 30.0)
    hall_wide = rng.uniform(1.2, 1.5, _STEP_M)
    laid = []
    for row in rows:
        small = all(w.area < 8.0 for c in row for w in c)
        deep = rng.uniform(1.9, 2.6, _STEP_M) if small else rng.uniform(2.9, 4.8, _STEP_M)
        widths = _widths(row, deep)
        if widths is None:
            return None
        laid.append((row, deep, widths))
    long = max(sum(x[0] for x in widths) for _, _, widths in laid)
    full = sum(deep for _, deep, _ in laid) + hall_wide
    x0 = round(sum(w.area for w in block) / full / _STEP_M) * _STEP_M if block else 0.0
    cells: Cells = []
    if block:
        sliced = _sliced(rng, Rect(0.0, 0.0, x0, full), block)
        if sliced is None:
            return None
        cells += sliced
    for k, (row, deep, widths) in enumerate(laid):
        placed = _row(row, _stretched(widths, long), x0, deep)
        cells += (
            placed
            if k == 0
            else [(w, Rect(r.x0, full - r.y1, r.x1, full - r.y0)) for w, r in placed]
        )
    y = laid[0][1]
    cells.append((RoomSpec("hall", 1.0), Rect(x0, y, x0 + long, y + hall_wide)))
    return _turned(rng, cells)


def _columns(rng: RandomStream, specs: Sequence[RoomSpec]) -> list[list[RoomSpec]]:
    """Columns of rooms; sometimes a small room lies behind another small one."""
    small = rng.shuffled([w for w in specs if w.area < 7.5])
    columns = [[w] for w in specs if w.area >= 7.5]
    while small:
        if len(small) >= 2 and rng.chance(0.35):
            columns.append([small.pop(), small.pop()])
        else:
            columns.append([small.pop()])
    return rng.shuffled(columns)


def _rows(
    rng: RandomStream, columns: list[list[RoomSpec]], *, single: bool
) -> list[list[list[RoomSpec]]]:
    """Columns on each side of the hall."""
    if len(columns) < 2 or (single and rng.chance(0.6)):
        return [columns]
    if rng.chance(0.35):
        # A shallow service side and a deep side.
        service = [c for c in columns if all(w.area < 8.0 for w in c)]
        rest = [c for c in columns if not all(w.area < 8.0 for w in c)]
        if service and rest:
            return [service, rest]
    goal = rng.uniform(0.4, 0.6) * sum(_area(c) for c in columns)
    first: list[list[RoomSpec]] = []
    while (
        len(first) < len(columns) - 1
        and sum(_area(c) for c in first) + _area(columns[len(first)]) / 2 < goal
    ):
        first.append(columns[len(first)])
    cut = max(len(first), 1)
    return [columns[:cut], columns[cut:]]


def _area(column: Sequence[RoomSpec]) -> float:
    return sum(w.area for w in column)


def _widths(row: Sequence[Sequence[RoomSpec]], deep: float) -> list[tuple[float, float]] | None:
    """Width and greatest width of every column; None if a column can't be so deep."""
    result = []
    for column in row:
        area = _area(column)
        low, high = 0.0, 99.0
        for spec in column:
            own = deep * spec.area / area
            least, longest = LIMITS[spec.kind]
            if own - WALL_M < least:
                return None
            low = max(low, least, (own - WALL_M) / longest)
            high = min(high, (own - WALL_M) * longest)
        if low > high:
            return None
        wide = min(max(area / deep, low + WALL_M + 0.05), high + WALL_M - 0.05)
        if not 0.6 < wide * deep / area < 1.7:
            return None
        result.append((round(wide / _STEP_M) * _STEP_M, high + WALL_M - 0.05))
    return result


def _stretched(widths: Sequence[tuple[float, float]], long: float) -> list[float]:
    """Widths that fill the row's length as far as the columns allow."""
    total = sum(w for w, _ in widths)
    if total < 0.75 * long:
        return [w for w, _ in widths]
    room = [min(high, w * 1.35) - w for w, high in widths]
    share = min((long - total) / max(sum(room), 1e-9), 1.0)
    return [w + r * share for (w, _), r in zip(widths, room, strict=True)]


def _row(
    row: Sequence[Sequence[RoomSpec]], widths: Sequence[float], x: float, deep: float
) -> Cells:
    """Columns side by side below the hall, which is at y = deep."""
    cells: Cells = []
    for column, wide in zip(row, widths, strict=True):
        level = deep
        for spec in column:
            own = deep * spec.area / _area(column)
            cells.append((spec, Rect(x, level - own, x + wide, level)))
            level -= own
        x += wide
    return cells


def _turned(rng: RandomStream, cells: Cells) -> Cells:
    turn, flip = rng.chance(0.5), rng.chance(0.5)
    result = []
    for spec, r in cells:
        x0, x1 = (-r.x1, -r.x0) if flip else (r.x0, r.x1)
        result.append((spec, Rect(r.y0, x0, r.y1, x1) if turn else Rect(x0, r.y0, x1, r.y1)))
    low_x = min(r.x0 for _, r in result)
    low_y = min(r.y0 for _, r in result)
    return [(w, Rect(r.x0 - low_x, r.y0 - low_y, r.x1 - low_x, r.y1 - low_y)) for w, r in result]


def sample_plan(rng: RandomStream, program: Program | None = None) -> FloorPlan:
    """Random floor plan that satisfies all rules.

    Args:
        rng: Source of randomness.
        program: Rooms of the house; sampled if None. Rooms are left out if no plan holds them all.
    """
    wanted = program or sample_program(rng.fork("program"))
    for attempt in range(1000):
        plan = _attempt(rng.fork("plan", attempt), wanted)
        if plan is not None:
            return plan
        if attempt % 2 == 1:
            wanted = _easier(wanted)
    raise AssertionError("a flat of four rooms always fits")


def _easier(program: Program) -> Program:
    """Simpler program: first with a hall, then with fewer rooms, finally the small flat."""
    if not program.has_hall and len(program.public) > 1:
        return replace(program, has_hall=True)
    if len(program.private) > 4:
        return replace(program, private=program.private[:-1])
    return small_flat()


def _attempt(rng: RandomStream, program: Program) -> FloorPlan | None:
    rooms = sample_rooms(rng.fork("rooms"), program, lambda r: find_connections(r) is not None)
    if rooms is None:
        return None
    doors = sample_doors(rng.fork("doors"), rooms)
    if doors is None:
        return None
    entrance = sample_entrance(rng.fork("entrance"), rooms, doors)
    if entrance is None:
        return None
    openings = [*doors, entrance]
    if program.balcony:
        rooms, glass = sample_balcony(rng.fork("balcony"), rooms, openings)
        openings += [glass] if glass is not None else []
    height = rng.uniform(2.5, 2.75, 0.05)
    openings += sample_windows(rng.fork("windows"), rooms, openings, height)
    return centred(FloorPlan(rooms, tuple(openings), height))


def centred(plan: FloorPlan) -> FloorPlan:
    """Floor plan moved so that its middle is the origin, to 0.1 m."""
    cells = [room.cell for room in plan.rooms]
    dx = -round((min(c.x0 for c in cells) + max(c.x1 for c in cells)) / 2.0, 1)
    dy = -round((min(c.y0 for c in cells) + max(c.y1 for c in cells)) / 2.0, 1)

    def moved(r: Rect) -> Rect:
        x0, y0, x1, y1 = (round(v, 4) for v in (r.x0 + dx, r.y0 + dy, r.x1 + dx, r.y1 + dy))
        return Rect(x0, y0, x1, y1)

    openings = []
    for o in plan.openings:
        across, along = (dy, dx) if o.along == "x" else (dx, dy)
        openings.append(
            replace(
                o,
                at=round(o.at + across, 4),
                start=round(o.start + along, 4),
                end=round(o.end + along, 4),
            )
        )
    return FloorPlan(
        tuple(replace(r, cell=moved(r.cell)) for r in plan.rooms), tuple(openings), plan.height
    )
