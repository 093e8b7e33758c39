"""Kinds of buildings, and generation of a building from its number."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from hypernav.simulator.houses.assembly import (
    CompactScene,
    PlacedModel,
    compact,
    name_and_label,
    to_scene,
)
from hypernav.simulator.houses.building import BUILTIN_HOUSE, VERSION, Building
from hypernav.simulator.houses.furnishing.crowded_offices import CROWDED_FURNISHING
from hypernav.simulator.houses.furnishing.home import HOME_FURNISHING
from hypernav.simulator.houses.furnishing.offices import OFFICE_FURNISHING
from hypernav.simulator.houses.furnishing.rooms import Furnishing, furnish_rooms
from hypernav.simulator.houses.furnishing.shops import SHOP_FURNISHING
from hypernav.simulator.houses.modelling.materials import sample_palette
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.houses.plan.home_plans import sample_plan, small_flat
from hypernav.simulator.houses.plan.office_plans import OFFICE_PLANS, crowded_plan
from hypernav.simulator.houses.plan.public_plans import sample_public_plan
from hypernav.simulator.houses.plan.shop_plans import SHOP_PLANS
from hypernav.simulator.houses.plan.storey_plans import HOME_STOREYS, OFFICE_STOREYS, sample_storeys
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.shell.doors_and_windows import build_openings
from hypernav.simulator.houses.shell.finishes import RoomFinish, public_finishes, room_finishes
from hypernav.simulator.houses.shell.room_surfaces import build_rooms
from hypernav.simulator.houses.shell.stairs import build_stairs
from hypernav.simulator.worlds.scenes.scene import Scene

_OFFICE_CARPETS = {
    **dict.fromkeys(("office", "open office", "meeting room", "conference room"), 0.75),
    **dict.fromkeys(("corridor", "lounge"), 0.4),
}

_SHOP_CARPETS = {
    "library": 0.6,
    "reading room": 0.6,
    "clothes shop": 0.3,
    "bookshop": 0.4,
    "office": 0.6,
}


@dataclass(frozen=True)
class BuildingKind:
    """Kind of building: its plans, its surfaces and its furniture.

    Attributes:
        sample_plan: Gives the floor plan of the building with a number.
        sample_finishes: Gives the finishes of rooms of these kinds.
        furnishing: Rules by which its rooms are furnished.
    """

    sample_plan: Callable[[RandomStream, int], FloorPlan]
    sample_finishes: Callable[[RandomStream, list[str]], list[RoomFinish]]
    furnishing: Furnishing


HOMES = BuildingKind(
    lambda rng, number: sample_plan(rng, small_flat() if number == BUILTIN_HOUSE else None),
    room_finishes,
    HOME_FURNISHING,
)
OFFICES = BuildingKind(
    lambda rng, _: sample_public_plan(rng, OFFICE_PLANS),
    partial(public_finishes, soft=_OFFICE_CARPETS),
    OFFICE_FURNISHING,
)
SHOPS = BuildingKind(
    lambda rng, _: sample_public_plan(rng, SHOP_PLANS),
    partial(public_finishes, soft=_SHOP_CARPETS),
    SHOP_FURNISHING,
)
_KINDS: dict[str, BuildingKind] = {
    "houses": HOMES,
    "offices": OFFICES,
    "shops": SHOPS,
    "crowded": replace(OFFICES, sample_plan=crowded_plan, furnishing=CROWDED_FURNISHING),
}


def _kind_of(building: Building) -> BuildingKind:
    if building.kind == "storeys":  # even numbers are homes
        return OFFICES if building.number % 2 else HOMES
    return _KINDS[building.kind]


def storeys_of(building: Building) -> tuple[FloorPlan, ...]:
    """Floor plans of a building, the lowest storey first."""
    rng = RandomStream(VERSION, *building.key, "plan")
    if building.kind == "storeys":
        return sample_storeys(rng, OFFICE_STOREYS if building.number % 2 else HOME_STOREYS)
    return (_kind_of(building).sample_plan(rng, building.number),)


def plan_of(building: Building) -> FloorPlan:
    """Floor plan of a building; of its lowest storey, if it has several."""
    return storeys_of(building)[0]


def placed_models(building: Building, plan: FloorPlan) -> list[PlacedModel]:
    """Models of a storey of the building and its furniture, each at its position."""
    kind = _kind_of(building)
    # The storeys of a building have the same finishes, and furniture to the same taste.
    rng = RandomStream(VERSION, *building.key)
    own = rng if plan.stairwell is None else rng.fork("storey", f"{plan.floor_z:.1f}")
    finishes = kind.sample_finishes(rng.fork("finishes"), [r.kind for r in plan.rooms])
    pieces = build_rooms(plan, finishes) + build_openings(plan, own.fork("openings"))
    palette = sample_palette(rng.fork("taste"))
    pieces += furnish_rooms(plan, kind.furnishing, palette, own.fork("furniture"))
    if plan.stairwell is None:
        return pieces
    pieces += build_stairs(plan, finishes[plan.stairwell.room])
    return [replace(piece, z=piece.z + plan.floor_z) for piece in pieces]


def build_compact(building: Building) -> CompactScene:
    """Building in the compact form that files hold."""
    pieces = [piece for plan in storeys_of(building) for piece in placed_models(building, plan)]
    names, labels = name_and_label(pieces)
    return compact(pieces, names, labels)


def generate(building: Building) -> Scene:
    """Scene of a building: the same bytes on every machine."""
    return to_scene(build_compact(building), building.scene)
