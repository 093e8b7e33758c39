"""Generation of a building from its number."""

from dataclasses import replace

from hypernav.houses.assembly import CompactScene, PlacedModel, compact, to_scene
from hypernav.houses.building import VERSION, Building
from hypernav.houses.furnishing.rooms import furnish_rooms
from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.kinds.crowded import CROWDED
from hypernav.houses.kinds.homes import HOMES
from hypernav.houses.kinds.offices import OFFICES
from hypernav.houses.kinds.shops import SHOPS
from hypernav.houses.kinds.storeys import kind_of, program_of
from hypernav.houses.labelling import name_and_label
from hypernav.houses.materials import sample_palette
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.plan.storey_plans import sample_storeys
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.doors_and_windows import build_openings
from hypernav.houses.shell.room_surfaces import build_rooms
from hypernav.houses.shell.stairs import build_stairs
from hypernav.worlds.scenes.scene import Scene

_KINDS: dict[str, BuildingKind] = {
    "houses": HOMES,
    "offices": OFFICES,
    "shops": SHOPS,
    "crowded": CROWDED,
}


def _kind_of(building: Building) -> BuildingKind:
    return kind_of(building.number) if building.kind == "storeys" else _KINDS[building.kind]


def storeys_of(building: Building) -> tuple[FloorPlan, ...]:
    """Floor plans of a building, the lowest storey first."""
    rng = RandomStream(VERSION, *building.key, "plan")
    if building.kind == "storeys":
        return sample_storeys(rng, program_of(building.number))
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
