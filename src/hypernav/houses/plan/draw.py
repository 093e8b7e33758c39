"""A floor plan from chance: rooms, doors, windows."""

from dataclasses import replace

from hypernav.houses.dice import Dice
from hypernav.houses.plan.doors import draw_doors, find_links
from hypernav.houses.plan.layout import draw_rooms
from hypernav.houses.plan.program import Program, draw_program, small_flat
from hypernav.houses.plan.shapes import FloorPlan, Rect
from hypernav.houses.plan.windows import draw_balcony, draw_entrance, draw_windows


def draw_plan(dice: Dice, program: Program | None = None) -> FloorPlan:
    """A plan that satisfies all rules.

    Args:
        dice: Chance.
        program: The rooms wanted; drawn as well if None. A room is given up if no plan holds them.
    """
    wanted = program or draw_program(dice.fork("program"))
    for attempt in range(1000):
        plan = _attempt(dice.fork("plan", attempt), wanted)
        if plan is not None:
            return plan
        if attempt % 2 == 1:
            wanted = _easier(wanted)
    raise AssertionError("a flat of four rooms always fits")


def _easier(program: Program) -> Program:
    """First with a hall, then with fewer rooms, and at last the small flat, which always fits."""
    if not program.has_hall and len(program.public) > 1:
        return replace(program, has_hall=True)
    if len(program.private) > 4:
        return replace(program, private=program.private[:-1])
    return small_flat()


def _attempt(dice: Dice, program: Program) -> FloorPlan | None:
    rooms = draw_rooms(dice.fork("rooms"), program, lambda r: find_links(r) is not None)
    if rooms is None:
        return None
    doors = draw_doors(dice.fork("doors"), rooms)
    if doors is None:
        return None
    entrance = draw_entrance(dice.fork("entrance"), rooms, doors)
    if entrance is None:
        return None
    openings = [*doors, entrance]
    if program.balcony:
        rooms, glass = draw_balcony(dice.fork("balcony"), rooms, openings)
        openings += [glass] if glass is not None else []
    height = dice.uniform(2.5, 2.75, 0.05)
    openings += draw_windows(dice.fork("windows"), rooms, openings, height)
    x = (min(r.cell.x0 for r in rooms) + max(r.cell.x1 for r in rooms)) / 2.0
    y = (min(r.cell.y0 for r in rooms) + max(r.cell.y1 for r in rooms)) / 2.0
    return _shifted(FloorPlan(rooms, tuple(openings), height), -round(x, 1), -round(y, 1))


def _shifted(plan: FloorPlan, dx: float, dy: float) -> FloorPlan:
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
