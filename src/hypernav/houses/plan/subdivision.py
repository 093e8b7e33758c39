"""Subdivision of the floor into rooms: the best of many random plans that satisfies the rules.

Two families of plans are sampled. *Strips*: rooms in one or two rows along a hall, the public rooms
as a block at its end or in the rows (a squarified row layout with a corridor, after Marson and
Musse, "Automatic real-time generation of floor plans based on squarified treemaps", 2010).
*Slices*: the footprint is cut recursively in proportion to the rooms' areas, as in slicing
floor plans of circuit design. A plan counts if every room keeps its least width and its
proportions and can be reached by the rules of `hypernav.houses.plan.doors`; of these, the one with
the smallest penalty is taken.
"""

from collections.abc import Callable, Sequence

from hypernav.houses.plan.program import LIMITS, Program, RoomSpec
from hypernav.houses.plan.shapes import WALL_M, Rect, Room, named_rooms
from hypernav.houses.random_stream import RandomStream

_STEP_M = 0.05
_ATTEMPTS = 400
_KEPT = 12

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
