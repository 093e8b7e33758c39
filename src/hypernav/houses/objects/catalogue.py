"""Catalogue of all object models that the generator can make."""

import inspect
from collections.abc import Callable
from types import ModuleType

from hypernav.houses.materials import Palette
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.belongings import (
    household,
    leisure,
    luggage_and_tools,
    pets,
    sports,
    toys,
)
from hypernav.houses.objects.decor import ornaments, plants, textiles, wall_decor
from hypernav.houses.objects.devices import electronics, lighting, screens
from hypernav.houses.objects.furniture import (
    beds,
    cabinets,
    chairs,
    desks,
    shelves,
    sofas,
    stools,
    tables,
)
from hypernav.houses.objects.kitchen_and_bathroom import (
    appliances,
    bathing,
    kitchen_units,
    laundry,
    sanitary,
    small_appliances,
    tableware,
)
from hypernav.houses.objects.shop import clothes, counters, shelving
from hypernav.houses.objects.workplace import boards, machines, office_furniture
from hypernav.houses.random_stream import RandomStream

Maker = Callable[[RandomStream, Palette], Model]

_FAMILIES: tuple[ModuleType, ...] = (
    *(sofas, chairs, stools, beds, tables, desks, cabinets, shelves),
    *(kitchen_units, appliances, small_appliances, tableware, sanitary, bathing, laundry),
    *(lighting, screens, electronics),
    *(plants, textiles, wall_decor, ornaments),
    *(household, leisure, sports, toys, pets, luggage_and_tools),
    *(machines, office_furniture, boards),
    *(shelving, counters, clothes),
)


def all_makers() -> dict[str, Maker]:
    """Functions that make a model from random draws and a palette, by ``module.function``."""
    makers: dict[str, Maker] = {}
    for family in _FAMILIES:
        for name, function in vars(family).items():
            if name.startswith("_") or inspect.getmodule(function) is not family:
                continue
            if not inspect.isfunction(function):
                continue
            parameters = list(inspect.signature(function).parameters)
            if parameters[:2] == ["rng", "palette"] and function.__annotations__["return"] is Model:
                makers[f"{family.__name__.rpartition('.')[2]}.{name}"] = function
    return makers
