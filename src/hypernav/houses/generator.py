"""Generation of a house from its number."""

from hypernav.houses.assembly import CompactScene, PlacedModel, compact, to_scene
from hypernav.houses.furnishing.house import furnish_rooms
from hypernav.houses.labelling import name_and_label
from hypernav.houses.materials import sample_palette
from hypernav.houses.numbers import BUILTIN_HOUSE, VERSION
from hypernav.houses.plan.program import small_flat
from hypernav.houses.plan.sampling import sample_plan
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.doors_and_windows import build_openings
from hypernav.houses.shell.room_finishes import room_finishes
from hypernav.houses.shell.room_surfaces import build_rooms
from hypernav.worlds.scenes.scene import Scene


def plan_of(number: int) -> FloorPlan:
    """Floor plan of a house."""
    rng = RandomStream(VERSION, number, "plan")
    return sample_plan(rng, small_flat() if number == BUILTIN_HOUSE else None)


def placed_models(number: int, plan: FloorPlan) -> list[PlacedModel]:
    """Models of the building and its furniture, each at its position in the house."""
    rng = RandomStream(VERSION, number)
    finishes = room_finishes(rng.fork("finishes"), [r.kind for r in plan.rooms])
    pieces = build_rooms(plan, finishes) + build_openings(plan, rng.fork("openings"))
    return pieces + furnish_rooms(plan, sample_palette(rng.fork("taste")), rng.fork("furniture"))


def build_compact(number: int) -> CompactScene:
    """House in the compact form that files hold."""
    pieces = placed_models(number, plan_of(number))
    names, labels = name_and_label(pieces)
    return compact(pieces, names, labels)


def build_house(number: int) -> Scene:
    """Scene of a house: the same bytes on every machine.

    Args:
        number: Number of the house; 0 is the built-in flat.

    Raises:
        ValueError: The number is negative.
    """
    if number < 0:
        raise ValueError(f"house numbers start at 0, got {number}")
    return to_scene(build_compact(number), f"houses:{number}")
