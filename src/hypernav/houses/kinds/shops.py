"""Shops, libraries and arcades of 60 to 800 square metres."""

from hypernav.houses.furnishing.trade.shop_building import SHOP_FURNISHING
from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.plan.public_plans import sample_public_plan
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.plan.shop_plans import SHOP_PLANS
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.public_finishes import public_finishes
from hypernav.houses.shell.room_finishes import RoomFinish

_SOFT = {"library": 0.6, "reading room": 0.6, "clothes shop": 0.3, "bookshop": 0.4, "office": 0.6}


def _plan(rng: RandomStream, _number: int) -> FloorPlan:
    return sample_public_plan(rng, SHOP_PLANS)


def _finishes(rng: RandomStream, kinds: list[str]) -> list[RoomFinish]:
    return public_finishes(rng, kinds, _SOFT)


SHOPS = BuildingKind(_plan, _finishes, SHOP_FURNISHING)
