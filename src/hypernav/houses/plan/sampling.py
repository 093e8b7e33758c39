"""Random floor plans with rooms, doors and windows."""

from dataclasses import replace

from hypernav.houses.plan.doors import find_connections, sample_doors
from hypernav.houses.plan.program import Program, sample_program, small_flat
from hypernav.houses.plan.shapes import FloorPlan, Rect
from hypernav.houses.plan.subdivision import sample_rooms
from hypernav.houses.plan.windows import sample_balcony, sample_entrance, sample_windows
from hypernav.houses.random_stream import RandomStream


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
