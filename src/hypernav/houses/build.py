"""A house from its number."""

from hypernav.houses.assembly import CompactScene, Placed, compact, to_scene
from hypernav.houses.dice import Dice
from hypernav.houses.furnish.rooms import furnish_rooms
from hypernav.houses.labelling import name_pieces
from hypernav.houses.palette import draw_taste
from hypernav.houses.plan.draw import draw_plan
from hypernav.houses.plan.program import small_flat
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.shell.finishes import room_finishes
from hypernav.houses.shell.openings import build_openings
from hypernav.houses.shell.rooms import build_rooms
from hypernav.worlds.scenes.scene import Scene

BUILTIN_HOUSE = 0
"""Number of the house that ships as the built-in scene: a small flat."""

VERSION = 1
"""Rises whenever a number gives another house than before."""


def plan_of(number: int) -> FloorPlan:
    """The floor plan of a house."""
    dice = Dice(VERSION, number, "plan")
    return draw_plan(dice, small_flat() if number == BUILTIN_HOUSE else None)


def pieces_of(number: int, plan: FloorPlan) -> list[Placed]:
    """Building and furniture of a house."""
    dice = Dice(VERSION, number)
    finishes = room_finishes(dice.fork("finishes"), [r.kind for r in plan.rooms])
    pieces = build_rooms(plan, finishes) + build_openings(plan, dice.fork("openings"))
    return pieces + furnish_rooms(plan, draw_taste(dice.fork("taste")), dice.fork("furniture"))


def build_compact(number: int) -> CompactScene:
    """A house in the form that files hold."""
    pieces = pieces_of(number, plan_of(number))
    names, labels = name_pieces(pieces)
    return compact(pieces, names, labels)


def build_house(number: int) -> Scene:
    """The house of a number: the same bytes on every machine.

    Args:
        number: 0 is the built-in flat; any other whole number from 1 on is some house.

    Raises:
        ValueError: The number is negative.
    """
    if number < 0:
        raise ValueError(f"house numbers start at 0, got {number}")
    return to_scene(build_compact(number), f"houses:{number}")
