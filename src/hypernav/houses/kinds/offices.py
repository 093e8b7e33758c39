"""Offices of 60 to 800 square metres."""

from hypernav.houses.furnishing.workplace.office_building import OFFICE_FURNISHING
from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.plan.office_plans import OFFICE_PLANS
from hypernav.houses.plan.public_plans import sample_public_plan
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.public_finishes import public_finishes
from hypernav.houses.shell.room_finishes import RoomFinish

_SOFT = {
    **dict.fromkeys(("office", "open office", "meeting room", "conference room"), 0.75),
    **dict.fromkeys(("corridor", "lounge"), 0.4),
}


def _plan(rng: RandomStream, _number: int) -> FloorPlan:
    return sample_public_plan(rng, OFFICE_PLANS)


def _finishes(rng: RandomStream, kinds: list[str]) -> list[RoomFinish]:
    return public_finishes(rng, kinds, _SOFT)


OFFICES = BuildingKind(_plan, _finishes, OFFICE_FURNISHING)
