"""Homes: houses and flats of 45 to 220 square metres."""

from hypernav.houses.building import BUILTIN_HOUSE
from hypernav.houses.furnishing.home import HOME_FURNISHING
from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.plan.program import small_flat
from hypernav.houses.plan.sampling import sample_plan
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.room_finishes import room_finishes


def _plan(rng: RandomStream, number: int) -> FloorPlan:
    return sample_plan(rng, small_flat() if number == BUILTIN_HOUSE else None)


HOMES = BuildingKind(_plan, room_finishes, HOME_FURNISHING)
