"""Kinds of buildings, and generation of a building from its number."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from hypernav.houses.assembly import CompactScene, PlacedModel, compact, name_and_label, to_scene
from hypernav.houses.building import BUILTIN_HOUSE, VERSION, Building
from hypernav.houses.furnishing.crowded_offices import CROWDED_FURNISHING
from hypernav.houses.furnishing.home import HOME_FURNISHING
from hypernav.houses.furnishing.offices import OFFICE_FURNISHING
from hypernav.houses.furnishing.rooms import Furnishing, furnish_rooms
from hypernav.houses.furnishing.shops import SHOP_FURNISHING
from hypernav.houses.modelling.materials import sample_palette
from hypernav.houses.plan.floor_plan import FloorPlan
from hypernav.houses.plan.home_plans import sample_plan, small_flat
from hypernav.houses.plan.office_plans import OFFICE_PLANS, crowded_plan
from hypernav.houses.plan.public_plans import sample_public_plan
from hypernav.houses.plan.shop_plans import SHOP_PLANS
from hypernav.houses.plan.storey_plans import (
    HOME_STOREYS,
    OFFICE_STOREYS,
    StoreyProgram,
    sample_storeys,
)
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.doors_and_windows import build_openings
from hypernav.houses.shell.finishes import RoomFinish, public_finishes, room_finishes
from hypernav.houses.shell.room_surfaces import build_rooms
from hypernav.houses.shell.stairs import build_stairs
from hypernav.worlds.scenes.scene import Scene

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


def _home_plan(rng: RandomStream, number: int) -> FloorPlan:
    return sample_plan(rng, small_flat() if number == BUILTIN_HOUSE else None)


HOMES = BuildingKind(_home_plan, room_finishes, HOME_FURNISHING)


def _office_plan(rng: RandomStream, _number: int) -> FloorPlan:
    return sample_public_plan(rng, OFFICE_PLANS)


def _office_finishes(rng: RandomStream, kinds: list[str]) -> list[RoomFinish]:
    return public_finishes(rng, kinds, _OFFICE_CARPETS)


OFFICES = BuildingKind(_office_plan, _office_finishes, OFFICE_FURNISHING)


CROWDED = replace(OFFICES, sample_plan=crowded_plan, furnishing=CROWDED_FURNISHING)


def _shop_plan(rng: RandomStream, _number: int) -> FloorPlan:
    return sample_public_plan(rng, SHOP_PLANS)


def _shop_finishes(rng: RandomStream, kinds: list[str]) -> list[RoomFinish]:
    return public_finishes(rng, kinds, _SHOP_CARPETS)


SHOPS = BuildingKind(_shop_plan, _shop_finishes, SHOP_FURNISHING)


def _storeyed_kind(number: int) -> BuildingKind:
    """Finishes and furniture of the building with a number."""
    return OFFICES if number % 2 else HOMES


def _storeyed_program(number: int) -> StoreyProgram:
    """Rooms of the building with a number."""
    return OFFICE_STOREYS if number % 2 else HOME_STOREYS


_KINDS: dict[str, BuildingKind] = {
    "houses": HOMES,
    "offices": OFFICES,
    "shops": SHOPS,
    "crowded": CROWDED,
}


def _kind_of(building: Building) -> BuildingKind:
    return _storeyed_kind(building.number) if building.kind == "storeys" else _KINDS[building.kind]


def storeys_of(building: Building) -> tuple[FloorPlan, ...]:
    """Floor plans of a building, the lowest storey first."""
    rng = RandomStream(VERSION, *building.key, "plan")
    if building.kind == "storeys":
        return sample_storeys(rng, _storeyed_program(building.number))
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
