"""Generation of a building from its number."""

from hypernav.houses.assembly import CompactScene, PlacedModel, compact, to_scene
from hypernav.houses.building import VERSION, Building
from hypernav.houses.furnishing.rooms import furnish_rooms
from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.kinds.crowded import CROWDED
from hypernav.houses.kinds.homes import HOMES
from hypernav.houses.kinds.offices import OFFICES
from hypernav.houses.kinds.shops import SHOPS
from hypernav.houses.labelling import name_and_label
from hypernav.houses.materials import sample_palette
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.doors_and_windows import build_openings
from hypernav.houses.shell.room_surfaces import build_rooms
from hypernav.worlds.scenes.scene import Scene

_KINDS: dict[str, BuildingKind] = {
    "houses": HOMES,
    "offices": OFFICES,
    "shops": SHOPS,
    "crowded": CROWDED,
}


def plan_of(building: Building) -> FloorPlan:
    """Floor plan of a building."""
    rng = RandomStream(VERSION, *building.key, "plan")
    return _KINDS[building.kind].sample_plan(rng, building.number)


def placed_models(building: Building, plan: FloorPlan) -> list[PlacedModel]:
    """Models of the building and its furniture, each at its position."""
    kind = _KINDS[building.kind]
    rng = RandomStream(VERSION, *building.key)
    finishes = kind.sample_finishes(rng.fork("finishes"), [r.kind for r in plan.rooms])
    pieces = build_rooms(plan, finishes) + build_openings(plan, rng.fork("openings"))
    palette = sample_palette(rng.fork("taste"))
    return pieces + furnish_rooms(plan, kind.furnishing, palette, rng.fork("furniture"))


def build_compact(building: Building) -> CompactScene:
    """Building in the compact form that files hold."""
    pieces = placed_models(building, plan_of(building))
    names, labels = name_and_label(pieces)
    return compact(pieces, names, labels)


def generate(building: Building) -> Scene:
    """Scene of a building: the same bytes on every machine."""
    return to_scene(build_compact(building), building.scene)
