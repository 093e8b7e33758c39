"""All kinds of furniture that the generator can make."""

import inspect
from collections.abc import Callable
from types import ModuleType

from hypernav.houses.dice import Dice
from hypernav.houses.furniture.belongings import belongings, household, pastime, pets, sport, toys
from hypernav.houses.furniture.decor import ornaments, plants, textiles, walls
from hypernav.houses.furniture.devices import electronics, gadgets, lighting, screens
from hypernav.houses.furniture.kitchen_and_bath import (
    appliances,
    bathing,
    bathroom,
    kitchen,
    laundry,
    tableware,
)
from hypernav.houses.furniture.seating_and_storage import (
    beds,
    cabinets,
    chairs,
    desks,
    shelves,
    sofas,
    stools,
    tables,
)
from hypernav.houses.kit.model import Model
from hypernav.houses.palette import Taste

Maker = Callable[[Dice, Taste], Model]

_FAMILIES: tuple[ModuleType, ...] = (
    *(sofas, chairs, stools, beds, tables, desks, cabinets, shelves, lighting, plants, screens),
    *(kitchen, appliances, gadgets, tableware, bathroom, bathing, laundry, household, electronics),
    *(textiles, walls, ornaments, pastime, sport, toys, pets, belongings),
)


def all_makers() -> dict[str, Maker]:
    """Every function of the families that makes a piece from chance and taste, by name."""
    makers: dict[str, Maker] = {}
    for family in _FAMILIES:
        for name, function in vars(family).items():
            if name.startswith("_") or inspect.getmodule(function) is not family:
                continue
            if not inspect.isfunction(function):
                continue
            parameters = list(inspect.signature(function).parameters)
            if parameters[:2] == ["dice", "taste"] and function.__annotations__["return"] is Model:
                makers[f"{family.__name__.rpartition('.')[2]}.{name}"] = function
    return makers
