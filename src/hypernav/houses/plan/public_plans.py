"""Random floor plans of public buildings: an area, one of several layouts, doors and windows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from hypernav.houses.plan.circulation import Circulation, WindowRule, sample_doors, sample_windows
from hypernav.houses.plan.sampling import centred
from hypernav.houses.plan.shapes import FloorPlan, named_rooms
from hypernav.houses.plan.strips import Cell
from hypernav.houses.plan.windows import sample_entrance
from hypernav.houses.random_stream import RandomStream

LEAST_M2, MOST_M2 = 60.0, 800.0
"""Least and greatest area of all rooms of a public building, walls included."""

_ATTEMPTS = 60
"""Number of attempts with one layout before the simplest replaces it."""


@dataclass(frozen=True)
class Layout:
    """One way to arrange the rooms of a kind of building.

    Attributes:
        sample_cells: Gives rooms of about an area in square metres; none if they don't fit.
        least_m2: Least area that the layout needs.
        weight: How often it is taken, in proportion to the others that fit.
        circulation: How people walk through it.
    """

    sample_cells: Callable[[RandomStream, float], list[Cell]]
    least_m2: float
    weight: float
    circulation: Circulation


@dataclass(frozen=True)
class PlanRules:
    """Rules of the floor plans of a kind of public building.

    Attributes:
        layouts: Its layouts; the first fits at every area.
        windows: Windows by kind of room.
        heights: Least and greatest height of the rooms, metres.
    """

    layouts: Sequence[Layout]
    windows: Mapping[str, WindowRule]
    heights: tuple[float, float]


def sample_public_plan(rng: RandomStream, rules: PlanRules) -> FloorPlan:
    """Random floor plan of 60 to 800 square metres."""
    wanted = LEAST_M2 + 10.0 + (MOST_M2 - LEAST_M2 - 40.0) * rng.unit() ** 1.4
    layout = rng.weighted([(one, one.weight) for one in rules.layouts if wanted > one.least_m2])
    for attempt in range(1000):
        chosen = layout if attempt < _ATTEMPTS else rules.layouts[0]
        plan = _attempt(rng.fork("plan", attempt), wanted, chosen, rules)
        if plan is not None:
            return plan
    raise AssertionError("the first layout fits at every area")


def _attempt(
    rng: RandomStream, wanted: float, layout: Layout, rules: PlanRules
) -> FloorPlan | None:
    cells = layout.sample_cells(rng.fork("rooms"), wanted)
    if not cells or not LEAST_M2 <= sum(rect.area for _, rect in cells) <= MOST_M2:
        return None
    rooms = named_rooms(cells)
    doors = sample_doors(rng.fork("doors"), rooms, layout.circulation)
    if doors is None:
        return None
    entrances = layout.circulation.entrances
    entrance = sample_entrance(rng.fork("entrance"), rooms, doors, entrances)
    if entrance is None:
        return None
    height = rng.uniform(*rules.heights, 0.05)
    openings = [*doors, entrance]
    openings += sample_windows(rng.fork("windows"), rooms, openings, height, rules.windows)
    return centred(FloorPlan(rooms, tuple(openings), height))
